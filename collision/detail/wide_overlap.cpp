#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/collision/detail/wide_overlap.cpp>
#include <hwy/foreach_target.h>

#include <carom/collision/detail/wide_overlap.hpp>
#include <carom/collision/detail/wide_traverse.hpp>

#include <bit>
#include <cmath>
#include <limits>

#ifndef CAROM_COLLISION_WIDE_OVERLAP_ONCE
#define CAROM_COLLISION_WIDE_OVERLAP_ONCE
namespace carom {

/// A box in float, in the tree's coordinates.
struct QueryBox {
    float lower[3];
    float upper[3];
};

}  // namespace carom
#endif

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

/// The leaf's triangles whose boxes overlap.
HWY_INLINE unsigned overlapping_triangles(const WideLeaf& leaf, const Floats* lower, const Floats* upper) {
    unsigned met = 0;
    Table16 table[3];
    for (int axis = 0; axis < 3; ++axis) {
        for (int part = 0; part < kParts; ++part) table[axis].set(part, load(leaf.vertex[axis] + part * kLanes));
    }
    for (int at = 0; at < kWidth; at += kLanes) {
        if (at != 0 && static_cast<std::uint32_t>(at) >= leaf.triangle_count) break;
        const Picks a(leaf.corner[0] + at), b(leaf.corner[1] + at), c(leaf.corner[2] + at);
        Mask all = first_lanes(kLanes);
        for (int axis = 0; axis < 3; ++axis) {
            const Floats p = a(table[axis]), q = b(table[axis]), r = c(table[axis]);
            all = all & (min(min(p, q), r) <= upper[axis]) & (max(max(p, q), r) >= lower[axis]);
        }
        met |= bits(all) << at;
    }
    return met & ((1u << leaf.triangle_count) - 1u);
}

void visit_box(const WideBvh& tree, const QueryBox& box, FunctionRef<bool(std::uint32_t)> visit) {
    Floats lower[3], upper[3];
    for (int axis = 0; axis < 3; ++axis) {
        lower[axis] = Floats(box.lower[axis]);
        upper[axis] = Floats(box.upper[axis]);
    }
    WideRef stack[WideBvh::kMaxStack];
    std::size_t size = 0;
    stack[size++] = WideBvh::root();
    while (size > 0) {
        const WideRef here = stack[--size];
        if (is_leaf(here)) {
            const WideLeaf& leaf = tree.leaf(here);
            for (unsigned met = overlapping_triangles(leaf, lower, upper); met != 0; met &= met - 1) {
                if (!visit(leaf.triangle[std::countr_zero(met)])) return;
            }
            continue;
        }
        const WideNode& node = tree.node(here);
        unsigned met = 0;
        for (int at = 0; at < kWidth; at += kLanes) {
            Mask all = first_lanes(kLanes);
            for (int axis = 0; axis < 3; ++axis) {
                all = all & (load(node.bound[0][axis] + at) <= upper[axis]) & (load(node.bound[1][axis] + at) >= lower[axis]);
            }
            met |= bits(all) << at;
        }
        for (; met != 0;) {  // the last lane first, so that the first one is on top
            const int lane = 31 - std::countl_zero(met);
            stack[size++] = node.child[lane];
            met &= ~(1u << lane);
        }
    }
}

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom {
namespace {

HWY_EXPORT(visit_box);

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// The largest float that is not above `x`; no larger than the largest finite one, for lanes without a child have infinite bounds.
float round_down(double x) noexcept {
    if (x > static_cast<double>(std::numeric_limits<float>::max())) return std::numeric_limits<float>::max();
    const float rounded = static_cast<float>(x);
    return static_cast<double>(rounded) > x ? std::nextafter(rounded, -kInfinity) : rounded;
}

}  // namespace

void visit_overlaps(const WideBvh& tree, const Aabb& box, FunctionRef<bool(std::uint32_t)> visit) {
    if (is_empty(box)) return;  // NaN too
    // Rounded inward: against float boxes that gives the verdicts of the box in double. Against coordinates that were rounded to the
    // denormals, the box grows by what they may have moved.
    const auto scale = static_cast<double>(tree.scale);
    const double slack = tree.lossless ? 0.0 : 0x1p-148;
    QueryBox query;
    for (int axis = 0; axis < 3; ++axis) {
        query.lower[axis] = -round_down(-(scale * box.lower[axis] - slack));
        query.upper[axis] = round_down(scale * box.upper[axis] + slack);
    }
    HWY_DYNAMIC_DISPATCH(visit_box)(tree, query, visit);
}

}  // namespace carom
#endif
