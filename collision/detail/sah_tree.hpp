// The binary tree over triangles from which the wide one is folded, and the programme that folds it.
//
//   SahTree tree = build_sah_tree(items, corners, executor);
//   tree.nodes[0].choice[16];
#pragma once

#include <carom/collision/detail/huge_page_allocator.hpp>
#include <carom/core/executor.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carom {

/// A triangle's box. The upper corner is negated, so that one minimum grows both. The triangle's number stands in a lane of floats:
/// tagged, it is a normal one, for denormals would make arithmetic on that lane slow.
struct alignas(32) SahItem {
    static constexpr std::uint32_t kTag = 0x40000000u;
    float lower[3];
    std::uint32_t tagged;  ///< triangle | kTag
    float minus_upper[3];
    float zero;
    [[nodiscard]] std::uint32_t triangle() const noexcept { return tagged & ~kTag; }
};
static_assert(sizeof(SahItem) == 32);

/// A box as in SahItem; the fourth lanes mean nothing.
struct alignas(32) SahBox {
    float minimum[8];  ///< lower x y z -, minus upper x y z -
};

/// A node of the binary tree, in depth-first order: the left child of node i is i + 1, the right one i + skip.
struct SahNode {
    SahBox box;
    std::uint32_t first = 0;  ///< of its triangles in SahTree::order
    std::uint32_t count = 0;
    std::uint32_t skip = 0;   ///< 0 in a leaf of the binary tree
    /// How to make at most i children of a wide node from this subtree, i = 2..16: how many go to the left child; 0: as for i - 1.
    /// With kWhole set the subtree as one child costs no more.
    std::uint8_t choice[17] = {};
    bool whole_is_leaf = false;  ///< as one child: a wide leaf, or a wide node
};
inline constexpr std::uint8_t kWhole = 0x80;

/// What a subtree costs, for its parent.
struct SahFold {
    std::array<float, 17> cost{};               ///< as at most i children, i = 1..limit; more gain nothing
    int limit = 1;
    std::uint32_t vertex_count = 0;             ///< different vertices, where there are at most 16; else 17
    std::array<std::uint32_t, 16> vertices{};
};

struct SahTree {
    HugePageVector<SahNode> nodes;
    HugePageVector<std::uint32_t> order;  ///< triangles as the leaves hold them
};

using Corners = std::array<std::uint32_t, 3>;

/// Sets the costs of a binary leaf of a few triangles with their (welded) corners.
void fold_leaf(SahNode& node, std::span<const std::uint32_t> triangles, std::span<const Corners> corners, SahFold& fold);

/// Sets choices and costs of an inner node from its children's.
void fold_inner(SahNode& node, const SahFold& left, const SahFold& right, SahFold& fold);

/// Builds the tree by binned surface-area heuristic down to 5 triangles and folds it. The same tree on every thread count and SIMD
/// width.
/// @param items    (m,), 1 <= m < 2^28, coordinates below 2^60; used as scratch.
/// @param corners  (m,) welded vertices of each triangle.
[[nodiscard]] SahTree build_sah_tree(HugePageVector<SahItem> items, std::span<const Corners> corners, Executor& executor);

}  // namespace carom
