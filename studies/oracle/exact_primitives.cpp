#include <carom/studies/oracle/exact_primitives.hpp>

#include <boost/multiprecision/cpp_bin_float.hpp>

#include <algorithm>
#include <array>
#include <optional>

namespace carom::oracle {
namespace {

namespace mp = boost::multiprecision;
// Without expression templates, so that `auto` and `?:` hold values. The exponent's range is far beyond a double's.
using Real = mp::number<mp::cpp_bin_float<300, mp::digit_base_2, void, std::int32_t>, mp::et_off>;
using Vector = std::array<Real, 3>;

Vector vec(const dvec3& v) { return {Real(v.x), Real(v.y), Real(v.z)}; }
Vector operator+(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector operator*(const Real& s, const Vector& a) { return {s * a[0], s * a[1], s * a[2]}; }
Real dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Real magnitude(const Real& x) { return x < 0 ? -x : x; }
Real clamped(const Real& x) { return x < 0 ? Real(0) : x > 1 ? Real(1) : x; }

PreciseAnswer at(const Real& t) { return {true, static_cast<double>(t)}; }

// The part of a ray inside a solid: its first point, if it has any.
PreciseAnswer first_of(const Real& enter, const Real& leave, const geo::Ray<double>& ray) {
    const Real start = std::max(enter, Real(ray.t_min));
    return start <= leave && start <= Real(ray.t_max) ? at(start) : PreciseAnswer{};
}

Real point_segment_sq(const Vector& p, const Vector& a, const Vector& b) {
    const Vector along = b - a;
    const Real length_sq = dot(along, along);
    const Real s = length_sq == 0 ? Real(0) : clamped(dot(p - a, along) / length_sq);
    const Vector gap = p - (a + s * along);
    return dot(gap, gap);
}

Real point_triangle_sq(const Vector& p, const Vector& a, const Vector& b, const Vector& c) {
    const Vector n = cross(b - a, c - a);
    const auto left = [&](const Vector& from, const Vector& to) { return dot(cross(to - from, p - from), n) >= 0; };
    if (dot(n, n) != 0 && left(a, b) && left(b, c) && left(c, a)) {
        const Real height = dot(p - a, n);
        return height * height / dot(n, n);
    }
    return std::min({point_segment_sq(p, a, b), point_segment_sq(p, b, c), point_segment_sq(p, c, a)});
}

// Of two segments: where their lines are closest if that is within both, otherwise an end of one.
Real segment_segment_sq(const Vector& a0, const Vector& a1, const Vector& b0, const Vector& b1) {
    const Real best = std::min({point_segment_sq(a0, b0, b1), point_segment_sq(a1, b0, b1), point_segment_sq(b0, a0, a1),
                                point_segment_sq(b1, a0, a1)});
    const Vector u = a1 - a0, v = b1 - b0, w = b0 - a0;
    const Vector n = cross(u, v);
    const Real nn = dot(n, n);
    if (nn == 0) return best;
    const Real s = dot(cross(w, v), n) / nn, t = dot(cross(w, u), n) / nn;
    if (s < 0 || s > 1 || t < 0 || t > 1) return best;
    const Real height = dot(w, n);
    return std::min<Real>(best, height * height / nn);
}

PreciseAnswer distance_of(const Real& square) { return {square == 0, static_cast<double>(mp::sqrt(square))}; }

struct Parallelepiped {
    Vector center;
    std::array<Vector, 3> sides;  // half of each edge

    explicit Parallelepiped(const geo::Obb<double>& box) : center(vec(box.center)) {
        for (int k = 0; k < 3; ++k) {
            sides[static_cast<std::size_t>(k)] = Real(box.half_extents[k]) * vec(box.axes[k]);
        }
    }
    [[nodiscard]] Real reach(const Vector& axis) const {
        return magnitude(dot(sides[0], axis)) + magnitude(dot(sides[1], axis)) + magnitude(dot(sides[2], axis));
    }
};

}  // namespace

PreciseAnswer first_hit(const geo::Sphere<double>& sphere, const geo::Ray<double>& ray) {
    const Vector o = vec(ray.origin) - vec(sphere.center), d = vec(ray.direction);
    const Real a = dot(d, d), b = dot(o, d), c = dot(o, o) - Real(sphere.radius) * Real(sphere.radius);
    const Real discriminant = b * b - a * c;
    if (discriminant < 0) return {};
    const Real root = mp::sqrt(discriminant);
    return first_of((-b - root) / a, (-b + root) / a, ray);
}

PreciseAnswer first_hit(const geo::Aabb<double>& box, const geo::Ray<double>& ray) {
    std::optional<Real> enter, leave;
    for (int k = 0; k < 3; ++k) {
        const Real low = Real(box.lower[k]) - Real(ray.origin[k]), high = Real(box.upper[k]) - Real(ray.origin[k]);
        const Real d(ray.direction[k]);
        if (d == 0) {
            if (low > 0 || high < 0) return {};
            continue;
        }
        const Real first = std::min<Real>(low / d, high / d), last = std::max<Real>(low / d, high / d);
        enter = enter ? std::max(*enter, first) : first;
        leave = leave ? std::min(*leave, last) : last;
    }
    return first_of(*enter, *leave, ray);
}

PreciseAnswer first_hit(const geo::Triangle<double>& triangle, const geo::Ray<double>& ray) {
    const Vector o = vec(ray.origin), d = vec(ray.direction);
    const Vector a = vec(triangle.a) - o, b = vec(triangle.b) - o, c = vec(triangle.c) - o;
    const Real u = dot(d, cross(b, c)), v = dot(d, cross(c, a)), w = dot(d, cross(a, b));
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return {};
    const Real below = u + v + w;
    if (below == 0) return {};
    const Real t = dot(a, cross(b, c)) / below;
    return t >= Real(ray.t_min) && t <= Real(ray.t_max) ? at(t) : PreciseAnswer{};
}

PreciseAnswer distance(const dvec3& point, const geo::Triangle<double>& triangle) {
    return distance_of(point_triangle_sq(vec(point), vec(triangle.a), vec(triangle.b), vec(triangle.c)));
}

PreciseAnswer distance(const geo::Segment<double>& a, const geo::Segment<double>& b) {
    return distance_of(segment_segment_sq(vec(a.a), vec(a.b), vec(b.a), vec(b.b)));
}

PreciseAnswer overlap(const geo::Sphere<double>& sphere, const geo::Aabb<double>& box) {
    Real square(0);
    for (int k = 0; k < 3; ++k) {
        const Real center(sphere.center[k]);
        const Real outside = std::max({Real(box.lower[k]) - center, center - Real(box.upper[k]), Real(0)});
        square += outside * outside;
    }
    return {square <= Real(sphere.radius) * Real(sphere.radius), 0.0};
}

PreciseAnswer overlap(const geo::Capsule<double>& a, const geo::Capsule<double>& b) {
    const Real reach = Real(a.radius) + Real(b.radius);
    return {segment_segment_sq(vec(a.axis.a), vec(a.axis.b), vec(b.axis.a), vec(b.axis.b)) <= reach * reach, 0.0};
}

PreciseAnswer overlap(const geo::Obb<double>& a, const geo::Obb<double>& b) {
    const Parallelepiped p(a), q(b);
    const Vector between = q.center - p.center;
    const auto separates = [&](const Vector& axis) { return magnitude(dot(between, axis)) > p.reach(axis) + q.reach(axis); };
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        if (separates(cross(p.sides[i], p.sides[j])) || separates(cross(q.sides[i], q.sides[j]))) return {};
        for (std::size_t k = 0; k < 3; ++k) {
            if (separates(cross(p.sides[i], q.sides[k]))) return {};
        }
    }
    return {true, 0.0};
}

}  // namespace carom::oracle
