// The studies "sat" and "gjk": verdicts, depths and distances of boxes and hulls, by every way that Carom has.
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/convex_cases.hpp>

#include <carom/collision/overlap_tests.hpp>
#include <carom/narrowphase/overlap.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace carom::accuracy {
namespace {

using Cases = std::vector<std::shared_ptr<const ConvexCases>>;

// Verdicts this near to touching are right either way: what the long doubles of the oracle may err by.
constexpr double kTouching = 1e-15;  // of the size

// The answer to one pair. Without a verdict or a value, the way has none to give.
struct Answer {
    Overlap verdict = Overlap::Undecided;
    double separation = std::numeric_limits<double>::quiet_NaN();  // negative: a depth
    double lower = -std::numeric_limits<double>::infinity();       // that a way proves
    double upper = std::numeric_limits<double>::infinity();
};
// Answers all pairs of the cases. @return the time that took [s].
using Way = std::function<double(const ConvexCases&, std::vector<Answer>&)>;

double error_of(const Answer& answer, double truth, double size) {
    const double gap = std::abs(truth) / size;
    if (gap > kTouching) {
        if (answer.verdict == Overlap::Apart && truth < 0.0) return 1.0;
        if (answer.verdict == Overlap::Overlapping && truth > 0.0) return 1.0;
    }
    if (!std::isnan(answer.separation)) return std::min(1.0, std::abs(answer.separation - truth) / size);
    return answer.verdict == Overlap::Undecided ? std::min(1.0, gap) : 0.0;
}

Sample run_all(const Cases& all, const Way& way) {
    Sample sample;
    double sum = 0.0;
    std::size_t count = 0;
    for (const std::shared_ptr<const ConvexCases>& cases : all) {
        std::vector<Answer> answers(cases->pairs.size());
        sample.time_s += way(*cases, answers);
        for (std::size_t i = 0; i < answers.size(); ++i) {
            const double truth = cases->separation[i], slack = kTouching * cases->size[i];
            sum += error_of(answers[i], truth, cases->size[i]);
            // Bounds that do not hold are no answer.
            if (answers[i].lower > truth + slack || answers[i].upper < std::max(0.0, truth) - slack) ++sample.failures;
        }
        count += answers.size();
    }
    sample.error = sum / static_cast<double>(count);
    return sample;
}

// One pair after the other.
template <class Ask>
Way one_by_one(const Ask& ask) {
    return [ask](const ConvexCases& cases, std::vector<Answer>& answers) {
        const ThreadStopwatch watch;
        for (std::size_t i = 0; i < answers.size(); ++i) {
            answers[i] = ask(cases.shapes[2 * i], cases.poses[2 * i], cases.shapes[2 * i + 1], cases.poses[2 * i + 1]);
        }
        return watch.seconds();
    };
}

double verdicts_of_many(const ConvexCases& cases, std::vector<Answer>& answers) {
    SerialExecutor executor;
    std::vector<Overlap> verdicts;
    const ThreadStopwatch watch;
    overlaps(cases.places(), cases.pairs, executor, verdicts);
    const double seconds = watch.seconds();
    for (std::size_t i = 0; i < answers.size(); ++i) answers[i].verdict = verdicts[i];
    return seconds;
}

Answer verdict_of_one(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    return {.verdict = overlaps(a, pose_a, b, pose_b)};
}

Answer answer_of(const DistanceResult& r) {
    if (r.status == DistanceStatus::Overlap) return {.verdict = Overlap::Overlapping, .upper = 0.0};
    return {r.lower > 0.0 ? Overlap::Apart : Overlap::Undecided, r.upper, r.lower > 0.0 ? r.lower : -std::numeric_limits<double>::infinity(), r.upper};
}

// Depths of those that overlap, from manifolds; distances of boxes are lower bounds there, so only overlaps count.
double manifolds_of_many(const ConvexCases& cases, std::vector<Answer>& answers) {
    SerialExecutor executor;
    CollideScratch scratch;
    std::vector<Manifold> manifolds;
    const ThreadStopwatch watch;
    collide(cases.places(), cases.pairs, executor, scratch, manifolds);
    const double seconds = watch.seconds();
    for (Answer& answer : answers) answer.verdict = Overlap::Apart;
    for (const Manifold& m : manifolds) {
        double deepest = std::numeric_limits<double>::infinity();
        for (const ContactPoint& p : m.used()) deepest = std::min(deepest, static_cast<double>(p.separation));
        answers[m.pair] = {.verdict = Overlap::Overlapping, .separation = deepest};
    }
    return seconds;
}

Answer depth_of_one(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    const PenetrationResult r = penetration(a, pose_a, b, pose_b);
    if (!(r.upper > 0.0)) return {.verdict = Overlap::Apart};
    const double lower = -r.upper;  // a depth is a negative separation, and its upper bound the lower one
    return {r.lower > 0.0 ? Overlap::Overlapping : Overlap::Undecided, -r.upper, lower, std::numeric_limits<double>::infinity()};
}

// The primitives of collision, about A's place.
template <class T>
Answer primitive_of(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    const auto box = [](const Shape& shape, const dvec3& centre, const dquat& q) {
        return geo::Obb<T>{geo::Vec3<T>(centre), geo::Vec3<T>(std::get<Box>(shape).half_extents), glm::mat<3, 3, T>(glm::mat3_cast(q))};
    };
    const bool hit = geo::overlaps(box(a, dvec3{0.0}, pose_a.orientation), box(b, pose_b.position - pose_a.position, pose_b.orientation));
    return {.verdict = hit ? Overlap::Overlapping : Overlap::Apart};
}

Study study_of(std::string name, const std::string& what, const Cases& cases) {
    std::size_t count = 0;
    for (const auto& part : cases) count += part->pairs.size();
    return {.name = std::move(name),
            .stage = "pairs of convex shapes",
            .error = "share of wrong verdicts, and otherwise the mean error of the depth or distance, or the gap left undecided, over the size",
            .unit = "1",
            .oracle = fmt::format("all separating axes and features in long double; {} pairs: {}", count, what),
            .candidates = {}};
}

void add(Study& study, const Cases& cases, Settings settings, const Way& way) {
    study.candidates.push_back({"carom", std::move(settings), [cases, way] { return run_all(cases, way); }});
}

void add_sat(Study& study, const Cases& cases) {
    add(study, cases, {{"method", "axes, many"}, {"precision", "float, then double"}}, verdicts_of_many);
    add(study, cases, {{"method", "axes, one"}, {"precision", "double"}}, one_by_one(verdict_of_one));
    add(study, cases, {{"method", "primitive"}, {"precision", "float"}}, one_by_one(primitive_of<float>));
    add(study, cases, {{"method", "primitive"}, {"precision", "double"}}, one_by_one(primitive_of<double>));
    add(study, cases, {{"method", "manifold, many"}, {"precision", "float"}}, manifolds_of_many);
    add(study, cases, {{"method", "polytope"}, {"precision", "double"}}, one_by_one(depth_of_one));
}

void add_gjk(Study& study, const Cases& cases) {
    add(study, cases, {{"method", "verdict, many"}, {"tolerance", 0.0}, {"cap", 128.0}}, verdicts_of_many);
    add(study, cases, {{"method", "distance, many"}, {"tolerance", 0.0}, {"cap", 128.0}}, [](const ConvexCases& c, std::vector<Answer>& answers) {
        SerialExecutor executor;
        std::vector<DistanceResult> results;
        const ThreadStopwatch watch;
        distance(c.places(), c.pairs, executor, {}, results);
        const double seconds = watch.seconds();
        std::ranges::transform(results, answers.begin(), answer_of);
        return seconds;
    });
    add(study, cases, {{"method", "verdict"}, {"tolerance", 0.0}, {"cap", 128.0}}, one_by_one(verdict_of_one));
    const auto with = [&](double tolerance, int cap) {
        add(study, cases, {{"method", "distance"}, {"tolerance", tolerance}, {"cap", double(cap)}},
            one_by_one([tolerance, cap](const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
                return answer_of(distance(a, pose_a, b, pose_b, {tolerance, cap}));
            }));
    };
    for (const double tolerance : {1e-1, 1e-2, 1e-4, 1e-8, 0.0}) with(tolerance, 128);
    for (const int cap : {1, 2, 3, 4, 6}) with(0.0, cap);
    add(study, cases, {{"method", "depth"}, {"tolerance", 0.0}, {"cap", 128.0}}, one_by_one(depth_of_one));
}

std::vector<Study> studies_of(const std::string& name, ConvexKind kind, bool quick, void (*fill)(Study&, const Cases&)) {
    Cases all;
    for (ConvexCases& cases : convex_cases(kind, quick)) all.push_back(std::make_shared<const ConvexCases>(std::move(cases)));
    std::vector<Study> studies{study_of(name, "all conditions", all)};
    fill(studies.back(), all);
    for (const auto& cases : all) {
        studies.push_back(study_of(name + "_" + cases->condition, cases->condition, {cases}));
        fill(studies.back(), {cases});
    }
    return studies;
}

}  // namespace

std::vector<Study> sat_studies(const StudyOptions& options) { return studies_of("sat", ConvexKind::Boxes, options.quick, add_sat); }
std::vector<Study> gjk_studies(const StudyOptions& options) { return studies_of("gjk", ConvexKind::Hulls, options.quick, add_gjk); }

}  // namespace carom::accuracy
