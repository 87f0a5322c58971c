#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/collision/detail/wide_volume.cpp>
#include <hwy/foreach_target.h>

#include <carom/collision/detail/wide_volume.hpp>
#include <carom/core/lanes.hpp>

#include <bit>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

/// @return the children whose boxes the volume may meet.
unsigned children_met(const WideNode& node, const WideVolume& volume) {
    unsigned met = 0;
    for (int part = 0; part < kWidth; part += kLanes) {
        Mask inside = first_lanes(kLanes);
        for (int k = 0; k < 3; ++k) {
            const Floats lower = load(node.bound[0][k] + part), upper = load(node.bound[1][k] + part);
            inside = inside & (lower <= Floats(volume.upper[k])) & (upper >= Floats(volume.lower[k]));
        }
        for (std::size_t c = 0; c < volume.cut_count; ++c) {
            // The corner that is deepest below the plane. Lanes without a child have infinite corners; they are out already.
            const WideVolume::Cut& cut = volume.cuts[c];
            Floats depth(0.0f);
            for (int k = 0; k < 3; ++k) depth += Floats(cut.normal[k]) * load(node.bound[cut.normal[k] < 0.0f ? 1 : 0][k] + part);
            inside = inside & (depth <= Floats(cut.offset));
        }
        met |= bits(inside) << part;
    }
    return met;
}

void VisitLeaves(const WideBvh& tree, const WideVolume& volume, FunctionRef<bool(const WideLeaf& leaf)> visit) {
    WideRef stack[WideBvh::kMaxStack];
    std::size_t size = 0;
    stack[size++] = WideBvh::root();
    while (size > 0) {
        const WideRef here = stack[--size];
        if (is_leaf(here)) {
            if (!visit(tree.leaf(here))) return;
            continue;
        }
        const WideNode& node = tree.node(here);
        for (unsigned met = children_met(node, volume); met != 0;) {  // the last one first, so that the first is on top
            const int child = 31 - std::countl_zero(met);
            stack[size++] = node.child[child];
            met &= ~(1u << child);
        }
    }
}

/// Squared distances of a point from a node's boxes, from below but for rounding. Lanes without a child are infinitely far.
void distances_sq(const WideNode& node, const WidePoint3& point, float* out) {
    for (int part = 0; part < kWidth; part += kLanes) {
        Floats sum(0.0f);
        for (int k = 0; k < 3; ++k) {
            const Floats p(point.at[k]);
            const Floats d = max(max(load(node.bound[0][k] + part) - p, p - load(node.bound[1][k] + part)), Floats(0.0f));
            sum += d * d;
        }
        store(sum, out + part);
    }
}

void VisitLeavesNear(const WideBvh& tree, const WidePoint3& point, float reach, FunctionRef<float(const WideLeaf& leaf)> visit) {
    struct Entry {
        WideRef ref;
        float distance_sq;
    };
    // Each square and sum is rounded once: 8 u of the whole, and the slack, cover them; three squares that underflow are 1.5 of the
    // least denormals too large together. Squares that overflow bound nothing.
    const auto limit_of = [&](float distance) {
        const float bound = (distance + point.slack) * 1.000001f;
        return bound * bound + 0x1p-147f;
    };
    Entry stack[WideBvh::kMaxStack];
    std::size_t size = 0;
    stack[size++] = {WideBvh::root(), 0.0f};
    float limit = limit_of(reach);
    while (size > 0) {
        const Entry here = stack[--size];
        if (here.distance_sq > limit) continue;
        if (is_leaf(here.ref)) {
            limit = limit_of(visit(tree.leaf(here.ref)));
            continue;
        }
        const WideNode& node = tree.node(here.ref);
        alignas(64) float distance_sq[kWidth];
        distances_sq(node, point, distance_sq);
        const std::size_t first = size;
        for (int k = 0; k < kWidth && node.bound[0][0][k] <= node.bound[1][0][k]; ++k) {
            if (distance_sq[k] > limit) continue;
            std::size_t place = size++;  // insertion: the farthest first, so that the nearest is on top
            for (; place > first && stack[place - 1].distance_sq < distance_sq[k]; --place) stack[place] = stack[place - 1];
            stack[place] = {node.child[k], distance_sq[k]};
        }
    }
}

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom {
HWY_EXPORT(VisitLeaves);
HWY_EXPORT(VisitLeavesNear);

void visit_leaves(const WideBvh& tree, const WideVolume& volume, FunctionRef<bool(const WideLeaf& leaf)> visit) {
    HWY_DYNAMIC_DISPATCH(VisitLeaves)(tree, volume, visit);
}

void visit_leaves_near(const WideBvh& tree, const WidePoint3& point, float reach, FunctionRef<float(const WideLeaf& leaf)> visit) {
    HWY_DYNAMIC_DISPATCH(VisitLeavesNear)(tree, point, reach, visit);
}
}  // namespace carom
#endif
