// The convex hull of points as triangles, with exact decisions: the first half of building a ConvexHull.
//
//   std::vector<HullTriangle> hull = triangle_hull(points, 0.0);
//   if (hull.empty()) { /* the points are coplanar */ }
#pragma once

#include <carom/core/types.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::detail {

/// A triangle of a closed surface, counter-clockwise seen from outside.
struct HullTriangle {
    std::array<std::uint32_t, 3> vertex{};    ///< indices of points
    std::array<std::uint32_t, 3> neighbor{};  ///< the triangle across the edge from vertex[i] to vertex[i + 1]
};

/// @return the index within `triangle` of the edge that starts at `vertex`.
[[nodiscard]] inline std::uint32_t edge_from(const HullTriangle& triangle, std::uint32_t vertex) noexcept {
    return triangle.vertex[0] == vertex ? 0u : triangle.vertex[1] == vertex ? 1u : 2u;
}

/// Quickhull (Barber, Dobkin, Huhdanpaa 1996). Which side of a triangle a point lies on is decided without rounding, so the
/// surface is exactly convex, and closed, for every input. Points on a face or an edge may or may not become vertices.
/// @param points         (n,), n >= 4, finite, each coordinate a float's value; duplicates allowed.
/// @param min_thickness  [m]
/// @return the triangles; none where all points lie within `min_thickness` of a line or a plane.
/// Cost: O(n log n) expected.
[[nodiscard]] std::vector<HullTriangle> triangle_hull(std::span<const dvec3> points, double min_thickness);

}  // namespace carom::detail
