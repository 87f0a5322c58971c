// The studies "toi" and "sweeps": how early times of impact are, and whether any is late, against tolerance, cap and precision.
#include <carom/studies/accuracy/catalogue.hpp>

#include <carom/collision/closest_points.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/narrowphase/time_of_impact.hpp>

#include <fmt/format.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

namespace carom::accuracy {
namespace {

dvec3 direction(Random& random) {
    for (;;) {
        const dvec3 v{random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0)};
        const double length = glm::length(v);
        if (length > 0.1 && length <= 1.0) return v / length;
    }
}

struct MovingCase {
    Shape a, b;
    RigidMotion motion_a, motion_b;
    double first_overlap = 2.0;  ///< the first of the sampled times at which they overlap; 2: none
    Impact finest{};
};
using MovingCases = std::shared_ptr<const std::vector<MovingCase>>;

Shape any_shape(Random& random, int kind) {
    const auto size = [&] { return static_cast<float>(random.range(0.1, 0.6)); };
    if (kind % 4 == 0) return Box{{size(), size(), size()}};
    if (kind % 4 == 1) return Capsule{size(), size()};
    if (kind % 4 == 2) return Sphere{size()};
    std::vector<vec3> points;
    for (int i = 0; i < 14; ++i) points.push_back(size() * vec3(direction(random)));
    return *ConvexHull::build(points);
}

/// @param kind  "moving": translation alone; "turning": up to 2 rad; "spinning": 1e4 rad/s for 1/240 s, thin rods against balls.
MovingCases make_cases(const std::string& kind, int count) {
    auto cases = std::make_shared<std::vector<MovingCase>>();
    Random random(kind == "moving" ? 0x701 : kind == "turning" ? 0x702 : 0x703);
    const bool spinning = kind == "spinning";
    for (int i = 0; i < count; ++i) {
        MovingCase c{spinning ? Shape{Box{{0.5f, 0.0005f, 0.0005f}}} : any_shape(random, i),
                     spinning ? Shape{Sphere{0.02f}} : any_shape(random, i / 4), {}, {}};
        const dvec3 from = (spinning ? 0.8 : 2.0) * direction(random);
        c.motion_a.start.orientation = rotation_from_vector(2.0 * direction(random));
        c.motion_b.start = {from, rotation_from_vector(2.0 * direction(random))};
        c.motion_b.translation = random.range(0.5, 2.0) * -from + 0.5 * direction(random);
        if (kind == "turning") c.motion_a.rotation = 2.0 * direction(random), c.motion_b.rotation = random.unit() * direction(random);
        if (spinning) c.motion_a.rotation = 1e4 / 240.0 * direction(random);
        for (int k = 0; k <= 400 && c.first_overlap > 1.0; ++k) {
            const double t = k / 400.0;
            if (distance(c.a, pose_at(c.motion_a, t), c.b, pose_at(c.motion_b, t)).status == DistanceStatus::Overlap) c.first_overlap = t;
        }
        c.finest = time_of_impact(c.a, c.motion_a, c.b, c.motion_b, {.most_checks = 1 << 14});
        cases->push_back(std::move(c));
    }
    return cases;
}

Sample run(const MovingCases& cases, const TimeOfImpactSettings& settings) {
    Sample sample;
    std::vector<Impact> out(cases->size());
    const ThreadStopwatch watch;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const MovingCase& c = (*cases)[i];
        out[i] = time_of_impact(c.a, c.motion_a, c.b, c.motion_b, settings);
    }
    sample.time_s = watch.seconds() / static_cast<double>(out.size());
    double ahead = 0.0;
    std::size_t clamped = 0, checks = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const MovingCase& c = (*cases)[i];
        const double end = may_touch(out[i].status) ? out[i].t : 1.0;
        sample.failures += c.first_overlap < end ? 1 : 0;
        ahead += std::max(0.0, (may_touch(c.finest.status) ? c.finest.t : 1.0) - end);
        clamped += out[i].status == ImpactStatus::Clamped ? 1 : 0;
        checks += static_cast<std::size_t>(out[i].checks);
    }
    sample.error = ahead / static_cast<double>(out.size());
    sample.note = fmt::format("{} clamped, {:.1f} checks", clamped, static_cast<double>(checks) / static_cast<double>(out.size()));
    return sample;
}

Study toi_study(const std::string& name, const MovingCases& cases) {
    const auto meet = std::count_if(cases->begin(), cases->end(), [](const MovingCase& c) { return c.first_overlap <= 1.0; });
    Study study{.name = name,
                .stage = "sweeps and continuous collision",
                .error = "how much earlier than the finest the time is, mean, of the motion; a failure is an overlap before it",
                .unit = "1",
                .oracle = fmt::format("overlap at 401 times, proved; {} pairs, {} of which meet", cases->size(), meet),
                .time = "one pair, of the processor"};
    const auto candidate = [&](double tolerance, int cap) {
        study.candidates.push_back({"carom", {{"tolerance", tolerance}, {"checks", static_cast<double>(cap)}}, [=] {
                                        return run(cases, {.tolerance = tolerance, .most_checks = cap});
                                    }});
    };
    for (const double tolerance : {0.0, 1e-6, 1e-4, 1e-2}) candidate(tolerance, 4096);
    for (const int cap : {128, 32, 8, 2}) candidate(0.0, cap);
    return study;
}

// ---- sweeps in closed form -----------------------------------------------------------------------------------------------------------

template <class A, class B>
struct SweepCases {
    std::vector<A> a;
    std::vector<dvec3> motion;
    std::vector<B> b;
};

geo::Sphere<double> moved(geo::Sphere<double> s, const dvec3& by) { return {s.center + by, s.radius}; }
geo::Capsule<double> moved(geo::Capsule<double> c, const dvec3& by) { return {{c.axis.a + by, c.axis.b + by}, c.radius}; }
void fill(Random& random, geo::Sphere<double>& s) { s = {direction(random) * random.unit(), random.range(0.05, 0.4)}; }
void fill(Random& random, geo::Capsule<double>& c) { c = {{direction(random), direction(random) * random.unit()}, random.range(0.05, 0.4)}; }
void fill(Random& random, geo::Aabb<double>& b) { b.upper = glm::abs(direction(random)), b.lower = -b.upper; }
void fill(Random& random, geo::Obb<double>& b) {
    b = {random.unit() * direction(random), glm::abs(direction(random)), glm::mat3_cast(rotation_from_vector(2.0 * direction(random)))};
}
void fill(Random& random, geo::Triangle<double>& t) { t = {direction(random), direction(random), direction(random)}; }

template <class A, class B>
Candidate sweep_candidate(const std::string& name, std::size_t count) {
    auto cases = std::make_shared<SweepCases<A, B>>();
    Random random(0x5bee);
    for (std::size_t i = 0; i < count; ++i) {
        A a;
        B b;
        fill(random, a);
        fill(random, b);
        const dvec3 from = 4.0 * direction(random);
        cases->a.push_back(moved(a, from));
        cases->motion.push_back(random.range(0.5, 2.0) * -from + direction(random));
        cases->b.push_back(b);
    }
    return {"carom", {{"pair", name}}, [cases] {
                std::vector<Impact> out(cases->a.size());
                const ThreadStopwatch watch;
                geo::sweep<A, B, double>(cases->a, cases->motion, cases->b, out);
                Sample sample{.time_s = watch.seconds() / static_cast<double>(out.size()), .error = 0.0};
                double early = 0.0;
                std::size_t touching = 0;
                for (std::size_t i = 0; i < out.size(); ++i) {
                    if (out[i].status != ImpactStatus::Touching) continue;
                    ++touching;
                    const auto near = geo::closest_points(moved(cases->a[i], out[i].t * cases->motion[i]), cases->b[i]);
                    early = std::max(early, std::sqrt(near.distance_sq));
                    const auto later = geo::closest_points(moved(cases->a[i], (out[i].t - 1e-9) * cases->motion[i]), cases->b[i]);
                    sample.failures += later.distance_sq > 0.0 ? 0 : 1;
                }
                sample.error = early;
                sample.note = fmt::format("{} of {} touch", touching, out.size());
                return sample;
            }};
}

}  // namespace

std::vector<Study> toi_studies(const StudyOptions& options) {
    const int count = options.quick ? 40 : 800;
    std::vector<Study> studies{toi_study("toi", make_cases("turning", count)), toi_study("toi_moving", make_cases("moving", count)),
                               toi_study("toi_spinning", make_cases("spinning", count / 4))};
    return studies;
}

std::vector<Study> sweep_studies(const StudyOptions& options) {
    const std::size_t count = options.quick ? 200 : 20000;
    Study study{.name = "sweeps",
                .stage = "sweeps and continuous collision",
                .error = "largest gap at the reported contact; a failure is contact before it",
                .unit = "m",
                .oracle = fmt::format("distances of the two at the reported time; {} sweeps of each pair, sizes about 1 m", count),
                .time = "one sweep in a batch, of the processor"};
    using geo::Aabb, geo::Obb, geo::Triangle;
    using Ball = geo::Sphere<double>;
    using Rod = geo::Capsule<double>;
    study.candidates.push_back(sweep_candidate<Ball, Ball>("sphere_sphere", count));
    study.candidates.push_back(sweep_candidate<Ball, Rod>("sphere_capsule", count));
    study.candidates.push_back(sweep_candidate<Ball, Aabb<double>>("sphere_aabb", count));
    study.candidates.push_back(sweep_candidate<Ball, Obb<double>>("sphere_obb", count));
    study.candidates.push_back(sweep_candidate<Ball, Triangle<double>>("sphere_triangle", count));
    study.candidates.push_back(sweep_candidate<Rod, Ball>("capsule_sphere", count));
    study.candidates.push_back(sweep_candidate<Rod, Rod>("capsule_capsule", count));
    study.candidates.push_back(sweep_candidate<Rod, Aabb<double>>("capsule_aabb", count));
    study.candidates.push_back(sweep_candidate<Rod, Obb<double>>("capsule_obb", count));
    study.candidates.push_back(sweep_candidate<Rod, Triangle<double>>("capsule_triangle", count));
    return {std::move(study)};
}

}  // namespace carom::accuracy
