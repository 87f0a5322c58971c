// The studies "integrator": what free bodies lose over a run, against the time that a second of one of them takes.
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/integrator_baselines.hpp>
#include <carom/studies/accuracy/integrator_cases.hpp>
#include <carom/studies/accuracy/integrator_digest.hpp>

#include <fmt/format.h>

#include <array>
#include <utility>

namespace carom::accuracy {
namespace {

using MakeEngine = std::function<std::unique_ptr<Engine>()>;

Sample one_pass(Engine& engine, const FreeCases& cases, FreeMeasure measure, double dt) {
    const Track track = follow(engine, cases.bodies, cases.times, dt);
    const double seconds = track.seconds / (static_cast<double>(cases.bodies.moving.size()) * cases.duration());
    const std::optional<double> error = error_of(cases, track, measure);
    return {seconds, error, error ? 0u : 1u};
}

// Of a study: which cases, what is measured, and what it is called.
struct Question {
    std::string name;
    FreeCasesPtr cases;
    FreeMeasure measure;
    FreeKind kind;
    std::vector<double> steps;  ///< dt, falling [s]

    [[nodiscard]] Candidate candidate(std::string who, Settings settings, double dt, MakeEngine make) const {
        settings.emplace_back("dt", dt);
        return {std::move(who), std::move(settings), [cases = cases, measure = measure, dt, make = std::move(make)] {
                    const std::unique_ptr<Engine> engine = make();
                    return one_pass(*engine, *cases, measure, dt);
                }};
    }
};

void add_worlds(const Question& q, Study& study) {
    const auto add = [&](double tolerance, int substeps, double dt) {
        const WorldDef def{.substeps = substeps, .spin_tolerance = tolerance};
        study.candidates.push_back(q.candidate("carom", {{"call", "world"}, {"tolerance", tolerance}, {"substeps", static_cast<double>(substeps)}}, dt,
                                               [cases = q.cases, def] { return make_carom(cases->make(def)); }));
    };
    for (const double dt : q.steps) add(1e-6, 8, dt);
    if (q.kind == FreeKind::Scene) return;
    add(1e-6, 1, q.steps[3]);  // free bodies know no substeps: the same error
    if (q.kind != FreeKind::Asymmetric) return;
    for (const double dt : q.steps) add(1.0, 8, dt);
    for (const double tolerance : {1e-3, 1e-9, 1e-12}) {
        for (const double dt : q.steps) add(tolerance, 8, dt);
    }
}

void add_rotations(const Question& q, Study& study) {
    const auto add = [&](const char* scheme, const SpinSettings& settings) {
        for (const double dt : q.steps) {
            study.candidates.push_back(q.candidate("carom", {{"call", "rotate_free"}, {"scheme", scheme}}, dt, [cases = q.cases, settings] {
                return make_rotation(cases->bodies, settings);
            }));
        }
    };
    if (q.kind != FreeKind::Asymmetric) return add("exact", {});
    add("strang", {.tolerance = 1.0, .scheme = SpinScheme::Strang});
    add("fourth_order", {.tolerance = 1.0, .scheme = SpinScheme::FourthOrder});
}

const char* words_of(FreeMeasure measure) {
    switch (measure) {
        case FreeMeasure::Orientation: return "largest angle between orientations over bodies and times";
        case FreeMeasure::Energy: return "largest relative error of the kinetic energy of rotation over bodies and times";
        case FreeMeasure::Momentum: return "largest relative error of the angular momentum over bodies and times";
        case FreeMeasure::Position: return "largest distance between centres of mass over the way, over bodies and times";
    }
    return "";
}

Study study_of(const Question& q, const StudyOptions& options) {
    Study study{.name = q.name,
                .stage = "integrator",
                .error = words_of(q.measure),
                .unit = q.measure == FreeMeasure::Orientation ? "rad" : "1",
                .oracle = fmt::format("Taylor's series of order 32 in long double; {} free {} over {} s", q.cases->bodies.moving.size(),
                                      q.cases->bodies.moving.size() == 1 ? "body" : "bodies", q.cases->duration()),
                .time = "a second of one body, of the processor",
                .cases = {{"kind", std::string(to_string(q.kind))}}};
    add_worlds(q, study);
    if (q.kind != FreeKind::Scene) add_rotations(q, study);
    for (const double dt : q.steps) {
        study.candidates.push_back(q.candidate("euler", {}, dt, [cases = q.cases] { return make_semi_implicit_euler(cases->bodies); }));
        for (const EngineMaker& peer : options.engine_peers) {
            study.candidates.push_back(q.candidate(peer.who, {}, dt, [cases = q.cases, make = peer.make] { return make(cases->bodies); }));
        }
    }
    return study;
}

// Powers of two: every time that is compared is a whole number of them to the last bit.
std::vector<double> steps_of(FreeKind kind, bool quick) {
    if (kind == FreeKind::Scene) return {1.0 / 60.0};
    std::vector<double> steps;
    for (int n = 8; n <= (quick ? 128 : 512); n *= 2) steps.push_back(1.0 / n);
    return steps;
}

}  // namespace

std::vector<Study> integrator_studies(const StudyOptions& options) {
    constexpr std::array kTurning{std::pair{"", FreeMeasure::Orientation}, std::pair{"_energy", FreeMeasure::Energy},
                                  std::pair{"_momentum", FreeMeasure::Momentum}};
    std::vector<Study> studies;
    for (const FreeKind kind : {FreeKind::Asymmetric, FreeKind::Symmetric, FreeKind::Isotropic, FreeKind::Falling, FreeKind::Scene}) {
        const bool scene = kind == FreeKind::Scene;
        const FreeCasesPtr cases = free_cases(kind, options.quick ? 3 : 8, scene ? (options.quick ? 10.0 : 60.0) : (options.quick ? 2.0 : 10.0));
        const std::string name = kind == FreeKind::Asymmetric ? "integrator" : fmt::format("integrator_{}", to_string(kind));
        const auto add = [&](const std::string& suffix, FreeMeasure measure) {
            studies.push_back(study_of({name + suffix, cases, measure, kind, steps_of(kind, options.quick)}, options));
        };
        if (kind == FreeKind::Falling) {
            add("", FreeMeasure::Position);
            continue;
        }
        for (const auto& [suffix, measure] : kTurning) {
            if (!scene || measure != FreeMeasure::Orientation) add(suffix, measure);
        }
    }
    return studies;
}

}  // namespace carom::accuracy
