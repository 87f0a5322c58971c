#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/collision/detail/wide_pairs.cpp>
#include <hwy/foreach_target.h>

#include <carom/collision/detail/wide_leaf_pairs.hpp>
#include <carom/collision/detail/wide_pairs.hpp>

#include <bit>
#include <cstddef>
#include <type_traits>
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
        while (!stack_.empty() && !done_) {
            const PairEntry here = stack_.back();
            stack_.pop_back();
            if (is_leaf(here.a) && is_leaf(here.b)) {
                leaves(here, visit);
                continue;
            }
            if (visited_ != nullptr) note(here);
            if (is_leaf(here.a)) {
                leaf_of_a(here, visit);
            } else if (is_leaf(here.b)) {
                leaf_of_b(here, visit);
            } else {
                nodes(here, visit);
            }
            if (kDeepestFirst && depth_ >= 0.0f) std::swap(stack_[deepest_], stack_.back());
            depth_ = -1.0f;
        }
        if (!done_) judge_gathered(visit);
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

    /// The children of a node in the frame of the other tree. Neighbours on the stack have a node in common.
    HWY_INLINE void place_a(WideRef node) {
        if (node == placed_a_) return;
        placed_a_ = node;
        place_boxes(a_.node(node).bound, placement_.to_b, placement_.margin_b + placement_.reach_b, a_in_b_);
    }
    HWY_INLINE void place_b(WideRef node) {
        if (node == placed_b_) return;
        placed_b_ = node;
        place_boxes(b_.node(node).bound, placement_.to_a, placement_.margin_a + placement_.reach_a, b_in_a_);
    }
    HWY_INLINE void describe_a(WideRef leaf) {
        if (leaf == described_a_) return;
        described_a_ = leaf;
        first_.set(a_.leaf(leaf), placement_.margin_a);
    }
    HWY_INLINE void describe_b(WideRef leaf, BoxAt own) {
        if (leaf == described_b_) return;
        described_b_ = leaf;
        second_.set_placed(b_.leaf(leaf), own, placement_, placement_.margin_a + placement_.reach_a);
    }

    HWY_INLINE bool list(const PairEntry& here) {
        describe_b(here.b, here.box_b);
        pair_.b = &b_.leaf(here.b);
        const unsigned near = overlapping(second_.box, here.box_a) & ((1u << pair_.b->triangle_count) - 1u);
        if (near == 0) return false;
        describe_a(here.a);
        pair_.a = &a_.leaf(here.a);
        list_partners(first_, second_, near, pair_);
        return pair_.count != 0;
    }
    HWY_NOINLINE void judge_gathered(LeafPairVisit visit) {
        if constexpr (!kDeepestFirst) done_ = !gathered_.judge_all(placement_.reach_a, pair_, visit);
    }
    HWY_NOINLINE void leaves(const PairEntry& here, LeafPairVisit visit) {
        if (visited_ != nullptr) note(here);
        if (!list(here)) return;
        if constexpr (kDeepestFirst) {  // which wants to stop at the first
            judge_partners(first_, second_, placement_, pair_);
            done_ = pair_.count != 0 && !visit(pair_);
        } else {
            gathered_.add(first_, second_, pair_);
            if (gathered_.are_many()) judge_gathered(visit);
        }
    }

    HWY_INLINE void nodes(const PairEntry& here, LeafPairVisit visit) {
        const WideNode &first = a_.node(here.a), &second = b_.node(here.b);
        place_b(here.b);
        unsigned of_b = overlapping(b_in_a_, here.box_a) & children_of(second);
        if (of_b == 0) return;
        place_a(here.a);
        unsigned met[kWidth], of_a = 0;
        for (unsigned rest = of_b; rest != 0; rest &= rest - 1) {
            const auto j = static_cast<std::size_t>(std::countr_zero(rest));
            met[j] = overlapping(first.bound, BoxAt(b_in_a_, j));
            if (met[j] != 0) met[j] &= overlapping(a_in_b_, BoxAt(second.bound, j));
            if (met[j] == 0) {
                of_b ^= 1u << j;
                continue;
            }
            of_a |= met[j];
            prefetch(b_, second.child[j]);
        }
        prefetch_children(first, of_a);
        for (; of_b != 0 && !done_; of_b &= of_b - 1) {
            const auto j = static_cast<std::size_t>(std::countr_zero(of_b));
            go_on(first, BoxAt(b_in_a_, j), met[j], second.child[j], BoxAt(second.bound, j), visit);
        }
    }

    HWY_INLINE void leaf_of_b(const PairEntry& here, LeafPairVisit visit) {
        const WideNode& first = a_.node(here.a);
        place_a(here.a);
        describe_b(here.b, here.box_b);
        const unsigned met = overlapping(first.bound, second_.around()) & overlapping(a_in_b_, here.box_b);
        prefetch_children(first, met);
        go_on(first, second_.around(), met, here.b, here.box_b, visit);
    }

    HWY_INLINE void leaf_of_a(const PairEntry& here, LeafPairVisit visit) {
        const WideNode& second = b_.node(here.b);
        place_b(here.b);
        alignas(64) float depths[kWidth];
        const unsigned met = overlapping_deep(b_in_a_, here.box_a, children_of(second), depths);
        for (unsigned rest = met; rest != 0; rest &= rest - 1) prefetch(b_, second.child[std::countr_zero(rest)]);
        for (unsigned rest = met; rest != 0 && !done_; rest &= rest - 1) {
            const auto j = static_cast<std::size_t>(std::countr_zero(rest));
            offer({here.a, second.child[j], here.box_a, BoxAt(second.bound, j)}, depths[j], visit);
        }
    }

    HWY_INLINE void prefetch_children(const WideNode& first, unsigned of_a) {
        for (; of_a != 0; of_a &= of_a - 1) prefetch(a_, first.child[std::countr_zero(of_a)]);
    }

    /// With the children of a in `met`, which overlap a box of b: at `placed` in the frame of a.
    HWY_INLINE void go_on(const WideNode& first, BoxAt placed, unsigned met, WideRef b, BoxAt box_b, LeafPairVisit visit) {
        alignas(64) float depths[kWidth];
        if (kDeepestFirst) {
            overlapping_deep(first.bound, placed, met, depths);
        }
        for (; met != 0 && !done_; met &= met - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(met));
            offer({first.child[i], b, BoxAt(first.bound, i), box_b}, kDeepestFirst ? depths[i] : 0.0f, visit);
        }
    }
    /// To be looked at: two leaves at once, unless the deepest are to come first.
    HWY_INLINE void offer(const PairEntry& entry, float depth, LeafPairVisit visit) {
        if (!kDeepestFirst && is_leaf(entry.a) && is_leaf(entry.b)) {
            leaves(entry, visit);
            return;
        }
        if (kDeepestFirst && depth > depth_) depth_ = depth, deepest_ = stack_.size();
        stack_.push_back(entry);
    }

    const WideBvh &a_, &b_;
    const WidePlacement& placement_;
    std::vector<VisitedPair>* visited_;
    std::vector<PairEntry>& stack_;
    alignas(64) Bounds a_in_b_, b_in_a_;
    Described first_, second_;
    WideRef placed_a_ = -1, placed_b_ = -1;      // nodes are not below zero,
    WideRef described_a_ = 0, described_b_ = 0;  // leaves are
    Bounds root_[2];
    LeafPair pair_;
    struct Nothing {};
    std::conditional_t<kDeepestFirst, Nothing, GatheredPairs> gathered_;
    bool done_ = false;  ///< the visit wants no more
    std::size_t deepest_ = 0;
    float depth_ = -1.0f;  ///< of the deepest pair of this step
};

template <bool kDeepestFirst>
void descend_in(const WideBvh& a, const WideBvh& b, const WidePlacement& placement, LeafPairVisit visit,
                std::vector<VisitedPair>* visited) {
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

void visit_leaf_pairs(const WideBvh& a, const WideBvh& b, const WidePlacement& placement, LeafPairVisit visit, const PairWalk& walk) {
    if (placement.too_unlike) {
        visit_leaf_pairs_in_double(a, b, placement, visit, walk);
    } else {
        HWY_DYNAMIC_DISPATCH(descend)(a, b, placement, visit, walk);
    }
}

}  // namespace carom
#endif
