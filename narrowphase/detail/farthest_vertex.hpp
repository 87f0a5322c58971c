// The vertex of a hull that is farthest along a direction, in double, as wide as the machine allows.
//
//   std::uint32_t i = farthest_vertex(hull.vertex_bundles(), direction);
#pragma once

#include <carom/collision/convex_hull.hpp>

#include <cstdint>
#include <span>

namespace carom::detail {

/// @return the lowest number of those whose dot product with `direction`, (x + y) + z rounded in double, is the largest: the same at
/// every SIMD width. @param vertices  one bundle at least; `direction` finite.
[[nodiscard]] std::uint32_t farthest_vertex(std::span<const ConvexHull::VertexBundle> vertices, const dvec3& direction) noexcept;

}  // namespace carom::detail
