// How crowded the leaves of a wide hierarchy are: what says when a refitted one should be built anew.
//
//   tree.crowding = crowding_of(tree, all_refs(tree));
#pragma once

#include <carom/collision/detail/wide_bvh.hpp>

#include <span>

namespace carom {

/// @return how many leaves have a place of the mesh in their boxes, on average over the middles of triangles from all over it: 1 for
/// triangles that lie apart. Each place counts alike, so that a few triangles that strayed do not hide what became of the others,
/// as they do in a sum of areas.
/// @param refs  all_refs(tree).
/// Cost: some 128 look-ups of a point; in a tree that is of no use, 128 times 1,000 leaves at most.
[[nodiscard]] double crowding_of(const WideBvh& tree, std::span<const WideRef> refs);

}  // namespace carom
