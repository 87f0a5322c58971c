// Scenes for queries out of strings of bytes, for tests (pseudo-random bytes) and fuzzers (any bytes) alike.
//
//   Draw<float> draw(bytes);
//   geo::Sphere<float> ball = draw.sphere();
//   geo::Ray<float> ray = draw.ray_at(anchors(ball));
//
// Most scenes lie where mistakes are: on a lattice of small integers, with equal and neighbouring numbers, far from the
// world's origin, tiny or huge, and with rays aimed at corners, edges, rims and tangent points.
#pragma once

#include <carom/collision/primitives.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

namespace carom::test {

[[nodiscard]] inline std::vector<std::uint8_t> random_bytes(Random& random, std::size_t count) {
    std::vector<std::uint8_t> bytes(count);
    for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random.unit() * 256.0);
    return bytes;
}

/// Draws numbers and shapes from bytes, zeros once those are used up. All it draws is finite and valid.
template <class T>
class Draw {
public:
    explicit Draw(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
        style_ = byte() % 5;
        if (style_ == 3) {
            far_ = vec_of(T(1)) * std::ldexp(T(1), byte() % 16);
        } else if (style_ == 4) {
            scale_ = std::ldexp(T(1), byte() % 128 - 64);
        }
    }

    std::uint8_t byte() {
        if (bytes_.empty()) return 0;
        const std::uint8_t first = bytes_.front();
        bytes_ = bytes_.subspan(1);
        return first;
    }
    [[nodiscard]] bool empty() const { return bytes_.empty(); }

    /// About [-4, 4], times the scene's scale; in one style of five any of 1e-20 to 1e20, ±0, denormals.
    T number() {
        T x = T(0);
        const int how = byte();
        if (style_ == 0) {
            x = static_cast<T>(how % 9 - 4);
        } else if (style_ == 2 && how < 64) {
            x = special(how % 8);
        } else if (how < 16) {
            x = last_;
        } else if (how < 32) {
            x = std::nextafter(last_, how % 2 == 0 ? T(9) : T(-9));
        } else {
            x = T(4) * fraction();
        }
        return last_ = std::isfinite(x) ? x : T(1);
    }
    T length() { return std::abs(number()) * scale_; }
    T positive_length() {
        const T x = length();
        return x > T(0) ? x : scale_;
    }
    geo::Vec3<T> point() { return vec_of(scale_) + far_; }
    geo::Vec3<T> direction() {
        const geo::Vec3<T> v = vec_of(T(1));
        return v == geo::Vec3<T>{T(0)} ? geo::Vec3<T>{T(0), T(-0.0), T(1)} : v;
    }
    /// Rotations by quaternions of small integers or any numbers, orthonormal to a few ulp of T.
    glm::mat<3, 3, T> axes() {
        if (byte() % 4 == 0) return glm::mat<3, 3, T>(T(1));
        const double w = 1.0 + static_cast<double>(fraction());
        const glm::dquat q(w, static_cast<double>(fraction()), static_cast<double>(fraction()),
                           static_cast<double>(fraction()));
        return glm::mat<3, 3, T>(glm::mat3_cast(q / std::sqrt(glm::dot(q, q))));
    }

    geo::Plane<T> plane() { return {direction(), number() * scale_}; }
    geo::Sphere<T> sphere() { return {point(), length()}; }
    geo::Aabb<T> aabb() {
        const geo::Vec3<T> a = point();
        const geo::Vec3<T> b = point();
        return {glm::min(a, b), glm::max(a, b)};
    }
    geo::Obb<T> obb() { return {point(), {length(), length(), length()}, axes()}; }
    geo::Segment<T> segment() {
        const geo::Vec3<T> a = point();
        return {a, point()};
    }
    geo::Capsule<T> capsule() { return {segment(), length()}; }
    geo::Cylinder<T> cylinder() { return {axis(), positive_length()}; }
    geo::Cone<T> cone() {
        const geo::Segment<T> s = axis();
        return {s.a, s.b, positive_length()};
    }
    geo::Disc<T> disc() { return {point(), direction(), length()}; }
    geo::Triangle<T> triangle() {
        const geo::Segment<T> s = segment();
        return {s.a, s.b, point()};
    }
    /// Flat and perhaps concave or crossing itself: 3 to 8 corners with whole coordinates in a plane along two axes, or
    /// in one across a space diagonal.
    std::vector<geo::Vec3<T>> polygon() {
        const int n = 3 + byte() % 6;
        const int how = byte() % 4;
        std::vector<geo::Vec3<T>> corners;
        for (int i = 0; i < n; ++i) {
            const T u = static_cast<T>(byte() % 9 - 4) * scale_;
            const T v = static_cast<T>(byte() % 9 - 4) * scale_;
            geo::Vec3<T> c{u, v, how == 3 ? -u - v : T(0)};
            for (int turn = 0; turn < how % 3; ++turn) c = {c.z, c.x, c.y};
            corners.push_back(c);
        }
        return corners;
    }

    /// A ray from anywhere or from one of the anchors; anywhere, towards an anchor or a point between two, or along an
    /// axis through it.
    geo::Ray<T> ray_at(std::span<const geo::Vec3<T>> anchors) {
        geo::Ray<T> ray;
        const int how = byte();
        const geo::Vec3<T> target = pick(anchors);
        ray.origin = how % 8 == 0 ? pick(anchors) : point();
        if (how % 4 == 1) {
            ray.origin += (ray.origin - far_) * std::ldexp(T(1), byte() % 20);
        }
        ray.direction = how % 16 < 12 ? target - ray.origin : direction();
        if (how >= 192) {
            const int k = how % 3;
            ray.direction = geo::Vec3<T>{T(how % 2 == 0 ? 0.0 : -0.0)};
            ray.direction[k] = how % 2 == 0 ? T(-2) : T(1);
            ray.origin = target - ray.direction * length();
        }
        if (ray.direction == geo::Vec3<T>{T(0)} || !is_finite(ray.direction)) ray.direction = direction();
        const int range = byte();
        if (range < 32) ray.t_max = std::abs(fraction()) * T(2);
        if (range % 8 == 0) ray.t_min = -std::numeric_limits<T>::infinity();
        if (range % 8 == 1) ray.t_min = std::min(fraction(), ray.t_max);
        return ray;
    }

private:
    T fraction() {
        std::uint32_t bits = 0;
        for (int i = 0; i < 4; ++i) bits = bits << 8 | byte();
        return static_cast<T>(static_cast<double>(bits) * 0x1p-31 - 1.0);
    }
    T special(int which) {
        constexpr T kValues[8] = {T(0),     T(-0.0), std::numeric_limits<T>::denorm_min(), T(1e-20), T(-1e20), T(1e10),
                                  T(-1e-7), T(1e20)};
        return kValues[which];
    }
    geo::Vec3<T> vec_of(T scale) {
        const T x = number();
        const T y = number();
        return geo::Vec3<T>{x, y, number()} * scale;
    }
    geo::Segment<T> axis() {
        geo::Segment<T> s = segment();
        if (s.a == s.b) s.b.y += std::max(scale_, std::abs(s.b.y));
        return s;
    }
    geo::Vec3<T> pick(std::span<const geo::Vec3<T>> anchors) {
        const geo::Vec3<T> a = anchors[byte() % anchors.size()];
        const int how = byte();
        if (how < 128) return a;
        const geo::Vec3<T> b = anchors[byte() % anchors.size()];
        return how < 160 ? (a + b) * T(0.5) : a + (b - a) * std::abs(fraction());
    }

    std::span<const std::uint8_t> bytes_;
    int style_ = 0;
    T scale_ = T(1);
    geo::Vec3<T> far_{T(0)};
    T last_ = T(1);
};

// ----------------------------------------------------------------------- anchors: corners, rims, tangent points, the
// middle comes last

template <class T>
using Points = std::vector<geo::Vec3<T>>;

template <class T>
Points<T> around(const geo::Vec3<T>& center, const glm::mat<3, 3, T>& axes, const geo::Vec3<T>& r) {
    Points<T> points;
    for (int k = 0; k < 3; ++k) {
        points.push_back(center + axes[k] * r[k]);
        points.push_back(center - axes[k] * r[k]);
    }
    points.push_back(center);
    return points;
}
template <class T>
Points<T> corners_of(const geo::Vec3<T>& center, const glm::mat<3, 3, T>& axes, const geo::Vec3<T>& half) {
    Points<T> points;
    for (int i = 0; i < 8; ++i) {
        points.push_back(center + axes[0] * (i & 1 ? half.x : -half.x) + axes[1] * (i & 2 ? half.y : -half.y) +
                         axes[2] * (i & 4 ? half.z : -half.z));
    }
    points.push_back(center);
    return points;
}
/// Two axes across `along`, and it, of unit length.
template <class T>
glm::mat<3, 3, T> axes_about(const geo::Vec3<T>& along) {
    const dvec3 n(along);
    const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
    if (!(largest > 0.0)) return glm::mat<3, 3, T>(T(1));
    const dvec3 unit = glm::normalize(n / largest);
    const dvec3 side = any_perpendicular(unit);
    return glm::mat<3, 3, T>(dmat3(side, glm::cross(unit, side), unit));
}

template <class T>
Points<T> anchors(const geo::Sphere<T>& s) {
    return around(s.center, glm::mat<3, 3, T>(T(1)), geo::Vec3<T>{s.radius});
}
template <class T>
Points<T> anchors(const geo::Aabb<T>& b) {
    Points<T> points;
    for (int i = 0; i < 8; ++i) {
        points.push_back({i & 1 ? b.upper.x : b.lower.x, i & 2 ? b.upper.y : b.lower.y, i & 4 ? b.upper.z : b.lower.z});
    }
    return points;
}
template <class T>
Points<T> anchors(const geo::Obb<T>& b) {
    return corners_of(b.center, b.axes, b.half_extents);
}
template <class T>
Points<T> anchors(const geo::Capsule<T>& c) {
    const glm::mat<3, 3, T> axes = axes_about(c.axis.b - c.axis.a);
    Points<T> points = around(c.axis.a, axes, geo::Vec3<T>{c.radius});
    const Points<T> more = around(c.axis.b, axes, geo::Vec3<T>{c.radius});
    points.insert(points.end(), more.begin(), more.end());
    return points;
}
template <class T>
Points<T> anchors(const geo::Cylinder<T>& c) {
    return anchors(geo::Capsule<T>{c.axis, c.radius});
}
template <class T>
Points<T> anchors(const geo::Cone<T>& c) {
    Points<T> points = around(c.base_center, axes_about(c.base_center - c.tip), geo::Vec3<T>{c.radius});
    points.push_back(c.tip);
    return points;
}
template <class T>
Points<T> anchors(const geo::Disc<T>& d) {
    return around(d.center, axes_about(d.normal), geo::Vec3<T>{d.radius, d.radius, T(0)});
}
template <class T>
Points<T> anchors(const geo::Triangle<T>& t) {
    return {t.a, t.b, t.c};
}
template <class T>
Points<T> anchors(const geo::Plane<T>& p) {
    const dvec3 n(p.normal);
    const double nn = glm::dot(n, n);
    const dvec3 foot = nn > 0.0 && std::isfinite(nn) ? n * (static_cast<double>(p.offset) / nn) : dvec3{0.0};
    return {geo::Vec3<T>(foot), {T(1), T(0), T(0)}};
}

}  // namespace carom::test
