// Judges an answer of geo::ray_interval or geo::cast_ray by exact rationals.
//
//   EXPECT_EQ(exact::fault(sphere, ray, geo::ray_interval(sphere, ray), 4.0), "");
//
// A solid's answer is right within k eps S (see ray_primitives.hpp) where the reported interval lies in the exact solid
// grown by that and holds the exact solid shrunk by it. A surface's is right where the reported point is that near the
// surface, and where a miss is no line that passes through the surface shrunk by it.
#pragma once

#include <carom/collision/ray_primitives.hpp>

#include "exact.hpp"

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace carom::exact {

struct Line {
    Vec origin;
    Vec direction;

    [[nodiscard]] Vec at(const Rational& t) const { return origin + t * direction; }
};

inline constexpr double kEps = std::numeric_limits<double>::epsilon();

// ------------------------------------------------------------------------------------------- solids: constraints on t
// along a line

/// The t of `range` for which low + t rate >= 0; empty ranges have low > high.
struct Range {
    Rational low, high;

    void keep_nonnegative(const Rational& at_zero, const Rational& rate) {
        if (rate.sign() == 0) {
            high = at_zero.sign() >= 0 ? high : Rational(low - 1);
        } else if (rate.sign() > 0) {
            low = std::max(low, Rational(-at_zero / rate));
        } else {
            high = std::min(high, Rational(-at_zero / rate));
        }
    }
    /// Whether a t of the range has q(t) <= 0. The minimum is at an end or at the vertex.
    [[nodiscard]] bool meets(const Quadratic& q) const {
        if (low > high) {
            return false;
        }
        return q.at(low).sign() <= 0 || q.at(high).sign() <= 0 ||
               (q.a.sign() > 0 && q.at(clamped(-q.b / q.a, low, high)).sign() <= 0);
    }
};

/// |from + t direction|² - r².
inline Quadratic ball(const Vec& from, const Vec& direction, const Rational& r) {
    return {length_sq(direction), dot(from, direction), length_sq(from) - r * r};
}

/// The same of what is across `axis`.
inline Quadratic tube(const Vec& from, const Vec& direction, const Vec& axis, const Rational& r) {
    const Rational nn = length_sq(axis);
    const Rational height = dot(from, axis);
    const Rational climb = dot(direction, axis);
    return {length_sq(direction) - climb * climb / nn, dot(from, direction) - height * climb / nn,
            length_sq(from) - height * height / nn - r * r};
}

/// Whether a point of the line with t in `range` is in the solid grown by `by`, which may be negative.
template <class T>
bool meets(const geo::Sphere<T>& s, const Line& line, Range range, const Rational& by) {
    const Rational r = number(s.radius) + by;
    return r.sign() >= 0 && range.meets(ball(line.origin - vec(s.center), line.direction, r));
}
/// Faces move by `by` times their distance from the origin, and by as much as t by its least number, which underflow may take.
template <class T>
bool meets(const geo::Aabb<T>& b, const Line& line, Range range, const Rational& by) {
    for (int k = 0; k < 3; ++k) {
        const Rational low = line.origin[k] - number(b.lower[k]);
        const Rational high = number(b.upper[k]) - line.origin[k];
        const Rational least = by.sign() * number(std::numeric_limits<T>::denorm_min()) * magnitude(line.direction[k]);
        range.keep_nonnegative(low + by * magnitude(low) + least, line.direction[k]);
        range.keep_nonnegative(high + by * magnitude(high) + least, -line.direction[k]);
    }
    return range.low <= range.high;
}
template <class T>
bool meets(const geo::Obb<T>& b, const Line& line, Range range, const Rational& by) {
    for (int k = 0; k < 3; ++k) {
        const Vec axis = vec(b.axes[k]);
        const Rational at = dot(axis, line.origin - vec(b.center));
        const Rational rate = dot(axis, line.direction);
        const Rational half = number(b.half_extents[k]) + by;
        range.keep_nonnegative(half + at, rate);
        range.keep_nonnegative(half - at, -rate);
    }
    return range.low <= range.high;
}
inline bool tube_meets(const Vec& from, const Vec& direction, const Vec& axis, Range range, const Rational& r,
                       const Rational& by_end) {
    const Rational slack = by_end * sqrt_up(length_sq(axis));
    range.keep_nonnegative(dot(from, axis) + slack, dot(direction, axis));
    range.keep_nonnegative(length_sq(axis) - dot(from, axis) + slack, -dot(direction, axis));
    return r.sign() >= 0 && range.meets(tube(from, direction, axis, r));
}
template <class T>
bool meets(const geo::Capsule<T>& c, const Line& line, const Range& range, const Rational& by) {
    const Rational r = number(c.radius) + by;
    const Vec a = vec(c.axis.a);
    const Vec b = vec(c.axis.b);
    return r.sign() >= 0 && (range.meets(ball(line.origin - a, line.direction, r)) ||
                             range.meets(ball(line.origin - b, line.direction, r)) ||
                             (!(a == b) && tube_meets(line.origin - a, line.direction, b - a, range, r, 0)));
}
template <class T>
bool meets(const geo::Cylinder<T>& c, const Line& line, const Range& range, const Rational& by) {
    const Vec a = vec(c.axis.a);
    return tube_meets(line.origin - a, line.direction, vec(c.axis.b) - a, range, number(c.radius) + by, by);
}
template <class T>
bool meets(const geo::Cone<T>& c, const Line& line, Range range, const Rational& by) {
    const Vec from = line.origin - vec(c.tip);
    const Vec axis = vec(c.base_center) - vec(c.tip);
    const Rational nn = length_sq(axis);
    const Rational height = dot(from, axis) / nn;
    const Rational climb = dot(line.direction, axis) / nn;
    const Rational end = by / sqrt_up(nn);
    const Rational slope = number(c.radius);
    const Rational aside =
        by * sqrt_up(1 + slope * slope / nn);  // across the axis, where the side moves by `by` along its normal
    range.keep_nonnegative(height + end, climb);
    range.keep_nonnegative(1 + end - height, -climb);
    const Rational radius = slope * height + aside;
    const Rational growth = slope * climb;
    range.keep_nonnegative(radius, growth);
    Quadratic q = tube(from, line.direction, axis, 0);
    q.a -= growth * growth;
    q.b -= growth * radius;
    q.c -= radius * radius;
    return range.meets(q);
}

/// S: the distance from the ray's origin and the size of what it meets, from above. What underflow loses counts as
/// size.
template <class T>
Rational reach(const Vec& o, const geo::Vec3<T>& center, const Rational& size) {
    const Vec c = vec(center);
    return sqrt_up(length_sq(o - c)) + size + number(0x1p-400) * (largest(o) + largest(c));
}
template <class T>
Rational reach(const geo::Sphere<T>& s, const Vec& o) {
    return reach(o, s.center, number(s.radius));
}
/// Aabb: k eps is relative to each face's distance.
template <class T>
Rational reach(const geo::Aabb<T>&, const Vec&) {
    return 1;
}
template <class T>
Rational reach(const geo::Obb<T>& b, const Vec& o) {
    return reach(o, b.center, sqrt_up(length_sq(vec(b.half_extents))));
}
template <class T>
Rational reach(const geo::Capsule<T>& c, const Vec& o) {
    return reach(o, c.axis.a, sqrt_up(length_sq(vec(c.axis.b) - vec(c.axis.a))) + number(c.radius));
}
template <class T>
Rational reach(const geo::Cylinder<T>& c, const Vec& o) {
    return reach(geo::Capsule<T>{c.axis, c.radius}, o);
}
template <class T>
Rational reach(const geo::Cone<T>& c, const Vec& o) {
    return reach(geo::Capsule<T>{{c.tip, c.base_center}, c.radius}, o);
}

/// Farther than any point of the solid, in t.
template <class Shape>
Rational far_t(const Shape& shape, const Line& line) {
    return 8 * reach(shape, line.origin) / sqrt_down(length_sq(line.direction));
}
template <class T>
Rational far_t(const geo::Aabb<T>& b, const Line& line) {
    return 8 * (largest(line.origin) + largest(vec(b.lower)) + largest(vec(b.upper))) / largest(line.direction);
}

/// `range` cut to t_min and t_max, where those are finite, and to what T holds.
template <class T>
Range cut_to(Range range, const geo::Ray<T>& ray) {
    constexpr T kMost = std::numeric_limits<T>::max();
    range.low = std::max(range.low, number(std::isfinite(ray.t_min) ? ray.t_min : -kMost));
    range.high = std::min(range.high, number(std::isfinite(ray.t_max) ? ray.t_max : kMost));
    return range;
}

/// What is wrong with the answer `got` for a valid solid and ray, or nothing. Where T is float, t may besides be off by
/// half an ulp.
template <template <class> class Shape, class T>
std::string fault(const Shape<T>& shape, const geo::Ray<T>& ray, const std::optional<geo::RayInterval<T>>& got,
                  double k) {
    const Line line{vec(ray.origin), vec(ray.direction)};
    const Rational by = number(k * kEps) * reach(shape, line.origin);
    const Rational far = far_t(shape, line);
    if (!got) {
        return meets(shape, line, cut_to({-far, far}, ray), -by) ? "a hit is missed" : "";
    }
    if (!(got->t_enter <= got->t_exit && got->t_enter <= ray.t_max && got->t_exit >= ray.t_min)) {
        return "the interval is not one of the ray";
    }
    if (!std::isfinite(got->t_enter) || !std::isfinite(got->t_exit)) {
        return "";  // beyond T, where the exact interval may lie anywhere
    }
    const Rational half_ulp = std::is_same_v<T, float> ? number(0x1p-24) : Rational(0);
    const auto around = [&](T t) {
        const Rational slack = half_ulp * magnitude(number(t)) + number(std::numeric_limits<T>::denorm_min());
        return Range{number(t) - slack, number(t) + slack};
    };
    if (!meets(shape, line, around(got->t_enter), by)) return "the entry is outside";
    if (!meets(shape, line, around(got->t_exit), by)) return "the exit is outside";
    if (meets(shape, line, {-far, around(got->t_enter).low}, -by)) return "the entry is too late";
    if (meets(shape, line, {around(got->t_exit).high, far}, -by)) return "the exit is too early";
    return "";
}

// ---------------------------------------------------------------------------------------------------------------------
// surfaces

/// A flat figure: whether a point of its plane is inside by more than `by`, and whether any point is within `by` of it.
template <class T>
struct Figure;

template <class T>
struct Figure<geo::Disc<T>> {
    Vec center, normal;
    Rational radius;

    explicit Figure(const geo::Disc<T>& d) : center(vec(d.center)), normal(vec(d.normal)), radius(number(d.radius)) {}
    [[nodiscard]] const Vec& origin() const { return center; }
    [[nodiscard]] Rational size(const Vec& o) const {
        return sqrt_up(length_sq(o - center)) + radius + number(0x1p-400) * (largest(o) + largest(center));
    }
    [[nodiscard]] bool deep_inside(const Vec& p, const Rational& by) const {
        return radius >= by && length_sq(p - center) <= square(radius - by);
    }
    [[nodiscard]] bool near_to(const Vec& p, const Rational& by) const {
        const Rational height = dot(p - center, normal);
        return height * height <= by * by * length_sq(normal) && length_sq(p - center) <= square(radius + by) + by * by;
    }
};

/// A polygon in order; a triangle is one.
struct Corners {
    std::vector<Vec> corners;
    Vec normal;

    [[nodiscard]] const Vec& origin() const { return corners[0]; }
    [[nodiscard]] Rational diameter() const {
        Rational d = 0;
        for (const Vec& a : corners) d = std::max(d, length_sq(a - corners[0]));
        return 2 * sqrt_up(d);
    }
    [[nodiscard]] bool near_outline(const Vec& p, const Rational& by) const {
        for (std::size_t i = 0; i < corners.size(); ++i) {
            if (distance_sq(p, corners[i], corners[(i + 1) % corners.size()]) <= by * by) return true;
        }
        return false;
    }
    /// By crossings in the plane without the axis of the largest normal component; points on the outline may count or
    /// not.
    [[nodiscard]] bool inside(const Vec& p) const {
        const Rational m = largest(normal);
        const int dropped = magnitude(normal.x) == m ? 0 : magnitude(normal.y) == m ? 1 : 2;
        const int x = (dropped + 1) % 3, y = (dropped + 2) % 3;
        bool odd = false;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Vec a = corners[i] - p;
            const Vec b = corners[(i + 1) % corners.size()] - p;
            if ((a[y].sign() > 0) != (b[y].sign() > 0)) {
                odd ^= (a[x] * b[y] - b[x] * a[y]).sign() * (b[y] - a[y]).sign() > 0;
            }
        }
        return odd;
    }
    [[nodiscard]] bool deep_inside(const Vec& p, const Rational& by) const { return inside(p) && !near_outline(p, by); }
    [[nodiscard]] bool near_to(const Vec& p, const Rational& by) const {
        const Rational height = dot(p - corners[0], normal);
        const Rational nn = length_sq(normal);
        if (nn.sign() != 0 && height * height <= by * by * nn && inside(p - height / nn * normal)) {
            return true;
        }
        return near_outline(p, by);
    }
};

template <class T>
struct Figure<geo::Triangle<T>> : Corners {
    explicit Figure(const geo::Triangle<T>& t)
        : Corners{{vec(t.a), vec(t.b), vec(t.c)}, cross(vec(t.b) - vec(t.a), vec(t.c) - vec(t.a))} {}
    [[nodiscard]] Rational size(const Vec& o) const {
        return std::max({sqrt_up(length_sq(o - corners[0])), sqrt_up(length_sq(o - corners[1])),
                         sqrt_up(length_sq(o - corners[2]))});
    }
};

template <class T>
struct Figure<std::span<const geo::Vec3<T>>> : Corners {
    explicit Figure(std::span<const geo::Vec3<T>> given) {
        for (const geo::Vec3<T>& c : given) corners.push_back(vec(c));
        for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
            normal = normal + cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
        }
    }
    [[nodiscard]] Rational size(const Vec& o) const {
        const Rational d = diameter();
        const Rational area = sqrt_down(length_sq(normal)) / 2;
        return (sqrt_up(length_sq(o - corners[0])) + d) * (1 + d * d / area);
    }
};

/// Whether what holds at both ends of a segment holds between them.
template <class Given>
inline constexpr bool kIsConvex = true;
template <class T>
inline constexpr bool kIsConvex<std::span<const geo::Vec3<T>>> = false;

/// What is wrong with the answer for a flat figure: `t` of the hit or nothing.
template <class Given, class T>
std::string surface_fault(const Given& given, const geo::Ray<T>& ray, std::optional<T> t, double k) {
    const Figure<Given> figure(given);
    const Line line{vec(ray.origin), vec(ray.direction)};
    const Rational by = number(k * kEps) * figure.size(line.origin);
    if (t) {
        const Rational rounded = std::is_same_v<T, float> ? number(0x1p-24) : Rational(0);
        const Rational slack = (rounded * magnitude(number(*t)) + number(std::numeric_limits<T>::denorm_min())) *
                               sqrt_up(length_sq(line.direction));
        return figure.near_to(line.at(number(*t)), by + slack) ? "" : "the hit is not on the surface";
    }
    const Rational rate = dot(figure.normal, line.direction);
    // A disc's plane may be missed where it is met at an angle below 2^-400.
    const Rational least =
        std::is_same_v<Given, geo::Disc<T>> ? number(0x1p-800) * length_sq(figure.normal) * length_sq(line.direction) : Rational(0);
    if (rate * rate <= least) return "";
    const Rational height = dot(figure.normal, figure.origin() - line.origin);
    const Rational thick = by * sqrt_up(length_sq(figure.normal));
    const auto crossing = [&](const Rational& moved) {
        return line.at((height + moved) / rate) - moved / length_sq(figure.normal) * figure.normal;
    };
    const auto crosses_deep = [&](const Rational& moved, const Rational& deep) {
        const Rational at = (height + moved) / rate;
        const Rational far = magnitude(at) + 1;
        const Range range = cut_to({-far, far}, ray);
        return range.low <= at && at <= range.high && figure.deep_inside(crossing(moved), deep);
    };
    if (!crosses_deep(thick, by) || !crosses_deep(-thick, by)) {
        return "";
    }
    // A grazing ray may pass a notch of the outline between the two: certain is what is as deep as they are apart.
    const Rational half = sqrt_up(length_sq(crossing(thick) - crossing(-thick))) / 2;
    return kIsConvex<Given> || crosses_deep(Rational(0), by + half) ? "a hit is missed" : "";
}

/// The plane itself: t has a relative error of k eps, or is as small as underflow.
template <class T>
std::string fault(const geo::Plane<T>& plane, const geo::Ray<T>& ray, const std::optional<geo::RayHit<T>>& got,
                  double k) {
    const Line line{vec(ray.origin), vec(ray.direction)};
    const Vec normal = vec(plane.normal);
    const Rational length = sqrt_up(length_sq(normal));
    const auto moved_by = [&](const Rational& t) {  // in lengths of the normal
        const Rational lost = largest(normal) * (largest(line.origin) + magnitude(t) * largest(line.direction)) +
                              magnitude(number(plane.offset));
        return number(k * kEps) * (magnitude(t * dot(normal, line.direction)) + number(0x1p-400) * lost);
    };
    const Rational height = number(plane.offset) - dot(normal, line.origin);
    const Rational rate = dot(normal, line.direction);
    if (got) {
        const Rational t = number(got->t);
        const Rational rounded = std::is_same_v<T, float> ? number(0x1p-24) : Rational(0);
        const Rational slack =
            (rounded * magnitude(t) + number(std::numeric_limits<T>::denorm_min())) * magnitude(rate);
        return magnitude(t * rate - height) <= moved_by(t) + slack ? "" : "the hit is not on the plane";
    }
    // Parallel, or so nearly that the sine of the angle underflows.
    if (magnitude(rate) <= number(0x1p-400) * largest(normal) * largest(line.direction)) {
        return "";
    }
    const Rational t = height / rate;
    if (magnitude(t) > number(std::numeric_limits<T>::max())) {
        return "";
    }
    const Rational slack = moved_by(t) / rate;
    const Rational far = magnitude(t) + magnitude(slack) + 1;
    const Range range = cut_to({-far, far}, ray);
    const bool certain =
        range.low <= t - slack && t - slack <= range.high && range.low <= t + slack && t + slack <= range.high;
    return certain ? "a hit is missed" : "";
}

}  // namespace carom::exact
