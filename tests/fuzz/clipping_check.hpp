// What must hold for any segment and polygon cut by any half-space, box or frustum: judged by exact rationals, for the
// fuzzer and for tests.
//
//   EXPECT_EQ(test::clipping_fault(bytes), "");
#pragma once

#include <carom/collision/clipping.hpp>

#include <support/exact_ray.hpp>
#include <support/query_cases.hpp>

#include <cmath>
#include <string>
#include <vector>

namespace carom::test {

/// The `t` for which a + t (b - a) is below a plane moved up by `by` metres.
template <class T>
void keep_below(exact::Range& range, const exact::Line& line, const geo::Plane<T>& plane, const exact::Rational& by) {
    const exact::Vec n = exact::vec(plane.normal);
    const exact::Rational moved = by * exact::sqrt_up(exact::length_sq(n));
    range.keep_nonnegative(exact::number(plane.offset) + moved - exact::dot(n, line.origin), -exact::dot(n, line.direction));
}

template <class T>
[[nodiscard]] exact::Range kept(exact::Range range, const exact::Line& line, const std::vector<geo::Plane<T>>& planes,
                                const exact::Rational& by) {
    for (const geo::Plane<T>& plane : planes) keep_below(range, line, plane, by);
    return range;
}
template <class T>
[[nodiscard]] exact::Range kept(exact::Range range, const exact::Line& line, const geo::Aabb<T>& box, const exact::Rational& by) {
    for (int k = 0; k < 3; ++k) {
        range.keep_nonnegative(line.origin[k] - exact::number(box.lower[k]) + by, line.direction[k]);
        range.keep_nonnegative(exact::number(box.upper[k]) - line.origin[k] + by, -line.direction[k]);
    }
    return range;
}
template <class T>
[[nodiscard]] exact::Range kept(exact::Range range, const exact::Line& line, const geo::Obb<T>& box, const exact::Rational& by) {
    for (int k = 0; k < 3; ++k) {
        const exact::Vec axis = exact::vec(box.axes[k]);
        const exact::Rational at = exact::dot(axis, line.origin - exact::vec(box.center));
        const exact::Rational half = exact::number(box.half_extents[k]) + by;
        range.keep_nonnegative(half + at, exact::dot(axis, line.direction));
        range.keep_nonnegative(half - at, -exact::dot(axis, line.direction));
    }
    return range;
}

/// What heights above planes may lose to underflow [m].
inline constexpr double kLostToUnderflow = 0x1p-800;

/// What is wrong with the part of `segment` that was kept of `solid`, if faces may be moved by `by`.
template <class T, class Solid>
[[nodiscard]] std::string segment_fault(const geo::Segment<T>& segment, const Solid& solid,
                                        const std::optional<geo::ClippedSegment<T>>& got, const exact::Rational& by) {
    const exact::Line line{exact::vec(segment.a), exact::vec(segment.b) - exact::vec(segment.a)};
    const auto is_left = [&](const exact::Range& range, const exact::Rational& moved) {
        const exact::Range k = kept(range, line, solid, moved);
        return k.low <= k.high;
    };
    if (!got) return is_left({0, 1}, -by) ? "a part is lost" : "";
    if (!(got->t_a >= T(0) && got->t_a <= got->t_b && got->t_b <= T(1))) return "the part is not one of the segment";
    // Whether an end is inside is decided exactly, but for underflow; by an oriented box, in its frame.
    const exact::Rational inside = std::is_same_v<Solid, geo::Obb<T>> ? exact::Rational(-by) : -exact::number(kLostToUnderflow);
    if (is_left({0, 0}, inside) && got->segment.a != segment.a) return "the first end is inside and changed";
    if (is_left({1, 1}, inside) && got->segment.b != segment.b) return "the second end is inside and changed";
    const exact::Rational half_ulp = exact::number(static_cast<double>(std::numeric_limits<T>::epsilon()) / 2.0);
    const auto around = [&](T t) {
        const exact::Rational slack = half_ulp * exact::number(t) + exact::number(std::numeric_limits<T>::denorm_min());
        return exact::Range{exact::number(t) - slack, exact::number(t) + slack};
    };
    if (!is_left(around(got->t_a), by) || !is_left(around(got->t_b), by)) return "an end is outside";
    if (got->t_a > T(0) && is_left({0, around(got->t_a).low}, -by)) return "it starts too late";
    if (got->t_b < T(1) && is_left({around(got->t_b).high, 1}, -by)) return "it ends too early";
    const exact::Rational off = exact::number(4.0 * static_cast<double>(std::numeric_limits<T>::epsilon())) *
                                    (exact::largest(line.origin) + exact::largest(line.direction)) +
                                4 * exact::number(std::numeric_limits<T>::denorm_min());
    if (exact::largest(line.at(exact::number(got->t_a)) - exact::vec(got->segment.a)) > off + by) return "its start is not on the segment";
    if (exact::largest(line.at(exact::number(got->t_b)) - exact::vec(got->segment.b)) > off + by) return "its end is not on the segment";
    return "";
}

/// What is wrong with the corners left of a flat polygon: all are in the half-spaces and on the polygon to 4 ulp of the
/// coordinates, and there are not too many.
template <class T, class Solid>
[[nodiscard]] std::string polygon_fault(std::span<const geo::Vec3<T>> polygon, const Solid& solid, std::span<const geo::Vec3<T>> left,
                                        const exact::Rational& size) {
    const exact::Figure<std::span<const geo::Vec3<T>>> figure(polygon);
    const exact::Rational by = exact::number(4.0 * static_cast<double>(std::numeric_limits<T>::epsilon())) * size +
                               4 * exact::number(std::numeric_limits<T>::denorm_min()) + exact::number(kLostToUnderflow);
    for (const geo::Vec3<T>& corner : left) {
        const exact::Line point{exact::vec(corner), {0, 0, 0}};
        const exact::Range k = kept({0, 0}, point, solid, by);
        if (k.low > k.high) return "a corner is outside";
        const exact::Rational height = exact::dot(point.origin - figure.origin(), figure.normal);
        if (height * height > 4 * by * by * exact::length_sq(figure.normal)) return "a corner is not in the polygon's plane";
        // Parts of polygons that are not convex stay joined along a plane, outside of them.
        if (polygon.size() == 3 && !figure.near_to(point.origin, 2 * by)) return "a corner is not on the triangle";
    }
    return "";
}

template <class T>
[[nodiscard]] exact::Rational size_of(const std::vector<geo::Plane<T>>& planes) {
    exact::Rational size = 0;
    for (const geo::Plane<T>& p : planes) {
        size = std::max(size, exact::magnitude(exact::number(p.offset)) / exact::sqrt_down(exact::length_sq(exact::vec(p.normal))));
    }
    return size;
}
template <class T>
[[nodiscard]] exact::Rational size_of(const geo::Aabb<T>&) {
    return 0;
}
template <class T>
[[nodiscard]] exact::Rational size_of(const geo::Obb<T>& box) {
    return exact::largest(exact::vec(box.center)) + exact::largest(exact::vec(box.half_extents));
}

template <class T, class Solid>
[[nodiscard]] std::string clip_fault(const Solid& solid, Draw<T>& draw) {
    using Planes = std::vector<geo::Plane<T>>;
    const geo::Segment<T> segment = draw.segment();
    if (!is_finite(segment.a) || !is_finite(segment.b)) return "";
    const exact::Vec a = exact::vec(segment.a);
    const exact::Vec b = exact::vec(segment.b);
    exact::Rational reach = exact::sqrt_up(exact::length_sq(b - a)) + exact::number(std::numeric_limits<T>::denorm_min());
    if constexpr (std::is_same_v<Solid, geo::Obb<T>>) {
        reach = exact::reach(solid, a) + exact::reach(solid, b);
    }
    const exact::Rational by = exact::number(16.0 * exact::kEps) * reach + exact::number(kLostToUnderflow);
    const std::vector<geo::Vec3<T>> corners = draw.polygon();
    geo::PolygonClipper<T> clipper;
    std::optional<geo::ClippedSegment<T>> part;
    std::span<const geo::Vec3<T>> left;
    if constexpr (std::is_same_v<Solid, Planes>) {
        part = geo::clip(segment, std::span<const geo::Plane<T>>(solid));
        left = clipper.clip(corners, std::span<const geo::Plane<T>>(solid));
    } else {
        part = geo::clip(segment, solid);
        left = clipper.clip(corners, solid);
    }
    const std::string fault = segment_fault(segment, solid, part, by);
    if (!fault.empty()) return fault;
    exact::Rational size = size_of(solid);
    for (const geo::Vec3<T>& c : corners) size = std::max(size, exact::largest(exact::vec(c)));
    return polygon_fault<T>(corners, solid, left, size);
}

template <class T>
[[nodiscard]] std::string clipping_fault_in(int which, Draw<T>& draw) {
    if (which == 0) {
        std::vector<geo::Plane<T>> planes(1 + draw.byte() % 6);
        for (geo::Plane<T>& p : planes) p = draw.plane();
        return clip_fault(planes, draw);
    }
    return which == 1 ? clip_fault(draw.aabb(), draw) : clip_fault(draw.obb(), draw);
}

inline constexpr int kClippings = 3;

/// What is wrong with the answers for the scenes that `bytes` describe, or nothing. The first byte chooses solid and
/// precision.
[[nodiscard]] inline std::string clipping_fault(std::span<const std::uint8_t> bytes) {
    if (bytes.empty()) return "";
    const int which = bytes[0] % (2 * kClippings);
    const std::span<const std::uint8_t> rest = bytes.subspan(1);
    if (which < kClippings) {
        Draw<float> draw(rest);
        return clipping_fault_in(which, draw);
    }
    Draw<double> draw(rest);
    return clipping_fault_in(which - kClippings, draw);
}

}  // namespace carom::test
