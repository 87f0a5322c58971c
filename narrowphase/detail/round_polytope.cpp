// Capsule and sphere against hull.
#include <carom/collision/convex_hull.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/round_contact.hpp>
#include <carom/narrowphase/detail/segment_polytope.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

namespace carom::detail {

CollideStatus capsule_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    return capsule_hull(pair, *as<ConvexHullPtr>(pair.second), workspace, sink);
}

CollideStatus capsule_hull(const PairFrame& pair, const ConvexHull& second, Workspace& workspace, ManifoldSink& sink) {
    load_hull(workspace.second, second, pair.rotation, pair.translation);
    const Capsule& capsule = as<Capsule>(pair.first);
    const double half = static_cast<double>(capsule.half_segment);
    const RoundSegment core{{{0.0, -half, 0.0}, {0.0, half, 0.0}}, static_cast<double>(capsule.radius)};
    ContactAxis axis;
    if (!find_axis(core, workspace.second, pair.margin, workspace.polygons, axis)) return CollideStatus::Ok;
    Patch patch;
    build_patch(core, workspace.second, axis, pair.margin, AxisPoint::Keep, workspace.polygons, patch);
    if (patch.count > 0) sink.add(patch);
    return CollideStatus::Ok;
}

CollideStatus sphere_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    return sphere_hull(pair, *as<ConvexHullPtr>(pair.second), workspace, sink);
}

// In the hull's frame, so that nothing of it is to be moved.
CollideStatus sphere_hull(const PairFrame& pair, const ConvexHull& second, Workspace& workspace, ManifoldSink& sink) {
    const double radius = static_cast<double>(as<Sphere>(pair.first).radius);
    const dvec3 centre = pair.to_second(dvec3{0.0});
    load_hull(workspace.second, second);
    ContactAxis axis;
    if (!find_axis({{centre, centre}, radius}, workspace.second, pair.margin, workspace.polygons, axis)) return CollideStatus::Ok;
    Patch patch;
    patch.normal = pair.rotation * axis.normal;
    add_ball(patch, dvec3{0.0}, radius, axis.separation, 0);
    sink.add(patch);
    return CollideStatus::Ok;
}

}  // namespace carom::detail
