// A tree of boxes in boxes that changes as they move: any sizes, any spread, and queries of any kind.
//
// A leaf's box is larger than the box in it by the motion that the last one predicts, so most updates leave the tree alone; what leaves
// its leaf is taken out and put where it adds least surface (Goldsmith and Salmon 1987; Catto 2019, "Dynamic Bounding Volume
// Hierarchies"), and rotations on the way up keep the tree good (Kopta et al. 2012). From scratch the tree is split in bins of
// equal width by the surface area (Wald 2007). Nodes know their parents, so walks need no stack, however deep the tree is.
//
// dynamic_tree.cpp finds the pairs; detail/dynamic_tree.cpp keeps the tree.
#pragma once

#include <carom/broadphase/detail/method.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace carom::detail {

class DynamicTree final : public Method {
public:
    [[nodiscard]] bool prefers_all(const ProxyTable& table, const ChangeLists& changes) const noexcept override {
        return 2 * (changes.moved.size() + changes.inserted.size()) > table.live_count;
    }
    void find_all(const ProxyTable& table, Executor& executor, PairPieces& out) override;
    void find_moved(const ProxyTable& table, const ChangeLists& changes, Executor& executor, PairPieces& out) override;
    void visit_near(const ProxyTable& table, const FloatAabb& box, FunctionRef<bool(std::uint32_t)> visit) const override {
        walk(box, [&](std::uint32_t slot) { return !overlaps(table.boxes[slot], box) || visit(slot); });
    }
    void visit_where(const ProxyTable& table, FunctionRef<bool(const FloatAabb&)> touches,
                     FunctionRef<bool(std::uint32_t)> visit) const override {
        walk_where(touches, [&](std::uint32_t slot) { return !touches(table.boxes[slot]) || visit(slot); });
    }
    void visit_parts(const ProxyTable&, FunctionRef<void(const BroadphasePart&)> visit) const override {
        int depth = 0;
        std::uint32_t node = root_;
        while (node != kNone) {  // down the first children, then up to the next second one
            visit({nodes_[node].box, depth, nodes_[node].is_leaf() ? std::size_t{1} : std::size_t{0}});
            if (!nodes_[node].is_leaf()) {
                node = nodes_[node].child[0];
                ++depth;
                continue;
            }
            std::uint32_t up = nodes_[node].parent;
            while (up != kNone && nodes_[up].child[1] == node) {
                node = up;
                up = nodes_[up].parent;
                --depth;
            }
            node = up == kNone ? kNone : nodes_[up].child[1];
        }
    }
    void visit_parts_of(std::uint32_t slot, FunctionRef<void(const BroadphasePart&)> visit) const override {
        std::vector<std::uint32_t> path;
        for (std::uint32_t node = leaf_[slot]; node != kNone; node = nodes_[node].parent) path.push_back(node);
        for (std::size_t depth = 0; depth < path.size(); ++depth) {
            const Node& node = nodes_[path[path.size() - 1 - depth]];
            visit({node.box, static_cast<int>(depth), node.is_leaf() ? std::size_t{1} : std::size_t{0}});
        }
    }
    [[nodiscard]] std::size_t memory() const noexcept override {
        return sizeof(Node) * nodes_.capacity() + sizeof(std::uint32_t) * (leaf_.capacity() + order_.capacity() + free_.capacity());
    }

private:
    static constexpr std::uint32_t kNone = ~std::uint32_t{0};
    struct Node {
        FloatAabb box;
        std::uint32_t parent = kNone;
        std::uint32_t child[2] = {kNone, kNone};  // of a leaf: kNone and its slot
        [[nodiscard]] bool is_leaf() const noexcept { return child[0] == kNone; }
        [[nodiscard]] std::uint32_t slot() const noexcept { return child[1]; }
    };
    // Half of a split: leaves [first, last) of order_.
    struct Range {
        std::uint32_t node, first, last;
    };
    void build(const ProxyTable& table);
    [[nodiscard]] std::uint32_t split(const ProxyTable& table, const Range& range);
    [[nodiscard]] std::uint32_t make_node();
    void insert(std::uint32_t leaf);
    void remove(std::uint32_t leaf);
    [[nodiscard]] std::uint32_t best_sibling(std::uint32_t leaf) const noexcept;
    void refit_upward(std::uint32_t node) noexcept;
    void rotate(std::uint32_t node) noexcept;
    void exchange(std::uint32_t node, int side, std::uint32_t lower_node, int lower_side) noexcept;
    void fit(std::uint32_t node) noexcept;

    // Calls `visit` for the slots of leaves that overlap `box` until it returns false.
    template <class F>
    void walk(const FloatAabb& box, F visit) const {
        walk_where([&](const FloatAabb& node) { return overlaps(node, box); }, visit);
    }
    template <class T, class F>
    void walk_where(T touches, F visit) const {
        std::uint32_t node = root_;
        while (node != kNone) {
            const Node& n = nodes_[node];
            if (touches(n.box)) {
                if (!n.is_leaf()) {
                    node = n.child[0];
                    continue;
                }
                if (!visit(n.slot())) return;
            }
            std::uint32_t up = n.parent;
            while (up != kNone && nodes_[up].child[1] == node) {
                node = up;
                up = nodes_[up].parent;
            }
            node = up == kNone ? kNone : nodes_[up].child[1];
        }
    }

    std::vector<Node> nodes_;
    std::uint32_t root_ = kNone;
    std::vector<std::uint32_t> free_;   // nodes to be used again
    std::vector<std::uint32_t> leaf_;   // of each slot
    std::vector<std::uint32_t> order_;  // slots, leaf by leaf, when the tree was built
    std::vector<Range> ranges_;
    std::vector<std::uint32_t> movers_;
    std::vector<unsigned char> moved_;  // of each slot
};

}  // namespace carom::detail
