// The common region of two facing polygons: the points of contact of two faces, or of two edges of nearly facing faces.
//
//   collect_face_contact(face_a, face_b, plane, sides, points);
//   finish_patch(points, face_a, face_b, rule, patch);
#pragma once

#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/feature.hpp>
#include <carom/narrowphase/detail/kernel.hpp>
#include <carom/narrowphase/detail/reduce.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace carom::detail {

/// A corner of a face, counter-clockwise seen from outside, with its coordinates in the plane of contact.
struct FaceCorner {
    dvec3 point{0.0};
    double u = 0.0;
    double w = 0.0;
    std::uint32_t vertex = 0;
    std::uint32_t edge = 0;  ///< from this corner to the next
};

/// One of the two polygons with its supporting plane dot(normal, x) = offset, normal outward.
struct FacePolygon {
    std::span<const FaceCorner> corners;
    dvec3 normal{0.0};
    double offset = 0.0;
};

/// The plane of contact: its normal from the first face to the second, and axes with cross(axis_u, axis_w) = normal.
struct ContactPlane {
    dvec3 normal{0.0};
    dvec3 axis_u{0.0};
    dvec3 axis_w{0.0};
    double margin = 0.0;     ///< points with a larger separation are left out [m]
    double tolerance = 0.0;  ///< points outside by this much count as inside [m]
};

/// @return the plane across a unit normal, with any two axes.
[[nodiscard]] inline ContactPlane contact_plane(const dvec3& normal, double margin, double tolerance) noexcept {
    const dvec3 axis_u = any_perpendicular(normal);
    return {normal, axis_u, glm::cross(normal, axis_u), margin, tolerance};
}

/// Whether two faces have points of contact in common, from the cosines of the angles at which they face the normal: one of them lies
/// square to it and the other is not too steep to have heights over it, or both lie nearly square.
[[nodiscard]] inline bool share_points(double cosine_a, double cosine_b) noexcept {
    const double most = std::max(cosine_a, cosine_b), least = std::min(cosine_a, cosine_b);
    return least > (most > kSquareCosine ? kLeastSlope : kFacingCosine);
}

/// Buffers for polygons of any size.
struct PolygonScratch {
    std::vector<FaceCorner> first, second;
    std::vector<double> sides;
    std::vector<Candidate> candidates;
    std::vector<std::uint32_t> edges;
};

/// side[k * points + m]: on which side of edge k of `polygon` corner m of `other` lies, times the length of the edge; positive inside.
/// `turn` is +1 where the polygon runs counter-clockwise in (u, w).
inline void fill_sides(const FacePolygon& polygon, const FacePolygon& other, double turn, std::span<double> side) {
    const auto a = polygon.corners;
    const auto b = other.corners;
    for (std::size_t k = 0; k < a.size(); ++k) {
        const FaceCorner& p = a[k];
        const FaceCorner& q = a[k + 1 < a.size() ? k + 1 : 0];
        const double eu = turn * (q.u - p.u), ew = turn * (q.w - p.w);
        for (std::size_t m = 0; m < b.size(); ++m) {
            side[k * b.size() + m] = eu * (b[m].w - p.w) - ew * (b[m].u - p.u);
        }
    }
}

/// Adds corner `c` of a polygon, which lies over the other one, if it is within the margin. `direction` is +1 for the first polygon, -1 for the second.
/// @param slope  the cosine between the other's normal and that of contact; bounded away from 0 by the choice of the two faces.
inline void add_corner(const FaceCorner& c, const FacePolygon& other, double slope, const ContactPlane& plane, double direction,
                       std::vector<Candidate>& points) {
    const double along = (other.offset - glm::dot(other.normal, c.point)) / slope;  // to the other plane, along the normal
    const double separation = direction * along;
    if (!(separation <= plane.margin)) return;
    const std::uint64_t name =
        direction > 0.0 ? feature_name(FeatureKind::VertexOfFirst, c.vertex, 0) : feature_name(FeatureKind::VertexOfSecond, 0, c.vertex);
    points.push_back({c.point + (0.5 * along) * plane.normal, separation, c.u, c.w, name});
}

/// Adds the crossing of side k of the first polygon and side m of the second, if it is within the margin.
/// @param of_first  on which side of side k the ends of side m lie; `of_second` the other way round.
inline void add_crossing(const FacePolygon& first, std::size_t k, const FacePolygon& second, std::size_t m, const double (&of_first)[2],
                         const double (&of_second)[2], const ContactPlane& plane, std::vector<Candidate>& points) {
    const FaceCorner &a0 = first.corners[k], &a1 = first.corners[k + 1 < first.corners.size() ? k + 1 : 0];
    const FaceCorner &b0 = second.corners[m], &b1 = second.corners[m + 1 < second.corners.size() ? m + 1 : 0];
    const dvec3 on_first = a0.point + (of_second[0] / (of_second[0] - of_second[1])) * (a1.point - a0.point);
    const dvec3 on_second = b0.point + (of_first[0] / (of_first[0] - of_first[1])) * (b1.point - b0.point);
    const double separation = glm::dot(on_second - on_first, plane.normal);
    if (!(separation <= plane.margin)) return;
    const dvec3 middle = 0.5 * (on_first + on_second);
    points.push_back({middle, separation, glm::dot(middle, plane.axis_u), glm::dot(middle, plane.axis_w),
                      feature_name(FeatureKind::Edges, a0.edge, b0.edge)});
}

/// Adds the corners of `polygon` that lie over the other one. `direction` is +1 for the first polygon, -1 for the second.
inline void collect_corners(const FacePolygon& polygon, const FacePolygon& other, std::span<const double> side_of_other,
                     const ContactPlane& plane, double direction, std::vector<Candidate>& points) {
    const auto corners = polygon.corners;
    const auto sides = other.corners;
    const double slope = glm::dot(other.normal, plane.normal);
    for (std::size_t m = 0; m < corners.size(); ++m) {
        bool inside = true;
        for (std::size_t k = 0; k < sides.size() && inside; ++k) {
            const FaceCorner& p = sides[k];
            const FaceCorner& q = sides[k + 1 < sides.size() ? k + 1 : 0];
            const double length = std::abs(q.u - p.u) + std::abs(q.w - p.w);
            inside = side_of_other[k * corners.size() + m] >= -plane.tolerance * length;
        }
        if (inside) add_corner(corners[m], other, slope, plane, direction, points);
    }
}

/// Adds the crossings of the two outlines.
inline void collect_crossings(const FacePolygon& first, const FacePolygon& second, std::span<const double> side_of_first,
                       std::span<const double> side_of_second, const ContactPlane& plane, std::vector<Candidate>& points) {
    const auto a = first.corners;
    const auto b = second.corners;
    for (std::size_t k = 0; k < a.size(); ++k) {
        const std::size_t k1 = k + 1 < a.size() ? k + 1 : 0;
        for (std::size_t m = 0; m < b.size(); ++m) {
            const std::size_t m1 = m + 1 < b.size() ? m + 1 : 0;
            const double b0 = side_of_first[k * b.size() + m], b1 = side_of_first[k * b.size() + m1];
            const double a0 = side_of_second[m * a.size() + k], a1 = side_of_second[m * a.size() + k1];
            if ((b0 < 0.0) == (b1 < 0.0) || (a0 < 0.0) == (a1 < 0.0)) continue;
            add_crossing(first, k, second, m, {b0, b1}, {a0, a1}, plane, points);
        }
    }
}

/// Collects the corners of the region that two polygons share in the plane of contact: corners of either over the other, and
/// crossings of their outlines. Nothing is ordered or cut one after the other, so the result treats both alike.
/// `sides` needs room for 2 |first| |second| numbers.
inline void collect_face_contact(const FacePolygon& first, const FacePolygon& second, const ContactPlane& plane,
                          std::span<double> sides, std::vector<Candidate>& points) {
    const std::size_t half = first.corners.size() * second.corners.size();
    const std::span<double> of_first = sides.subspan(0, half);
    const std::span<double> of_second = sides.subspan(half, half);
    fill_sides(first, second, 1.0, of_first);
    fill_sides(second, first, -1.0, of_second);
    collect_corners(first, second, of_second, plane, 1.0, points);
    collect_corners(second, first, of_first, plane, -1.0, points);
    collect_crossings(first, second, of_first, of_second, plane, points);
}

/// The same, to the bit, of two polygons of at most eight corners each: all sides at once.
void collect_face_contact(const FacePolygon& first, const FacePolygon& second, const ContactPlane& plane, std::vector<Candidate>& points);

/// Names a point after the corner that it lies at, within `distance` [m] in the plane of contact: a crossing that wanders over a
/// corner keeps its name.
inline std::uint64_t steady_name(const Candidate& point, const FacePolygon& first, const FacePolygon& second, double distance) {
    const auto near = [&](const FaceCorner& c) {
        const double du = c.u - point.u, dw = c.w - point.w;
        return du * du + dw * dw < distance * distance;
    };
    for (const FaceCorner& c : second.corners) {
        if (near(c)) return feature_name(FeatureKind::VertexOfSecond, 0, c.vertex);
    }
    for (const FaceCorner& c : first.corners) {
        if (near(c)) return feature_name(FeatureKind::VertexOfFirst, c.vertex, 0);
    }
    return point.feature;
}

/// How points become a patch.
struct PatchRule {
    double tolerance = 0.0;  ///< of reduce_points() [m]
    double snap = 0.0;       ///< points within this distance of a corner bear its name [m]
    PlanarDirection start;
    double overlook = 0.0;  ///< of reduce_points() [m]
};

/// Reduces the candidates to the points of the patch and gives them steady names.
inline void finish_patch(std::span<const Candidate> candidates, const FacePolygon& first, const FacePolygon& second,
                  const PatchRule& rule, Patch& patch) {
    Chosen chosen{};
    const int count = reduce_points(candidates, rule.tolerance, rule.start, rule.overlook, chosen);
    for (int i = 0; i < count; ++i) {
        const Candidate& c = candidates[static_cast<std::size_t>(chosen[static_cast<std::size_t>(i)])];
        std::uint64_t name = steady_name(c, first, second, rule.snap);
        for (int k = 0; k < patch.count; ++k) {
            if (patch.points[static_cast<std::size_t>(k)].feature == name) name = c.feature;
        }
        patch.add(c.position, c.separation, name);
    }
}

}  // namespace carom::detail
