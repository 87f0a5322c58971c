#include <carom/narrowphase/detail/polytope_patch.hpp>
#include <carom/narrowphase/detail/polytope_lanes.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <algorithm>
#include <limits>

namespace carom::detail {
namespace {

// The pair of points that the axis itself names: closest points, crossing edges, or the vertex that is deepest under a face.
Candidate point_of_axis(const Polytope& a, const Polytope& b, const ContactAxis& axis, const ContactPlane& plane) noexcept {
    dvec3 point = 0.5 * (axis.on_a + axis.on_b);
    std::uint64_t name = feature_name(FeatureKind::Edges, axis.feature_a, axis.feature_b);
    if (axis.kind == AxisKind::FaceOfA) {
        const std::uint32_t v = lowest(b, axis.normal).number;
        point = b.vertex(v) - (0.5 * axis.separation) * axis.normal;
        name = feature_name(FeatureKind::VertexOfSecond, 0, v);
    } else if (axis.kind == AxisKind::FaceOfB) {
        const std::uint32_t v = lowest(a, -axis.normal).number;
        point = a.vertex(v) + (0.5 * axis.separation) * axis.normal;
        name = feature_name(FeatureKind::VertexOfFirst, v, 0);
    }
    return {point, axis.separation, glm::dot(point, plane.axis_u), glm::dot(point, plane.axis_w), name};
}

}  // namespace

double least_side(std::span<const FaceCorner> corners) noexcept {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const dvec3 d = corners[k + 1 < corners.size() ? k + 1 : 0].point - corners[k].point;
        least = std::min(least, glm::dot(d, d));
    }
    return std::sqrt(least);
}

FacePolygon polygon_of(const Polytope& p, std::uint32_t face, const ContactPlane& plane, std::vector<FaceCorner>& corners) {
    const ConvexHull::Face& loop = p.loops[face];
    corners.clear();
    std::uint32_t e = loop.first_edge;
    for (std::uint32_t k = 0; k < loop.edge_count; ++k, e = p.half_edges[e].next) {
        const dvec3 v = p.origin_of(e);
        corners.push_back({v, glm::dot(v, plane.axis_u), glm::dot(v, plane.axis_w), p.half_edges[e].origin, p.edge_name(e / 2)});
    }
    return {corners, p.normal(face), p.offset(face)};
}

void build_patch(const Polytope& a, const Polytope& b, const ContactAxis& axis, const Asked& asked, AxisPoint axis_point,
                 PolygonScratch& scratch, Patch& patch) {
    const double size = common_size(a, b);
    const ContactPlane plane = contact_plane(axis.normal, asked.margin, kInsideTolerance * size);

    const std::uint32_t face_a = axis.kind == AxisKind::FaceOfA ? axis.feature_a : face_along(a, plane.normal).number;
    const std::uint32_t face_b = axis.kind == AxisKind::FaceOfB ? axis.feature_b : face_along(b, -plane.normal).number;
    const FacePolygon first = polygon_of(a, face_a, plane, scratch.first);
    const FacePolygon second = polygon_of(b, face_b, plane, scratch.second);

    std::vector<Candidate>& points = scratch.candidates;
    points.clear();
    if (share_points(glm::dot(first.normal, plane.normal), -glm::dot(second.normal, plane.normal))) {
        constexpr std::size_t kFew = kDoubleBundleWidth;
        if (first.corners.size() <= kFew && second.corners.size() <= kFew) {
            collect_face_contact(first, second, plane, points);
        } else {
            scratch.sides.resize(2 * first.corners.size() * second.corners.size());
            collect_face_contact(first, second, plane, scratch.sides, points);
        }
    }
    // The deepest vertex belongs to the region as a rule. It does not where the other face that faces the normal best is not at
    // that vertex, and where rounding leaves no region.
    const auto reaches = [&](const Candidate& c) { return c.separation <= axis.separation + kPointTolerance * size; };
    if (axis_point == AxisPoint::Keep && std::none_of(points.begin(), points.end(), reaches)) {
        points.push_back(point_of_axis(a, b, axis, plane));
    }
    patch.normal = plane.normal;
    patch.count = 0;
    if (points.empty()) return;
    const double snap = kSnap * std::min(least_side(first.corners), least_side(second.corners));
    const PatchRule rule{kPointTolerance * size, snap, outline_start(plane.normal, plane.axis_u, plane.axis_w), overlook(asked.steady, size)};
    finish_patch(points, first, second, rule, patch);
}

}  // namespace carom::detail
