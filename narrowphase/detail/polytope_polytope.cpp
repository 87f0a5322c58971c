// Box against hull, and hull against hull.
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/polytope_patch.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

namespace carom::detail {
namespace {

CollideStatus touch(double margin, Workspace& workspace, ManifoldSink& sink) {
    ContactAxis axis;
    if (!find_axis(workspace.first, workspace.second, margin, workspace.edges, axis)) return CollideStatus::Ok;
    Patch patch;
    build_patch(workspace.first, workspace.second, axis, margin, AxisPoint::Keep, workspace.polygons, patch);
    sink.add(patch);
    return CollideStatus::Ok;
}

}  // namespace

CollideStatus box_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    load_box(workspace.first, dvec3(as<Box>(pair.first).half_extents), dmat3{1.0}, dvec3{0.0});
    load_hull(workspace.second, *as<ConvexHullPtr>(pair.second), pair.rotation, pair.translation);
    return touch(pair.margin, workspace, sink);
}

CollideStatus hull_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    load_hull(workspace.first, *as<ConvexHullPtr>(pair.first), dmat3{1.0}, dvec3{0.0});
    load_hull(workspace.second, *as<ConvexHullPtr>(pair.second), pair.rotation, pair.translation);
    return touch(pair.margin, workspace, sink);
}

}  // namespace carom::detail
