// Sphere, box, capsule, hull, cylinder and cone against a triangle mesh.
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/one_sided.hpp>
#include <carom/narrowphase/detail/polytope_lanes.hpp>
#include <carom/narrowphase/detail/round_contact.hpp>
#include <carom/narrowphase/detail/segment_polytope.hpp>
#include <carom/narrowphase/detail/solid_mesh.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>
#include <carom/narrowphase/detail/turned_contact.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

#include <glm/common.hpp>

#include <algorithm>

namespace carom::detail {
namespace {

Aabb add_ball(const Aabb& box, const dvec3& centre, double radius) noexcept {
    return merge(box, {centre - dvec3{radius}, centre + dvec3{radius}});
}

// Whether the shape is farther from the triangle's plane than the margin.
template <class Probe>
bool off_the_plane(const Probe& probe, const NearTriangle& t, double margin) noexcept {
    const dvec3 n = glm::cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]);
    const double offset = glm::dot(n, t.corners[0]), allowed = margin * std::sqrt(glm::dot(n, n));
    return offset - probe.reach(n) > allowed || -offset - probe.reach(-n) > allowed;
}

// The kinds of convex shape that need more than closest points, behind one face.
struct PolytopeProbe {
    Polytope& polytope;
    Aabb box;  // of the polytope, in its own frame
    dvec3 centre{0.0};

    [[nodiscard]] const Aabb& own() const noexcept { return box; }
    [[nodiscard]] double size() const noexcept { return polytope.size; }
    [[nodiscard]] double radius() const noexcept { return 0.0; }
    [[nodiscard]] double reach(const dvec3& n) const noexcept { return -lowest(polytope, -n).value; }
    [[nodiscard]] dvec3 farthest(const dvec3& n) const noexcept { return polytope.vertex(lowest(polytope, -n).number); }
    [[nodiscard]] bool beside(const NearTriangle& t, double margin) const noexcept {
        return glm::any(glm::greaterThan(t.lower, box.upper + dvec3{margin})) ||
               glm::any(glm::lessThan(t.upper, box.lower - dvec3{margin})) || passes_by(polytope, t.corners, margin);
    }
    bool axis(Polytope& triangle, double margin, Workspace&, ContactAxis& axis) const {
        return find_axis(polytope, triangle, centre, triangle.centre, margin, axis);
    }
    void patch(const Polytope& triangle, const ContactAxis& axis, const Asked& asked, AxisPoint point, Workspace& workspace,
               Patch& patch) const {
        build_patch(polytope, triangle, axis, asked, point, workspace.polygons, patch);
    }
};

struct SegmentProbe {
    const RoundSegment& core;
    dvec3 centre{0.0};

    [[nodiscard]] Aabb own() const noexcept {
        const dvec3 half = glm::abs(core.segment.to) + dvec3{core.radius};
        return {-half, half};
    }
    [[nodiscard]] double size() const noexcept { return core.radius + std::abs(core.segment.to.y); }
    [[nodiscard]] double radius() const noexcept { return core.radius; }
    [[nodiscard]] double reach(const dvec3& n) const noexcept {
        return core.radius * std::sqrt(glm::dot(n, n)) + std::max(glm::dot(core.segment.from, n), glm::dot(core.segment.to, n));
    }
    [[nodiscard]] dvec3 farthest(const dvec3& n) const noexcept {  // of the core
        return glm::dot(core.segment.to - core.segment.from, n) > 0.0 ? core.segment.to : core.segment.from;
    }
    [[nodiscard]] bool beside(const NearTriangle& t, double margin) const noexcept {
        const dvec3 half = glm::abs(core.segment.to) + dvec3{core.radius + margin};
        return glm::any(glm::greaterThan(t.lower, half)) || glm::any(glm::lessThan(t.upper, -half)) || off_the_plane(*this, t, margin);
    }
    bool axis(const Polytope& triangle, double margin, Workspace& workspace, ContactAxis& axis) const {
        return find_axis(core, triangle, margin, workspace.polygons, axis);
    }
    void patch(const Polytope& triangle, const ContactAxis& axis, const Asked& asked, AxisPoint point, Workspace& workspace,
               Patch& patch) const {
        build_patch(core, triangle, axis, asked.margin, point, workspace.polygons, patch);
    }
};

struct TurnedProbe {
    const TruncatedCone& solid;
    const Aabb& box;  // of the solid, in its own frame
    CollideStatus& status;
    dvec3 centre{0.0};

    [[nodiscard]] const Aabb& own() const noexcept { return box; }
    [[nodiscard]] double size() const noexcept { return solid.size(); }
    [[nodiscard]] double radius() const noexcept { return 0.0; }
    [[nodiscard]] double reach(const dvec3& n) const noexcept { return solid.reach(n); }
    [[nodiscard]] dvec3 farthest(const dvec3& n) const noexcept { return solid.support(n); }
    [[nodiscard]] bool beside(const NearTriangle& t, double margin) const noexcept {
        return glm::any(glm::greaterThan(t.lower, box.upper + dvec3{margin})) ||
               glm::any(glm::lessThan(t.upper, box.lower - dvec3{margin})) || off_the_plane(*this, t, margin);
    }
    bool axis(Polytope& triangle, double margin, Workspace&, ContactAxis& axis) const {
        return find_axis(solid, triangle, margin, axis, status);
    }
    void patch(const Polytope& triangle, const ContactAxis& axis, const Asked& asked, AxisPoint point, Workspace& workspace,
               Patch& patch) const {
        build_patch(solid, triangle, axis, asked, point, workspace.polygons, patch);
    }
};

// Where the triangle supports the contact along the axis.
dvec3 point_on_triangle(const Polytope& triangle, const ContactAxis& axis) noexcept {
    if (axis.kind == AxisKind::Distance || axis.kind == AxisKind::Edges) return axis.on_b;
    return triangle.vertex(lowest(triangle, axis.normal).number);
}

// The way out of the surface that is left where no triangle has a contact of its own: along the normal of one that the shape meets, to the
// side of the shape's centre. Of triangles that look to the side of the surface on which the centre is, the one of least depth.
struct WayOut {
    bool found = false, facing = false;
    double height = 0.0;  // of the shape over the triangle's plane [m]
    dvec3 outward{0.0};   // unit
    std::uint32_t triangle = 0;

    void offer(const WayOut& other) noexcept {
        if (!found || other.facing > facing || (other.facing == facing && other.height > height)) *this = other;
    }
};

// The contact of one triangle. Its own normal is always allowed, on the side on which the shape's centre lies; another one only
// where the surface is locally highest along it. Otherwise the triangle's normal takes its place, over the triangle alone.
template <class Probe>
bool touch_triangle(const Probe& probe, MeshSurface& surface, const Asked& asked, Workspace& workspace, TrianglePatch& contact,
                    WayOut& way_out) {
    Polytope& triangle = workspace.second;
    const bool above = glm::dot(triangle.normal(0), probe.centre) >= triangle.offset(0);
    const dvec3 outward = triangle.normal(above ? 0 : 1);
    ContactAxis axis;
    if (!probe.axis(triangle, asked.margin, workspace, axis)) return false;

    const bool apart = axis.separation > kTouching * probe.size();
    const bool is_face = axis.kind == AxisKind::FaceOfB || -glm::dot(axis.normal, outward) > kFaceCosine;
    const bool is_other_face = axis.kind == AxisKind::FaceOfB && glm::dot(axis.normal, outward) > 0.0;
    AxisPoint axis_point = AxisPoint::Keep;
    if (is_other_face || (!is_face && !surface.allows(point_on_triangle(triangle, axis), -axis.normal, kPointTolerance * probe.size()))) {
        // The far side of a ridge that the shape reaches across would push it through the surface: the near side speaks for both.
        const bool facing = above == surface.is_in_front(probe.centre);
        const double height = -probe.reach(-outward) - triangle.offset(above ? 0 : 1);  // of the shape over the face; negative below it
        if (axis.separation <= probe.radius() + kTouching * probe.size()) way_out.offer({true, facing, height, outward, contact.triangle});
        if (!facing) return false;
        const ContactAxis rejected = axis;
        // On a flat stretch the deepest point under its plane is the depth, though it may lie over a triangle that the shape does not meet.
        const dvec3 deepest = probe.farthest(-outward);
        const double of_core = height + probe.radius();
        using Foot = MeshSurface::Foot;
        const Foot foot = apart ? Foot::None : surface.foot_at(deepest - of_core * outward, kInsideTolerance * probe.size());
        axis = {AxisKind::FaceOfB, -outward, of_core, deepest, deepest - of_core * outward, 0, above ? 0u : 1u};
        axis_point = foot == Foot::New ? AxisPoint::Keep : AxisPoint::Leave;
        contact.replaced = true;
        contact.way = rejected.normal;
        contact.along = rejected.separation - probe.radius();
        contact.holds_deepest = foot != Foot::None;
    }
    Patch& patch = contact.patch;
    probe.patch(triangle, axis, asked, axis_point, workspace, patch);
    // A shape that does not reach the triangle lies on one side of it, all over it. Where that is not the side of the centre, the
    // heights are those of its far side and mean nothing.
    if (apart && contact.replaced && patch.count > 0 && patch.points[0].separation < -probe.radius()) return false;
    return patch.count > 0;
}

// The deepest point alone, wherever it lies.
template <class Probe>
TrianglePatch patch_of(const Probe& probe, const WayOut& way_out) noexcept {
    TrianglePatch contact;
    contact.triangle = way_out.triangle;
    contact.patch.normal = -way_out.outward;
    const dvec3 middle = probe.farthest(-way_out.outward) - (probe.radius() + 0.5 * way_out.height) * way_out.outward;
    contact.patch.add(middle, way_out.height, feature_name(FeatureKind::Edges, 0, 0));
    return contact;
}

bool faces_away(const NearTriangle& t, const dvec3& centre) noexcept {
    return glm::dot(glm::cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]), centre - t.corners[0]) < 0.0;
}

// Whether the patches are those of a one-sided mesh with the back of its surface towards the shape. Asked last: most pairs have none.
bool touches_back(const PairFrame& pair, const MeshSurface& surface, const dvec3& centre) {
    const TriangleMesh& mesh = *as<TriangleMeshPtr>(pair.second);
    return mesh.is_one_sided() && !surface.patches.empty() && is_behind(mesh, pair.to_second(centre));
}

// Whether the shape does not meet the triangle, or touches it.
template <class Probe>
bool is_free(const Probe& probe, const Corners& corners, Workspace& workspace) {
    ContactAxis axis;
    if (!load_triangle(workspace.second, corners) || !probe.axis(workspace.second, 0.0, workspace, axis)) return true;
    return axis.separation - probe.radius() >= -kPointTolerance * probe.size();
}

// The solid in whose place the mesh stands, if any (detail/solid_mesh.hpp).
template <class Probe>
const ConvexHull* solid_of(const PairFrame& pair, const Probe& probe) {
    return solid_to(*as<TriangleMeshPtr>(pair.second), pair.to_second(probe.centre), glm::transpose(pair.rotation), [&](const dvec3& n) {
        const dvec3 in_first = pair.rotation * n;
        return probe.reach(in_first) - glm::dot(in_first, pair.translation);
    });
}

bool reaches(const PairFrame& pair, const Aabb& bounds, const ConvexHull& solid) noexcept {
    return overlaps(inflate(bounds, pair.margin), solid.local_bounds());
}

// Where the shape is as deep as this share of its size and of its least extent, the way out of the whole is looked for.
constexpr double kDeepShare = 1.0 / 64.0;
constexpr double kThinShare = 1.0 / 16.0;

// Puts a way out of the whole in the place of all patches that are stand-ins or deeper.
template <class Probe>
CollideStatus look_for_a_way_out(const PairFrame& pair, const Probe& probe, const Aabb& bounds, Workspace& workspace) {
    // What meets a convex solid's triangles is in that room, and a one-sided mesh leads to its front alone.
    if (const TriangleMesh& mesh = *as<TriangleMeshPtr>(pair.second); mesh.solid() || mesh.is_one_sided()) return CollideStatus::Ok;
    const Aabb& own = probe.own();
    const dvec3 extent = own.upper - own.lower;
    const double thin = std::min({extent.x, extent.y, extent.z}), tolerance = kPointTolerance * probe.size();
    const double deep = std::min(kDeepShare * probe.size(), kThinShare * thin);
    const auto reach = [&](const dvec3& n) { return probe.reach(n); };
    const auto meets = [&](const Corners& corners, ContactAxis& axis) {
        if (!load_triangle(workspace.second, corners) || !probe.axis(workspace.second, 0.0, workspace, axis)) return false;
        axis.separation -= probe.radius();
        return axis.separation < -tolerance;
    };
    MeshSurface& surface = workspace.surface;
    ShapeWayOut::Way way;
    switch (workspace.shape_ways.find(pair, bounds, surface, {own, probe.centre, thin, deep, tolerance, reach, meets}, way)) {
        case ShapeWayOut::Verdict::Right:
            return CollideStatus::Ok;
        case ShapeWayOut::Verdict::None:
            return CollideStatus::Undecided;
        case ShapeWayOut::Verdict::Other:
            break;
    }
    surface.replace_deeper(way.normal, way.depth, way.middle, deep);
    return CollideStatus::Ok;
}

template <class Probe>
CollideStatus touch_surface(const PairFrame& pair, const Probe& probe, const Aabb& bounds, double same_normal, Workspace& workspace,
                            ManifoldSink& sink) {
    MeshSurface& surface = workspace.surface;
    const bool one_sided = as<TriangleMeshPtr>(pair.second)->is_one_sided();
    WayOut way_out;
    surface.gather(pair, inflate(bounds, pair.margin + kInsideTolerance * probe.size()));
    for (const NearTriangle& t : surface.triangles) {
        if (probe.beside(t, pair.margin) || (one_sided && faces_away(t, probe.centre)) || !load_triangle(workspace.second, t.corners)) {
            continue;
        }
        TrianglePatch contact;
        contact.triangle = t.index;
        if (touch_triangle(probe, surface, pair.asked(), workspace, contact, way_out)) surface.patches.push_back(contact);
    }
    surface.drop_spared(kPointTolerance * probe.size(), [&](const Corners& corners, const dvec3& motion) {
        const Corners moved{corners[0] + motion, corners[1] + motion, corners[2] + motion};
        return is_free(probe, moved, workspace);
    });
    surface.drop_runaways(kPointTolerance * probe.size());
    if (way_out.found && !surface.touches()) surface.patches.push_back(patch_of(probe, way_out));
    if (touches_back(pair, surface, probe.centre)) return CollideStatus::Ok;
    const CollideStatus status = look_for_a_way_out(pair, probe, bounds, workspace);
    surface.emit(same_normal, kPointTolerance * probe.size(), sink);
    return status;
}

CollideStatus polytope_mesh(const PairFrame& pair, const Aabb& own, Workspace& workspace, ManifoldSink& sink) {
    Polytope& polytope = workspace.first;
    const Aabb bounds = bounds_of(polytope, pair.translation, pair.rotation);
    const PolytopeProbe probe{polytope, own, polytope.centre};
    if (const ConvexHull* const solid = solid_of(pair, probe)) {
        if (!reaches(pair, bounds, *solid)) return CollideStatus::Ok;
        load_hull(workspace.second, *solid, pair.rotation, pair.translation);
        return touch_polytopes(pair.asked(), workspace, sink);
    }
    return touch_surface(pair, probe, bounds, kSameNormal, workspace, sink);
}

}  // namespace

CollideStatus box_mesh(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const dvec3 half(as<Box>(pair.first).half_extents);
    load_box(workspace.first, half);
    return polytope_mesh(pair, {-half, half}, workspace, sink);
}

CollideStatus hull_mesh(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const ConvexHull& hull = *as<ConvexHullPtr>(pair.first);
    load_hull(workspace.first, hull);
    return polytope_mesh(pair, hull.local_bounds(), workspace, sink);
}

CollideStatus capsule_mesh(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const Capsule& capsule = as<Capsule>(pair.first);
    const double half = static_cast<double>(capsule.half_segment);
    const RoundSegment core{{{0.0, -half, 0.0}, {0.0, half, 0.0}}, static_cast<double>(capsule.radius)};
    Aabb bounds = add_ball({}, pair.to_second(core.segment.from), core.radius);
    bounds = add_ball(bounds, pair.to_second(core.segment.to), core.radius);
    const SegmentProbe probe{core};
    if (const ConvexHull* const solid = solid_of(pair, probe)) {
        return reaches(pair, bounds, *solid) ? capsule_hull(pair, *solid, workspace, sink) : CollideStatus::Ok;
    }
    return touch_surface(pair, probe, bounds, kSameRoundNormal, workspace, sink);
}

CollideStatus turned_mesh(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const TruncatedCone solid = truncated_cone(pair.first, dmat3{1.0}, dvec3{0.0});
    const Aabb own = box_of(solid);
    // The same solid in the mesh's frame, for the box that the mesh is asked with.
    const TruncatedCone in_mesh = truncated_cone(pair.first, glm::transpose(pair.rotation), pair.to_second(dvec3{0.0}));
    const Aabb bounds = box_of(in_mesh);
    CollideStatus status = CollideStatus::Ok;
    const TurnedProbe probe{solid, own, status};
    if (const ConvexHull* const hull = solid_of(pair, probe)) {
        return reaches(pair, bounds, *hull) ? turned_hull(pair, *hull, workspace, sink) : CollideStatus::Ok;
    }
    return std::max(touch_surface(pair, probe, bounds, kSameRoundNormal, workspace, sink), status);
}

CollideStatus sphere_mesh(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const double radius = static_cast<double>(as<Sphere>(pair.first).radius);
    MeshSurface& surface = workspace.surface;
    const TriangleMesh& mesh = *as<TriangleMeshPtr>(pair.second);
    const bool one_sided = mesh.is_one_sided();
    // Of what has its centre outside the nearest point is the depth, of a surface as of a solid.
    if (const dvec3 centre = pair.to_second(dvec3{0.0}); mesh.solid() && !one_sided && is_in(*mesh.solid(), centre)) {
        const auto reach = [&](const dvec3& n) { return glm::dot(centre, n) + radius; };
        if (!has_room(*mesh.solid(), reach)) return sphere_hull(pair, *mesh.solid(), workspace, sink);
    }
    surface.gather(pair, inflate(add_ball({}, pair.to_second(dvec3{0.0}), radius), pair.margin + kInsideTolerance * radius));
    for (const NearTriangle& t : surface.triangles) {
        if (one_sided && faces_away(t, dvec3{0.0})) continue;
        const TrianglePoint closest = closest_on_triangle(t.corners, dvec3{0.0});
        const dvec3 cross = glm::cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]);
        // With the centre on the surface, out to the front of the triangle.
        Direction direction = direction_of(closest.point, -direction_of(cross, {0.0, 1.0, 0.0}).unit);
        if (direction.length - radius > pair.margin) continue;
        if (!closest.inside && direction.length > 0.0 && !surface.allows(closest.point, -direction.unit, kPointTolerance * radius)) {
            continue;  // a neighbour is nearer
        }
        TrianglePatch contact;
        contact.triangle = t.index;
        contact.patch.normal = direction.unit;
        add_ball(contact.patch, dvec3{0.0}, radius, direction.length, 0);
        surface.patches.push_back(contact);
    }
    if (touches_back(pair, surface, dvec3{0.0})) return CollideStatus::Ok;
    surface.emit(kSameRoundNormal, kPointTolerance * radius, sink);
    return CollideStatus::Ok;
}

}  // namespace carom::detail
