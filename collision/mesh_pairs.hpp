// Which triangles of two meshes meet: one hierarchy against the other, both at any pose.
//
//   const Pose b_in_a = inverse(pose_a) * pose_b;
//   if (meshes_overlap(a, b, b_in_a)) { ... }
//   overlapping_pairs(a, b, b_in_a, pairs);      // all pairs of triangles that share a point, sorted
//
// What counts. Mesh a lies as it was given, in float; the corners of mesh b lie at transform_point(b_in_a, corner), in double. For
// these points the verdicts are exact: no pair is missed and none is added, whether triangles cross, touch in a point, lie in one
// plane or are degenerate, and the answer depends neither on the tree's shape nor on SIMD widths. Surfaces count, not what they
// enclose: a mesh inside of another meets nothing.
//
// Method: both trees are descended together; the boxes of 16 children against those of 16 others, each in the frame of either mesh.
// Triangles of two leaves are parted by their boxes and planes, or found to cross, with lanes and proved bounds; what that leaves open, exact
// predicates decide.
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/static_bvh.hpp>
#include <carom/core/pose.hpp>

#include <compare>
#include <cstdint>
#include <optional>
#include <vector>

namespace carom {

/// A triangle of the first mesh and one of the second, by their numbers there.
struct TrianglePair {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    friend auto operator<=>(const TrianglePair&, const TrianglePair&) = default;
};

/// @param b_in_a  the second mesh in the frame of the first. With an orientation that is not a unit one, the verdict is on the corners
///                where transform_point() puts them; not finite: nothing meets.
/// @return whether any two triangles share a point.
/// Cost: 4 to 9 us for two balls of 69,312 triangles that meet, less where they do not; O(nodes near each other) in the worst case.
/// Allocates only while a buffer of the calling thread grows. Thread-safe.
[[nodiscard]] bool meshes_overlap(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a);

/// The same, with a pair that meets: which one of several is unspecified but always the same.
[[nodiscard]] std::optional<TrianglePair> find_overlap(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a);

/// Replaces `pairs` by all pairs of triangles that share a point, ascending.
/// Cost: about 0.3 us a pair, descending included, where surfaces cross; 4 us where they coincide, as each verdict then needs exact
/// arithmetic. Allocates where `pairs` grows.
void overlapping_pairs(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a, std::vector<TrianglePair>& pairs);

/// Replaces `pairs` by pairs of triangles, ascending: all that have points within `reach` of each other, and some that lie somewhat farther
/// apart (neither a box nor the plane of one of them parts them by more than that). The same at every SIMD width.
/// @param reach  [m], finite and >= 0; otherwise reports misuse and changes nothing.
/// Cost: some 10 ns a pair and 100 ns a pair of nodes near each other. Allocates while `pairs` or buffers of the calling thread grow.
void near_pairs(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a, double reach, std::vector<TrianglePair>& pairs);

/// A node or a leaf of a hierarchy.
struct VisitedNode {
    std::int32_t id = 0;   ///< one of its own for each node of the tree
    bool is_leaf = false;
    Aabb box;              ///< [m], in the mesh's own frame
};
struct NodePair {
    VisitedNode a, b;
};

/// @return the pairs of nodes that near_pairs() looks at, in its order, the two roots first: to draw, and to see what a query costs. None where
/// boxes around all of the two are farther apart than the reach. The same at every SIMD width.
/// @param reach  [m], finite and >= 0; otherwise reports misuse.
[[nodiscard]] std::vector<NodePair> visited_nodes(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a, double reach);

}  // namespace carom
