// Closest points of a box and a point, segment, triangle or box, in double.
//
//   Nearest n = closest(segment, obb, slack);      // n.a on the segment, n.b on the box; one point of both where they overlap
//
// In the box's own frame a box is a clamp. Source: Ericson, Real-Time Collision Detection (2005), sec. 5.1.3 and 5.1.4, for points;
// segments by the one root of a derivative that is increasing and linear between the box's planes; triangles and boxes by their
// edges, the edges of the box and its deepest corner, which is all that a pair of closest points can lie on.
#pragma once

#include <carom/collision/detail/closest_features.hpp>
#include <carom/collision/detail/solids.hpp>

namespace carom::geo::detail {

/// The box's frame: vectors along its axes.
[[nodiscard]] inline dvec3 to_local(const AlignedBox& b, const dvec3& p) noexcept { return p - b.center; }
[[nodiscard]] inline dvec3 to_world(const AlignedBox& b, const dvec3& p) noexcept { return p + b.center; }
[[nodiscard]] inline dvec3 to_local(const Obb<double>& b, const dvec3& p) noexcept {
    const dvec3 d = p - b.center;
    return {glm::dot(b.axes[0], d), glm::dot(b.axes[1], d), glm::dot(b.axes[2], d)};
}
[[nodiscard]] inline dvec3 to_world(const Obb<double>& b, const dvec3& p) noexcept { return b.center + b.axes * p; }
[[nodiscard]] inline const dvec3& half_extents(const AlignedBox& b) noexcept { return b.half; }
[[nodiscard]] inline const dvec3& half_extents(const Obb<double>& b) noexcept { return b.half_extents; }

template <class Box>
concept AnyBox = std::is_same_v<Box, AlignedBox> || std::is_same_v<Box, Obb<double>>;

// About a box at the origin with half extents h.
[[nodiscard]] inline dvec3 clamp_to(const dvec3& h, const dvec3& p) noexcept { return glm::min(glm::max(p, -h), h); }
[[nodiscard]] Nearest closest_local(const Segment<double>& s, const dvec3& h) noexcept;
[[nodiscard]] Nearest closest_local(const Triangle<double>& t, const dvec3& h, double slack) noexcept;

template <AnyBox Box>
[[nodiscard]] Segment<double> to_local(const Box& b, const Segment<double>& s) noexcept {
    return {to_local(b, s.a), to_local(b, s.b)};
}
template <AnyBox Box>
[[nodiscard]] Triangle<double> to_local(const Box& b, const Triangle<double>& t) noexcept {
    return {to_local(b, t.a), to_local(b, t.b), to_local(b, t.c)};
}
template <AnyBox Box>
[[nodiscard]] Nearest to_world(const Box& b, const Nearest& n) noexcept {
    return {to_world(b, n.a), to_world(b, n.b), n.sq};
}

template <AnyBox Box>
[[nodiscard]] Nearest closest(const dvec3& a, const Box& b) noexcept {
    const dvec3 p = to_local(b, a), q = clamp_to(half_extents(b), p);
    if (p == q) return {a, a, 0.0};
    return {a, to_world(b, q), nearest(p, q).sq};
}
/// Cost: up to eight clamps.
template <AnyBox Box>
[[nodiscard]] Nearest closest(const Segment<double>& a, const Box& b) noexcept {
    return to_world(b, closest_local(to_local(b, a), half_extents(b)));
}
/// Cost: three segments against the box, one corner and up to twelve edges of the box against the triangle.
template <AnyBox Box>
[[nodiscard]] Nearest closest(const Triangle<double>& a, const Box& b, double slack) noexcept {
    return to_world(b, closest_local(to_local(b, a), half_extents(b), slack));
}
/// Cost: up to 24 segments against a box.
[[nodiscard]] Nearest closest(const Obb<double>& a, const Obb<double>& b) noexcept;
[[nodiscard]] Nearest closest(const AlignedBox& a, const Obb<double>& b) noexcept;
/// Cost: O(1); the middle of what the boxes share on each axis where they do.
[[nodiscard]] Nearest closest(const AlignedBox& a, const AlignedBox& b) noexcept;

}  // namespace carom::geo::detail
