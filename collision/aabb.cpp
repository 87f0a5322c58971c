#include <carom/collision/aabb.hpp>
#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/check.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Outward padding of rotated coordinates, relative to |x| + |y| + |z| of the point. With u = 2^-53: an entry of the matrix below
/// is wrong by at most 5 u, a row times a point by 5 u more, and transform_point() in its other order of operations by at most
/// 20 u; so 32 u = 2^-48 covers both.
constexpr double kTurnPad = 0x1p-48;
/// And of the sum of position and extent, which rounds once here and once in transform_point(): 2 u would do.
constexpr double kSumPad = 0x1p-51;

/// The rows of the matrix that `rotate` applies.
struct Rows {
    dvec3 row[3];
};

Rows rows_of(const dquat& q) {
    return {{{1.0 - 2.0 * (q.y * q.y + q.z * q.z), 2.0 * (q.x * q.y - q.w * q.z), 2.0 * (q.x * q.z + q.w * q.y)},
             {2.0 * (q.x * q.y + q.w * q.z), 1.0 - 2.0 * (q.x * q.x + q.z * q.z), 2.0 * (q.y * q.z - q.w * q.x)},
             {2.0 * (q.x * q.z - q.w * q.y), 2.0 * (q.y * q.z + q.w * q.x), 1.0 - 2.0 * (q.x * q.x + q.y * q.y)}}};
}

/// The box [lower, upper] about `position`, widened for the rounding above. `reach` bounds |x| + |y| + |z| over the shape.
Aabb placed(const dvec3& position, const dvec3& lower, const dvec3& upper, double reach) {
    const dvec3 pad = kTurnPad * reach + kSumPad * (glm::abs(position) + reach);
    return {position + (lower - pad), position + (upper + pad)};
}

Aabb bounds_of(const Sphere& sphere, const Pose& pose) {
    const double r = static_cast<double>(sphere.radius);
    return placed(pose.position, dvec3{-r}, dvec3{r}, 2.0 * r);  // |x| + |y| + |z| <= sqrt(3) r
}

Aabb bounds_of(const Box& box, const Pose& pose) {
    const dvec3 h{box.half_extents};
    const Rows m = rows_of(pose.orientation);
    const dvec3 e{glm::dot(glm::abs(m.row[0]), h), glm::dot(glm::abs(m.row[1]), h), glm::dot(glm::abs(m.row[2]), h)};
    return placed(pose.position, -e, e, h.x + h.y + h.z);
}

Aabb bounds_of(const Capsule& capsule, const Pose& pose) {
    const double r = static_cast<double>(capsule.radius);
    const double h = static_cast<double>(capsule.half_segment);
    const Rows m = rows_of(pose.orientation);
    const dvec3 e = dvec3{r} + h * glm::abs(dvec3{m.row[0].y, m.row[1].y, m.row[2].y});
    return placed(pose.position, -e, e, 2.0 * r + h);
}

Aabb bounds_of(const Plane&, const Pose&) { return {dvec3{-kInfinity}, dvec3{kInfinity}}; }

Aabb bounds_of(const ConvexHullPtr& hull, const Pose& pose) {
    CAROM_ASSERT(hull != nullptr);
    const Rows m = rows_of(pose.orientation);
    dvec3 lower{kInfinity};
    dvec3 upper{-kInfinity};
    double reach = 0.0;
    for (const vec3& vertex : hull->vertices()) {
        const dvec3 v{vertex};
        const dvec3 turned{glm::dot(m.row[0], v), glm::dot(m.row[1], v), glm::dot(m.row[2], v)};
        lower = glm::min(lower, turned);
        upper = glm::max(upper, turned);
        reach = std::max(reach, std::abs(v.x) + std::abs(v.y) + std::abs(v.z));
    }
    return placed(pose.position, lower, upper, reach);
}

Aabb bounds_of(const TriangleMeshPtr& mesh, const Pose& pose) {
    CAROM_ASSERT(mesh != nullptr);
    const Aabb& local = mesh->local_bounds();
    const Rows m = rows_of(pose.orientation);
    dvec3 lower{0.0};
    dvec3 upper{0.0};
    for (int i = 0; i < 3; ++i) {
        const dvec3 a = m.row[i] * local.lower;
        const dvec3 b = m.row[i] * local.upper;
        const dvec3 low = glm::min(a, b);
        const dvec3 high = glm::max(a, b);
        lower[i] = low.x + low.y + low.z;
        upper[i] = high.x + high.y + high.z;
    }
    const dvec3 far = glm::max(glm::abs(local.lower), glm::abs(local.upper));
    return placed(pose.position, lower, upper, far.x + far.y + far.z);
}

/// The solid between two discs about (0, -h, 0) and (0, h, 0): the hull of their rims.
Aabb turned_bounds(double lower_radius, double upper_radius, double h, const Pose& pose) {
    const Rows m = rows_of(pose.orientation);
    dvec3 lower{0.0};
    dvec3 upper{0.0};
    for (int i = 0; i < 3; ++i) {
        const dvec3& row = m.row[i];
        const double across = std::sqrt(row.x * row.x + row.z * row.z);
        upper[i] = std::max(upper_radius * across + h * row.y, lower_radius * across - h * row.y);
        lower[i] = -std::max(upper_radius * across - h * row.y, lower_radius * across + h * row.y);
    }
    return placed(pose.position, lower, upper, 2.0 * std::max(lower_radius, upper_radius) + h);
}

Aabb bounds_of(const Cylinder& cylinder, const Pose& pose) {
    const double r = static_cast<double>(cylinder.radius);
    return turned_bounds(r, r, static_cast<double>(cylinder.half_height), pose);
}

Aabb bounds_of(const Cone& cone, const Pose& pose) {
    return turned_bounds(static_cast<double>(cone.radius), 0.0, static_cast<double>(cone.half_height), pose);
}

/// The parts' boxes are those of poses that were multiplied in double; the pad is for a point that goes through the two poses one
/// after the other instead.
Aabb bounds_of(const CompoundPtr& compound, const Pose& pose) {
    CAROM_ASSERT(compound != nullptr);
    Aabb box;
    for (const CompoundPart& part : compound->parts()) box = merge(box, bounds(part.shape, pose * part.pose));
    const Aabb& local = compound->local_bounds();
    const dvec3 far = glm::max(glm::abs(local.lower), glm::abs(local.upper));
    const double reach = far.x + far.y + far.z;
    const dvec3 pad = kTurnPad * reach + kSumPad * (glm::abs(pose.position) + reach);
    return {box.lower - pad, box.upper + pad};
}

/// sqrt(x² + y² + z²) rounds four times; the product makes up for that.
double length_up(const dvec3& v) { return glm::length(v) * (1.0 + 0x1p-50); }

double longest_up(std::span<const vec3> vertices) {
    double square = 0.0;
    for (const vec3& v : vertices) square = std::max(square, glm::dot(dvec3{v}, dvec3{v}));
    return std::sqrt(square) * (1.0 + 0x1p-50);
}

double radius_of(const Sphere& sphere) { return static_cast<double>(sphere.radius); }
double radius_of(const Box& box) { return length_up(dvec3{box.half_extents}); }
double radius_of(const Capsule& capsule) {
    return (static_cast<double>(capsule.radius) + static_cast<double>(capsule.half_segment)) * (1.0 + 0x1p-50);
}
double radius_of(const Plane&) { return kInfinity; }
double radius_of(const ConvexHullPtr& hull) { return hull->reach(); }
double radius_of(const TriangleMeshPtr& mesh) { return longest_up(mesh->vertices()); }

double rim_distance(float radius, float half_height) {
    return length_up({static_cast<double>(radius), static_cast<double>(half_height), 0.0});
}
double radius_of(const Cylinder& cylinder) { return rim_distance(cylinder.radius, cylinder.half_height); }
double radius_of(const Cone& cone) { return rim_distance(cone.radius, cone.half_height); }
double radius_of(const CompoundPtr& compound) {
    double farthest = 0.0;
    for (const CompoundPart& part : compound->parts()) {
        farthest = std::max(farthest, (length_up(part.pose.position) + bounding_radius(part.shape)) * (1.0 + 0x1p-50));
    }
    return farthest;
}

double smallest(const dvec3& v) { return std::min({v.x, v.y, v.z}); }

double extent_of(const Sphere& sphere) { return 2.0 * static_cast<double>(sphere.radius); }
double extent_of(const Box& box) { return 2.0 * smallest(dvec3{box.half_extents}); }
double extent_of(const Capsule& capsule) { return 2.0 * static_cast<double>(capsule.radius); }
double extent_of(const Plane&) { return kInfinity; }
double extent_of(const ConvexHullPtr& hull) {
    double least = kInfinity;
    for (const ConvexHull::Face& face : hull->faces()) {
        const dvec3 opposite{hull->vertices()[hull->support(-face.normal)]};
        least = std::min(least, face.offset - glm::dot(face.normal, opposite));
    }
    return least;
}
double extent_of(const Cylinder& cylinder) {
    return 2.0 * static_cast<double>(std::min(cylinder.radius, cylinder.half_height));
}
/// The least altitude of its section through the axis, which is as wide as the cone in each direction.
double extent_of(const Cone& cone) {
    const double r = static_cast<double>(cone.radius);
    const double height = 2.0 * static_cast<double>(cone.half_height);
    return std::min(height, 2.0 * r * height / std::sqrt(r * r + height * height));
}
double extent_of(const CompoundPtr& compound) {
    double least = kInfinity;
    for (const CompoundPart& part : compound->parts()) least = std::min(least, smallest_extent(part.shape));
    return least;
}
double extent_of(const TriangleMeshPtr& mesh) { return smallest(mesh->local_bounds().upper - mesh->local_bounds().lower); }

}  // namespace

Aabb bounds(const Shape& shape, const Pose& pose) {
    return std::visit([&](const auto& alternative) { return bounds_of(alternative, pose); }, shape);
}

double bounding_radius(const Shape& shape) {
    return std::visit([](const auto& alternative) { return radius_of(alternative); }, shape);
}

double smallest_extent(const Shape& shape) {
    return std::visit([](const auto& alternative) { return extent_of(alternative); }, shape);
}

}  // namespace carom
