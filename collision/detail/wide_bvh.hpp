// How the static hierarchy of triangles lies in memory: 16-wide nodes and leaves that hold their triangles whole.
//
//   WideBvh tree = build_wide_bvh(vertices, triangles, executor);
//   const WideNode& root = tree.node(tree.root());
//
// Queries are written against this file alone. Invariants, beyond what the fields say:
//  - Coordinates are those of the mesh times `scale`, a power of two; it is 1 unless the mesh is tinier than 2^-20 or larger than
//    2^20, so that products neither overflow nor underflow. Leaf coordinates / scale are the mesh's own bits, save
//    where a mesh larger than 2^20 has coordinates so small that they become denormal; `lossless` tells.
//  - A child's box is the exact box of the vertices of the triangles below it; boxes of siblings may overlap.
//  - Children stand in lanes 0, 1, ... without gaps; a lane without a child has the box [+inf, -inf] and child 0.
//  - Each triangle of the mesh is in exactly one leaf, degenerate ones too, and the numbers in a leaf ascend.
//  - Corners are in the order of the mesh, so windings survive. Vertices at one position are one in a leaf (-0 is +0).
//  - Lanes without a triangle have three times corner 0 and triangle kNoTriangle; lanes without a vertex repeat vertex 0.
//  - The root is a node, even over one leaf. Parents stand before their children in `lines`. Depth is at most kMaxDepth.
#pragma once

#include <carom/collision/detail/huge_page_allocator.hpp>
#include <carom/core/types.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace carom {

inline constexpr int kWidth = 16;  ///< children of a node, triangles of a leaf, vertices of a leaf

/// Names a node (>= 0) or a leaf (< 0) by the line at which it starts.
using WideRef = std::int32_t;
[[nodiscard]] constexpr bool is_leaf(WideRef ref) noexcept { return ref < 0; }

/// The boxes of up to 16 children.
struct alignas(64) WideNode {
    float bound[2][3][kWidth];  ///< [lower, upper][x, y, z][child]
    WideRef child[kWidth];
};
static_assert(sizeof(WideNode) == 448);

/// Up to 16 triangles over up to 16 vertices.
struct alignas(64) WideLeaf {
    float vertex[3][kWidth];          ///< [x, y, z][vertex]
    std::uint8_t corner[3][kWidth];   ///< [a, b, c][triangle]: numbers of vertices
    std::uint32_t triangle[kWidth];   ///< the triangle's number in the mesh
    std::uint32_t triangle_count;     ///< 1..16
    std::uint32_t vertex_count;       ///< 1..16
    std::uint32_t reserved[2];        ///< zero
};
static_assert(sizeof(WideLeaf) == 320);

inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;

/// The tree as one block of 64-byte lines.
struct WideBvh {
    static constexpr int kMaxDepth = 80;                                     ///< of a leaf; the root has depth 0
    static constexpr std::size_t kMaxStack = kMaxDepth * (kWidth - 1) + 1;   ///< of a depth-first traversal
    static constexpr std::size_t kMaxTriangles = std::size_t{1} << 28;       ///< so that lines fit into a WideRef

    static constexpr float kFar = 8.0f;

    struct alignas(64) Line {
        std::byte bytes[64];
    };

    HugePageVector<Line> lines;  ///< the root's node first
    std::size_t node_count = 0;
    std::size_t leaf_count = 0;
    std::size_t triangle_count = 0;
    float scale = 1.0f;
    bool lossless = true;          ///< leaf coordinates / scale are the mesh's own, to the bit
    alignas(16) vec3 lower{0.0f};  ///< box of the triangles, scaled; lanes read each corner with a fourth float
    float zero_lower = 0.0f;
    vec3 upper{0.0f};
    float zero_upper = 0.0f;
    float far_reach = 0.0f;        ///< kFar sizes where scale is 1, else -1: rays from further off are moved or scaled first
    double sah_cost = 0.0;         ///< see StaticBvh::sah_cost
    double crowding = 1.0;         ///< see crowding_of (wide_crowding.hpp)
    double built_crowding = 1.0;   ///< what it was when the tree was built
    bool welded = false;           ///< when the tree was built, triangles had different vertices at one position
    std::uint64_t id = 0;          ///< of this process' trees, never given twice; a refit keeps it, as it keeps leaves where they are

    [[nodiscard]] static constexpr WideRef root() noexcept { return 0; }
    /// Sets far_reach; to be called when the box or the scale has changed.
    void update_far_reach() noexcept {
        const vec3 size = upper - lower;
        const float largest = size.x > size.y ? (size.x > size.z ? size.x : size.z) : (size.y > size.z ? size.y : size.z);
        far_reach = scale == 1.0f ? kFar * largest : -1.0f;
    }
    [[nodiscard]] const WideNode& node(WideRef ref) const noexcept {
        return *reinterpret_cast<const WideNode*>(lines.data() + ref);
    }
    [[nodiscard]] const WideLeaf& leaf(WideRef ref) const noexcept {
        return *reinterpret_cast<const WideLeaf*>(lines.data() + ~ref);
    }
    [[nodiscard]] WideNode& node(WideRef ref) noexcept { return *reinterpret_cast<WideNode*>(lines.data() + ref); }
    [[nodiscard]] WideLeaf& leaf(WideRef ref) noexcept { return *reinterpret_cast<WideLeaf*>(lines.data() + ~ref); }
};

/// How many children a node has.
[[nodiscard]] inline int child_count(const WideNode& node) noexcept {
    int count = 0;
    while (count < kWidth && node.bound[0][0][count] <= node.bound[1][0][count]) ++count;
    return count;
}

}  // namespace carom
