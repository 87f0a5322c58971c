// Whether a closed surface of triangles is that of a convex solid, and of which.
//
//   if (const ConvexHullPtr solid = convex_solid(vertices, triangles)) ...
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/types.hpp>

#include <array>
#include <cstdint>
#include <span>

namespace carom::detail {

/// Corners of a triangle lie in a plane of the solid to this share of the largest extent: coordinates of 24 bits leave faces bumpy by about
/// 1e-7 of it, and ConvexHull::build lays planes over faces that it merges.
inline constexpr double kSolidTolerance = 2e-6;

/// Larger ones are not looked at: a hull has to cost less than what its surface does.
inline constexpr std::size_t kMostSolidTriangles = 1u << 14;
inline constexpr std::size_t kMostSolidFaces = 1024;

/// @param triangles  closed (surface_kind), indices in range.
/// @return the hull of the vertices where every triangle lies on it, to kSolidTolerance, and faces out of it, and together they cover it once;
/// null otherwise, and where there are more triangles or faces than the two bounds.
/// Cost: a look at a few triangles where it is not convex; otherwise that of the hull, and O(triangles) unless most have corners inside faces.
[[nodiscard]] ConvexHullPtr convex_solid(std::span<const vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace carom::detail
