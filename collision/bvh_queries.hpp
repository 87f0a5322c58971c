// What of a static hierarchy of triangles overlaps a volume, and what is closest to a point.
//
//   overlapping_triangles(bvh, geo::Sphere<double>{centre, 2.0}, [&](std::uint32_t triangle) { ...; return true; });
//   if (auto nearest = closest_point(bvh, p, 5.0)) { nearest->point; nearest->distance; nearest->triangle; }
//
// Everything is in the frame of the triangles, in double; the tree's float boxes only choose which triangles are looked at, and are
// compared with what rounding may do to them on the safe side. The answers do not depend on the tree's shape, the SIMD width or the
// thread count. No allocation but where said, thread-safe.
#pragma once

#include <carom/collision/frustum.hpp>
#include <carom/collision/primitives.hpp>
#include <carom/collision/static_bvh.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/core/pose.hpp>

#include <cstdint>
#include <limits>
#include <optional>
#include <span>

namespace carom {

class ConvexHull;

/// Called for a triangle, by its number in the mesh; false ends the query.
using TriangleVisit = FunctionRef<bool(std::uint32_t triangle)>;

/// Visits each triangle that shares a point with the volume (closed), once, in an order that the mesh fixes. Solid volumes: triangles
/// inside count.
/// @param volume  finite; a negative radius or half extent, an inverted box or a NaN overlaps nothing.
/// Accuracy: that of geo::overlaps(): no triangle is missed, and one that is visited lies within its bound of the volume.
/// Cost: O(log m + triangles near): some 50 ns a node, 5 to 500 ns a triangle whose box is met.
void overlapping_triangles(const StaticBvh& bvh, const geo::Aabb<double>& volume, TriangleVisit visit);
void overlapping_triangles(const StaticBvh& bvh, const geo::Sphere<double>& volume, TriangleVisit visit);
void overlapping_triangles(const StaticBvh& bvh, const geo::Obb<double>& volume, TriangleVisit visit);
void overlapping_triangles(const StaticBvh& bvh, const geo::Capsule<double>& volume, TriangleVisit visit);

/// The same for the points above the planes of a frustum, and for a hull at a pose.
/// Accuracy: conservative: no triangle is missed, and one that is visited comes within 32 eps of the largest coordinate (of triangle,
/// planes and pose) of every half-space at one point. Frusta that reach to infinity do.
/// Cost: as above, the triangles that are met cut by each plane, 20 ns for each. Allocates a small buffer.
void overlapping_triangles(const StaticBvh& bvh, const geo::Frustum<double>& volume, TriangleVisit visit);
void overlapping_triangles(const StaticBvh& bvh, const ConvexHull& hull, const Pose& pose, TriangleVisit visit);

/// The point of the mesh that is closest to a point.
struct ClosestOnMesh {
    dvec3 point{0.0};
    double distance = 0.0;
    std::uint32_t triangle = 0;  ///< the lowest of several at the least distance
};

/// @param point   finite.
/// @param radius  only what is at most this far counts; not NaN. Nothing that near is missed, a point exactly on a triangle and a radius
///                of 0 included; what is returned may be 32 eps of the largest coordinate difference farther.
/// @return nothing where the mesh is farther than `radius`, and for bad input.
/// Accuracy: that of geo::closest_points() of a point and a triangle.
/// Cost: O(log m) expected, O(m) for a point as far from everything (the centre of a sphere).
[[nodiscard]] std::optional<ClosestOnMesh> closest_point(const StaticBvh& bvh, const dvec3& point,
                                                         double radius = std::numeric_limits<double>::infinity());

/// closest_point() of each point. @param found  (n,) as points; otherwise reports misuse and changes nothing.
void closest_points(const StaticBvh& bvh, std::span<const dvec3> points, double radius, std::span<std::optional<ClosestOnMesh>> found,
                    Executor& executor);

}  // namespace carom
