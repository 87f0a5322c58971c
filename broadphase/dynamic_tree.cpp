// The pairs of boxes in the tree, all of them or those of what moved.
#include <carom/broadphase/detail/dynamic_tree.hpp>

#include <algorithm>
#include <memory>

namespace carom::detail {
namespace {

constexpr std::size_t kLeavesAPiece = 256;
constexpr std::size_t kMoversAPiece = 64;
constexpr float kPredictedFrames = 4.0f;  // of motion like the last one

bool holds(const FloatAabb& outer, const FloatAabb& inner) noexcept {
    return glm::all(glm::lessThanEqual(outer.lower, inner.lower)) && glm::all(glm::greaterThanEqual(outer.upper, inner.upper));
}

// The box, and where it gets to if it goes on like this. Overflow to infinity is harmless: the leaf is then large.
FloatAabb with_margin(const FloatAabb& now, const FloatAabb& before) noexcept {
    if (!(before.lower.x <= before.upper.x)) return now;
    const vec3 low = now.lower - before.lower, high = now.upper - before.upper;
    const vec3 zero{0.0f}, all_round = glm::max(glm::abs(low), glm::abs(high));
    FloatAabb box{now.lower - all_round + kPredictedFrames * glm::min(low, zero),
                  now.upper + all_round + kPredictedFrames * glm::max(high, zero)};
    return holds(box, now) ? box : now;
}

}  // namespace

void DynamicTree::find_all(const ProxyTable& table, Executor& executor, PairPieces& out) {
    build(table);
    const std::size_t pieces = (order_.size() + kLeavesAPiece - 1) / kLeavesAPiece;
    out.begin(pieces, out.limit());
    executor.parallel_for(pieces, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end && !out.is_full(); ++k) {
            const std::size_t last = std::min((k + 1) * kLeavesAPiece, order_.size());
            for (std::size_t i = k * kLeavesAPiece; i < last && !out[k].is_full(); ++i) {
                const std::uint32_t a = order_[i];
                walk(table.boxes[a], [&](std::uint32_t b) {  // leaves are as tight as their boxes now
                    if (a < b && (table.movable[a] | table.movable[b]) != 0) out[k].add(a, b);
                    return true;
                });
            }
            out.found(out[k].size());
        }
    });
}

void DynamicTree::find_moved(const ProxyTable& table, const ChangeLists& changes, Executor& executor, PairPieces& out) {
    leaf_.resize(table.boxes.size(), kNone);
    moved_.resize(table.boxes.size(), 0);
    for (const std::uint32_t slot : changes.removed) {
        remove(leaf_[slot]);
        free_.push_back(leaf_[slot]);
    }
    for (const std::uint32_t slot : changes.moved) {
        if (holds(nodes_[leaf_[slot]].box, table.boxes[slot])) continue;
        remove(leaf_[slot]);
        nodes_[leaf_[slot]].box = with_margin(table.boxes[slot], table.previous[slot]);
        insert(leaf_[slot]);
    }
    for (const std::uint32_t slot : changes.inserted) {
        leaf_[slot] = make_node();
        nodes_[leaf_[slot]].box = table.boxes[slot];
        nodes_[leaf_[slot]].child[1] = slot;
        insert(leaf_[slot]);
    }
    movers_.assign(changes.moved.begin(), changes.moved.end());
    movers_.insert(movers_.end(), changes.inserted.begin(), changes.inserted.end());
    for (const std::uint32_t slot : movers_) moved_[slot] = 1;
    const std::size_t pieces = (movers_.size() + kMoversAPiece - 1) / kMoversAPiece;
    out.begin(pieces, out.limit());
    executor.parallel_for(pieces, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end && !out.is_full(); ++k) {
            const std::size_t last = std::min((k + 1) * kMoversAPiece, movers_.size());
            for (std::size_t i = k * kMoversAPiece; i < last && !out[k].is_full(); ++i) {
                const std::uint32_t a = movers_[i];
                const FloatAabb &box = table.boxes[a], &before = table.previous[a];
                walk(box, [&](std::uint32_t b) {
                    const bool new_to_us = moved_[b] != 0 ? a < b : !overlaps(before, table.boxes[b]);
                    const bool meets = (table.movable[a] | table.movable[b]) != 0 && overlaps(box, table.boxes[b]);
                    if (new_to_us && meets) out[k].add(a, b);
                    return true;
                });
            }
            out.found(out[k].size());
        }
    });
    for (const std::uint32_t slot : movers_) moved_[slot] = 0;
}

std::unique_ptr<Method> make_dynamic_tree() { return std::make_unique<DynamicTree>(); }

}  // namespace carom::detail
