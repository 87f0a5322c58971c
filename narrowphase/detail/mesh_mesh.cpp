// A triangle mesh against another one.
//
// Method. Leaders first (mesh_leaders.hpp): pairs of features along whose normal the one surface can leave the other. The deepest one
// takes along all whose normals lie close to its own, and the faces that look at each other along it are cut against each other for
// the rest of the patch; then the deepest of those that are left.
#include <carom/collision/mesh_pairs.hpp>
#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/mesh_leaders.hpp>
#include <carom/narrowphase/detail/one_sided.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace carom::detail {
namespace {

// Overlaps are looked for down to this share of the smaller mesh's box.
constexpr double kDepthShare = 0.25;

// Contacts are looked for within this share of the smaller mesh's box first, and within more and more of the margin while there are none.
constexpr double kNearShare = 1.0 / 64.0;
constexpr double kNearGrowth = 3.0;

// Where the two are deeper in each other than this share of the smaller one's box, a way out of the whole is looked for.
constexpr double kDeepShare = 1.0 / 64.0;

// How much farther out a point has to be for each length that it is higher, to be chosen: what rocks by less than 1/128 of a radian
// touches with what is lower first. With 8 and 32 teapots rocked on for good, at 0.06 and 0.03 m/s in the mean; with 1/4 of the way kept, at 0.03.
constexpr double kDrawIn = 128.0;

struct MeshBox {
    dvec3 centre{0.0};
    double diagonal = 0.0;
};

MeshBox box_of(const TriangleMesh& mesh) noexcept {
    const Aabb& box = mesh.local_bounds();
    return {0.5 * (box.lower + box.upper), glm::length(box.upper - box.lower)};
}

// A triangle as the polygon code sees it.
struct FaceOfMesh {
    std::array<FaceCorner, 3> corners;

    FaceOfMesh(const PlacedFace& face, const ContactPlane& plane) noexcept {
        for (std::size_t k = 0; k < 3; ++k) {
            const dvec3& p = face.corners[k];
            corners[k] = {p, glm::dot(p, plane.axis_u), glm::dot(p, plane.axis_w), face.names[k], face.edges[k]};
        }
    }
};

// Adds the points that two triangles have in common along the normal, where they look at each other.
void add_face_points(const PlacedFace& a, const PlacedFace& b, const ContactPlane& plane, std::vector<Candidate>& points) {
    if (!share_points(glm::dot(a.normal, plane.normal), -glm::dot(b.normal, plane.normal))) return;
    const FaceOfMesh first(a, plane), second(b, plane);
    std::array<double, 18> sides{};
    collect_face_contact({first.corners, a.normal, glm::dot(a.normal, a.corners[0])},
                         {second.corners, b.normal, glm::dot(b.normal, b.corners[0])}, plane, sides, points);
}

// A surface that is not flat touches with what is lowest first, and what is farther out but higher only once it leans over. So what is chosen from
// are points drawn in towards their middle, by kDrawIn times how much higher than the lowest they are. Of equal height they stay where they are.
void draw_in(std::span<Candidate> points) {
    if (points.size() <= kMaxManifoldPoints) return;
    double lowest = std::numeric_limits<double>::infinity(), u = 0.0, w = 0.0;
    for (const Candidate& p : points) {
        lowest = std::min(lowest, p.separation);
        u += p.u / static_cast<double>(points.size());
        w += p.w / static_cast<double>(points.size());
    }
    for (Candidate& p : points) {
        const double out = std::sqrt((p.u - u) * (p.u - u) + (p.w - w) * (p.w - w));
        if (!(out > 0.0)) continue;
        const double kept = std::max(0.0, 1.0 - kDrawIn * (p.separation - lowest) / out);
        p.u = u + kept * (p.u - u);
        p.w = w + kept * (p.w - w);
    }
}

// Emits one manifold for each group of leaders.
void emit_patches(MeshContact& contact, const LeaderLimits& limits, bool steady, std::vector<Candidate>& points, ManifoldSink& sink) {
    std::vector<Leader>& leaders = contact.finder.leaders;
    double floor = -std::numeric_limits<double>::infinity();  // of what leads out of the whole
    for (const Leader& l : leaders) {
        if (l.of_whole) floor = l.separation;
    }
    for (;;) {
        Leader* deepest = nullptr;
        for (Leader& l : leaders) {
            if (!l.used && (deepest == nullptr || l.separation < deepest->separation)) deepest = &l;
        }
        if (deepest == nullptr) return;
        const ContactPlane plane = contact_plane(deepest->normal, limits.margin, limits.tolerance);
        points.clear();
        const PlacedFaces& faces = contact.faces;
        for (const FacePair& pair : faces.pairs) add_face_points(faces.first[pair.a], faces.second[pair.b], plane, points);
        // Faces on far sides of thin parts look at each other too, from behind.
        const double least = std::max(floor, std::min(2.0 * deepest->separation, deepest->separation)) - limits.tolerance;
        std::erase_if(points, [&](const Candidate& c) { return c.separation < least; });
        for (Leader& l : leaders) {
            const double cosine = glm::dot(l.normal, plane.normal);
            if (l.used || (&l != deepest && cosine < kSameNormal)) continue;
            l.used = true;
            points.push_back({l.position, &l == deepest ? l.separation : l.separation * cosine, glm::dot(l.position, plane.axis_u),
                              glm::dot(l.position, plane.axis_w), l.feature});
        }
        draw_in(points);
        Chosen chosen{};
        const int count = reduce_points(points, limits.tolerance, outline_start(plane.normal, plane.axis_u, plane.axis_w),
                                        overlook(steady, limits.tolerance / kPointTolerance), chosen);
        Patch patch;
        patch.normal = plane.normal;
        for (int i = 0; i < count; ++i) {
            const Candidate& c = points[static_cast<std::size_t>(chosen[static_cast<std::size_t>(i)])];
            patch.add(c.position, c.separation, c.feature);
        }
        sink.add(patch);
    }
}

// Whether the second mesh's box, as it lies, meets that of the first.
bool boxes_meet(const PairFrame& pair, const TriangleMesh& a, const TriangleMesh& b) noexcept {
    const Aabb &own = a.local_bounds(), &other = b.local_bounds();
    const dvec3 half = 0.5 * (other.upper - other.lower), centre = pair.to_first(0.5 * (other.lower + other.upper));
    const dvec3 reach = glm::abs(pair.rotation[0]) * half.x + glm::abs(pair.rotation[1]) * half.y + glm::abs(pair.rotation[2]) * half.z;
    return overlaps(own, Aabb{centre - reach, centre + reach});
}

// Sets the two sides.
void set_sides(const PairFrame& pair, MeshContact& contact) {
    const TriangleMesh &a = *as<TriangleMeshPtr>(pair.first), &b = *as<TriangleMeshPtr>(pair.second);
    const MeshBox first = box_of(a), second = box_of(b);
    contact.first.set(a, dmat3{1.0}, dvec3{0.0}, {pair.to_first(second.centre), second.diagonal});
    contact.second.set(b, pair.rotation, pair.translation, {first.centre, first.diagonal});
}

// Whether one of the two is one-sided and has its back towards the other's centre.
bool shows_back(const PairFrame& pair, const TriangleMesh& a, const TriangleMesh& b) {
    return (a.is_one_sided() && is_behind(a, pair.to_first(box_of(b).centre))) ||
           (b.is_one_sided() && is_behind(b, pair.to_second(box_of(a).centre)));
}

// Leaders see what is around them: of what is deep in each other, features are led out that the whole would take another way. Where there is
// a way out of the whole, it takes the place of all that is deeper.
// @return Undecided where none is known and the leaders do not lead out.
CollideStatus add_way_out(const PairFrame& pair, const LeaderLimits& limits, double smaller, const Pose& b_in_a, Workspace& workspace) {
    MeshContact& contact = workspace.meshes;
    std::vector<Leader>& leaders = contact.finder.leaders;
    if (contact.meeting.empty()) return CollideStatus::Ok;
    const TriangleMesh &a = *as<TriangleMeshPtr>(pair.first), &b = *as<TriangleMeshPtr>(pair.second);
    const auto meets = [&](const dvec3& motion) {
        return meshes_overlap(a.bvh(), b.bvh(), {b_in_a.position - motion, b_in_a.orientation});
    };
    const std::optional<Leader> way = workspace.ways.find(contact.finder, contact.faces, {kDeepShare * smaller, limits.tolerance}, meets);
    if (!way) return workspace.ways.unfreed() ? CollideStatus::Undecided : CollideStatus::Ok;
    // What is as deep along the same way stays: it holds the other corners.
    std::erase_if(leaders, [&](const Leader& l) {
        const bool along = glm::dot(l.normal, way->normal) > kFaceCosine && l.separation >= way->separation - limits.tolerance;
        return l.separation < way->separation + limits.tolerance && !along;
    });
    leaders.push_back(*way);
    return CollideStatus::Ok;
}

// Of two meshes whose surfaces are apart: one that lies wholly inside of another that is closed is led out by its first vertex.
CollideStatus look_inside(const PairFrame& pair, const LeaderLimits& limits, Workspace& workspace, ManifoldSink& sink) {
    const TriangleMesh &a = *as<TriangleMeshPtr>(pair.first), &b = *as<TriangleMeshPtr>(pair.second);
    const bool inner_is_first = box_of(a).diagonal <= box_of(b).diagonal;
    if (!(inner_is_first ? b : a).is_closed() || !boxes_meet(pair, a, b)) return CollideStatus::Ok;
    MeshContact& contact = workspace.meshes;
    set_sides(pair, contact);
    const MeshSide &inner = inner_is_first ? contact.first : contact.second, &outer = inner_is_first ? contact.second : contact.first;
    const std::uint32_t vertex = inner.mesh().triangles()[0][0];
    const std::optional<SurfacePoint> nearest =
        outer.measure(inner.to_pair(inner.mesh().vertices()[vertex]), std::numeric_limits<double>::infinity());
    if (!nearest || nearest->separation >= 0.0) return CollideStatus::Ok;
    contact.finder.add_way_out(inner, vertex, *nearest, inner_is_first);
    contact.faces.pairs.clear();
    emit_patches(contact, limits, pair.steady, workspace.polygons.candidates, sink);
    return CollideStatus::Undecided;
}

}  // namespace

CollideStatus mesh_mesh(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const TriangleMesh &a = *as<TriangleMeshPtr>(pair.first), &b = *as<TriangleMeshPtr>(pair.second);
    if (shows_back(pair, a, b)) return CollideStatus::Ok;
    if (a.solid() && b.solid()) return hull_hull(pair, *a.solid(), *b.solid(), workspace, sink);
    MeshContact& contact = workspace.meshes;
    const double smaller = std::min(box_of(a).diagonal, box_of(b).diagonal);
    LeaderLimits limits;
    limits.tolerance = kPointTolerance * smaller;
    CollideStatus status = CollideStatus::Ok;
    const Pose b_in_a{pair.translation, glm::quat_cast(pair.rotation)};

    // Nearest first: what is farther than the first contacts by more than a share of the size says nothing.
    for (double margin = std::min(pair.margin, kNearShare * smaller);; margin = std::min(pair.margin, kNearGrowth * margin)) {
        const double reach = margin + limits.tolerance;  // the pose is rounded
        near_pairs(a.bvh(), b.bvh(), b_in_a, reach, contact.near);
        if (!contact.near.empty()) {
            set_sides(pair, contact);
            limits.margin = margin;
            limits.depth = std::max(margin, kDepthShare * smaller);
            overlapping_pairs(a.bvh(), b.bvh(), b_in_a, contact.meeting);
            contact.faces.place(contact.first, contact.second, contact.near, contact.meeting, reach);
            contact.finder.find(contact.first, contact.second, limits, contact.faces, contact.meeting);
            if (contact.finder.leaders.empty() && !contact.meeting.empty()) {
                contact.finder.add_parting(contact.first, contact.second, contact.meeting.front());
            }
            if (!contact.finder.leaders.empty()) {
                status = add_way_out(pair, limits, smaller, b_in_a, workspace);
                break;
            }
        }
        if (margin < pair.margin) continue;
        return look_inside(pair, limits, workspace, sink);
    }
    emit_patches(contact, limits, pair.steady, workspace.polygons.candidates, sink);
    return contact.finder.incomplete ? CollideStatus::Undecided : status;
}

}  // namespace carom::detail
