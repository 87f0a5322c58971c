#include <carom/studies/accuracy/manifold_cases.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/terrain.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/studies/accuracy/any_direction.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace carom::accuracy {
namespace {

dquat turn(const dvec3& axis, double angle) {
    const SinCos half = sin_cos(0.5 * angle);
    return {half.cos, half.sin * axis.x, half.sin * axis.y, half.sin * axis.z};
}

dquat any_turn(Random& random) { return turn(any_direction(random), random.range(0.0, 2.0 * kPi)); }

Box any_box(Random& random) {
    const auto half = [&] { return static_cast<float>(random.range(0.2, 1.0)); };
    const float x = half(), y = half(), z = half();
    return {{x, y, z}};
}

Shape any_hull(Random& random) {
    const vec3 scale{static_cast<float>(random.range(0.4, 1.0)), static_cast<float>(random.range(0.4, 1.0)), static_cast<float>(random.range(0.4, 1.0))};
    std::vector<vec3> points;
    for (int i = 0; i < 32; ++i) points.push_back(scale * vec3(any_direction(random)));
    return *ConvexHull::build(points);
}

double extent(const Shape& shape, const Pose& pose) {
    const Aabb box = bounds(shape, {dvec3{0.0}, pose.orientation});
    const dvec3 size = box.upper - box.lower;
    return std::max({size.x, size.y, size.z});
}

double true_depth(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    const Box* box_a = std::get_if<Box>(&a);
    const Box* box_b = std::get_if<Box>(&b);
    if (box_a != nullptr && box_b != nullptr) return oracle::overlap_depth(*box_a, pose_a, *box_b, pose_b);
    return oracle::overlap_depth(*oracle::make_polytope(a, pose_a), *oracle::make_polytope(b, pose_b));
}

template <class MakeShape>
ManifoldCasesPtr overlapping(std::size_t count, Depth depth, std::uint64_t seed, const MakeShape& make_shape) {
    auto cases = std::make_shared<ManifoldCases>();
    Random random(seed);
    while (cases->depth.size() < count) {
        const Shape a = make_shape(random), b = make_shape(random);
        const Pose pose_a{dvec3{0.0}, any_turn(random)};
        const Pose pose_b{any_direction(random) * random.range(0.0, 2.4), any_turn(random)};
        const double overlap = true_depth(a, pose_a, b, pose_b);
        const double least = depth == Depth::Wedged ? 0.1 * std::min(smallest_extent(a), smallest_extent(b)) : 0.0;
        if (!(overlap > least)) continue;
        cases->add(a, pose_a, b, pose_b);
        cases->depth.push_back(overlap);
    }
    cases->number(0.0f);
    return cases;
}

using Corner = glm::dvec2;

double cross(const Corner& a, const Corner& b) { return a.x * b.y - a.y * b.x; }

// Half the sum of the cross products, counter-clockwise.
double polygon_area(const std::vector<Corner>& corners) {
    double sum = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) sum += cross(corners[i], corners[(i + 1) % corners.size()]);
    return 0.5 * sum;
}

// The cut of two convex polygons, one edge of the second after the other.
std::vector<Corner> cut(std::vector<Corner> polygon, const std::vector<Corner>& by) {
    for (std::size_t i = 0; i < by.size(); ++i) {
        const Corner from = by[i], along = by[(i + 1) % by.size()] - from;
        std::vector<Corner> left;
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const Corner p = polygon[k], q = polygon[(k + 1) % polygon.size()];
            const double hp = cross(along, p - from), hq = cross(along, q - from);
            if (hp >= 0.0) left.push_back(p);
            if ((hp > 0.0 && hq < 0.0) || (hp < 0.0 && hq > 0.0)) left.push_back(p + (hp / (hp - hq)) * (q - p));
        }
        polygon = std::move(left);
    }
    return polygon;
}

std::vector<Corner> rectangle(double half_x, double half_z, const Corner& middle, double angle) {
    const SinCos t = sin_cos(angle);
    std::vector<Corner> corners;
    for (const auto& [sx, sz] : {std::pair{1.0, 1.0}, {-1.0, 1.0}, {-1.0, -1.0}, {1.0, -1.0}}) {
        const double x = sx * half_x, z = sz * half_z;
        corners.push_back(middle + Corner{t.cos * x - t.sin * z, t.sin * x + t.cos * z});
    }
    return corners;
}

// The area of the hull of a few points.
double hull_area(std::vector<Corner> points) {
    Corner middle{0.0};
    for (const Corner& p : points) middle += p / static_cast<double>(points.size());
    std::ranges::sort(points, {}, [&](const Corner& p) { return arctan2(p.y - middle.y, p.x - middle.x); });
    return std::abs(polygon_area(points));
}

Shape any_solid(Random& random, int kind) {
    const auto size = [&](double low, double high) { return static_cast<float>(random.range(low, high)); };
    switch (kind) {
        case 0: return any_box(random);
        case 1: return any_hull(random);
        case 2: return Sphere{size(0.2, 0.8)};
        case 3: return Capsule{size(0.1, 0.4), size(0.1, 0.6)};
        case 4: return Cylinder{size(0.2, 0.6), size(0.2, 0.6)};
        default: return Cone{size(0.2, 0.6), size(0.2, 0.6)};
    }
}

Shape ground_of(int triangles) {
    if (triangles == 0) return Plane{};
    const int side = static_cast<int>(std::lround(std::sqrt(0.5 * triangles)));
    const MeshData data = height_grid(side, side, 16.0 / side, [](double, double) { return 0.0; });
    return *TriangleMesh::build(data.vertices, data.triangles);
}

// Calls each(case, first manifold, count) for every case; manifolds come in the order of the pairs.
template <class Each>
void for_each_case(std::size_t cases, std::span<const Manifold> manifolds, const Each& each) {
    std::size_t next = 0;
    for (std::size_t k = 0; k < cases; ++k) {
        const std::size_t first = next;
        while (next < manifolds.size() && manifolds[next].pair == k) ++next;
        each(k, manifolds.subspan(first, next - first));
    }
}

// The deepest point, with its manifold's normal.
std::optional<std::pair<double, dvec3>> deepest(std::span<const Manifold> manifolds) {
    std::optional<std::pair<double, dvec3>> best;
    for (const Manifold& m : manifolds) {
        for (const ContactPoint& p : m.used()) {
            const double depth = -static_cast<double>(p.separation);
            if (!best || depth > best->first) best = {depth, dvec3(m.normal)};
        }
    }
    return best;
}

template <class Each>
void for_each_depth_error(const ManifoldCases& cases, std::span<const Manifold> manifolds, const Each& each) {
    for_each_case(cases.count(), manifolds, [&](std::size_t k, std::span<const Manifold> of_pair) {
        const auto found = deepest(of_pair);
        each(found ? std::abs(found->first - cases.depth[k]) / cases.size[k] : 1.0);
    });
}

}  // namespace

void ManifoldCases::add(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    shapes.insert(shapes.end(), {a, b});
    poses.insert(poses.end(), {pose_a, pose_b});
    const auto finite = [](const Shape& s, const Pose& p) { return is_bounded(s) && type_of(s) != ShapeType::TriangleMesh ? extent(s, p) : 0.0; };
    size.push_back(std::max(finite(a, pose_a), finite(b, pose_b)));
}

void ManifoldCases::number(float margin) {
    pointers.clear();
    pairs.clear();
    for (const Shape& shape : shapes) pointers.push_back(&shape);
    for (std::uint32_t k = 0; 2 * k < shapes.size(); ++k) pairs.push_back({2 * k, 2 * k + 1, margin});
}

ManifoldCasesPtr box_cases(std::size_t count, Depth depth, std::uint64_t seed) {
    return overlapping(count, depth, seed, [](Random& random) { return Shape(any_box(random)); });
}

ManifoldCasesPtr hull_cases(std::size_t count, std::uint64_t seed) { return overlapping(count, Depth::Any, seed, any_hull); }

ManifoldCasesPtr as_hulls(const ManifoldCases& boxes) {
    auto cases = std::make_shared<ManifoldCases>(boxes);
    for (Shape& shape : cases->shapes) {
        const vec3 h = std::get<Box>(shape).half_extents;
        std::vector<vec3> corners;
        for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? h.x : -h.x, i & 2 ? h.y : -h.y, i & 4 ? h.z : -h.z});
        shape = *ConvexHull::build(corners);
    }
    cases->number(boxes.pairs.empty() ? 0.0f : boxes.pairs[0].margin);
    return cases;
}

ManifoldCasesPtr resting_cases(std::size_t count, std::uint64_t seed) {
    auto cases = std::make_shared<ManifoldCases>();
    Random random(seed);
    while (cases->depth.size() < count) {
        const Box a = any_box(random), b = any_box(random);
        const double depth = 1e-3 * random.unit(), angle = random.range(0.0, 2.0 * kPi);
        const Corner at{random.range(-1.0, 1.0), random.range(-1.0, 1.0)};
        const auto half = [](const Box& box, int k) { return static_cast<double>(box.half_extents[k]); };
        const double area = polygon_area(cut(rectangle(half(a, 0), half(a, 2), {}, 0.0), rectangle(half(b, 0), half(b, 2), at, angle)));
        if (!(area > 0.02)) continue;
        // A turn by `angle` from x towards z is one by -angle about y.
        cases->add(a, {}, b, {{at.x, half(a, 1) + half(b, 1) - depth, at.y}, turn({0, 1, 0}, -angle)});
        cases->depth.push_back(depth);
        cases->area.push_back(area);
    }
    cases->number(0.01f);
    return cases;
}

ManifoldCasesPtr ground_cases(std::size_t count, int triangles, bool turned, std::uint64_t seed) {
    auto cases = std::make_shared<ManifoldCases>();
    Random random(seed);
    const Shape ground = ground_of(triangles);
    for (std::size_t i = 0; i < count; ++i) {
        const Shape solid = any_solid(random, static_cast<int>(turned ? 4 + i % 2 : i % 4));
        const dquat orientation = any_turn(random);
        // bounds() is tight for these but for roundings of 2^-46, rounded outward.
        const double lowest = bounds(solid, {dvec3{0.0}, orientation}).lower.y;
        // Shallow enough that up is the shortest way out, and the middle above.
        const double depth = 0.2 * smallest_extent(solid) * random.unit();
        cases->add(solid, {{random.range(-3.0, 3.0), -lowest - depth, random.range(-3.0, 3.0)}, orientation}, ground, {});
        cases->depth.push_back(depth);
    }
    cases->number(0.0f);
    return cases;
}

ManifoldCasesPtr moved(const ManifoldCases& cases, double share, std::uint64_t seed) {
    auto out = std::make_shared<ManifoldCases>(cases);
    Random random(seed);
    for (std::size_t k = 0; k < out->count(); ++k) {
        Pose& pose = out->poses[2 * k + 1];
        pose.position += (share * out->size[k]) * any_direction(random);
        pose.orientation = turn(any_direction(random), share) * pose.orientation;
    }
    out->number(cases.pairs.empty() ? 0.0f : cases.pairs[0].margin);
    return out;
}

double depth_error(const ManifoldCases& cases, std::span<const Manifold> manifolds) {
    double worst = 0.0;
    for_each_depth_error(cases, manifolds, [&](double error) { worst = std::max(worst, error); });
    return worst;
}

double mean_depth_error(const ManifoldCases& cases, std::span<const Manifold> manifolds) {
    double sum = 0.0;
    for_each_depth_error(cases, manifolds, [&](double error) { sum += error; });
    return cases.count() == 0 ? 0.0 : sum / static_cast<double>(cases.count());
}

double normal_error(const ManifoldCases& cases, std::span<const Manifold> manifolds) {
    double worst = 0.0;
    for_each_case(cases.count(), manifolds, [&](std::size_t k, std::span<const Manifold> of_pair) {
        const auto found = deepest(of_pair);
        if (!found) return;
        const ShapePair pair = cases.pair(k);
        const oracle::Polytope a = *oracle::make_polytope(*pair.a, pair.pose_a), b = *oracle::make_polytope(*pair.b, pair.pose_b);
        const dvec3 normal = glm::normalize(found->second);
        double top = -1e300, bottom = 1e300;
        for (const dvec3& v : a.vertices) top = std::max(top, glm::dot(normal, v));
        for (const dvec3& v : b.vertices) bottom = std::min(bottom, glm::dot(normal, v + (b.position - a.position)));
        worst = std::max(worst, (top - bottom - cases.depth[k]) / cases.size[k]);
    });
    return worst;
}

double area_error(const ManifoldCases& cases, std::span<const Manifold> manifolds, std::size_t points) {
    double sum = 0.0;
    for_each_case(cases.count(), manifolds, [&](std::size_t k, std::span<const Manifold> of_pair) {
        std::vector<Corner> corners;
        for (const Manifold& m : of_pair) {
            for (const ContactPoint& p : m.used()) corners.emplace_back(p.position.x, p.position.z);
        }
        corners.resize(std::min(points, corners.size()));
        const double kept = corners.size() < 3 ? 0.0 : hull_area(corners);
        sum += std::max(0.0, 1.0 - kept / cases.area[k]);
    });
    return sum / static_cast<double>(cases.count());
}

double new_names(std::span<const Manifold> before, std::span<const Manifold> after) {
    std::size_t fresh = 0, all = 0, first = 0;
    for (const Manifold& m : after) {
        while (first < before.size() && before[first].pair < m.pair) ++first;
        for (const ContactPoint& p : m.used()) {
            bool known = false;
            for (std::size_t i = first; i < before.size() && before[i].pair == m.pair; ++i) {
                for (const ContactPoint& q : before[i].used()) known |= q.feature == p.feature;
            }
            fresh += !known;
            ++all;
        }
    }
    return all == 0 ? 0.0 : static_cast<double>(fresh) / static_cast<double>(all);
}

}  // namespace carom::accuracy
