// Box, hull and mesh against a half-space: the corners below it.
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/plane_form.hpp>
#include <carom/narrowphase/detail/reduce.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

namespace carom::detail {
namespace {

// The plane with axes in it.
struct PlaneFrame {
    PlaneForm form;
    dvec3 axis_u{any_perpendicular(form.normal)};
    dvec3 axis_w{glm::cross(axis_u, form.normal)};
    PlanarDirection start{outline_start(form.normal, axis_u, axis_w)};
};

Candidate corner_on_plane(const dvec3& corner, std::uint32_t vertex, const PlaneFrame& plane) noexcept {
    const double distance = plane.form.distance(corner);
    return {corner - (0.5 * distance) * plane.form.normal, distance, glm::dot(corner, plane.axis_u), glm::dot(corner, plane.axis_w),
            feature_name(FeatureKind::VertexOfFirst, vertex, 0)};
}

void emit(std::span<const Candidate> candidates, double size, const PlaneFrame& plane, double overlook, ManifoldSink& sink) {
    Chosen chosen{};
    const int count = reduce_points(candidates, kPointTolerance * size, plane.start, overlook, chosen);
    if (count == 0) return;
    Patch patch;
    patch.normal = -plane.form.normal;
    for (int i = 0; i < count; ++i) {
        const Candidate& c = candidates[static_cast<std::size_t>(chosen[static_cast<std::size_t>(i)])];
        patch.add(c.position, c.separation, c.feature);
    }
    sink.add(patch);
}

}  // namespace

CollideStatus box_plane(const PairFrame& pair, Workspace&, ManifoldSink& sink) {
    const dvec3 half(as<Box>(pair.first).half_extents);
    const PlaneFrame plane{plane_in_first(pair)};
    std::array<Candidate, 8> candidates;
    std::size_t count = 0;
    for (int i = 0; i < 8; ++i) {
        const dvec3 corner{i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z};
        candidates[count] = corner_on_plane(corner, static_cast<std::uint32_t>(i), plane);
        if (candidates[count].separation <= pair.margin) ++count;
    }
    emit({candidates.data(), count}, std::max({half.x, half.y, half.z}), plane, 0.0, sink);
    return CollideStatus::Ok;
}

namespace {

CollideStatus vertices_plane(std::span<const vec3> vertices, const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    const PlaneFrame plane{plane_in_first(pair)};
    std::vector<Candidate>& candidates = workspace.polygons.candidates;
    candidates.clear();
    double size = 0.0;
    for (std::uint32_t i = 0; i < vertices.size(); ++i) {
        const Candidate c = corner_on_plane(dvec3(vertices[i]), i, plane);
        size = std::max({size, std::abs(c.u), std::abs(c.w), std::abs(c.separation)});
        if (c.separation <= pair.margin) candidates.push_back(c);
    }
    emit(candidates, size, plane, overlook(pair.steady, size), sink);
    return CollideStatus::Ok;
}

}  // namespace

CollideStatus hull_plane(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    return vertices_plane(as<ConvexHullPtr>(pair.first)->vertices(), pair, workspace, sink);
}

// Vertices that no triangle has count too.
CollideStatus mesh_plane(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    return vertices_plane(as<TriangleMeshPtr>(pair.first)->vertices(), pair, workspace, sink);
}

}  // namespace carom::detail
