// Which triangles' boxes a box overlaps.
//
//   visit_overlaps(tree, box, [&](std::uint32_t triangle) { ...; return true; });
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/core/function_ref.hpp>

#include <cstdint>

namespace carom {

/// Calls `visit` for every triangle whose own box overlaps `box` (closed, in the mesh's frame) until it returns false, in the order of
/// the tree. The verdict is that of double for a tree that is lossless; of another, triangles that miss by the rounding of their scaled
/// corners are visited too. Same order at every SIMD width. No allocation.
void visit_overlaps(const WideBvh& tree, const Aabb& box, FunctionRef<bool(std::uint32_t triangle)> visit);

}  // namespace carom
