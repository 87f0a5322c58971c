// What is done with all vertices, planes or edges of a polytope at once, in lanes.
//
//   const Extreme low = lowest(b, normal);      // a support point
//   list_edges_above_both(p, ends, 0.0, edges);
//
// A double a lane, eight lanes to a bundle, the same bits at every width: what is compared are dot products that each lane computes as a
// scalar would, and of equal ones the lowest number counts.
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/narrowphase/detail/polytope.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::detail {

/// Moves points and planes: x goes to axes * x + origin.
void place_polytope(std::span<const PointBundle> points, std::span<const PlaneBundle> planes, const dmat3& axes, const dvec3& origin,
                    PointBundle* to_points, PlaneBundle* to_planes);

/// Which of many, and what it has there.
struct Extreme {
    double value = 0.0;
    std::uint32_t number = 0;
};

/// @return the vertex with the least dot product with `direction`, and the product.
[[nodiscard]] Extreme lowest(std::span<const PointBundle> points, const dvec3& direction) noexcept;
[[nodiscard]] inline Extreme lowest(const Polytope& p, const dvec3& direction) noexcept { return lowest(p.points, direction); }
/// @return the numbers of the lowest vertices of two sets, each along a direction of its own.
[[nodiscard]] std::array<std::uint32_t, 2> lowest_of_two(std::span<const PointBundle> a, const dvec3& along_a,
                                                         std::span<const PointBundle> b, const dvec3& along_b) noexcept;
/// @return the bounds of the vertices v, as (v - origin) * axes.
[[nodiscard]] Aabb bounds_of(const Polytope& p, const dvec3& origin, const dmat3& axes) noexcept;
/// @return the face whose normal has the greatest dot product with `direction`, and the product.
[[nodiscard]] Extreme face_along(const Polytope& p, const dvec3& direction) noexcept;

/// @return the face over whose plane the lower end of the segment is highest, and its height.
[[nodiscard]] Extreme highest_face(const Polytope& p, const dvec3& from, const dvec3& to) noexcept;

/// Lists the edges between whose planes a normal may separate by more than `floor`: from one of the two points, or from both. No normal
/// between those of two planes separates from a point by more than the better of the two does.
void list_edges_above_one(const Polytope& p, const dvec3 (&points)[2], double floor, std::vector<std::uint32_t>& numbers);
void list_edges_above_both(const Polytope& p, const dvec3 (&points)[2], double floor, std::vector<std::uint32_t>& numbers);

}  // namespace carom::detail
