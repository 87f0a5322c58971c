// Capsule against box and hull, sphere against hull.
#include <carom/collision/convex_hull.hpp>
#include <carom/narrowphase/detail/gjk.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/round_contact.hpp>
#include <carom/narrowphase/detail/segment_polytope.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

#include <limits>

namespace carom::detail {
namespace {

CollideStatus capsule_polytope(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const Capsule& capsule = as<Capsule>(pair.first);
    const double half = static_cast<double>(capsule.half_segment);
    const RoundSegment core{{{0.0, -half, 0.0}, {0.0, half, 0.0}}, static_cast<double>(capsule.radius)};
    ContactAxis axis;
    if (!find_axis(core, workspace.second, pair.margin, axis)) return CollideStatus::Ok;
    Patch patch;
    build_patch(core, workspace.second, axis, pair.margin, AxisPoint::Keep, workspace.polygons, patch);
    if (patch.count > 0) sink.add(patch);
    return CollideStatus::Ok;
}

// Whether the point over the face's plane projects into the face.
bool over_face(const ConvexHull& hull, const ConvexHull::Face& face, const dvec3& p) noexcept {
    std::uint32_t e = face.first_edge;
    for (std::uint32_t k = 0; k < face.edge_count; ++k) {
        const std::uint32_t next = hull.edges()[e].next;
        const dvec3 v(hull.vertices()[hull.edges()[e].origin]);
        const dvec3 edge = dvec3(hull.vertices()[hull.edges()[next].origin]) - v;
        if (glm::dot(glm::cross(edge, face.normal), p - v) > 0.0) return false;
        e = next;
    }
    return true;
}

}  // namespace

CollideStatus capsule_box(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    load_box(workspace.second, dvec3(as<Box>(pair.second).half_extents), pair.rotation, pair.translation);
    return capsule_polytope(pair, workspace, sink);
}

CollideStatus capsule_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const ConvexHull& hull = *as<ConvexHullPtr>(pair.second);
    load_hull_vertices(workspace.second, hull, pair.rotation, pair.translation);
    load_hull_faces(workspace.second, hull, pair.rotation, pair.translation);
    return capsule_polytope(pair, workspace, sink);
}

CollideStatus sphere_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const double radius = static_cast<double>(as<Sphere>(pair.first).radius);
    const ConvexHull& hull = *as<ConvexHullPtr>(pair.second);
    const dvec3 centre = pair.to_second(dvec3{0.0});
    double distance = -std::numeric_limits<double>::infinity();
    const ConvexHull::Face* nearest = nullptr;
    for (const ConvexHull::Face& face : hull.faces()) {
        const double d = glm::dot(face.normal, centre) - face.offset;
        if (d > distance) {
            distance = d;
            nearest = &face;
        }
    }
    if (distance - radius > pair.margin) return CollideStatus::Ok;

    Patch patch;
    patch.normal = -(pair.rotation * nearest->normal);
    CollideStatus status = CollideStatus::Ok;
    if (distance > 0.0 && !over_face(hull, *nearest, centre)) {
        std::vector<dvec3>& vertices = workspace.second.vertices;
        vertices.assign(hull.vertices().begin(), hull.vertices().end());
        const GjkResult r = gjk(std::span<const dvec3>(&centre, 1), vertices, radius + pair.margin);
        if (r.beyond || r.distance - radius > pair.margin) return CollideStatus::Ok;
        const Direction out = direction_of(r.on_b - r.on_a, dvec3{0.0});
        if (out.length > distance) {
            patch.normal = pair.rotation * out.unit;
            distance = out.length;
        }
        if (!r.converged) status = CollideStatus::Undecided;
    }
    add_ball(patch, dvec3{0.0}, radius, distance, 0);
    sink.add(patch);
    return status;
}

}  // namespace carom::detail
