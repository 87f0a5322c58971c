// Box against hull, hull against hull, and box against box where there is but one pair of them.
#include <carom/collision/convex_hull.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/polytope_patch.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

namespace carom::detail {
namespace {

void touch(const GjkResult& distance, double margin, Workspace& workspace, ManifoldSink& sink) {
    ContactAxis axis;
    if (!find_axis(workspace.first, workspace.second, distance, margin, workspace.edges, axis)) return;
    Patch patch;
    build_patch(workspace.first, workspace.second, axis, margin, AxisPoint::Keep, workspace.polygons, patch);
    sink.add(patch);
}

}  // namespace

CollideStatus box_box_alone(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    load_box(workspace.first, dvec3(as<Box>(pair.first).half_extents), dmat3{1.0}, dvec3{0.0});
    load_box(workspace.second, dvec3(as<Box>(pair.second).half_extents), pair.rotation, pair.translation);
    const GjkResult distance = gjk(workspace.first.vertices, workspace.second.vertices, pair.margin);
    if (!distance.beyond) touch(distance, pair.margin, workspace, sink);
    return CollideStatus::Ok;
}

CollideStatus box_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const ConvexHull& hull = *as<ConvexHullPtr>(pair.second);
    load_box(workspace.first, dvec3(as<Box>(pair.first).half_extents), dmat3{1.0}, dvec3{0.0});
    load_hull_vertices(workspace.second, hull, pair.rotation, pair.translation);
    const GjkResult distance = gjk(workspace.first.vertices, workspace.second.vertices, pair.margin);
    if (distance.beyond) return CollideStatus::Ok;
    load_hull_faces(workspace.second, hull, pair.rotation, pair.translation);
    touch(distance, pair.margin, workspace, sink);
    return CollideStatus::Ok;
}

CollideStatus hull_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const ConvexHull &first = *as<ConvexHullPtr>(pair.first), &second = *as<ConvexHullPtr>(pair.second);
    load_hull_vertices(workspace.first, first, dmat3{1.0}, dvec3{0.0});
    load_hull_vertices(workspace.second, second, pair.rotation, pair.translation);
    const GjkResult distance = gjk(workspace.first.vertices, workspace.second.vertices, pair.margin);
    if (distance.beyond) return CollideStatus::Ok;
    load_hull_faces(workspace.first, first, dmat3{1.0}, dvec3{0.0});
    load_hull_faces(workspace.second, second, pair.rotation, pair.translation);
    touch(distance, pair.margin, workspace, sink);
    return CollideStatus::Ok;
}

}  // namespace carom::detail
