// Walks the wide hierarchy for volumes and for points.
//
//   visit_leaves(tree, volume, [&](const WideLeaf& leaf) { ...; return true; });
#pragma once

#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/core/function_ref.hpp>

#include <cstddef>

namespace carom {

/// A convex volume in the coordinates of a tree, or anything that holds it: a box, cut by half-spaces normal . x <= offset.
/// The box is finite: lanes without a child have the box [inf, -inf], which an infinite one would meet.
struct WideVolume {
    static constexpr std::size_t kMaxPlanes = 8;
    struct Cut {
        float normal[3];
        float offset;  ///< raised by what rounding may lower a corner's product
    };
    float lower[3];
    float upper[3];
    Cut cuts[kMaxPlanes];
    std::size_t cut_count = 0;
};

/// Calls `visit` for each leaf whose box may meet the volume, in the order of the tree, until it returns false.
void visit_leaves(const WideBvh& tree, const WideVolume& volume, FunctionRef<bool(const WideLeaf& leaf)> visit);

/// A point in the coordinates of a tree, rounded to float.
struct WidePoint3 {
    float at[3];
    float slack;  ///< how far rounding may have moved the point, or a distance from it, at the least distance
};

/// Calls `visit` for each leaf whose box may be within a distance of `point` (scaled), nearer ones mostly first. `visit` returns the
/// distance beyond which nothing counts any more; it starts at `reach`.
void visit_leaves_near(const WideBvh& tree, const WidePoint3& point, float reach, FunctionRef<float(const WideLeaf& leaf)> visit);

}  // namespace carom
