// Box against hull, hull against hull, and box against box where there is but one pair of them.
#include <carom/collision/convex_hull.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/polytope_patch.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

namespace carom::detail {

CollideStatus touch_polytopes(const Asked& asked, Workspace& workspace, ManifoldSink& sink) {
    Polytope &a = workspace.first, &b = workspace.second;
    ContactAxis axis;
    if (!find_axis(a, b, a.centre, b.centre, asked.margin, axis)) return CollideStatus::Ok;
    Patch patch;
    build_patch(a, b, axis, asked, AxisPoint::Keep, workspace.polygons, patch);
    sink.add(patch);
    return CollideStatus::Ok;
}

CollideStatus box_box_alone(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    load_box(workspace.first, dvec3(as<Box>(pair.first).half_extents));
    load_box(workspace.second, dvec3(as<Box>(pair.second).half_extents), pair.rotation, pair.translation);
    return touch_polytopes(pair.asked(), workspace, sink);
}

CollideStatus box_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const ConvexHull& hull = *as<ConvexHullPtr>(pair.second);
    load_box(workspace.first, dvec3(as<Box>(pair.first).half_extents));
    if (passes_by(workspace.first, hull, pair.rotation, pair.translation, pair.margin)) return CollideStatus::Ok;
    load_hull(workspace.second, hull, pair.rotation, pair.translation);
    return touch_polytopes(pair.asked(), workspace, sink);
}

CollideStatus hull_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    return hull_hull(pair, *as<ConvexHullPtr>(pair.first), *as<ConvexHullPtr>(pair.second), workspace, sink);
}

CollideStatus hull_hull(const PairFrame& pair, const ConvexHull& first, const ConvexHull& second, Workspace& workspace, ManifoldSink& sink) {
    load_hull(workspace.first, first);
    if (passes_by(workspace.first, second, pair.rotation, pair.translation, pair.margin)) return CollideStatus::Ok;
    load_hull(workspace.second, second, pair.rotation, pair.translation);
    return touch_polytopes(pair.asked(), workspace, sink);
}

}  // namespace carom::detail
