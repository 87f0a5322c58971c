#include <carom/studies/accuracy/primitive_cases.hpp>

#include <carom/collision/closest_points.hpp>
#include <carom/collision/overlap_tests.hpp>
#include <carom/collision/ray_primitives.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/studies/accuracy/study.hpp>
#include <carom/studies/oracle/exact_primitives.hpp>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

namespace carom::accuracy {
namespace {

using oracle::PreciseAnswer;

enum class Condition { Plain, Offset, Scale, Touch };
constexpr std::array<std::pair<Condition, const char*>, 4> kConditions{
    {{Condition::Plain, "plain"}, {Condition::Offset, "offset"}, {Condition::Scale, "scale"}, {Condition::Touch, "touch"}}};

// ---- the same primitive in another precision

template <class T>
glm::vec<3, T> to(const dvec3& v) { return glm::vec<3, T>(v); }
template <class T>
geo::Ray<T> to(const geo::Ray<double>& r) { return {.origin = to<T>(r.origin), .direction = to<T>(r.direction)}; }
template <class T>
geo::Sphere<T> to(const geo::Sphere<double>& s) { return {to<T>(s.center), static_cast<T>(s.radius)}; }
template <class T>
geo::Aabb<T> to(const geo::Aabb<double>& b) { return {to<T>(b.lower), to<T>(b.upper)}; }
template <class T>
geo::Obb<T> to(const geo::Obb<double>& b) { return {to<T>(b.center), to<T>(b.half_extents), glm::mat<3, 3, T>(b.axes)}; }
template <class T>
geo::Segment<T> to(const geo::Segment<double>& s) { return {to<T>(s.a), to<T>(s.b)}; }
template <class T>
geo::Capsule<T> to(const geo::Capsule<double>& c) { return {to<T>(c.axis), static_cast<T>(c.radius)}; }
template <class T>
geo::Triangle<T> to(const geo::Triangle<double>& t) { return {to<T>(t.a), to<T>(t.b), to<T>(t.c)}; }

// ---- making cases

double to_float(double x) { return static_cast<double>(static_cast<float>(x)); }
dvec3 to_float(const dvec3& v) { return dvec3(vec3(v)); }

// Random things about a middle, of the size `unit`. All numbers but the axes of boxes are floats.
class Maker {
public:
    Maker(std::uint64_t seed, Condition condition) : random_(seed), condition_(condition) {}

    // A new case: another middle or another unit, where the condition says so.
    void next() {
        if (condition_ == Condition::Scale) unit_ = std::pow(10.0, std::floor(random_.range(-12.0, 13.0)));
        if (condition_ == Condition::Offset) middle_ = std::pow(10.0, std::floor(random_.range(1.0, 5.0))) * direction();
    }
    [[nodiscard]] bool touching() const { return condition_ == Condition::Touch; }
    [[nodiscard]] double unit() const { return unit_; }

    double range(double low, double high) { return random_.range(low, high); }
    double length(double low, double high) { return to_float(unit_ * range(low, high)); }
    dvec3 vector(double half) {
        const double x = range(-half, half), y = range(-half, half);
        return {x, y, range(-half, half)};
    }
    dvec3 direction() {
        for (;;) {
            const dvec3 v = vector(1.0);
            if (const double l = glm::length(v); l > 0.1 && l < 1.0) return v / l;
        }
    }
    dvec3 point(double half) { return to_float(middle_ + unit_ * vector(half)); }
    // A ray from four units away through a point.
    geo::Ray<double> ray_at(const dvec3& target) {
        const dvec3 origin = to_float(middle_ + 4.0 * unit_ * direction());
        return {.origin = origin, .direction = to_float(target - origin)};
    }
    geo::Triangle<double> triangle() {
        const dvec3 a = point(1.0), b = point(1.0);
        return {a, b, point(1.0)};
    }
    geo::Aabb<double> aabb() {
        const dvec3 center = point(1.0);
        const double x = length(0.3, 1.0), y = length(0.3, 1.0);
        const dvec3 half{x, y, length(0.3, 1.0)};
        return {to_float(center - half), to_float(center + half)};
    }
    geo::Obb<double> obb() {
        const double x = length(0.3, 1.0), y = length(0.3, 1.0);
        const dvec3 half{x, y, length(0.3, 1.0)};
        return {point(1.2), half, glm::mat3_cast(rotation_about(direction(), range(0.0, kPi)))};
    }

private:
    Random random_;
    Condition condition_;
    dvec3 middle_{0.0};
    double unit_ = 1.0;
};

template <class A, class B>
struct Case {
    A a;
    B b;
    double unit = 1.0;
};

auto ray_sphere(Maker& make) {
    const geo::Sphere<double> sphere{make.point(1.0), make.length(0.3, 1.0)};
    geo::Ray<double> ray = make.ray_at(to_float(sphere.center + 1.3 * sphere.radius * make.vector(1.0)));
    if (make.touching()) {
        const dvec3 there = sphere.center - ray.origin;
        const dvec3 aside = glm::normalize(glm::cross(there, make.direction()));
        const double distance_sq = glm::dot(there, there), r = sphere.radius;
        ray.direction = to_float(there + aside * (std::sqrt(distance_sq) * r / std::sqrt(distance_sq - r * r)));
    }
    return Case<geo::Sphere<double>, geo::Ray<double>>{sphere, ray, make.unit()};
}

auto ray_aabb(Maker& make) {
    const geo::Aabb<double> box = make.aabb();
    dvec3 where = make.vector(1.3);
    if (make.touching()) {
        const int along = static_cast<int>(make.range(0.0, 3.0));
        for (int k = 0; k < 3; ++k) where[k] = k == along ? where[k] / 1.3 : (where[k] < 0.0 ? -1.0 : 1.0);
    }
    const dvec3 target = 0.5 * (box.lower + box.upper) + 0.5 * where * (box.upper - box.lower);
    return Case<geo::Aabb<double>, geo::Ray<double>>{box, make.ray_at(target), make.unit()};
}

auto ray_triangle(Maker& make) {
    const geo::Triangle<double> t = make.triangle();
    const double u = make.range(-0.2, 1.0), v = make.touching() ? 0.0 : make.range(-0.2, 1.0);
    return Case<geo::Triangle<double>, geo::Ray<double>>{t, make.ray_at(t.a + u * (t.b - t.a) + v * (t.c - t.a)), make.unit()};
}

auto point_triangle(Maker& make) {
    const geo::Triangle<double> t = make.triangle();
    const double u = make.range(0.0, 1.0), v = make.range(0.0, 1.0);
    const dvec3 point = make.touching() ? to_float(t.a + u * (t.b - t.a) + v * (t.c - t.a)) : make.point(1.5);
    return Case<dvec3, geo::Triangle<double>>{point, t, make.unit()};
}

auto segments(Maker& make) {
    const geo::Segment<double> a{make.point(1.0), make.point(1.0)};
    geo::Segment<double> b{make.point(1.0), make.point(1.0)};
    // Nearly parallel, at angles of 1e-1 .. 1e-7: where the lines are closest is all but undecided.
    if (make.touching()) b.b = to_float(b.a + (a.b - a.a) + std::pow(10.0, make.range(-7.0, -1.0)) * make.direction());
    return Case<geo::Segment<double>, geo::Segment<double>>{a, b, make.unit()};
}

auto sphere_aabb(Maker& make) {
    const geo::Aabb<double> box = make.aabb();
    geo::Sphere<double> sphere{make.point(2.0), make.length(0.3, 1.0)};
    if (make.touching()) sphere.radius = to_float(std::sqrt(geo::closest_points(sphere.center, box).distance_sq));
    return Case<geo::Sphere<double>, geo::Aabb<double>>{sphere, box, make.unit()};
}

auto capsules(Maker& make) {
    const geo::Capsule<double> a{{make.point(1.0), make.point(1.0)}, make.length(0.1, 0.5)};
    geo::Capsule<double> b{{make.point(1.0), make.point(1.0)}, make.length(0.1, 0.5)};
    if (make.touching()) b.radius = to_float(std::max(0.0, std::sqrt(geo::closest_points(a.axis, b.axis).distance_sq) - a.radius));
    return Case<geo::Capsule<double>, geo::Capsule<double>>{a, b, make.unit()};
}

auto boxes(Maker& make) {
    const geo::Obb<double> a = make.obb();
    geo::Obb<double> b = make.obb();
    if (make.touching()) {
        // The last place on a way out where they still touch, by halving.
        const dvec3 start = a.center, way = 5.0 * make.unit() * make.direction();
        double in = 0.0, out = 1.0;
        for (int i = 0; i < 60; ++i) {
            const double middle = 0.5 * (in + out);
            b.center = start + middle * way;
            (geo::overlaps(a, b) ? in : out) = middle;
        }
        b.center = to_float(start + in * way);
    }
    return Case<geo::Obb<double>, geo::Obb<double>>{a, b, make.unit()};
}

// ---- asking

struct Found {
    bool hit = false;
    double value = 0.0;
};

struct Expected {
    bool hit = false;
    double value = 0.0;
    double scale = 1.0;  ///< what the error of the value is relative to
};

template <class Hit>
Found found(const std::optional<Hit>& hit) { return hit ? Found{true, static_cast<double>(hit->t)} : Found{}; }

template <class T>
Found found(const geo::ClosestPoints<T>& points) { return {true, static_cast<double>(std::sqrt(points.distance_sq))}; }

// What a ray, a distance and an overlap are: the test in either precision, and the oracle.
struct AskRay {
    auto operator()(const auto& solid, const auto& ray) const { return found(geo::cast_ray(solid, ray)); }
    static Expected exact(const auto& solid, const auto& ray, double) {
        const PreciseAnswer t = oracle::first_hit(solid, ray);
        return {t.hit, t.value, t.value != 0.0 ? t.value : 1.0};
    }
};
struct AskDistance {
    auto operator()(const auto& a, const auto& b) const { return found(geo::closest_points(a, b)); }
    static Expected exact(const auto& a, const auto& b, double unit) {
        const double d = oracle::distance(a, b).value;
        return {true, d, std::max(d, unit)};
    }
};
struct AskOverlap {
    auto operator()(const auto& a, const auto& b) const { return Found{geo::overlaps(a, b), 0.0}; }
    static Expected exact(const auto& a, const auto& b, double) { return {oracle::overlap(a, b).hit, 0.0, 1.0}; }
};

template <class T, class A, class B, class Ask>
std::function<PartSample()> runner(const std::vector<Case<A, B>>& cases, std::shared_ptr<const std::vector<Expected>> expected,
                                   Ask ask) {
    using Pair = std::pair<decltype(to<T>(cases[0].a)), decltype(to<T>(cases[0].b))>;
    std::vector<Pair> pairs;
    for (const Case<A, B>& c : cases) {
        pairs.emplace_back(to<T>(c.a), to<T>(c.b));
    }
    return [pairs, expected, ask, answers = std::vector<Found>(cases.size())]() mutable {
        const Stopwatch watch;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            answers[i] = ask(pairs[i].first, pairs[i].second);
        }
        PartSample sample{watch.seconds(), 0.0, 0};
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const Expected& e = (*expected)[i];
            const Found& f = answers[i];
            if (!is_finite(f.value)) {
                ++sample.failures;
            } else {
                sample.error_sum += f.hit != e.hit ? 1.0 : std::min(1.0, std::abs(f.value - e.value) / e.scale);
            }
        }
        return sample;
    };
}

template <class Make, class Ask>
void add_kind(std::vector<PrimitivePart>& parts, const char* kind, std::size_t count, Make make_case, Ask ask) {
    for (const auto& [condition, name] : kConditions) {
        Maker make(5100 + parts.size(), condition);
        std::vector<decltype(make_case(make))> cases;
        auto expected = std::make_shared<std::vector<Expected>>();
        for (std::size_t i = 0; i < count; ++i) {
            make.next();
            cases.push_back(make_case(make));
            expected->push_back(Ask::exact(cases.back().a, cases.back().b, cases.back().unit));
        }
        parts.push_back({kind, name, count, runner<float>(cases, expected, ask), runner<double>(cases, expected, ask)});
    }
}

}  // namespace

std::vector<PrimitivePart> primitive_parts(bool quick) {
    const std::size_t count = quick ? 100 : 1000;
    std::vector<PrimitivePart> parts;
    add_kind(parts, "ray_sphere", count, ray_sphere, AskRay{});
    add_kind(parts, "ray_aabb", count, ray_aabb, AskRay{});
    add_kind(parts, "ray_triangle", count, ray_triangle, AskRay{});
    add_kind(parts, "point_triangle", count, point_triangle, AskDistance{});
    add_kind(parts, "segments", count, segments, AskDistance{});
    add_kind(parts, "sphere_aabb", count, sphere_aabb, AskOverlap{});
    add_kind(parts, "capsules", count, capsules, AskOverlap{});
    add_kind(parts, "boxes", count, boxes, AskOverlap{});
    return parts;
}

}  // namespace carom::accuracy
