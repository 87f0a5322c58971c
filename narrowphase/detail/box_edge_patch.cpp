#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/box_edge_patch.hpp>
#include <carom/narrowphase/detail/box_face.hpp>
#include <carom/narrowphase/detail/polygon_contact.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

namespace carom::detail {
namespace {

double sign_of(double x) noexcept { return x < 0.0 ? -1.0 : 1.0; }

int largest_component(const dvec3& v) noexcept {
    const dvec3 s = glm::abs(v);
    const int xy = s.y > s.x ? 1 : 0;
    return s.z > s[xy] ? 2 : xy;
}

// The unit normal across the two edges, from A to B; either way round where the centres coincide.
dvec3 edge_normal(const PairFrame& pair, const BoxAxis& axis) noexcept {
    dvec3 edge_a{0.0};
    edge_a[axis.of_a] = 1.0;
    const dvec3 cross = glm::cross(edge_a, pair.rotation[axis.of_b]);
    const dvec3 n = cross / std::sqrt(glm::dot(cross, cross));
    return glm::dot(n, pair.translation) < 0.0 ? -n : n;
}

// Where the two edges that support the boxes along the normal cross.
Candidate edge_point(const PairFrame& pair, const BoxAxis& axis, const ContactPlane& plane) noexcept {
    const dvec3 half_a(as<Box>(pair.first).half_extents), half_b(as<Box>(pair.second).half_extents);
    const dvec3& n = plane.normal;
    dvec3 corner_a{0.0}, corner_b{0.0}, direction_a{0.0};
    for (int k = 0; k < 3; ++k) {
        corner_a[k] = k == axis.of_a ? 0.0 : sign_of(n[k]) * half_a[k];
        corner_b[k] = k == axis.of_b ? 0.0 : -sign_of(glm::dot(n, pair.rotation[k])) * half_b[k];
    }
    direction_a[axis.of_a] = 1.0;
    const dvec3 direction_b = pair.rotation[axis.of_b];
    const dvec3 middle_b = pair.to_first(corner_b);
    const dvec3 between = middle_b - corner_a;
    // The plane through either edge and the normal cuts the other edge where the two lines cross, seen along the normal.
    const dvec3 across_a = glm::cross(direction_a, n), across_b = glm::cross(direction_b, n);
    const double s = glm::dot(between, across_b) / glm::dot(direction_a, across_b);
    const double t = -glm::dot(between, across_a) / glm::dot(direction_b, across_a);
    const dvec3 on_a = corner_a + glm::clamp(s, -half_a[axis.of_a], half_a[axis.of_a]) * direction_a;
    const dvec3 on_b = middle_b + glm::clamp(t, -half_b[axis.of_b], half_b[axis.of_b]) * direction_b;
    const dvec3 point = 0.5 * (on_a + on_b);
    return {point, axis.separation, glm::dot(point, plane.axis_u), glm::dot(point, plane.axis_w),
            feature_name(FeatureKind::Edges, box_edge(axis.of_a, corner_a), box_edge(axis.of_b, corner_b))};
}

// Fixed room for the candidates of two quadrilaterals: 4 + 4 corners, 16 crossings, 1 pair of edges.
struct QuadCandidates {
    std::array<Candidate, 25> items;
    std::size_t count = 0;
    void push_back(const Candidate& c) noexcept { items[count++] = c; }
};

}  // namespace

void build_box_edge_patch(const PairFrame& pair, const BoxAxis& axis, Patch& patch) noexcept {
    const dvec3 half_a(as<Box>(pair.first).half_extents), half_b(as<Box>(pair.second).half_extents);
    const double size = std::max({half_a.x, half_a.y, half_a.z, half_b.x, half_b.y, half_b.z});
    ContactPlane plane;
    plane.normal = edge_normal(pair, axis);
    plane.axis_u = any_perpendicular(plane.normal);
    plane.axis_w = glm::cross(plane.normal, plane.axis_u);
    plane.margin = pair.margin;
    plane.tolerance = kInsideTolerance * size;

    const dvec3 normal_b = plane.normal * pair.rotation;  // in B's frame
    const int face_a = largest_component(plane.normal), face_b = largest_component(normal_b);
    const Candidate crossing = edge_point(pair, axis, plane);
    patch.normal = plane.normal;
    if (!share_points(std::abs(plane.normal[face_a]), std::abs(normal_b[face_b]))) {
        patch.add(crossing.position, crossing.separation, crossing.feature);
        return;
    }
    const BoxFace first(half_a, dmat3{1.0}, dvec3{0.0}, face_a, sign_of(plane.normal[face_a]), plane);
    const BoxFace second(half_b, pair.rotation, pair.translation, face_b, -sign_of(normal_b[face_b]), plane);
    QuadCandidates points;
    points.push_back(crossing);
    std::array<double, 32> sides;
    collect_face_contact<4>(first.polygon(), second.polygon(), plane, sides, points);
    const double snap = kSnap * std::min(first.least_side(), second.least_side());
    finish_patch<4>({points.items.data(), points.count}, first.polygon(), second.polygon(),
                    {kPointTolerance * size, snap, outline_start(plane.normal, plane.axis_u, plane.axis_w)}, patch);
}

}  // namespace carom::detail
