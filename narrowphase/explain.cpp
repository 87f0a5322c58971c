#include <carom/narrowphase/explain.hpp>

#include <carom/collision/compound.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/check.hpp>
#include <carom/narrowphase/detail/check_pair.hpp>
#include <carom/narrowphase/detail/mesh_gap.hpp>
#include <carom/narrowphase/detail/one_sided.hpp>
#include <carom/narrowphase/detail/piece_pair.hpp>
#include <carom/narrowphase/detail/solid_mesh.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace carom {
namespace {

using detail::ConvexPiece;
using detail::HalfSpace;
using detail::PieceFinding;

/// What collide() may differ by, of the size: its accuracy, twice; where a side or a rim touches smoothly, what its normal is good to.
constexpr double kAccuracy = 4e-6;
constexpr double kSmoothAccuracy = 2e-5;

struct Placed {
    const Shape& shape;
    dmat3 axes{1.0};
    dvec3 origin{0.0};  // from A's
};

struct Part {
    ConvexPiece piece;
    std::uint32_t number = 0;
    dmat3 axes{1.0};  // of its own frame
};

/// The two pieces that come nearest.
struct Nearest {
    bool found = false;
    PieceFinding finding;
    std::uint32_t part_a = 0, part_b = 0, triangle = 0;
    ConvexPiece a, b;  // b: nothing of a plane
    bool back_face = false;
    bool of_solid = false;  // the mesh stands for the solid that it bounds
    double size = 0.0;      // of what the accuracy is a share, where it is not the pieces' own
    std::uint32_t triangle_b = 0;

    /// Whether what is `gap` away at least cannot take its place: what a one-sided mesh turns its front to goes before all else.
    [[nodiscard]] bool stays(bool is_back, double gap) const { return found && (is_back != back_face ? is_back : gap >= finding.axis.gap); }
};

bool is_mesh(const Shape& shape) { return type_of(shape) == ShapeType::TriangleMesh; }

bool is_solid(const Shape& shape) { return type_of(shape) == ShapeType::Compound || is_convex_solid(type_of(shape)); }

std::vector<Part> parts_of(const Placed& placed) {
    const CompoundPtr* compound = std::get_if<CompoundPtr>(&placed.shape);
    if (compound == nullptr) return {{detail::make_piece(placed.shape, placed.axes, placed.origin), 0, placed.axes}};
    std::vector<Part> parts;
    for (const CompoundPart& part : (*compound)->parts()) {
        const dmat3 axes = placed.axes * glm::mat3_cast(part.pose.orientation);
        const dvec3 origin = placed.origin + placed.axes * part.pose.position;
        parts.push_back({detail::make_piece(part.shape, axes, origin), static_cast<std::uint32_t>(parts.size()), axes});
    }
    return parts;
}

/// A lower bound of the gap between what two boxes hold.
double box_gap(const Aabb& a, const Aabb& b) {
    const dvec3 gap = glm::max(b.lower - a.upper, a.lower - b.upper);
    return std::max({gap.x, gap.y, gap.z});
}

std::vector<dvec3> contact_normals(const std::vector<Manifold>& manifolds, std::uint32_t part_a, std::uint32_t part_b) {
    std::vector<dvec3> normals;
    for (const Manifold& m : manifolds) {
        if (m.part_a == part_a && m.part_b == part_b) normals.emplace_back(m.normal);
    }
    return normals;
}

Nearest nearest_solids(const Placed& a, const Placed& b, const std::vector<Manifold>& manifolds) {
    Nearest best;
    const std::vector<Part> of_b = parts_of(b);
    for (Part& p : parts_of(a)) {
        for (const Part& q : of_b) {
            if (best.found && box_gap(p.piece.box, q.piece.box) > best.finding.axis.gap) continue;
            PieceFinding finding = detail::compare(p.piece, q.piece, contact_normals(manifolds, p.number, q.number));
            if (best.found && !(finding.axis.gap < best.finding.axis.gap)) continue;
            best = {true, std::move(finding), p.number, q.number, 0, p.piece, q.piece};
        }
    }
    return best;
}

HalfSpace half_space(const Placed& plane) {
    const Plane& p = std::get<Plane>(plane.shape);
    const dvec3 normal = plane.axes * dvec3(p.normal);
    return {normal, static_cast<double>(p.offset) + glm::dot(normal, plane.origin)};
}

Nearest nearest_to_plane(const Placed& solid, const Placed& plane) {
    const HalfSpace half = half_space(plane);
    Nearest best;
    for (const Part& part : parts_of(solid)) {
        PieceFinding finding = detail::compare(part.piece, half);
        if (best.found && !(finding.axis.gap < best.finding.axis.gap)) continue;
        best = {true, std::move(finding), part.number, 0, 0, part.piece, {}};
    }
    return best;
}

std::array<dvec3, 3> corners_of(const Placed& mesh, std::uint32_t triangle) {
    std::array<dvec3, 3> corners{};
    const auto own = std::get<TriangleMeshPtr>(mesh.shape)->corners(triangle);
    for (std::size_t k = 0; k < 3; ++k) corners[k] = mesh.origin + mesh.axes * dvec3(own[k]);
    return corners;
}

/// The triangle that reaches deepest into a half-space.
Nearest nearest_of_mesh_to_plane(const Placed& mesh, const Placed& plane) {
    const HalfSpace half = half_space(plane);
    std::optional<std::uint32_t> deepest;
    double least = 0.0;
    for (std::uint32_t t = 0; t < std::get<TriangleMeshPtr>(mesh.shape)->triangles().size(); ++t) {
        for (const dvec3& corner : corners_of(mesh, t)) {
            const double height = glm::dot(half.normal, corner);
            if (deepest && !(height < least)) continue;
            deepest = t;
            least = height;
        }
    }
    Nearest best;
    best.found = true;
    best.triangle = *deepest;  // a mesh has at least one
    best.a = detail::make_triangle(corners_of(mesh, *deepest));
    best.finding = detail::compare(best.a, half);
    return best;
}

/// Looks at the triangles near one part, farther and farther out until one is nearer than what was looked at.
void look_at_triangles(const Part& part, const Placed& mesh, double reach, const std::vector<Manifold>& manifolds, bool swapped, Nearest& best) {
    const TriangleMesh& triangles = *std::get<TriangleMeshPtr>(mesh.shape);
    const dvec3 middle = (0.5 * (part.piece.box.lower + part.piece.box.upper) - mesh.origin) * mesh.axes;
    const double radius = 0.5 * glm::length(part.piece.box.upper - part.piece.box.lower);
    const dvec3 centre = (part.piece.centre() - mesh.origin) * mesh.axes;
    const bool is_behind = triangles.is_one_sided() && detail::is_behind(triangles, centre);
    const std::vector<dvec3> normals = swapped ? contact_normals(manifolds, 0, part.number) : contact_normals(manifolds, part.number, 0);
    std::vector<dvec3> towards_mesh = normals;
    if (swapped) {
        for (dvec3& n : towards_mesh) n = -n;
    }
    const Aabb& whole = triangles.local_bounds();
    for (double r = std::max(reach, 1e-3 * radius);; r *= 8.0) {
        const Aabb around = inflate(Aabb{middle, middle}, radius + r);
        triangles.overlap(around, [&](std::uint32_t t) {
            const std::array<dvec3, 3> corners = corners_of(mesh, t);
            Aabb box;
            for (const dvec3& corner : corners) box = merge(box, {corner, corner});
            const bool is_back = is_behind || (triangles.is_one_sided() && detail::is_behind(triangles, t, centre));
            if (best.stays(is_back, box_gap(part.piece.box, box))) return true;
            ConvexPiece triangle = detail::make_triangle(corners);
            if (!triangle.polytope) return true;  // without an area it collides with nothing
            PieceFinding finding = detail::compare(part.piece, triangle, towards_mesh);
            if (best.stays(is_back, finding.axis.gap)) return true;
            best = {true, std::move(finding), part.number, 0, t, part.piece, std::move(triangle), is_back};
            return true;
        });
        const bool all = glm::all(glm::lessThanEqual(around.lower, whole.lower)) && glm::all(glm::greaterThanEqual(around.upper, whole.upper));
        if (all || (best.found && (is_behind || !best.back_face) && best.finding.axis.gap <= r)) return;
    }
}

/// The solid in whose place the mesh stands before one part, if any.
const ConvexHull* solid_before(const Part& part, const Placed& mesh) {
    const auto own = [&](const dvec3& p) { return (p - mesh.origin) * mesh.axes; };
    const dmat3 axes = glm::transpose(mesh.axes) * part.axes;
    return detail::solid_to(*std::get<TriangleMeshPtr>(mesh.shape), own(part.piece.centre()), axes, [&](const dvec3& n) {
        const dvec3 direction = mesh.axes * n;
        return part.piece.reach(direction) - glm::dot(direction, mesh.origin);
    });
}

Nearest nearest_to_mesh(const Placed& solid, const Placed& mesh, double margin, const std::vector<Manifold>& manifolds, bool swapped) {
    Nearest best;
    for (const Part& part : parts_of(solid)) {
        if (solid_before(part, mesh) == nullptr) {
            look_at_triangles(part, mesh, margin, manifolds, swapped, best);
            continue;
        }
        Nearest here;  // for the triangle
        look_at_triangles(part, mesh, margin, manifolds, swapped, here);
        if (!here.found) continue;
        std::vector<dvec3> normals = swapped ? contact_normals(manifolds, 0, part.number) : contact_normals(manifolds, part.number, 0);
        if (swapped) {
            for (dvec3& n : normals) n = -n;
        }
        here.b = detail::make_piece(std::get<TriangleMeshPtr>(mesh.shape)->solid(), mesh.axes, mesh.origin);
        here.finding = detail::compare(part.piece, here.b, normals);
        here.back_face = false;
        here.of_solid = true;
        if (!best.stays(false, here.finding.axis.gap)) best = std::move(here);
    }
    return best;
}

Nearest swapped(Nearest n) {
    n.finding = detail::swapped(std::move(n.finding));
    std::swap(n.part_a, n.part_b);
    std::swap(n.a, n.b);
    return n;
}

/// Whether a mesh is one-sided and has its back towards the middle of another one.
bool shows_back(const Placed& mesh, const Placed& other) {
    const TriangleMesh &own = *std::get<TriangleMeshPtr>(mesh.shape), &that = *std::get<TriangleMeshPtr>(other.shape);
    if (!own.is_one_sided()) return false;
    const Aabb& box = that.local_bounds();
    const dvec3 middle = other.origin + other.axes * (0.5 * (box.lower + box.upper));
    return detail::is_behind(own, (middle - mesh.origin) * mesh.axes);
}

Nearest nearest_meshes(const Placed& a, const Placed& b, const std::vector<Manifold>& manifolds) {
    const TriangleMesh &of_a = *std::get<TriangleMeshPtr>(a.shape), &of_b = *std::get<TriangleMeshPtr>(b.shape);
    std::optional<detail::MeshGap> gap = detail::compare_meshes({of_a, a.axes, a.origin}, {of_b, b.axes, b.origin}, manifolds);
    Nearest best;
    best.back_face = shows_back(a, b) || shows_back(b, a);
    if (!gap) return best;
    best.found = true;
    best.finding = std::move(gap->finding);
    best.a = std::move(gap->a);
    best.b = std::move(gap->b);
    best.triangle = gap->triangle_a;
    best.triangle_b = gap->triangle_b;
    best.of_solid = gap->of_solids;
    for (const TriangleMesh* mesh : {&of_a, &of_b}) best.size = std::max(best.size, glm::length(mesh->local_bounds().upper - mesh->local_bounds().lower));
    return best;
}

Nearest find_nearest(const Placed& a, const Placed& b, double margin, const std::vector<Manifold>& manifolds) {
    const ShapeType type_a = type_of(a.shape), type_b = type_of(b.shape);
    if (is_solid(a.shape) && is_solid(b.shape)) return nearest_solids(a, b, manifolds);
    if (is_solid(a.shape) && type_b == ShapeType::Plane) return nearest_to_plane(a, b);
    if (is_solid(b.shape) && type_a == ShapeType::Plane) return swapped(nearest_to_plane(b, a));
    if (is_solid(a.shape) && type_b == ShapeType::TriangleMesh) return nearest_to_mesh(a, b, margin, manifolds, false);
    if (is_solid(b.shape) && type_a == ShapeType::TriangleMesh) return swapped(nearest_to_mesh(b, a, margin, manifolds, true));
    if (type_a == ShapeType::TriangleMesh && type_b == ShapeType::Plane) return nearest_of_mesh_to_plane(a, b);
    if (type_b == ShapeType::TriangleMesh && type_a == ShapeType::Plane) return swapped(nearest_of_mesh_to_plane(b, a));
    return nearest_meshes(a, b, manifolds);
}

const Manifold* deepest(const std::vector<Manifold>& manifolds, float& separation) {
    const Manifold* best = nullptr;
    for (const Manifold& m : manifolds) {
        for (const ContactPoint& p : m.used()) {
            if (best != nullptr && !(p.separation < separation)) continue;
            best = &m;
            separation = p.separation;
        }
    }
    return best;
}

std::optional<FacePatch> patch_of(const Nearest& nearest, const Manifold& manifold, const Placed& a, const Placed& b) {
    double height = 0.0;
    const dvec3 normal(manifold.normal);
    for (const ContactPoint& p : manifold.used()) height += glm::dot(dvec3(p.position), normal) / manifold.count;
    if (!is_solid(a.shape) || !is_solid(b.shape)) return detail::common_patch(nearest.a, nearest.b, normal, height);
    return detail::common_patch(parts_of(a)[manifold.part_a].piece, parts_of(b)[manifold.part_b].piece, normal, height);
}

/// What collide() has to have said of the pieces that come nearest.
std::string disagreement_of(const ShapePair& pair, const Nearest& nearest, CollideStatus status, const Manifold* deepest_one, float separation) {
    if (nearest.back_face) return deepest_one == nullptr ? "" : "contacts are reported although the mesh is one-sided and shows its back";
    const ShapeType type_a = type_of(*pair.a), type_b = type_of(*pair.b);
    const bool smooth = nearest.a.turned.has_value() || nearest.b.turned.has_value();
    const bool are_meshes = is_mesh(*pair.a) && is_mesh(*pair.b);
    double size = std::max({nearest.a.size(), nearest.b.size(), nearest.size});
    if (type_a == ShapeType::Plane || type_b == ShapeType::Plane) size = type_a == ShapeType::Plane ? nearest.b.size() : nearest.a.size();
    const double tolerance = (smooth ? kSmoothAccuracy : kAccuracy) * size;
    const double gap = nearest.finding.axis.gap, margin = static_cast<double>(pair.margin);
    if (deepest_one != nullptr && gap > margin + tolerance) return "contacts are reported although the two are farther apart than the margin";
    if (deepest_one == nullptr && gap < margin - tolerance) return "no contact is reported although the two are nearer than the margin";
    const bool of_mesh = !nearest.of_solid && (type_a == ShapeType::TriangleMesh || type_b == ShapeType::TriangleMesh);
    // Where surfaces of meshes meet, the axis is that of the deepest contact.
    if (deepest_one == nullptr || (of_mesh && !are_meshes) || status != CollideStatus::Ok) return "";
    return std::abs(static_cast<double>(separation) - gap) <= tolerance ? "" : "the deepest contact is not as deep as the two overlap along the best axis";
}

}  // namespace

PairExplanation explain(const ShapePair& pair) {
    const detail::PairFault fault = detail::fault_of(pair);
    CAROM_REQUIRE(fault.what == nullptr, fault.code, fault.what, {});
    PairExplanation why;
    why.margin = static_cast<double>(pair.margin);
    why.status = collide(pair, 0, why.manifolds);
    const dvec3 between = pair.pose_b.position - pair.pose_a.position;
    if (!is_finite(between)) {  // farther apart than numbers go
        why.verdict = PairVerdict::Apart;
        return why;
    }
    const Placed a{*pair.a, glm::mat3_cast(pair.pose_a.orientation), dvec3{0.0}};
    const Placed b{*pair.b, glm::mat3_cast(pair.pose_b.orientation), between};
    Nearest nearest = find_nearest(a, b, why.margin, why.manifolds);
    float separation = 0.0f;
    const Manifold* deepest_one = deepest(why.manifolds, separation);
    if (!nearest.found) {  // a mesh without areas, or meshes farther apart than numbers go: what collide() says is all that is known
        why.verdict = deepest_one == nullptr || separation > 0.0f ? PairVerdict::Apart : PairVerdict::Touching;
        why.back_face = nearest.back_face;
        return why;
    }
    why.verdict = nearest.finding.verdict;
    why.part_a = nearest.part_a;
    why.part_b = nearest.part_b;
    why.triangle = nearest.triangle;
    why.triangle_b = nearest.triangle_b;
    why.back_face = nearest.back_face;
    why.disagreement = disagreement_of(pair, nearest, why.status, deepest_one, separation);
    const bool are_surfaces = is_mesh(*pair.a) && is_mesh(*pair.b) && !nearest.of_solid;  // whose patches are of many triangles
    if (deepest_one != nullptr && !are_surfaces) why.patch = patch_of(nearest, *deepest_one, a, b);
    why.distance = std::move(nearest.finding.distance);
    why.axis = nearest.finding.axis;
    return why;
}

const char* to_string(PairVerdict verdict) noexcept {
    switch (verdict) {
        case PairVerdict::Apart: return "apart";
        case PairVerdict::Touching: return "touching";
        case PairVerdict::Undecided: return "undecided";
    }
    return "unknown";
}

const char* to_string(SupportKind kind) noexcept {
    switch (kind) {
        case SupportKind::Corner: return "corner";
        case SupportKind::Edge: return "edge";
        case SupportKind::Face: return "face";
        case SupportKind::Round: return "round";
    }
    return "unknown";
}

const char* to_string(AxisSource source) noexcept {
    switch (source) {
        case AxisSource::FaceOfA: return "face of A";
        case AxisSource::FaceOfB: return "face of B";
        case AxisSource::Edges: return "edges";
        case AxisSource::Points: return "points";
        case AxisSource::Contact: return "contact";
    }
    return "unknown";
}

}  // namespace carom
