#include <carom/studies/accuracy/convex_cases.hpp>

#include <carom/collision/convex_hull.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/narrowphase/distance.hpp>
#include <carom/studies/oracle/brute_force.hpp>

#include <glm/geometric.hpp>

#include <cmath>

namespace carom::accuracy {
namespace {

constexpr int kCases = 1000, kHullPoints = 14;

dvec3 direction(Random& random) {
    for (;;) {
        const dvec3 d{random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0)};
        const double length = glm::length(d);
        if (length > 0.1 && length <= 1.0) return d / length;
    }
}

dquat rotation(Random& random) {
    const SinCos half = sin_cos(random.range(0.0, kPi));
    const dvec3 axis = half.sin * direction(random);
    return {half.cos, axis.x, axis.y, axis.z};
}

// What a condition makes of sizes and places.
struct Condition {
    const char* name;
    double thin = 1.0, scale = 1.0, near_share = 0.0;
    double least_gap = 0.0, most_gap = 0.0;  // decades of the gap next to contact; both 0: none
    double least_apart = 0.5, most_apart = 2.4, far = 0.0;
};
constexpr Condition kConditions[] = {
    {.name = "random"},
    {.name = "near", .near_share = 1.0, .least_gap = -12.0, .most_gap = -3.0},
    {.name = "touching", .near_share = 1.0},
    {.name = "deep", .least_apart = 0.0, .most_apart = 0.2},
    {.name = "thin", .thin = 1e-3, .near_share = 0.5, .least_gap = -12.0, .most_gap = -3.0, .least_apart = 0.2},
    {.name = "far", .near_share = 0.5, .least_gap = -6.0, .most_gap = -3.0, .far = 7.0},
    {.name = "tiny", .scale = 1e-6, .near_share = 0.5, .least_gap = -12.0, .most_gap = -3.0},
};

Shape make_shape(ConvexKind kind, const Condition& c, Random& random) {
    const auto extent = [&](double share) { return static_cast<float>(c.scale * share * random.range(0.2, 1.0)); };
    if (kind == ConvexKind::Boxes) return Box{{extent(1.0), extent(c.thin), extent(1.0)}};
    for (;;) {
        const vec3 radii{extent(1.0), extent(c.thin), extent(1.0)};
        std::vector<vec3> points;
        for (int i = 0; i < kHullPoints; ++i) points.push_back(radii * vec3(direction(random)));
        if (const Result<ConvexHullPtr> hull = ConvexHull::build(points)) return *hull;
    }
}

oracle::Solid solid(const Shape& shape, const Pose& pose, const dvec3& origin) {
    if (const Box* box = std::get_if<Box>(&shape)) return oracle::solid_of(*box, pose, origin);
    return oracle::solid_of(*std::get<ConvexHullPtr>(shape), pose, origin);
}

// Moves b along the axis of the greatest separation until that is `gap`, as far as doubles hold the place.
void bring_near(const Shape& a, const Pose& pose_a, const Shape& b, Pose& pose_b, double gap) {
    const auto axis = oracle::greatest_separation(solid(a, pose_a, pose_a.position), solid(b, pose_b, pose_a.position));
    pose_b.position += (gap - static_cast<double>(axis.value)) * dvec3(axis.normal);
}

void add_case(ConvexKind kind, const Condition& c, Random& random, ConvexCases& cases) {
    const Shape a = make_shape(kind, c, random), b = make_shape(kind, c, random);
    Pose pose_a{dvec3{0.0}, rotation(random)}, pose_b{dvec3{0.0}, rotation(random)};
    if (c.far > 0.0) pose_a.position = std::pow(10.0, random.range(4.0, c.far)) * direction(random);
    pose_b.position = pose_a.position + (c.scale * random.range(c.least_apart, c.most_apart)) * direction(random);
    if (random.unit() < c.near_share) {
        const double gap = c.most_gap != 0.0 ? std::pow(10.0, random.range(c.least_gap, c.most_gap)) : 0.0;
        bring_near(a, pose_a, b, pose_b, (random.unit() < 0.5 ? -1.0 : 1.0) * c.scale * gap);
    }
    cases.separation.push_back(
        static_cast<double>(oracle::signed_distance(solid(a, pose_a, pose_a.position), solid(b, pose_b, pose_a.position))));
    cases.size.push_back(2.0 * c.scale);
    const auto place = static_cast<std::uint32_t>(cases.shapes.size());
    cases.pairs.push_back({place, place + 1, 0.0f});
    cases.shapes.push_back(a);
    cases.shapes.push_back(b);
    cases.poses.push_back(pose_a);
    cases.poses.push_back(pose_b);
}

}  // namespace

std::vector<ConvexCases> convex_cases(ConvexKind kind, bool quick) {
    std::vector<ConvexCases> all;
    std::uint64_t seed = kind == ConvexKind::Boxes ? 0x5a7 : 0x91c;
    for (const Condition& condition : kConditions) {
        Random random(seed++);
        ConvexCases& cases = all.emplace_back();
        cases.condition = condition.name;
        for (int i = 0; i < (quick ? kCases / 10 : kCases); ++i) add_case(kind, condition, random, cases);
        for (const Shape& shape : cases.shapes) cases.placed.push_back(&shape);
    }
    return all;
}

}  // namespace carom::accuracy
