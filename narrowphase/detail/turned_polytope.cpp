// Cylinder and cone against capsule, box, hull and each other.
#include <carom/collision/convex_hull.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/turned_contact.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

namespace carom::detail {
namespace {

template <class B>
CollideStatus touch(const PairFrame& pair, B&& second, Workspace& workspace, ManifoldSink& sink) {
    const TruncatedCone solid = truncated_cone(pair.first, dmat3{1.0}, dvec3{0.0});
    CollideStatus status = CollideStatus::Ok;
    ContactAxis axis;
    if (!find_axis(solid, second, pair.margin, axis, status)) return status;
    Patch patch;
    build_patch(solid, second, axis, pair.asked(), AxisPoint::Keep, workspace.polygons, patch);
    if (patch.count > 0) sink.add(patch);
    return status;
}

}  // namespace

CollideStatus turned_box(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    load_box(workspace.second, dvec3(as<Box>(pair.second).half_extents), pair.rotation, pair.translation);
    return touch(pair, workspace.second, workspace, sink);
}

CollideStatus turned_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    return turned_hull(pair, *as<ConvexHullPtr>(pair.second), workspace, sink);
}

CollideStatus turned_hull(const PairFrame& pair, const ConvexHull& second, Workspace& workspace, ManifoldSink& sink) {
    load_hull(workspace.second, second, pair.rotation, pair.translation);
    return touch(pair, workspace.second, workspace, sink);
}

CollideStatus turned_turned(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    return touch(pair, truncated_cone(pair.second, pair.rotation, pair.translation), workspace, sink);
}

CollideStatus turned_capsule(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const Capsule& capsule = as<Capsule>(pair.second);
    const dvec3 half = static_cast<double>(capsule.half_segment) * pair.rotation[1];
    return touch(pair, RoundSegment{{pair.translation - half, pair.translation + half}, static_cast<double>(capsule.radius)}, workspace, sink);
}

}  // namespace carom::detail
