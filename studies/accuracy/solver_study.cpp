// The studies "solver": the same resting bodies by each contact method, and how far the forces that it finds are from holding them.
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/solver_cases.hpp>

#include <carom/studies/oracle/contact_forces.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace carom::accuracy {
namespace {

constexpr double kDt = 1.0 / 60.0;

struct Knobs {
    ContactMethod method = ContactMethod::Soft;
    int passes = 8;     ///< substeps of the soft method, passes of the impulses
    int steps = 1;      ///< each starts from the impulses of the one before
    double sag = 1e-4;  ///< of the direct method
};

std::vector<Knobs> knobs_of(bool quick) {
    std::vector<Knobs> all;
    for (const int steps : {1, 10, 60}) {
        if (quick && steps != 10) continue;
        for (const int n : {1, 2, 4, 8, 16, 32}) {
            if (!quick || n == 8) all.push_back({ContactMethod::Soft, n, steps});
        }
        for (const int n : {2, 4, 8, 16, 32, 64, 128}) {
            if (!quick || n == 8 || n == 64) all.push_back({ContactMethod::Impulses, n, steps});
        }
        for (const double sag : {1e-3, 1e-4, 1e-5}) {
            if (!quick || sag == 1e-4) all.push_back({ContactMethod::Direct, 8, steps, sag});
        }
    }
    return all;
}

Settings settings_of(const Knobs& knobs) {
    Settings out{{"method", std::string(to_string(knobs.method))}};
    if (knobs.method == ContactMethod::Soft) out.emplace_back("substeps", static_cast<double>(knobs.passes));
    if (knobs.method == ContactMethod::Impulses) out.emplace_back("passes", static_cast<double>(knobs.passes));
    if (knobs.method == ContactMethod::Direct) out.emplace_back("sag", knobs.sag);
    out.emplace_back("steps", static_cast<double>(knobs.steps));
    return out;
}

double force_error(const SolverCase& problem, const oracle::ContactForces& forces) {
    double worst = 0.0;
    for (std::size_t i = 0; i < problem.carried.size(); ++i) worst = std::max(worst, std::abs(forces.carried[i] / problem.carried[i] - 1.0));
    return worst;
}

struct Asked {
    std::vector<SolverCasePtr> problems;
    bool force = false;  ///< against statics, not the balance
};

double error_of(const SolverCase& problem, const Asked& asked, const World& world) {
    const oracle::ContactForces forces = oracle::contact_forces(world, kDt);
    return asked.force ? force_error(problem, forces) : std::max({forces.unbalanced, forces.pull, forces.beyond_cone});
}

Sample one_pass(const Asked& asked, const Knobs& knobs) {
    Sample sample{0.0, 0.0, 0};
    const auto count = static_cast<double>(asked.problems.size());
    for (const SolverCasePtr& problem : asked.problems) {
        World world = problem->make({.substeps = knobs.passes, .contact_method = knobs.method, .direct_sag = knobs.sag, .direct_budget = 2'000'000});
        const ThreadStopwatch watch;
        for (int i = 0; i < knobs.steps; ++i) world.step(kDt);
        sample.time_s += watch.seconds() / count;
        const double error = error_of(*problem, asked, world);
        if (!std::isfinite(error)) ++sample.failures;
        *sample.error += (asked.problems.size() > 1 ? std::min(error, 1.0) : error) / count;
    }
    return sample;
}

Study study_of(const std::string& name, const Asked& asked, const StudyOptions& options) {
    const bool one = asked.problems.size() == 1;
    Study study{.name = name,
                .stage = "contact solver",
                .error = asked.force ? "largest relative error of the force that a body is carried by"
                                     : "largest force or torque on a body that is left over, of the forces on it, or excess over the friction cone",
                .unit = "1",
                .oracle = asked.force ? "statics: the weight of what stands on it" : "bodies at rest are in balance; summed in long double",
                .time = "all steps of 1/60 s, of the processor",
                .cases = {{"problem", one ? std::string(to_string(asked.problems[0]->kind)) : std::string("all")}}};
    if (!one) study.error = "mean over all problems, at most 1 of each: " + study.error;
    for (const Knobs& knobs : knobs_of(options.quick)) {
        study.candidates.push_back({"carom", settings_of(knobs), [asked, knobs] { return one_pass(asked, knobs); }});
    }
    return study;
}

}  // namespace

std::vector<Study> solver_studies(const StudyOptions& options) {
    std::vector<SolverCasePtr> problems;
    for (const SolverKind kind : solver_kinds()) problems.push_back(solver_case(kind, options.quick));
    std::vector<Study> studies;
    studies.push_back(study_of("solver", {problems, false}, options));
    for (const SolverCasePtr& problem : problems) {
        const std::string name = fmt::format("solver_{}", to_string(problem->kind));
        studies.push_back(study_of(name, {{problem}, false}, options));
        if (!problem->carried.empty()) studies.push_back(study_of(name + "_force", {{problem}, true}, options));
    }
    return studies;
}

}  // namespace carom::accuracy
