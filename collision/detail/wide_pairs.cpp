#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/collision/detail/wide_pairs.cpp>
#include <hwy/foreach_target.h>

#include <carom/collision/detail/wide_leaf_pairs.hpp>
#include <carom/collision/detail/wide_pairs.hpp>

#include <bit>
#include <cstddef>
#include <utility>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

struct PairEntry {
    WideRef a, b;
    BoxAt box_a, box_b;  ///< as their parents have them
};

HWY_INLINE unsigned children_of(const WideNode& node) {
    unsigned children = 0;
    for (int part = 0; part < kWidth; part += kLanes) {
        children |= bits(load(node.bound[0][0] + part) <= load(node.bound[1][0] + part)) << part;
    }
    return children;
}

/// A leaf's five lines, or the first five of a node's seven.
HWY_INLINE void prefetch(const WideBvh& tree, WideRef ref) {
    const WideBvh::Line* line = tree.lines.data() + (is_leaf(ref) ? ~ref : ref);
    for (int k = 0; k < 5; ++k) hwy::Prefetch(line + k);
}

/// Descends two trees.
template <bool kDeepestFirst>
class Descent {
public:
    HWY_INLINE Descent(const WideBvh& a, const WideBvh& b, const WidePlacement& placement, std::vector<VisitedPair>* visited,
                       std::vector<PairEntry>& stack)
        : a_(a), b_(b), placement_(placement), visited_(visited), stack_(stack) {
        for (int k = 0; k < 3; ++k) {
            root_[0][0][k][0] = a.lower[k], root_[0][1][k][0] = a.upper[k];
            root_[1][0][k][0] = b.lower[k], root_[1][1][k][0] = b.upper[k];
        }
        stack_.clear();
        stack_.push_back({WideBvh::root(), WideBvh::root(), BoxAt(root_[0], 0), BoxAt(root_[1], 0)});
    }

    HWY_INLINE void run(LeafPairVisit visit) {
        LeafPair pair;
        while (!stack_.empty()) {
            const PairEntry here = stack_.back();
            stack_.pop_back();
            if (visited_ != nullptr) note(here);
            if (!is_leaf(here.a)) {
                if (is_leaf(here.b)) {
                    leaf_of_b(here);
                } else {
                    nodes(here);
                }
            } else if (!is_leaf(here.b)) {
                leaf_of_a(here);
            } else if (find_partners(here, pair) && !visit(pair)) {
                return;
            }
        }
    }

private:
    HWY_NOINLINE void note(const PairEntry& here) {
        VisitedPair& pair = visited_->emplace_back(VisitedPair{here.a, here.b, {}, {}});
        for (int side = 0; side < 2; ++side) {
            for (int k = 0; k < 3; ++k) {
                pair.box_a[side][k] = here.box_a.lane[(3 * side + k) * kWidth];
                pair.box_b[side][k] = here.box_b.lane[(3 * side + k) * kWidth];
            }
        }
    }

    HWY_INLINE void describe_a(WideRef leaf) {
        if (leaf == described_a_) return;
        described_a_ = leaf;
        first_.set(a_.leaf(leaf), placement_.margin_a);
    }
    HWY_INLINE void describe_b(WideRef leaf) {
        if (leaf == described_b_) return;
        described_b_ = leaf;
        second_.set_placed(b_.leaf(leaf), placement_, placement_.margin_a + placement_.reach_a);
    }

    HWY_INLINE bool find_partners(const PairEntry& here, LeafPair& pair) {
        describe_b(here.b);
        pair.b = &b_.leaf(here.b);
        const unsigned near = overlapping(second_.box, here.box_a) & ((1u << pair.b->triangle_count) - 1u);
        if (near == 0) return false;
        describe_a(here.a);
        pair.a = &a_.leaf(here.a);
        list_partners(first_, second_, near, pair);
        if (pair.count == 0) return false;
        judge_partners(first_, second_, placement_, pair);
        return pair.count != 0;
    }

    HWY_INLINE void nodes(const PairEntry& here) {
        const WideNode &first = a_.node(here.a), &second = b_.node(here.b);
        place_boxes(second.bound, placement_.to_a, placement_.margin_a + placement_.reach_a, b_in_a_);
        unsigned near = overlapping(b_in_a_, here.box_a) & children_of(second);
        if (near == 0) return;
        place_boxes(first.bound, placement_.to_b, placement_.margin_b + placement_.reach_b, a_in_b_);
        for (; near != 0; near &= near - 1) {
            const auto j = static_cast<std::size_t>(std::countr_zero(near));
            const BoxAt own(second.bound, j), placed(b_in_a_, j);
            prefetch(b_, second.child[j]);
            push_a(first, placed, overlapping(a_in_b_, own), second.child[j], own);
        }
        end();
    }

    HWY_INLINE void leaf_of_b(const PairEntry& here) {
        const WideNode& first = a_.node(here.a);
        describe_b(here.b);
        place_boxes(first.bound, placement_.to_b, placement_.margin_b + placement_.reach_b, a_in_b_);
        push_a(first, second_.around(), overlapping(a_in_b_, here.box_b), here.b, here.box_b);
        end();
    }

    HWY_INLINE void leaf_of_a(const PairEntry& here) {
        const WideNode& second = b_.node(here.b);
        place_boxes(second.bound, placement_.to_a, placement_.margin_a + placement_.reach_a, b_in_a_);
        alignas(64) float depths[kWidth];
        for (unsigned rest = overlapping_deep(b_in_a_, here.box_a, children_of(second), depths); rest != 0; rest &= rest - 1) {
            const auto j = static_cast<std::size_t>(std::countr_zero(rest));
            prefetch(b_, second.child[j]);
            push({here.a, second.child[j], here.box_a, BoxAt(second.bound, j)}, depths[j]);
        }
        end();
    }

    /// The children of a in `among` that overlap a box of b.
    HWY_INLINE void push_a(const WideNode& first, BoxAt placed, unsigned among, WideRef b, BoxAt box_b) {
        alignas(64) float depths[kWidth];
        unsigned met = kDeepestFirst ? overlapping_deep(first.bound, placed, among, depths) : overlapping(first.bound, placed) & among;
        for (; met != 0; met &= met - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(met));
            prefetch(a_, first.child[i]);
            push({first.child[i], b, BoxAt(first.bound, i), box_b}, kDeepestFirst ? depths[i] : 0.0f);
        }
    }
    HWY_INLINE void push(const PairEntry& entry, float depth) {
        if (kDeepestFirst && depth > depth_) depth_ = depth, deepest_ = stack_.size();
        stack_.push_back(entry);
    }
    HWY_INLINE void end() {
        if (kDeepestFirst && depth_ >= 0.0f) std::swap(stack_[deepest_], stack_.back());
        depth_ = -1.0f;
    }

    const WideBvh &a_, &b_;
    const WidePlacement& placement_;
    std::vector<VisitedPair>* visited_;
    std::vector<PairEntry>& stack_;
    alignas(64) Bounds a_in_b_, b_in_a_;
    Described first_, second_;
    WideRef described_a_ = 0, described_b_ = 0;  // leaves are below zero
    Bounds root_[2];
    std::size_t deepest_ = 0;
    float depth_ = -1.0f;  ///< of the deepest pair of this step
};

template <bool kDeepestFirst>
void descend_in(const WideBvh& a, const WideBvh& b, const WidePlacement& placement, LeafPairVisit visit, std::vector<VisitedPair>* visited) {
    // A visit may descend another pair of trees: the buffer is then in use.
    thread_local std::vector<PairEntry> kept;
    std::vector<PairEntry> stack = std::move(kept);
    Descent<kDeepestFirst>(a, b, placement, visited, stack).run(visit);
    kept = std::move(stack);
}
void descend(const WideBvh& a, const WideBvh& b, const WidePlacement& placement, LeafPairVisit visit, const PairWalk& walk) {
    if (walk.deepest_first) {
        descend_in<true>(a, b, placement, visit, walk.visited);
    } else {
        descend_in<false>(a, b, placement, visit, walk.visited);
    }
}

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom {
namespace {

HWY_EXPORT(descend);

}  // namespace

void visit_leaf_pairs(const WideBvh& a, const WideBvh& b, const WidePlacement& placement, LeafPairVisit visit,
                      const PairWalk& walk) {
    if (placement.too_unlike) {
        visit_leaf_pairs_in_double(a, b, placement, visit, walk);
    } else {
        HWY_DYNAMIC_DISPATCH(descend)(a, b, placement, visit, walk);
    }
}

}  // namespace carom
#endif
