// Binned surface-area splits on three axes (Wald, On fast Construction of SAH-based Bounding Volume Hierarchies, 2007).
#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/collision/detail/sah_tree.cpp>
#include <hwy/foreach_target.h>

#include <carom/collision/detail/sah_tree.hpp>
#include <carom/core/lanes.hpp>

#include <algorithm>
#include <limits>

#ifndef CAROM_COLLISION_SAH_TREE_ONCE
#define CAROM_COLLISION_SAH_TREE_ONCE
namespace carom {
namespace sah {

inline constexpr std::uint32_t kLeafSize = 3;
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
    std::vector<SahNode> nodes;
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

using Subtree = void (*)(const Build& build, const Range& range, std::vector<SahNode>& nodes, SahFold& fold);

}  // namespace sah
}  // namespace carom
#endif

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

using sah::Build;
using sah::Range;

using Tag8 = hn::CappedTag<float, 8>;
using Tag4 = hn::CappedTag<float, 4>;
using IntTag4 = hn::Rebind<std::int32_t, Tag4>;
constexpr std::size_t kStep8 = hn::MaxLanes(Tag8());
constexpr std::size_t kStep4 = hn::MaxLanes(Tag4());

HWY_INLINE void grow(float* box, const float* by) {
    for (std::size_t i = 0; i < 8; i += kStep8) {
        hn::Store(hn::Min(hn::Load(Tag8(), box + i), hn::Load(Tag8(), by + i)), Tag8(), box + i);
    }
}

HWY_INLINE void set_empty(float* box) {
    for (std::size_t i = 0; i < 8; i += kStep8) {
        hn::Store(hn::Set(Tag8(), std::numeric_limits<float>::infinity()), Tag8(), box + i);
    }
}

HWY_INLINE float half_area(const float* box) {
    const float x = -box[4] - box[0];
    const float y = -box[5] - box[1];
    const float z = -box[6] - box[2];
    return x * y + y * z + z * x;
}

/// The four floats of the box at once: x, y, z, and one that means nothing.
HWY_INLINE const float* as_floats(const SahItem& item) { return item.lower; }

/// Maps twice the centre of an item to a bin on each axis.
struct Binning {
    alignas(16) float origin[4];
    alignas(16) float scale[4];
    int bins;

    HWY_INLINE void bins_of(const SahItem& item, std::int32_t* bin) const {
        for (std::size_t i = 0; i < 4; i += kStep4) {
            const auto twice = hn::Sub(hn::Load(Tag4(), item.lower + i), hn::Load(Tag4(), item.minus_upper + i));
            const auto place = hn::Mul(hn::Sub(twice, hn::Load(Tag4(), origin + i)), hn::Load(Tag4(), scale + i));
            hn::Store(hn::Min(hn::ConvertTo(IntTag4(), place), hn::Set(IntTag4(), bins - 1)), IntTag4(), bin + i);
        }
    }
};

struct Split {
    int axis = -1;  ///< < 0: no split separates anything
    int last = 0;   ///< bins 0..last go left
    float cost = std::numeric_limits<float>::infinity();
    SahBox left{};
    SahBox right{};
    std::uint32_t left_count = 0;
};

/// Few bins for few triangles: most ranges are small, and summing up empty bins would take most of the build.
HWY_INLINE int bin_count(std::uint32_t count) { return std::min(sah::kMostBins, 4 + static_cast<int>(count / 10)); }

Binning binning_of(const SahItem* items, std::uint32_t count) {
    // Bounds of twice the centres: minimum, and minus maximum.
    alignas(32) float low[4], minus_high[4];
    for (std::size_t i = 0; i < 4; i += kStep4) {
        auto lowest = hn::Set(Tag4(), std::numeric_limits<float>::infinity());
        auto minus_highest = lowest;
        for (std::uint32_t k = 0; k < count; ++k) {
            const auto lower = hn::Load(Tag4(), items[k].lower + i);
            const auto minus_upper = hn::Load(Tag4(), items[k].minus_upper + i);
            lowest = hn::Min(lowest, hn::Sub(lower, minus_upper));
            minus_highest = hn::Min(minus_highest, hn::Sub(minus_upper, lower));
        }
        hn::Store(lowest, Tag4(), low + i);
        hn::Store(minus_highest, Tag4(), minus_high + i);
    }
    Binning binning;
    binning.bins = bin_count(count);
    binning.origin[3] = 0.0f, binning.scale[3] = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        const float extent = -minus_high[axis] - low[axis];
        binning.origin[axis] = low[axis];
        // An extent this small against a mesh of size 1 separates nothing worth it, and its inverse could overflow.
        binning.scale[axis] = extent > 1e-30f ? static_cast<float>(binning.bins) / extent : 0.0f;
    }
    return binning;
}

Split best_split(const SahItem* items, std::uint32_t count, const Binning& binning) {
    alignas(32) float box[3][sah::kMostBins][8];
    std::uint32_t number[3][sah::kMostBins];
    const int bins = binning.bins;
    for (int axis = 0; axis < 3; ++axis) {
        for (int i = 0; i < bins; ++i) {
            set_empty(box[axis][i]);
            number[axis][i] = 0;
        }
    }
    for (std::uint32_t k = 0; k < count; ++k) {
        alignas(16) std::int32_t bin[4];
        binning.bins_of(items[k], bin);
        for (int axis = 0; axis < 3; ++axis) {
            grow(box[axis][bin[axis]], as_floats(items[k]));
            ++number[axis][bin[axis]];
        }
    }
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
        if (binning.scale[axis] == 0.0f) continue;
        alignas(32) float right[sah::kMostBins][8];  // of bins i.. up to the last
        float right_area[sah::kMostBins];
        alignas(32) float sum[8];
        set_empty(sum);
        for (int i = bins - 1; i > 0; --i) {
            grow(sum, box[axis][i]);
            std::copy_n(sum, 8, right[i]);
            right_area[i] = half_area(sum);
        }
        set_empty(sum);
        std::uint32_t left_count = 0;
        for (int i = 0; i + 1 < bins; ++i) {
            grow(sum, box[axis][i]);
            left_count += number[axis][i];
            if (left_count == 0 || left_count == count) continue;
            const float cost = static_cast<float>(left_count) * half_area(sum) +
                               static_cast<float>(count - left_count) * right_area[i + 1];
            if (cost < best.cost) {
                best.axis = axis;
                best.last = i;
                best.cost = cost;
                best.left_count = left_count;
                std::copy_n(sum, 8, best.left.minimum);
                std::copy_n(right[i + 1], 8, best.right.minimum);
            }
        }
    }
    return best;
}

/// Left items from the front, right ones from the back: no branch, and so no misprediction for every second item.
void partition(const SahItem* from, SahItem* to, std::uint32_t count, const Binning& binning, const Split& split) {
    std::uint32_t begin = 0;
    std::uint32_t end = count;
    for (std::uint32_t k = 0; k < count; ++k) {
        alignas(16) std::int32_t bin[4];
        binning.bins_of(from[k], bin);
        const bool left = bin[split.axis] <= split.last;
        end -= left ? 0u : 1u;
        to[left ? begin : end] = from[k];
        begin += left ? 1u : 0u;
    }
}

void box_of(const SahItem* items, std::uint32_t count, SahBox& box) {
    set_empty(box.minimum);
    for (std::uint32_t k = 0; k < count; ++k) grow(box.minimum, as_floats(items[k]));
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

void build_subtree(const Build& build, const Range& range, std::vector<SahNode>& nodes, SahFold& fold) {
    const std::size_t self = nodes.size();
    nodes.emplace_back();
    nodes[self].box = range.box;
    nodes[self].first = range.first;
    nodes[self].count = range.count;
    if (range.count <= sah::kLeafSize) {
        const SahItem* items = build.buffer[range.swapped ? 1 : 0] + range.first;
        std::uint32_t* order = build.order + range.first;
        for (std::uint32_t k = 0; k < range.count; ++k) order[k] = items[k].triangle;
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
void join(std::vector<sah::Task>& tasks, std::size_t& next, std::vector<SahNode>& nodes, SahFold& fold) {
    sah::Task& task = tasks[next++];
    const std::size_t self = nodes.size();
    const bool top = task.fold.limit == 0;
    if (!top) {
        nodes.insert(nodes.end(), task.nodes.begin(), task.nodes.end());
        fold = task.fold;
        std::vector<SahNode>().swap(task.nodes);
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

SahTree build_sah_tree(std::vector<SahItem> items, std::span<const Corners> corners, Executor& executor) {
    const auto count = static_cast<std::uint32_t>(items.size());
    std::vector<SahItem> second(items.size());
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
