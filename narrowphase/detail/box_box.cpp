// Box against box: fifteen axes, then the points of the face or of the edges that decide.
#include <carom/narrowphase/detail/box_edge_patch.hpp>
#include <carom/narrowphase/detail/box_face_patch.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/polytope_patch.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

namespace carom::detail {
namespace {

// The axes lie within the margin, but the faces are not over each other: corner to corner or corner to edge. The true distance
// decides.
void touch_corners(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    load_box(workspace.first, dvec3(as<Box>(pair.first).half_extents), dmat3{1.0}, dvec3{0.0});
    load_box(workspace.second, dvec3(as<Box>(pair.second).half_extents), pair.rotation, pair.translation);
    const GjkResult distance = gjk(workspace.first.vertices, workspace.second.vertices, pair.margin);
    ContactAxis axis;
    if (distance.beyond || !find_axis(workspace.first, workspace.second, distance, pair.margin, workspace.edges, axis)) return;
    Patch patch;
    build_patch(workspace.first, workspace.second, axis, pair.margin, AxisPoint::Keep, workspace.polygons, patch);
    sink.add(patch);
}

}  // namespace

CollideStatus box_box(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const BoxPair boxes = box_pair(pair);
    BoxAxis axis;
    if (!find_box_axis(boxes, pair.margin, axis)) return CollideStatus::Ok;
    Patch patch;
    if (axis.of_a >= 0 && axis.of_b >= 0) {
        build_box_edge_patch(pair, axis, patch);
    } else {
        build_box_face_patch(boxes, axis, pair.margin, patch);
    }
    if (patch.count > 0) {
        sink.add(patch);
    } else {
        touch_corners(pair, workspace, sink);
    }
    return CollideStatus::Ok;
}

}  // namespace carom::detail
