// Closest points of points and segments.
#pragma once

#include <carom/core/types.hpp>

#include <glm/geometric.hpp>

namespace carom::detail {

struct Segment {
    dvec3 from{0.0};
    dvec3 to{0.0};
    [[nodiscard]] dvec3 at(double t) const noexcept { return from + t * (to - from); }
};

/// Parameters in [0, 1] of the closest points of two segments.
struct SegmentParameters {
    double s = 0.0;
    double t = 0.0;
};

[[nodiscard]] inline double clamp01(double x) noexcept { return x > 0.0 ? (x < 1.0 ? x : 1.0) : 0.0; }

/// @return the parameter of the point of `segment` closest to `point`; 0 for a segment without length.
[[nodiscard]] inline double closest_parameter(const Segment& segment, const dvec3& point) noexcept {
    const dvec3 d = segment.to - segment.from;
    const double length_sq = glm::dot(d, d);
    return length_sq > 0.0 ? clamp01(glm::dot(point - segment.from, d) / length_sq) : 0.0;
}

/// Closest points of two segments. Method: Ericson, Real-Time Collision Detection (2005), sec. 5.1.9; departure: either parameter
/// is projected again after the other was clamped, so that no length tolerance is needed.
/// Parallel segments have many pairs; which one is given is deterministic.
[[nodiscard]] inline SegmentParameters closest_parameters(const Segment& a, const Segment& b) noexcept {
    const dvec3 d = a.to - a.from, e = b.to - b.from, r = a.from - b.from;
    const double dd = glm::dot(d, d);
    if (!(dd > 0.0)) return {0.0, closest_parameter(b, a.from)};
    const double ee = glm::dot(e, e), de = glm::dot(d, e);
    const double determinant = dd * ee - de * de;
    double s = 0.0;
    if (determinant > 0.0) s = clamp01((de * glm::dot(e, r) - ee * glm::dot(d, r)) / determinant);
    double t = closest_parameter(b, a.at(s));
    s = closest_parameter(a, b.at(t));
    t = closest_parameter(b, a.at(s));
    return {s, t};
}

}  // namespace carom::detail
