// The studies "manifolds": how true contact manifolds are, and what they take.
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/manifold_cases.hpp>

#include <carom/core/executor.hpp>

#include <fmt/format.h>

#include <functional>
#include <memory>
#include <utility>

namespace carom::accuracy {
namespace {

constexpr const char* kStage = "narrowphase";
constexpr const char* kTime = "collide() of one pair, of the processor";
constexpr std::size_t kTimedPairs = 2000;  // a pass goes round until it has timed so many

enum class Calls { Batch, Single };

/// Collides all pairs over and over. @return the manifolds and the time of a pair.
std::pair<std::vector<Manifold>, double> collide_all(const ManifoldCases& cases, Calls calls) {
    std::vector<Manifold> manifolds;
    SerialExecutor executor;
    CollideScratch scratch;
    const std::size_t rounds = 1 + kTimedPairs / cases.count();
    const ThreadStopwatch watch;
    for (std::size_t round = 0; round < rounds; ++round) {
        if (calls == Calls::Batch) {
            collide(cases.placed(), cases.pairs, executor, scratch, manifolds);
            continue;
        }
        manifolds.clear();
        for (std::uint32_t k = 0; k < cases.count(); ++k) collide(cases.pair(k), k, manifolds);
    }
    return {std::move(manifolds), watch.seconds() / static_cast<double>(rounds * cases.count())};
}

using Measure = std::function<double(const ManifoldCases&, std::span<const Manifold>)>;

Candidate candidate(ManifoldCasesPtr cases, Calls calls, Settings settings, Measure measure) {
    settings.emplace_back("calls", std::string(calls == Calls::Batch ? "batch" : "single"));
    return {"carom", std::move(settings), [cases = std::move(cases), calls, measure = std::move(measure)] {
                const auto [manifolds, time] = collide_all(*cases, calls);
                Sample sample;
                sample.time_s = time;
                sample.error = measure(*cases, manifolds);
                return sample;
            }};
}

Study study_of(const std::string& name, const std::string& error, const std::string& oracle) {
    return {.name = name, .stage = kStage, .error = error, .unit = "1", .oracle = oracle, .time = kTime};
}

constexpr const char* kDepthError = "largest error of the deepest point, of the size; a missing contact counts 1";
constexpr const char* kNormalError = "largest excess of the overlap along the reported normal over the least, of the size";

void add_kernels(Study& study, const ManifoldCasesPtr& cases, const std::string& shapes, const Measure& measure) {
    study.candidates.push_back(candidate(cases, Calls::Batch, {{"shapes", shapes}}, measure));
    study.candidates.push_back(candidate(cases, Calls::Single, {{"shapes", shapes}}, measure));
}

void add_depth_studies(const std::string& kind, const ManifoldCasesPtr& cases, bool boxes, std::vector<Study>& studies) {
    const std::string oracle = fmt::format("least overlap over all separating axes in double; {} pairs", cases->count());
    const std::string suffix = kind.empty() ? "" : "_" + kind;
    for (const bool depth : {true, false}) {
        Study study = study_of(depth ? "manifolds" + suffix : "manifolds_normal" + suffix, depth ? kDepthError : kNormalError, oracle);
        const Measure measure = depth ? Measure(depth_error) : Measure(normal_error);
        add_kernels(study, cases, boxes ? "boxes" : "hulls", measure);
        if (boxes) add_kernels(study, as_hulls(*cases), "boxes as hulls", measure);
        studies.push_back(std::move(study));
    }
}

Study ground_study(std::size_t count, bool turned, bool quick) {
    Study study = study_of(turned ? "manifolds_ground_turned" : "manifolds_ground", kDepthError,
                           fmt::format("how far the lowest point lies below flat ground; {} {}", count,
                                       turned ? "cylinders and cones" : "boxes, hulls, spheres and capsules"));
    for (const int triangles : {0, 2, 128, 2048, 32768}) {
        if (quick && triangles > 2048) continue;
        const ManifoldCasesPtr cases = ground_cases(count, triangles, turned, 94);
        study.candidates.push_back(candidate(cases, Calls::Batch, {{"triangles", static_cast<double>(triangles)}}, depth_error));
    }
    return study;
}

Study area_study(std::size_t count) {
    const ManifoldCasesPtr cases = resting_cases(count, 95);
    Study study = study_of("manifolds_area", "mean share of the area of contact that the points do not span",
                           fmt::format("the cut of the two rectangles; {} boxes that rest on boxes", count));
    for (const std::size_t points : {1u, 2u, 3u, 4u}) {
        study.candidates.push_back(candidate(cases, Calls::Batch, {{"points", static_cast<double>(points)}},
                                             [points](const ManifoldCases& c, std::span<const Manifold> m) { return area_error(c, m, points); }));
    }
    return study;
}

Study steady_study(const std::string& name, double share, const ManifoldCasesPtr& boxes, const ManifoldCasesPtr& hulls) {
    Study study = study_of(name, "share of points whose name the pair did not have before the motion",
                           fmt::format("the same pairs before; one of each moved by {:g} of the size and turned by {:g} rad", share, share));
    for (const auto& [shapes, before] : {std::pair{"boxes", boxes}, {"boxes as hulls", hulls}}) {
        const auto known = std::make_shared<const std::vector<Manifold>>(collide_all(*before, Calls::Batch).first);
        study.candidates.push_back(candidate(moved(*before, share, 96), Calls::Batch, {{"shapes", std::string(shapes)}},
                                             [known](const ManifoldCases&, std::span<const Manifold> m) { return new_names(*known, m); }));
    }
    return study;
}

}  // namespace

std::vector<Study> manifold_studies(const StudyOptions& options) {
    const std::size_t count = options.quick ? 300 : 5000;
    std::vector<Study> studies;
    add_depth_studies("", box_cases(count, Depth::Any, 91), true, studies);
    add_depth_studies("wedged", box_cases(count, Depth::Wedged, 92), true, studies);
    add_depth_studies("hulls", hull_cases(count / 5, 93), false, studies);
    studies.push_back(ground_study(count / 5, false, options.quick));
    studies.push_back(ground_study(count / 5, true, options.quick));
    studies.push_back(area_study(count));
    const ManifoldCasesPtr resting = resting_cases(count, 97);
    const ManifoldCasesPtr resting_hulls = as_hulls(*resting);
    studies.push_back(steady_study("manifolds_steady_small", 1e-6, resting, resting_hulls));
    studies.push_back(steady_study("manifolds_steady", 1e-4, resting, resting_hulls));
    studies.push_back(steady_study("manifolds_steady_large", 1e-2, resting, resting_hulls));
    return studies;
}

}  // namespace carom::accuracy
