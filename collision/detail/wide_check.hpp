// Whether a wide hierarchy that comes from outside is one: every invariant of wide_bvh.hpp, so that queries can trust it.
//
//   if (Status status = check_wide_bvh(tree); !status) return status.error();
#pragma once

#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/core/result.hpp>

#include <glm/common.hpp>

#include <limits>
#include <vector>

namespace carom {

/// A box in the tree's coordinates. The default is empty.
struct WideBox {
    vec3 lower{std::numeric_limits<float>::infinity()};
    vec3 upper{-std::numeric_limits<float>::infinity()};

    void add(const WideBox& b) noexcept {
        lower = glm::min(lower, b.lower);
        upper = glm::max(upper, b.upper);
    }
    friend bool operator==(const WideBox&, const WideBox&) = default;
};

/// @return the box of a leaf's triangles.
[[nodiscard]] WideBox box_of(const WideLeaf& leaf) noexcept;

/// @return the root, then every node and leaf below it, parents before their children.
[[nodiscard]] std::vector<WideRef> all_refs(const WideBvh& tree);

/// @return the line at which a node or leaf starts.
[[nodiscard]] constexpr std::size_t start_of(WideRef ref) noexcept { return static_cast<std::size_t>(is_leaf(ref) ? ~ref : ref); }

/// Checks references, counts, depths, boxes, corners and triangles: nothing that a query reads is out of its range, no line is
/// shared, no box is other than the exact one, and every triangle below `triangle_count` is there once.
/// @return Parse with what is wrong and in which line.
/// Cost: O(lines), no recursion; a bit for each line and triangle of scratch.
[[nodiscard]] Status check_wide_bvh(const WideBvh& tree);

}  // namespace carom
