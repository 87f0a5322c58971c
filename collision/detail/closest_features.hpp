// Closest points of points, segments and triangles, in double, of any shape down to needles and points.
//
//   Nearest n = closest(segment, triangle);      // n.a on the segment, n.b on the triangle
//   TriangleFrame frame(triangle);               // made once for many points
//   dvec3 q = frame.closest(p);
//
// What keeps needles and nearly parallel segments from losing half the digits: the longer direction is projected out first, and
// the rest is solved with what remains. That is a Gram-Schmidt step, whose error is relative to the lengths, where the usual
// determinant a e - b b (Ericson 2005, sec. 5.1.9) squares the angle between the directions and with it the error. Every answer is
// a pair of points of the two solids with their distance as measured, the least of a few candidates, so it errs to one side only:
// some part of a rounding, times the size of the pair, above the true distance.
#pragma once

#include <carom/collision/primitives.hpp>

namespace carom::geo::detail {

/// A point of each solid and the square of their distance.
struct Nearest {
    dvec3 a{0.0};
    dvec3 b{0.0};
    double sq = 0.0;
};

[[nodiscard]] inline Nearest nearest(const dvec3& a, const dvec3& b) noexcept {
    const dvec3 d = b - a;
    return {a, b, glm::dot(d, d)};
}
[[nodiscard]] inline Nearest swapped(const Nearest& n) noexcept { return {n.b, n.a, n.sq}; }
/// The first of two that are equally near stays: the order of the candidates decides, not chance.
inline void keep_nearer(Nearest& best, const Nearest& other) noexcept {
    if (other.sq < best.sq) best = other;
}

/// What a triangle's interior is measured by: its longest edge and its height over that edge.
class TriangleFrame {
public:
    explicit TriangleFrame(const Triangle<double>& t) noexcept;

    /// @return the point of the triangle closest to p.
    [[nodiscard]] dvec3 closest(const dvec3& p) const noexcept;

    /// The point of the triangle's interior straight below p, if there is one.
    [[nodiscard]] bool project(const dvec3& p, dvec3& foot) const noexcept;

    /// At a right angle to the longest edge to full relative precision, so that far along a needle its plane is still its plane. Zero
    /// for a segment or a point. Not of unit length.
    [[nodiscard]] const dvec3& normal() const noexcept { return normal_; }
    /// The first end of the longest edge.
    [[nodiscard]] const dvec3& corner() const noexcept { return corner_; }
    /// The edges, the longest first.
    [[nodiscard]] Segment<double> edge(int k) const noexcept;

private:
    dvec3 corner_{0.0};  // of the longest edge
    dvec3 end_{0.0};     // its other end
    dvec3 apex_{0.0};
    dvec3 base_{0.0};    // end - corner
    dvec3 side_{0.0};    // apex - corner
    dvec3 height_{0.0};  // side less its part along the base
    dvec3 normal_{0.0};
    double base_sq_ = 0.0;
    double height_sq_ = 0.0;
};

/// @return where the segment is nearest to p. Deterministic; a segment of no length is its first point.
[[nodiscard]] dvec3 closest_on(const Segment<double>& s, const dvec3& p) noexcept;

[[nodiscard]] inline Nearest closest(const dvec3& a, const dvec3& b) noexcept { return nearest(a, b); }
[[nodiscard]] inline Nearest closest(const dvec3& a, const Segment<double>& b) noexcept { return nearest(a, closest_on(b, a)); }
[[nodiscard]] inline Nearest closest(const dvec3& a, const Triangle<double>& b) noexcept { return nearest(a, TriangleFrame(b).closest(a)); }
/// Cost: one interior solution; for nearly parallel segments and where the solution lies outside, four point-segment ones more.
[[nodiscard]] Nearest closest(const Segment<double>& a, const Segment<double>& b) noexcept;
/// Crossing, two end points, three edges. Where they cross the distance is exactly 0. `slack` is the distance at which a crossing found
/// by signs counts as one: a rounding times the size.
[[nodiscard]] Nearest closest(const Segment<double>& a, const Triangle<double>& b, double slack) noexcept;
/// Nine pairs of edges, six corners, six crossings.
[[nodiscard]] Nearest closest(const Triangle<double>& a, const Triangle<double>& b, double slack) noexcept;

/// Replaces `best` where the segment from p to q crosses the triangle: distance 0, one common point. `of_p` and `of_q` are the ends'
/// heights over the triangle's plane in lengths of its normal. What is only nearly a crossing competes as a pair of points.
void offer_crossing(const dvec3& p, const dvec3& q, double of_p, double of_q, const TriangleFrame& triangle, double slack,
                    Nearest& best) noexcept;

}  // namespace carom::geo::detail
