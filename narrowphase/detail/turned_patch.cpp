#include <carom/narrowphase/detail/polytope_lanes.hpp>
#include <carom/narrowphase/detail/polytope_patch.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>
#include <carom/narrowphase/detail/turned_contact.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

// What one of the two shows the other along the normal of contact: a face (three corners and more), a line (two) or a point (none).
struct Facet {
    FacePolygon polygon;
    double cosine = 1.0;  // of the angle between its normal and that of contact
    double radius = 0.0;  // of a line: how far the surface beside it is from straight

    [[nodiscard]] bool is_face() const noexcept { return polygon.corners.size() > 2; }
    [[nodiscard]] bool is_line() const noexcept { return polygon.corners.size() == 2; }
};

// @param direction  from the shape to the other, of unit length.
Facet facet_of(const TruncatedCone& solid, const dvec3& direction, const ContactAxis&, const ContactPlane& plane,
               std::vector<FaceCorner>& corners) {
    const double along = glm::dot(direction, solid.axis());
    const dvec3 outward = solid.outward(direction);
    const double side = glm::dot(solid.side_normal(outward), direction);
    const bool upper = along > 0.0;
    const double end = upper && !(solid.upper_radius > 0.0) ? -1.0 : std::abs(along);
    if (end >= side) return {disc_of(solid, upper, plane, corners), end, 0.0};
    return {side_line_of(solid, outward, plane, corners), side, solid.largest_radius()};
}

Facet facet_of(const Polytope& p, const dvec3& direction, const ContactAxis& axis, const ContactPlane& plane,
               std::vector<FaceCorner>& corners) {
    const std::uint32_t face = axis.kind == AxisKind::FaceOfB ? axis.feature_b : face_along(p, direction).number;
    return {polygon_of(p, face, plane, corners), glm::dot(p.normal(face), direction), 0.0};
}

Facet facet_of(const RoundSegment& round, const dvec3& direction, const ContactAxis&, const ContactPlane& plane,
               std::vector<FaceCorner>& corners) {
    corners.clear();
    const dvec3 d = round.segment.to - round.segment.from;
    const double length_sq = glm::dot(d, d);
    if (!(length_sq > 0.0)) return {{corners, direction, 0.0}, 1.0, round.radius};
    const double along = glm::dot(d, direction);
    std::uint32_t name = 0;
    for (const dvec3& p : {round.segment.from, round.segment.to}) {
        corners.push_back({p, glm::dot(p, plane.axis_u), glm::dot(p, plane.axis_w), name++, 0});
    }
    return {{corners, direction, 0.0}, std::sqrt(std::max(0.0, 1.0 - along * along / length_sq)), round.radius};
}

// Points where two lines run along each other: each end of `a` that lies over b but for kSnap of the radius. Between the two lines
// the surfaces have curved apart by a ten-thousandth of it then. `direction` is +1 where a is the first, -1 where it is the second.
void collect_along(const Facet& a, const Facet& b, const ContactPlane& plane, double direction, std::vector<Candidate>& points) {
    const FacePolygon &of = a.polygon, &other = b.polygon;
    const double reach = kSnap * std::min(a.radius, b.radius);
    const FaceCorner &p = other.corners[0], &q = other.corners[1];
    const double du = q.u - p.u, dw = q.w - p.w, length_sq = du * du + dw * dw;
    if (!(length_sq > 0.0)) return;
    for (const FaceCorner& c : of.corners) {
        const double t = ((c.u - p.u) * du + (c.w - p.w) * dw) / length_sq;
        const double aside = (c.u - p.u) * dw - (c.w - p.w) * du;
        if (!(t >= 0.0 && t <= 1.0) || aside * aside > reach * reach * length_sq) continue;
        const dvec3 across = p.point + t * (q.point - p.point);
        const double separation = direction * glm::dot(across - c.point, plane.normal);
        if (!(separation <= plane.margin)) continue;
        const dvec3 middle = 0.5 * (across + c.point);
        const std::uint64_t name = direction > 0.0 ? feature_name(FeatureKind::VertexOfFirst, c.vertex, 0)
                                                   : feature_name(FeatureKind::VertexOfSecond, 0, c.vertex);
        points.push_back({middle, separation, glm::dot(middle, plane.axis_u), glm::dot(middle, plane.axis_w), name});
    }
}

// What two features share. A line is a polygon of two corners, over which nothing lies.
void collect(const Facet& a, const Facet& b, const ContactPlane& plane, PolygonScratch& scratch) {
    const FacePolygon &first = a.polygon, &second = b.polygon;
    std::vector<Candidate>& points = scratch.candidates;
    points.clear();
    if (first.corners.empty() || second.corners.empty() || !share_points(a.cosine, b.cosine)) return;
    if (a.is_line() && b.is_line()) {
        collect_along(a, b, plane, 1.0, points);
        collect_along(b, a, plane, -1.0, points);
        if (!points.empty()) return;  // else the lines cross
    }
    const std::size_t half = first.corners.size() * second.corners.size();
    scratch.sides.resize(2 * half);
    const std::span<double> of_first(scratch.sides.data(), half), of_second(scratch.sides.data() + half, half);
    fill_sides(first, second, 1.0, of_first);
    fill_sides(second, first, -1.0, of_second);
    if (b.is_face()) collect_corners(first, second, of_second, plane, 1.0, points);
    if (a.is_face()) collect_corners(second, first, of_first, plane, -1.0, points);
    collect_crossings(first, second, of_first, of_second, plane, points);
}

// The size that tolerances are shares of: the larger one's, but of a triangle and a solid the solid's.
double common_size(const TruncatedCone& a, const Polytope& b) noexcept { return b.side_count > 0 ? a.size() : std::max(a.size(), b.size); }
double common_size(const TruncatedCone& a, const TruncatedCone& b) noexcept { return std::max(a.size(), b.size()); }
double common_size(const TruncatedCone& a, const RoundSegment& b) noexcept {
    const dvec3 d = b.segment.to - b.segment.from;
    return std::max({a.size(), b.radius, std::sqrt(glm::dot(d, d))});
}

// The pair of points that the axis itself names.
Candidate point_of_axis(const ContactAxis& axis, const ContactPlane& plane) noexcept {
    const dvec3 point = 0.5 * (axis.on_a + axis.on_b);
    const FeatureKind kind = axis.kind == AxisKind::FaceOfB ? FeatureKind::VertexOfFirst : FeatureKind::Edges;
    const std::uint64_t name = feature_name(kind, kRimPoint, 0);
    return {point, axis.separation, glm::dot(point, plane.axis_u), glm::dot(point, plane.axis_w), name};
}

template <class B>
void patch_of(const TruncatedCone& a, const B& b, const ContactAxis& axis, const Asked& asked, AxisPoint axis_point, PolygonScratch& scratch,
              Patch& patch) {
    const double size = common_size(a, b);
    const ContactPlane plane = contact_plane(axis.normal, asked.margin, kInsideTolerance * size);

    const Facet first = facet_of(a, axis.normal, axis, plane, scratch.first);
    const Facet second = facet_of(b, -axis.normal, axis, plane, scratch.second);
    collect(first, second, plane, scratch);
    std::vector<Candidate>& points = scratch.candidates;
    // A rim is deepest between its corners as a rule, and features that share nothing touch in one point.
    const auto reaches = [&](const Candidate& c) { return c.separation <= axis.separation + kPointTolerance * size; };
    if (axis_point == AxisPoint::Keep && std::none_of(points.begin(), points.end(), reaches)) {
        points.push_back(point_of_axis(axis, plane));
    }
    patch.normal = plane.normal;
    patch.count = 0;
    const double snap = kSnap * std::min(least_side(first.polygon.corners), least_side(second.polygon.corners));
    const PatchRule rule{kPointTolerance * size, snap, outline_start(plane.normal, plane.axis_u, plane.axis_w), overlook(asked.steady, size)};
    finish_patch(points, first.polygon, second.polygon, rule, patch);
}

}  // namespace

void build_patch(const TruncatedCone& a, const Polytope& b, const ContactAxis& axis, const Asked& asked, AxisPoint axis_point,
                 PolygonScratch& scratch, Patch& patch) {
    patch_of(a, b, axis, asked, axis_point, scratch, patch);
}

void build_patch(const TruncatedCone& a, const RoundSegment& b, const ContactAxis& axis, const Asked& asked, AxisPoint axis_point,
                 PolygonScratch& scratch, Patch& patch) {
    patch_of(a, b, axis, {asked.margin + b.radius, asked.steady}, axis_point, scratch, patch);
    for (PatchPoint& p : patch.points) {
        p.position -= (0.5 * b.radius) * patch.normal;
        p.separation -= b.radius;
    }
}

void build_patch(const TruncatedCone& a, const TruncatedCone& b, const ContactAxis& axis, const Asked& asked, AxisPoint axis_point,
                 PolygonScratch& scratch, Patch& patch) {
    patch_of(a, b, axis, asked, axis_point, scratch, patch);
}

}  // namespace carom::detail
