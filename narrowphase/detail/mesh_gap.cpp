#include <carom/narrowphase/detail/mesh_gap.hpp>

#include <carom/collision/bvh_queries.hpp>
#include <carom/collision/mesh_closest.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace carom::detail {
namespace {

dvec3 to_own(const PlacedMesh& placed, const dvec3& p) { return (p - placed.origin) * placed.axes; }

/// The deepest point of all manifolds.
struct Deepest {
    dvec3 position{0.0}, normal{0.0};
    double separation = 0.0;
};

std::optional<Deepest> deepest_of(std::span<const Manifold> manifolds) {
    std::optional<Deepest> best;
    for (const Manifold& m : manifolds) {
        for (const ContactPoint& p : m.used()) {
            const auto separation = static_cast<double>(p.separation);
            if (!best || separation < best->separation) best = {dvec3(p.position), dvec3(m.normal), separation};
        }
    }
    return best;
}

std::optional<ClosestOfMeshes> closest_of(const PlacedMesh& a, const PlacedMesh& b) {
    const Pose b_in_a{to_own(a, b.origin), glm::quat_cast(glm::transpose(a.axes) * b.axes)};
    std::optional<ClosestOfMeshes> closest = closest_pair(a.mesh.bvh(), b.mesh.bvh(), b_in_a);
    if (!closest) return closest;
    closest->on_a = a.origin + a.axes * closest->on_a;
    closest->on_b = a.origin + a.axes * closest->on_b;
    return closest;
}

std::vector<dvec3> normals_of(std::span<const Manifold> manifolds) {
    std::vector<dvec3> normals;
    for (const Manifold& m : manifolds) normals.emplace_back(m.normal);
    return normals;
}

void take_triangles(const PlacedMesh& a, const PlacedMesh& b, const TrianglePair& triangles, MeshGap& gap) {
    gap.triangle_a = triangles.a;
    gap.triangle_b = triangles.b;
    gap.a = make_triangle(a.corners(triangles.a));
    gap.b = make_triangle(b.corners(triangles.b));
}

/// Meshes are apart by more than what rounding does to their distance where the least of all triangles' distances is.
void note_distance(const ClosestOfMeshes& closest, MeshGap& gap) {
    DistanceBounds& distance = gap.finding.distance;
    distance.lower = closest.lower;
    distance.upper = 2.0 * closest.distance - closest.lower;
    distance.on_a = closest.on_a;
    distance.on_b = closest.on_b;
    distance.cores_overlap = !(closest.distance > 0.0);
}

/// Where surfaces meet, no axis parts the two; what the deepest contact says is the way out.
void take_contact(const PlacedMesh& a, const PlacedMesh& b, const Deepest& deepest, MeshGap& gap) {
    SeparatingAxis& axis = gap.finding.axis;
    axis.source = AxisSource::Contact;
    axis.normal = vec3(deepest.normal);
    axis.gap = deepest.separation;
    axis.on_a = deepest.position - 0.5 * deepest.separation * deepest.normal;
    axis.on_b = deepest.position + 0.5 * deepest.separation * deepest.normal;
    const std::optional<ClosestOnMesh> of_a = closest_point(a.mesh.bvh(), to_own(a, axis.on_a)),
                                       of_b = closest_point(b.mesh.bvh(), to_own(b, axis.on_b));
    if (of_a && of_b) take_triangles(a, b, {of_a->triangle, of_b->triangle}, gap);
    axis.of_a = gap.a.support(deepest.normal).feature;
    axis.of_b = gap.b.support(-deepest.normal).feature;
    axis.verdict = axis.gap > axis.rounding    ? PairVerdict::Apart
                   : axis.gap < -axis.rounding ? PairVerdict::Touching
                                               : PairVerdict::Undecided;
}

}  // namespace

std::array<dvec3, 3> PlacedMesh::corners(std::uint32_t triangle) const {
    std::array<dvec3, 3> corners{};
    const auto own = mesh.corners(triangle);
    for (std::size_t k = 0; k < 3; ++k) corners[k] = origin + axes * dvec3(own[k]);
    return corners;
}

std::optional<MeshGap> compare_meshes(const PlacedMesh& a, const PlacedMesh& b, std::span<const Manifold> manifolds) {
    const std::optional<ClosestOfMeshes> closest = closest_of(a, b);
    if (!closest) return std::nullopt;
    MeshGap gap;
    take_triangles(a, b, closest->triangles, gap);
    if (a.mesh.solid() && b.mesh.solid()) {
        gap.of_solids = true;
        gap.a = make_piece(a.mesh.solid(), a.axes, a.origin);
        gap.b = make_piece(b.mesh.solid(), b.axes, b.origin);
        gap.finding = compare(gap.a, gap.b, normals_of(manifolds));
        return gap;
    }
    const std::optional<Deepest> deepest = deepest_of(manifolds);
    const bool is_apart = closest->lower > 0.0 && !(deepest && deepest->separation < 0.0);
    gap.finding = compare(gap.a, gap.b, {});
    SeparatingAxis& axis = gap.finding.axis;
    axis.rounding = std::max(axis.rounding, closest->distance - closest->lower);
    note_distance(*closest, gap);
    if (!is_apart && deepest) take_contact(a, b, *deepest, gap);
    gap.finding.verdict = is_apart ? PairVerdict::Apart : axis.gap < -axis.rounding ? PairVerdict::Touching : PairVerdict::Undecided;
    return gap;
}

}  // namespace carom::detail
