// Builds the wide hierarchy of a mesh.
//
//   WideBvh tree = build_wide_bvh(vertices, triangles, executor);
#pragma once

#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/core/executor.hpp>

#include <array>
#include <cstdint>
#include <span>

namespace carom {

/// Welds vertices by exact position, splits by binned surface-area heuristic and folds the binary tree into wide nodes and leaves.
/// The same tree on every thread count and SIMD width.
/// @param vertices   (n,) finite.
/// @param triangles  (m,) 1 <= m <= WideBvh::kMaxTriangles, indices below n.
/// Cost: O(m log m); 200 B a triangle of scratch.
[[nodiscard]] WideBvh build_wide_bvh(std::span<const vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles,
                                     Executor& executor);

}  // namespace carom
