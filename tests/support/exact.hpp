// Exact rational geometry: the oracle for queries in floating point.
//
//   exact::Vec p = exact::vec(ray.origin) + exact::Rational(t) * exact::vec(ray.direction);
//   EXPECT_TRUE(exact::distance_sq(p, exact::vec(segment.a), exact::vec(segment.b)) <= exact::square(r + slack));
//
// Floats and doubles convert exactly, sums, products and quotients are exact, so every comparison has the right answer.
// Lengths are compared by their squares; sqrt_up() and sqrt_down() enclose one where a length itself is wanted.
#pragma once

#include <carom/core/types.hpp>

#include <support/rational.hpp>

#include <algorithm>
#include <cmath>
#include <span>

namespace carom::exact {

/// `x` is finite.
template <class T>
[[nodiscard]] Rational number(T x) {
    return Rational(static_cast<double>(x));
}
[[nodiscard]] inline int sign(const Rational& x) { return x.sign(); }
[[nodiscard]] inline Rational square(const Rational& x) { return x * x; }
[[nodiscard]] inline Rational magnitude(const Rational& x) { return x.sign() < 0 ? Rational(-x) : x; }
[[nodiscard]] inline Rational clamped(const Rational& x, const Rational& low, const Rational& high) {
    return x < low ? low : high < x ? high : x;
}

struct Vec {
    Rational x, y, z;

    [[nodiscard]] const Rational& operator[](int k) const { return k == 0 ? x : k == 1 ? y : z; }
    [[nodiscard]] Rational& operator[](int k) { return k == 0 ? x : k == 1 ? y : z; }
    friend Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vec operator-(const Vec& a) { return {-a.x, -a.y, -a.z}; }
    friend Vec operator*(const Rational& s, const Vec& a) { return {s * a.x, s * a.y, s * a.z}; }
    friend bool operator==(const Vec& a, const Vec& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
};

template <class T>
[[nodiscard]] Vec vec(const glm::vec<3, T>& v) {
    return {number(v.x), number(v.y), number(v.z)};
}
[[nodiscard]] inline Rational dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
[[nodiscard]] inline Rational length_sq(const Vec& a) { return dot(a, a); }
[[nodiscard]] inline Vec cross(const Vec& a, const Vec& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// The largest component's magnitude: the size of `a` up to a factor sqrt(3), without a root.
[[nodiscard]] inline Rational largest(const Vec& a) {
    return std::max({magnitude(a.x), magnitude(a.y), magnitude(a.z)});
}

/// At least the root of x >= 0, by at most a few parts in 1e15.
[[nodiscard]] inline Rational sqrt_up(const Rational& x) {
    if (x.sign() <= 0) {
        return 0;
    }
    // Scaled by a power of four to a number that double holds, whatever the size of x.
    const Rational scale = Rational::power_of_two(x.exponent() / 2);
    const double root = std::sqrt(static_cast<double>(Rational(x / square(scale)))) * (1.0 + 0x1p-50);
    return scale * Rational(root);
}
/// At most the root of x >= 0, by at most a few parts in 1e15.
[[nodiscard]] inline Rational sqrt_down(const Rational& x) {
    const Rational up = sqrt_up(x);
    return up.sign() == 0 ? up : Rational(x / up);
}

/// Squared distance of p from the segment a b, which may be a point.
[[nodiscard]] inline Rational distance_sq(const Vec& p, const Vec& a, const Vec& b) {
    const Vec along = b - a, from_a = p - a;
    const Rational l = length_sq(along), t = dot(from_a, along);
    if (t.sign() <= 0) return length_sq(from_a);
    if (t >= l) return length_sq(p - b);
    return (length_sq(from_a) * l - square(t)) / l;  // one quotient
}

/// Squared distance of p from the triangle a b c, which may be a segment or a point.
[[nodiscard]] inline Rational distance_sq(const Vec& p, const Vec& a, const Vec& b, const Vec& c) {
    const Vec n = cross(b - a, c - a);
    const Rational nn = length_sq(n);
    if (nn.sign() != 0) {
        const auto left = [&](const Vec& from, const Vec& to) {
            return dot(cross(to - from, p - from), n).sign() >= 0;
        };
        if (left(a, b) && left(b, c) && left(c, a)) {
            return square(dot(p - a, n)) / nn;
        }
    }
    return std::min({distance_sq(p, a, b), distance_sq(p, b, c), distance_sq(p, c, a)});
}

/// The real roots of a t² + 2 b t + c, compared with rationals without being formed.
struct Quadratic {
    Rational a, b, c;

    [[nodiscard]] Rational at(const Rational& t) const { return (a * t + 2 * b) * t + c; }
    [[nodiscard]] Rational discriminant() const { return b * b - a * c; }
    /// Whether the lower root is >= t, for a > 0 and a discriminant >= 0.
    [[nodiscard]] bool low_root_at_least(const Rational& t) const { return at(t).sign() >= 0 && t * a <= -b; }
    /// Whether the upper root is <= t, for a > 0 and a discriminant >= 0.
    [[nodiscard]] bool high_root_at_most(const Rational& t) const { return at(t).sign() >= 0 && t * a >= -b; }
};

}  // namespace carom::exact
