// Axis-aligned bounding boxes, in double (geometry) and in float rounded outward (broadphase).
//
//   Aabb box = bounds(shape, pose);
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/pose.hpp>

#include <limits>

namespace carom {

/// A closed box [lower, upper] [m]. The default is empty: lower > upper.
struct Aabb {
    dvec3 lower{std::numeric_limits<double>::infinity()};
    dvec3 upper{-std::numeric_limits<double>::infinity()};
    friend bool operator==(const Aabb&, const Aabb&) = default;
};

[[nodiscard]] inline bool is_empty(const Aabb& a) noexcept {
    return !(a.lower.x <= a.upper.x && a.lower.y <= a.upper.y && a.lower.z <= a.upper.z);
}
/// Closed test: boxes that only touch overlap.
[[nodiscard]] inline bool overlaps(const Aabb& a, const Aabb& b) noexcept {
    return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y && b.lower.y <= a.upper.y &&
           a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
}
[[nodiscard]] inline Aabb merge(const Aabb& a, const Aabb& b) noexcept {
    return {glm::min(a.lower, b.lower), glm::max(a.upper, b.upper)};
}
[[nodiscard]] inline Aabb inflate(const Aabb& a, double margin) noexcept {
    return {a.lower - dvec3{margin}, a.upper + dvec3{margin}};
}

/// @param shape  valid (see validate); @param pose  finite, unit orientation.
/// @return a box that holds the shape at `pose`; for a plane, infinite on every axis.
/// Accuracy: the box holds the exact shape, and also every point of it that transform_point() gives in double; it is larger by at
/// most 2^-46 of |position| + |shape|. Tight for sphere, box, capsule, cylinder, cone, hull and compounds of them; for a mesh it
/// holds the rotated box of the mesh.
/// Cost: O(1), hull O(vertices), compound the sum over its parts; no allocation, thread-safe.
[[nodiscard]] Aabb bounds(const Shape& shape, const Pose& pose);

/// @return the radius about the shape's own origin of a ball that holds it [m], rounded up; infinite for a plane.
/// Cost: O(1), hull and mesh O(vertices), compound the sum over its parts.
[[nodiscard]] double bounding_radius(const Shape& shape);

/// @return how thin the shape is [m]: the smallest edge of a box, the diameter of a sphere or capsule, the least width of a cylinder or
/// cone, the least width of a hull across one of its faces, however it is turned in its frame; of a compound that of its thinnest
/// part. Of a mesh: the smallest edge of the box that holds it in its own frame,
/// so 0 for one in a plane along the axes. Infinite for a plane. Cost: O(1), hull O(faces x vertices).
[[nodiscard]] double smallest_extent(const Shape& shape);

}  // namespace carom
