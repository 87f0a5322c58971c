// The static bounding-volume hierarchy of a triangle mesh.
//
//   Bvh bvh(vertices, triangles);
//   bvh.overlap(box, [&](std::uint32_t triangle) { ...; return true; });
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/detail/ray_slabs.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/core/types.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace carom {

/// A binary tree of boxes over triangles, as a flat array in depth-first order: the left child of node i is node i + 1, and
/// `skip` is the node after i's subtree, so that the right child is the left child's `skip`. An overlap query walks the array
/// forward without a stack.
///
/// Build: binned surface-area heuristic (Wald, On fast Construction of SAH-based Bounding Volume Hierarchies, 2007). Departure:
/// nodes deeper than kSahDepth are halved by count, so that the depth has a bound and a ray's stack a fixed size.
/// Boxes are float and exact, because vertices are float.
class Bvh {
public:
    using Triangle = std::array<std::uint32_t, 3>;
    static constexpr std::uint32_t kLeafSize = 4;
    static constexpr int kSahDepth = 48;
    static constexpr int kMaxDepth = kSahDepth + 32;              ///< of a leaf; the root has depth 0
    static constexpr std::size_t kMaxTriangles = std::size_t{1} << 29;  ///< what `leaf` can address

    /// @param triangles  (m,), 1 <= m <= kMaxTriangles, indices in range; vertices finite. The mesh has checked that.
    /// Cost: O(m log m), one thread.
    Bvh(std::span<const vec3> vertices, std::span<const Triangle> triangles);

    /// Calls `visit` for every triangle whose own box overlaps `box` (closed) until it returns false. No allocation.
    void overlap(const Aabb& box, FunctionRef<bool(std::uint32_t triangle)> visit) const;

    /// Calls `visit` for each node with its depth, in depth-first order.
    void visit_nodes(FunctionRef<void(const Aabb& box, int depth)> visit) const;

    /// Calls `test(triangle)` for every triangle whose leaf the ray may meet at a distance in [0, nearest], nearer children
    /// first. `test` may lower `nearest`.
    template <class Test>
    void traverse(const RaySlabs& slabs, const double& nearest, Test&& test) const;

private:
    struct Bounds {
        vec3 lower{std::numeric_limits<float>::infinity()};
        vec3 upper{-std::numeric_limits<float>::infinity()};
        void grow(const Bounds& b) noexcept;
        [[nodiscard]] double half_area() const noexcept;
    };
    struct Node {
        vec3 lower{0.0f};
        std::uint32_t skip = 0;  ///< the node after this subtree
        vec3 upper{0.0f};
        std::uint32_t leaf = 0;  ///< first item * 8 + count; count 0 is an inner node
        [[nodiscard]] std::uint32_t count() const noexcept { return leaf & 7u; }
        [[nodiscard]] std::uint32_t first() const noexcept { return leaf >> 3; }
    };
    struct Item {
        vec3 lower{0.0f};
        std::uint32_t triangle = 0;
        vec3 upper{0.0f};
    };
    struct Query;
    struct Split;

    void build(std::uint32_t first, std::uint32_t count, int depth);
    [[nodiscard]] Split best_split(std::uint32_t first, std::uint32_t count, const Bounds& centers) const;
    [[nodiscard]] std::uint32_t partition(std::uint32_t first, std::uint32_t count, const Bounds& centers, const Split& split);

    std::vector<Node> nodes_;
    std::vector<Item> items_;  ///< triangles with their boxes, in the order of the leaves
};

template <class Test>
void Bvh::traverse(const RaySlabs& slabs, const double& nearest, Test&& test) const {
    struct Entry {
        std::uint32_t node;
        double distance;
    };
    // A missed box is infinitely far, and `nearest` may be infinite too.
    const auto reachable = [&](double distance) { return distance <= nearest && distance < RaySlabs::kMiss; };
    std::array<Entry, kMaxDepth + 1> stack;
    std::size_t size = 0;
    Entry here{0, slabs.enter(nodes_[0].lower, nodes_[0].upper)};
    for (;;) {
        if (reachable(here.distance)) {
            const Node& node = nodes_[here.node];
            if (node.count() == 0) {
                const std::uint32_t left = here.node + 1;
                const std::uint32_t right = nodes_[left].skip;
                Entry near{left, slabs.enter(nodes_[left].lower, nodes_[left].upper)};
                Entry far{right, slabs.enter(nodes_[right].lower, nodes_[right].upper)};
                if (far.distance < near.distance) {
                    std::swap(near, far);
                }
                if (reachable(far.distance)) {
                    stack[size++] = far;
                }
                here = near;
                continue;
            }
            for (std::uint32_t i = node.first(); i < node.first() + node.count(); ++i) {
                test(items_[i].triangle);
            }
        }
        if (size == 0) {
            return;
        }
        here = stack[--size];
    }
}

}  // namespace carom
