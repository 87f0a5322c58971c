// Binned surface-area splits on three axes (Wald, On fast Construction of SAH-based Bounding Volume Hierarchies, 2007).
#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/collision/detail/sah_tree.cpp>
#include <hwy/foreach_target.h>

#include <carom/collision/detail/sah_lanes.hpp>
#include <carom/collision/detail/sah_tree.hpp>

#include <algorithm>
#include <limits>

#ifndef CAROM_COLLISION_SAH_TREE_ONCE
#define CAROM_COLLISION_SAH_TREE_ONCE
namespace carom {
namespace sah {

inline constexpr std::uint32_t kLeafSize = 5;  ///< so that any leaf has at most 15 vertices; smaller ones gain nothing
inline constexpr int kSahDepth = 48;  ///< below it ranges are halved by count, so that the depth has a bound
inline constexpr int kMostBins = 16;

/// A range of items, their box, and where it stands in the tree.
struct Range {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    int depth = 0;
    bool swapped = false;  ///< the items are in the second buffer
    SahBox box{};
};

/// A subtree that is built on its own, and then put in the place of a node of the top.
struct Task {
    Range range;
    HugePageVector<SahNode> nodes;
    SahFold fold;
};

/// What a build works on. Ranges are disjoint, so that tasks share it.
struct Build {
    SahItem* buffer[2];
    std::uint32_t* order;
    std::span<const Corners> corners;
    std::uint32_t task_size = 0;  ///< ranges of the top that are no larger become tasks; 0: none do
    std::vector<Task>* tasks = nullptr;
};

using Subtree = void (*)(const Build& build, const Range& range, HugePageVector<SahNode>& nodes, SahFold& fold);

}  // namespace sah
}  // namespace carom
#endif

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

using sah::Build;
using sah::Range;

/// Maps twice the centre of an item to a bin on each axis.
struct Binning {
    alignas(16) float origin[4];
    alignas(16) float scale[4];
    int bins;

    HWY_INLINE void bins_of(const SahItem& item, std::int32_t* bin) const {
        const Four twice = sub4(load4(lanes_of(item)), load4(lanes_of(item) + 4));
        bins4(mul4(sub4(twice, load4(origin)), load4(scale)), bins - 1, bin);
    }
};

struct Split {
    int axis = -1;  ///< < 0: no split separates anything
    int last = 0;   ///< bins 0..last go left
    float cost = std::numeric_limits<float>::infinity();
    std::uint32_t left_count = 0;
    SahBox left;
    SahBox right;
};

/// Few bins for few triangles: most ranges are small, and summing up empty bins would take most of the build.
HWY_INLINE int bin_count(std::uint32_t count) { return std::min(sah::kMostBins, 4 + static_cast<int>(count / 10)); }

Binning binning_of(const SahItem* items, std::uint32_t count) {
    // Bounds of twice the centres: minimum, and minus maximum.
    Four lowest = set4(std::numeric_limits<float>::infinity());
    Four minus_highest = lowest;
    for (std::uint32_t k = 0; k < count; ++k) {
        const Four lower = load4(lanes_of(items[k]));
        const Four minus_upper = load4(lanes_of(items[k]) + 4);
        lowest = min4(lowest, sub4(lower, minus_upper));
        minus_highest = min4(minus_highest, sub4(minus_upper, lower));
    }
    alignas(16) float low[4], minus_high[4];
    store4(lowest, low);
    store4(minus_highest, minus_high);
    Binning binning;
    binning.bins = bin_count(count);
    binning.origin[3] = 0.0f, binning.scale[3] = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        const float extent = -minus_high[axis] - low[axis];
        binning.origin[axis] = low[axis];
        // The first and the last bin are half as wide as the others, for values are rounded to nearest.
        // An extent this small against a mesh of size 1 separates nothing worth it, and its inverse could overflow.
        binning.scale[axis] = extent > 1e-30f ? static_cast<float>(binning.bins - 1) / extent : 0.0f;
    }
    return binning;
}

/// Boxes and counts of bins.
struct Bins {
    alignas(32) float box[3][sah::kMostBins][8];
    std::uint32_t number[3][sah::kMostBins];

    HWY_INLINE explicit Bins(int bins) {
        for (int axis = 0; axis < 3; ++axis) {
            for (int i = 0; i < bins; ++i) {
                set_empty(box[axis][i]);
                number[axis][i] = 0;
            }
        }
    }
    HWY_INLINE void add(const SahItem& item, const Binning& binning) {
        alignas(16) std::int32_t bin[4];
        binning.bins_of(item, bin);
        grow(box[0][bin[0]], lanes_of(item));
        grow(box[1][bin[1]], lanes_of(item));
        grow(box[2][bin[2]], lanes_of(item));
        ++number[0][bin[0]];
        ++number[1][bin[1]];
        ++number[2][bin[2]];
    }
};

Bins fill_bins(const SahItem* items, std::uint32_t count, const Binning& binning) {
    Bins bins(binning.bins);
    constexpr std::uint32_t kTwoSets = 48;
    if (count < kTwoSets) {
        for (std::uint32_t k = 0; k < count; ++k) bins.add(items[k], binning);
        return bins;
    }
    // Neighbours fall into one bin, and each waits there for the one before: two ranges in turn wait half as long.
    Bins second(binning.bins);
    const std::uint32_t half = count / 2;
    for (std::uint32_t k = 0; k < half; ++k) {
        bins.add(items[k], binning);
        second.add(items[half + k], binning);
    }
    if (count % 2 != 0) bins.add(items[count - 1], binning);
    for (int axis = 0; axis < 3; ++axis) {
        for (int i = 0; i < binning.bins; ++i) {
            grow(bins.box[axis][i], second.box[axis][i]);
            bins.number[axis][i] += second.number[axis][i];
        }
    }
    return bins;
}

Split best_split(const SahItem* items, std::uint32_t count, const Binning& binning) {
    const Bins filled = fill_bins(items, count, binning);
    const auto& box = filled.box;
    const auto& number = filled.number;
    const int bins = binning.bins;
    // Sums from the right first, then from the left; three axes at once, so that one does not wait for another's chain.
    float right_cost[3][sah::kMostBins];
    Four lower[3], minus_upper[3];
    std::uint32_t total[3] = {0, 0, 0};
    for (int axis = 0; axis < 3; ++axis) lower[axis] = minus_upper[axis] = set4(std::numeric_limits<float>::infinity());
    for (int i = bins - 1; i > 0; --i) {
        for (int axis = 0; axis < 3; ++axis) {
            lower[axis] = min4(lower[axis], load4(box[axis][i]));
            minus_upper[axis] = min4(minus_upper[axis], load4(box[axis][i] + 4));
            total[axis] += number[axis][i];
            right_cost[axis][i] = static_cast<float>(total[axis]) * half_area(lower[axis], minus_upper[axis]);
        }
    }
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
        total[axis] = 0;
        lower[axis] = minus_upper[axis] = set4(std::numeric_limits<float>::infinity());
    }
    for (int i = 0; i + 1 < bins; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            lower[axis] = min4(lower[axis], load4(box[axis][i]));
            minus_upper[axis] = min4(minus_upper[axis], load4(box[axis][i] + 4));
            total[axis] += number[axis][i];
            const float cost = static_cast<float>(total[axis]) * half_area(lower[axis], minus_upper[axis]) + right_cost[axis][i + 1];
            // An empty side costs 0 times infinity: NaN, which is not less.
            if (cost < best.cost) {
                best.axis = axis;
                best.last = i;
                best.cost = cost;
                best.left_count = total[axis];
            }
        }
    }
    if (best.axis >= 0) {
        set_empty(best.left.minimum);
        set_empty(best.right.minimum);
        for (int i = 0; i < bins; ++i) grow(i <= best.last ? best.left.minimum : best.right.minimum, box[best.axis][i]);
    }
    return best;
}

/// Left items from the front, right ones from the back: no branch, and so no misprediction for every second item.
void partition(const SahItem* from, SahItem* to, std::uint32_t count, const Binning& binning, const Split& split) {
    // The same arithmetic as in Binning, on one axis. A bin above the last one counts as the last, which never goes left.
    const float origin = binning.origin[split.axis];
    const float scale = binning.scale[split.axis];
    const float limit = static_cast<float>(split.last) + kRounder;
    std::uint32_t begin = 0;
    std::uint32_t end = count;
    for (std::uint32_t k = 0; k < count; ++k) {
        const float twice = from[k].lower[split.axis] - from[k].minus_upper[split.axis];
        const bool left = (twice - origin) * scale + kRounder <= limit;
        end -= left ? 0u : 1u;
        to[left ? begin : end] = from[k];
        begin += left ? 1u : 0u;
    }
}

void box_of(const SahItem* items, std::uint32_t count, SahBox& box) {
    set_empty(box.minimum);
    for (std::uint32_t k = 0; k < count; ++k) grow(box.minimum, lanes_of(items[k]));
}

/// Cuts a range in two.
void cut(const Build& build, const Range& range, Range& left, Range& right) {
    const SahItem* from = build.buffer[range.swapped ? 1 : 0] + range.first;
    SahItem* to = build.buffer[range.swapped ? 0 : 1] + range.first;
    left = {.first = range.first, .depth = range.depth + 1, .swapped = !range.swapped};
    right = left;
    Split split;
    if (range.depth < sah::kSahDepth) {
        const Binning binning = binning_of(from, range.count);
        split = best_split(from, range.count, binning);
        if (split.axis >= 0) {
            partition(from, to, range.count, binning, split);
            left.count = split.left_count;
            left.box = split.left;
            right.box = split.right;
        }
    }
    if (split.axis < 0) {
        left.count = range.count / 2;
        left.swapped = right.swapped = range.swapped;
        box_of(from, left.count, left.box);
        box_of(from + left.count, range.count - left.count, right.box);
    }
    right.first = range.first + left.count;
    right.count = range.count - left.count;
}

void build_subtree(const Build& build, const Range& range, HugePageVector<SahNode>& nodes, SahFold& fold) {
    const std::size_t self = nodes.size();
    nodes.emplace_back();
    nodes[self].box = range.box;
    nodes[self].first = range.first;
    nodes[self].count = range.count;
    if (range.count <= sah::kLeafSize) {
        const SahItem* items = build.buffer[range.swapped ? 1 : 0] + range.first;
        std::uint32_t* order = build.order + range.first;
        for (std::uint32_t k = 0; k < range.count; ++k) order[k] = items[k].triangle();
        fold_leaf(nodes[self], {order, range.count}, build.corners, fold);
        return;
    }
    Range left, right;
    cut(build, range, left, right);
    SahFold left_fold, right_fold;
    build_subtree(build, left, nodes, left_fold);
    nodes[self].skip = static_cast<std::uint32_t>(nodes.size() - self);
    build_subtree(build, right, nodes, right_fold);
    fold_inner(nodes[self], left_fold, right_fold, fold);
}

/// The box of all items.
void whole_box(const SahItem* items, std::uint32_t count, SahBox& box) { box_of(items, count, box); }

/// Cuts the top of the tree into tasks, in the order of the tree.
void cut_top(const Build& build, const Range& range) {
    if (range.count <= build.task_size) {
        build.tasks->push_back({range, {}, {}});
        return;
    }
    Range left, right;
    cut(build, range, left, right);
    // A node to be finished when its children are; its task slot is found again by position.
    build.tasks->push_back({range, {}, {}});
    build.tasks->back().nodes.resize(1);
    cut_top(build, left);
    cut_top(build, right);
}

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom {
namespace {

HWY_EXPORT(build_subtree);
HWY_EXPORT(whole_box);
HWY_EXPORT(cut_top);

/// Joins the tasks from `next` on into one tree, top nodes around them.
void join(std::vector<sah::Task>& tasks, std::size_t& next, HugePageVector<SahNode>& nodes, SahFold& fold) {
    sah::Task& task = tasks[next++];
    const std::size_t self = nodes.size();
    const bool top = task.fold.limit == 0;
    if (!top) {
        nodes.insert(nodes.end(), task.nodes.begin(), task.nodes.end());
        fold = task.fold;
        HugePageVector<SahNode>().swap(task.nodes);
        return;
    }
    nodes.emplace_back();
    nodes[self].box = task.range.box;
    nodes[self].first = task.range.first;
    nodes[self].count = task.range.count;
    SahFold left, right;
    join(tasks, next, nodes, left);
    nodes[self].skip = static_cast<std::uint32_t>(nodes.size() - self);
    join(tasks, next, nodes, right);
    fold_inner(nodes[self], left, right, fold);
}

}  // namespace

SahTree build_sah_tree(HugePageVector<SahItem> items, std::span<const Corners> corners, Executor& executor) {
    const auto count = static_cast<std::uint32_t>(items.size());
    HugePageVector<SahItem> second(items.size());
    SahTree tree;
    tree.order.resize(items.size());
    tree.nodes.reserve(items.size());
    sah::Build build{{items.data(), second.data()}, tree.order.data(), corners};
    sah::Range all{.count = count};
    HWY_DYNAMIC_DISPATCH(whole_box)(items.data(), count, all.box);
    SahFold fold;
    constexpr std::uint32_t kSmallestTask = 4096;
    if (executor.thread_count() == 1 || count <= kSmallestTask) {
        HWY_DYNAMIC_DISPATCH(build_subtree)(build, all, tree.nodes, fold);
        return tree;
    }
    std::vector<sah::Task> tasks;
    build.tasks = &tasks;
    build.task_size = std::max(kSmallestTask, count / 64);
    HWY_DYNAMIC_DISPATCH(cut_top)(build, all);
    for (sah::Task& task : tasks) {
        if (!task.nodes.empty()) task.fold.limit = 0;  // a top node
    }
    const sah::Subtree build_one = HWY_DYNAMIC_DISPATCH(build_subtree);
    executor.parallel_for(tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (tasks[i].fold.limit != 0) build_one(build, tasks[i].range, tasks[i].nodes, tasks[i].fold);
        }
    });
    std::size_t next = 0;
    join(tasks, next, tree.nodes, fold);
    return tree;
}

}  // namespace carom
#endif
