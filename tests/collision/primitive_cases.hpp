// Random primitives for tests, ordinary and awkward, and the size that error bounds are stated in.
//
//   Cases<float> cases(0x5eed);
//   auto [a, b] = cases.near_pair<geo::Obb<float>, geo::Triangle<float>>();
#pragma once

#include <carom/collision/closest_points.hpp>
#include <carom/collision/primitives.hpp>
#include <carom/core/math.hpp>
#include <carom/core/pose.hpp>
#include <carom/core/random.hpp>

#include <algorithm>
#include <cmath>

namespace carom::test {

using geo::Vec3;

// Everything a primitive's coordinates are made of, moved or scaled.
template <class T>
Vec3<T> moved(const Vec3<T>& p, const dvec3& by, double scale) {
    return Vec3<T>((dvec3(p) + by) * scale);
}
template <class T>
geo::Segment<T> moved(const geo::Segment<T>& s, const dvec3& by, double scale = 1.0) {
    return {moved(s.a, by, scale), moved(s.b, by, scale)};
}
template <class T>
geo::Triangle<T> moved(const geo::Triangle<T>& t, const dvec3& by, double scale = 1.0) {
    return {moved(t.a, by, scale), moved(t.b, by, scale), moved(t.c, by, scale)};
}
template <class T>
geo::Sphere<T> moved(const geo::Sphere<T>& s, const dvec3& by, double scale = 1.0) {
    return {moved(s.center, by, scale), static_cast<T>(static_cast<double>(s.radius) * scale)};
}
template <class T>
geo::Capsule<T> moved(const geo::Capsule<T>& c, const dvec3& by, double scale = 1.0) {
    return {moved(c.axis, by, scale), static_cast<T>(static_cast<double>(c.radius) * scale)};
}
template <class T>
geo::Aabb<T> moved(const geo::Aabb<T>& b, const dvec3& by, double scale = 1.0) {
    return {moved(b.lower, by, scale), moved(b.upper, by, scale)};
}
template <class T>
geo::Obb<T> moved(const geo::Obb<T>& b, const dvec3& by, double scale = 1.0) {
    return {moved(b.center, by, scale), moved(b.half_extents, dvec3{0.0}, scale), b.axes};
}

/// Primitives of a size of about one, near the origin.
template <class T>
class Cases {
public:
    explicit Cases(std::uint64_t seed) : random_(seed) {}

    Random& random() { return random_; }
    bool one_in(int n) { return random_.unit() * n < 1.0; }

    /// One in four on a grid of halves, where things touch, lie flat and are parallel; the rest anywhere in [-size, size]^3.
    Vec3<T> point(double size) {
        dvec3 p{random_.range(-size, size), random_.range(-size, size), random_.range(-size, size)};
        if (grid_) {
            for (int i = 0; i < 3; ++i) p[i] = std::round(2.0 * p[i]) / 2.0;
        }
        return Vec3<T>(p);
    }
    T length() { return static_cast<T>(grid_ ? std::round(random_.range(0.0, 3.0)) / 2.0 : random_.range(0.0, 1.0)); }

    /// Sets whether the next primitives stand on the grid.
    void choose_grid() { grid_ = one_in(3); }
    void set_grid(bool on) { grid_ = on; }

    glm::mat<3, 3, T> axes() {
        dquat q = rotation_from_vector({random_.range(-3, 3), random_.range(-3, 3), random_.range(-3, 3)});
        if (grid_) q = rotation_about({0, 0, 1}, kPi / 2 * std::round(random_.range(0, 3)));
        // Nearly along the axes: where edges are nearly parallel, by an angle of any magnitude.
        if (one_in(3)) q = rotation_from_vector(dvec3(point(1.0)) * std::ldexp(1.0, -static_cast<int>(random_.range(0, 50))));
        const dquat u = q / std::sqrt(glm::dot(q, q));
        return glm::mat<3, 3, T>(dmat3{rotate(u, dvec3{1, 0, 0}), rotate(u, dvec3{0, 1, 0}), rotate(u, dvec3{0, 0, 1})});
    }

    void make(Vec3<T>& p) { p = point(1.0); }
    void make(geo::Segment<T>& s) {
        s = {point(1.0), point(1.0)};
        if (one_in(8)) s.b = s.a;
        if (one_in(6)) s.b = s.a + Vec3<T>(1, 0, static_cast<T>(std::ldexp(random_.range(-1, 1), -static_cast<int>(random_.range(0, 50)))));
    }
    void make(geo::Sphere<T>& s) { s = {point(1.0), length()}; }
    void make(geo::Capsule<T>& c) {
        make(c.axis);
        c.radius = one_in(6) ? T(0) : length();
    }
    void make(geo::Aabb<T>& b) {
        const Vec3<T> p = point(1.0), q = point(1.0);
        b = {glm::min(p, q), glm::max(p, q)};
        if (one_in(10)) b.upper.y = b.lower.y;
    }
    void make(geo::Obb<T>& b) {
        b = {point(1.0), {length(), length(), length()}, axes()};
        if (one_in(10)) b.half_extents.z = 0;
    }
    void make(geo::Triangle<T>& t) {
        t = {point(1.0), point(1.0), point(1.0)};
        if (one_in(4)) {  // a needle, of any thinness down to none
            const T s = static_cast<T>(random_.range(-0.2, 1.2));
            t.c = t.a + s * (t.b - t.a) + Vec3<T>(dvec3(point(1.0)) * std::ldexp(1.0, -static_cast<int>(random_.range(1, 56))));
        }
        if (one_in(16)) t.c = t.a;
        if (one_in(40)) t.b = t.c = t.a;
    }

    template <class A, class B>
    std::pair<A, B> pair() {
        choose_grid();
        A a;
        B b;
        make(a), make(b);
        return {a, moved(b, dvec3{random_.range(-1, 1), random_.range(-1, 1), random_.range(-1, 1)} * (grid_ ? 0.0 : 1.5), 1.0)};
    }

    /// Brought to where they just touch, just not, or just overlap: off by nothing or by a few roundings up to 1e-3.
    template <class A, class B>
    std::pair<A, B> near_pair() {
        auto [a, b] = pair<A, B>();
        for (int i = 0; i < 3; ++i) {
            const auto c = geo::closest_points(a, b);
            const dvec3 d(dvec3(c.on_a) - dvec3(c.on_b));
            b = moved(b, d, 1.0);
        }
        const double off =
            one_in(4) ? 0.0 : std::ldexp(random_.range(-1, 1), -static_cast<int>(random_.range(10, sizeof(T) == 4 ? 28 : 56)));
        return {a, moved(b, dvec3{random_.range(-1, 1), random_.range(-1, 1), random_.range(-1, 1)} * off, 1.0)};
    }

private:
    Random random_;
    bool grid_ = false;
};

}  // namespace carom::test
