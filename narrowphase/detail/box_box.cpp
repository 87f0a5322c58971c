// Box against box: fifteen axes, then the common region of two faces.
#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/box_face.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/polytope_patch.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

#include <limits>

namespace carom::detail {
namespace {

constexpr int kNext[3] = {1, 2, 0};
constexpr int kOther[3] = {2, 0, 1};

struct Boxes {
    dvec3 a{0.0};      // half extents
    dvec3 b{0.0};
    dmat3 axes{1.0};   // column j: axis j of B in A's frame
    dmat3 size{1.0};   // |axes|, component by component
    dvec3 offset{0.0}; // B's centre in A's frame
};

struct Axis {
    double separation = -std::numeric_limits<double>::infinity();
    int of_a = -1;  // face or edge axis of A, -1 where the axis is a face of B
    int of_b = -1;
};

// Face axes of both. False: farther apart than the margin.
bool face_axes(const Boxes& p, double margin, Axis& best) noexcept {
    for (int i = 0; i < 3; ++i) {
        const double reach = p.a[i] + p.size[0][i] * p.b[0] + p.size[1][i] * p.b[1] + p.size[2][i] * p.b[2];
        const double s = std::abs(p.offset[i]) - reach;
        if (s > margin) return false;
        if (s > best.separation) best = {s, i, -1};
    }
    for (int j = 0; j < 3; ++j) {
        const double reach = p.b[j] + glm::dot(p.size[j], p.a);
        const double s = std::abs(glm::dot(p.axes[j], p.offset)) - reach;
        if (s > margin) return false;
        if (s > best.separation) best = {s, -1, j};
    }
    return true;
}

// Axes across an edge of each. An edge axis wins only where it is better by more than `preference`.
bool edge_axes(const Boxes& p, double margin, double preference, Axis& best) noexcept {
    Axis edge;
    for (int i = 0; i < 3; ++i) {
        const int i1 = kNext[i], i2 = kOther[i];
        for (int j = 0; j < 3; ++j) {
            const int j1 = kNext[j], j2 = kOther[j];
            // e_i x b_j has no component along i, so its length suffers no cancellation as the edges become parallel.
            const double length_sq = p.axes[j][i1] * p.axes[j][i1] + p.axes[j][i2] * p.axes[j][i2];
            if (length_sq < kParallelSine * kParallelSine) continue;
            const double reach = p.a[i1] * p.size[j][i2] + p.a[i2] * p.size[j][i1] + p.b[j1] * p.size[j2][i] +
                                 p.b[j2] * p.size[j1][i];
            const double along = std::abs(p.offset[i2] * p.axes[j][i1] - p.offset[i1] * p.axes[j][i2]);
            const double s = (along - reach) / std::sqrt(length_sq);
            if (s > margin) return false;
            if (s > edge.separation) edge = {s, i, j};
        }
    }
    if (edge.separation > best.separation + preference) best = edge;
    return true;
}

// The unit normal of the axis, from A to B; away from A's centre along +axis where the centres coincide.
dvec3 axis_normal(const Boxes& p, const Axis& axis) noexcept {
    dvec3 n{0.0};
    if (axis.of_b < 0) {
        n[axis.of_a] = 1.0;
    } else if (axis.of_a < 0) {
        n = p.axes[axis.of_b];
    } else {
        const int i1 = kNext[axis.of_a], i2 = kOther[axis.of_a];
        const dvec3& b = p.axes[axis.of_b];
        n[i1] = -b[i2];
        n[i2] = b[i1];
        n = n / std::sqrt(n[i1] * n[i1] + n[i2] * n[i2]);
    }
    return glm::dot(n, p.offset) < 0.0 ? -n : n;
}

int largest_component(const dvec3& v) noexcept {
    const dvec3 s = glm::abs(v);
    const int xy = s.y > s.x ? 1 : 0;
    return s.z > s[xy] ? 2 : xy;
}

double sign_of(double x) noexcept { return x < 0.0 ? -1.0 : 1.0; }

// The closest points of the two edges that support the boxes along `n`.
Candidate edge_point(const Boxes& p, const Axis& axis, const dvec3& n, const ContactPlane& plane) noexcept {
    dvec3 corner_a{0.0}, corner_b{0.0};
    for (int k = 0; k < 3; ++k) {
        corner_a[k] = k == axis.of_a ? 0.0 : sign_of(n[k]) * p.a[k];
        corner_b[k] = k == axis.of_b ? 0.0 : -sign_of(glm::dot(n, p.axes[k])) * p.b[k];
    }
    dvec3 direction_a{0.0};
    direction_a[axis.of_a] = 1.0;
    const dvec3 direction_b = p.axes[axis.of_b];
    const dvec3 middle_b = p.offset + p.axes * corner_b;
    const dvec3 between = middle_b - corner_a;
    // Both edges cross the plane of the other and n, so that the two lines meet in projection along n.
    const dvec3 across_a = glm::cross(direction_a, n);
    const dvec3 across_b = glm::cross(direction_b, n);
    const double s = glm::dot(between, across_b) / glm::dot(direction_a, across_b);
    const double t = -glm::dot(between, across_a) / glm::dot(direction_b, across_a);
    const dvec3 on_a = corner_a + glm::clamp(s, -p.a[axis.of_a], p.a[axis.of_a]) * direction_a;
    const dvec3 on_b = middle_b + glm::clamp(t, -p.b[axis.of_b], p.b[axis.of_b]) * direction_b;
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

// The axes lie within the margin, but the faces are not over each other: corner to corner or corner to edge. The true distance
// decides.
CollideStatus boxes_apart(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    load_box(workspace.first, dvec3(as<Box>(pair.first).half_extents), dmat3{1.0}, dvec3{0.0});
    load_box(workspace.second, dvec3(as<Box>(pair.second).half_extents), pair.rotation, pair.translation);
    ContactAxis axis;
    if (!find_axis(workspace.first, workspace.second, pair.margin, workspace.edges, axis)) return CollideStatus::Ok;
    Patch patch;
    build_patch(workspace.first, workspace.second, axis, pair.margin, AxisPoint::Keep, workspace.polygons, patch);
    sink.add(patch);
    return CollideStatus::Ok;
}

}  // namespace

CollideStatus box_box(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    Boxes p;
    p.a = dvec3(as<Box>(pair.first).half_extents);
    p.b = dvec3(as<Box>(pair.second).half_extents);
    p.axes = pair.rotation;
    for (int j = 0; j < 3; ++j) p.size[j] = glm::abs(p.axes[j]);
    p.offset = pair.translation;

    const double size = std::max({p.a.x, p.a.y, p.a.z, p.b.x, p.b.y, p.b.z});
    Axis axis;
    if (!face_axes(p, pair.margin, axis)) return CollideStatus::Ok;
    if (!edge_axes(p, pair.margin, kFacePreference * size, axis)) return CollideStatus::Ok;

    Patch patch;
    patch.normal = axis_normal(p, axis);
    ContactPlane plane;
    plane.normal = patch.normal;
    plane.axis_u = any_perpendicular(plane.normal);
    plane.axis_w = glm::cross(plane.normal, plane.axis_u);
    plane.margin = pair.margin;
    plane.tolerance = kInsideTolerance * size;

    const dvec3 normal_b = plane.normal * p.axes;  // in B's frame
    const int face_a = largest_component(plane.normal);
    const int face_b = largest_component(normal_b);
    const BoxFace first(p.a, dmat3{1.0}, dvec3{0.0}, face_a, sign_of(plane.normal[face_a]), plane);
    const BoxFace second(p.b, p.axes, p.offset, face_b, -sign_of(normal_b[face_b]), plane);

    QuadCandidates points;
    if (axis.of_a >= 0 && axis.of_b >= 0) points.push_back(edge_point(p, axis, plane.normal, plane));
    std::array<double, 32> sides;
    collect_face_contact<4>(first.polygon(), second.polygon(), plane, sides, points);
    if (points.count == 0) return boxes_apart(pair, workspace, sink);

    const double snap = kSnap * std::min(first.least_side(), second.least_side());
    finish_patch<4>({points.items.data(), points.count}, first.polygon(), second.polygon(), kPointTolerance * size, snap, patch);
    sink.add(patch);
    return CollideStatus::Ok;
}

}  // namespace carom::detail
