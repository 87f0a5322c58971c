// What the tests of two primitives compute with: the core of each (a point, segment, triangle or box) and its radius, in double,
// relative to a point of the pair.
//
//   Pair pair = make_pair(geo::Sphere<float>{...}, geo::Obb<float>{...});   // Pair<dvec3, Obb<double>>
//   if (!pair.valid) return false;                                         // NaN, an empty solid
//
// A sphere is a point with a radius, a capsule a segment with one. Floats become doubles exactly, so float input is computed with 29
// bits to spare. Coordinates are taken relative to the first solid, so what is lost to rounding is relative to the pair, not to its
// distance from the origin; and scaled by a power of two where squares and cubes of them would leave the range of double.
#pragma once

#include <carom/collision/primitives.hpp>

#include <cmath>
#include <type_traits>

namespace carom::geo::detail {

/// A box along the axes by its centre and half extents.
struct AlignedBox {
    dvec3 center{0.0};
    dvec3 half{0.0};
};

template <class T>
[[nodiscard]] dvec3 wide(const Vec3<T>& v) noexcept {
    return dvec3(v);
}

// A point of the solid or near it, to which the pair is taken relative.
template <class T>
[[nodiscard]] dvec3 anchor(const Vec3<T>& p) noexcept {
    return wide(p);
}
template <class T>
[[nodiscard]] dvec3 anchor(const Segment<T>& s) noexcept {
    return wide(s.a);
}
template <class T>
[[nodiscard]] dvec3 anchor(const Triangle<T>& t) noexcept {
    return wide(t.a);
}
template <class T>
[[nodiscard]] dvec3 anchor(const Sphere<T>& s) noexcept {
    return wide(s.center);
}
template <class T>
[[nodiscard]] dvec3 anchor(const Capsule<T>& c) noexcept {
    return wide(c.axis.a);
}
template <class T>
[[nodiscard]] dvec3 anchor(const Aabb<T>& b) noexcept {
    return wide(b.lower);
}
template <class T>
[[nodiscard]] dvec3 anchor(const Obb<T>& b) noexcept {
    return wide(b.center);
}

// The core relative to `o`.
template <class T>
[[nodiscard]] dvec3 core(const Vec3<T>& p, const dvec3& o) noexcept {
    return wide(p) - o;
}
template <class T>
[[nodiscard]] dvec3 core(const Sphere<T>& s, const dvec3& o) noexcept {
    return wide(s.center) - o;
}
template <class T>
[[nodiscard]] Segment<double> core(const Segment<T>& s, const dvec3& o) noexcept {
    return {wide(s.a) - o, wide(s.b) - o};
}
template <class T>
[[nodiscard]] Segment<double> core(const Capsule<T>& c, const dvec3& o) noexcept {
    return core(c.axis, o);
}
template <class T>
[[nodiscard]] Triangle<double> core(const Triangle<T>& t, const dvec3& o) noexcept {
    return {wide(t.a) - o, wide(t.b) - o, wide(t.c) - o};
}
template <class T>
[[nodiscard]] AlignedBox core(const Aabb<T>& b, const dvec3& o) noexcept {
    const dvec3 lower = wide(b.lower) - o, upper = wide(b.upper) - o;
    return {0.5 * (lower + upper), 0.5 * (upper - lower)};
}
template <class T>
[[nodiscard]] Obb<double> core(const Obb<T>& b, const dvec3& o) noexcept {
    return {wide(b.center) - o, wide(b.half_extents), dmat3(b.axes)};
}

template <class Shape>
[[nodiscard]] double radius(const Shape& s) noexcept {
    if constexpr (requires { s.radius; }) {
        return static_cast<double>(s.radius);
    } else {
        return 0.0;
    }
}

/// Whether the solid has no points at all: a negative radius, an inverted box.
template <class Shape>
[[nodiscard]] bool is_void(const Shape& s) noexcept {
    if constexpr (requires { s.radius; }) {
        return s.radius < 0;
    } else if constexpr (requires { s.lower; }) {
        return s.lower.x > s.upper.x || s.lower.y > s.upper.y || s.lower.z > s.upper.z;
    } else if constexpr (requires { s.half_extents; }) {
        return s.half_extents.x < 0 || s.half_extents.y < 0 || s.half_extents.z < 0;
    } else {
        return false;
    }
}

/// The largest coordinate or extent, and the sum of all, which is finite only if all are.
class Reach {
public:
    void add(double x) noexcept {
        const double size = std::fabs(x);
        if (size > largest_) largest_ = size;
        check_ += x - x;  // zero, or NaN
    }
    void add(const dvec3& v) noexcept { add(v.x), add(v.y), add(v.z); }
    void add(const Segment<double>& s) noexcept { add(s.a), add(s.b); }
    void add(const Triangle<double>& t) noexcept { add(t.a), add(t.b), add(t.c); }
    void add(const AlignedBox& b) noexcept { add(b.center), add(b.half); }
    void add(const Obb<double>& b) noexcept {
        add(b.center), add(b.half_extents);
        for (int k = 0; k < 3; ++k) check_ += glm::dot(b.axes[k], b.axes[k]) * 0.0;
    }
    [[nodiscard]] double largest() const noexcept { return largest_; }
    [[nodiscard]] bool is_finite() const noexcept { return check_ == 0.0; }

private:
    double largest_ = 0.0;
    double check_ = 0.0;
};

[[nodiscard]] inline dvec3 scaled(const dvec3& p, double s) noexcept { return s * p; }
[[nodiscard]] inline Segment<double> scaled(const Segment<double>& x, double s) noexcept { return {s * x.a, s * x.b}; }
[[nodiscard]] inline Triangle<double> scaled(const Triangle<double>& t, double s) noexcept { return {s * t.a, s * t.b, s * t.c}; }
[[nodiscard]] inline AlignedBox scaled(const AlignedBox& b, double s) noexcept { return {s * b.center, s * b.half}; }
[[nodiscard]] inline Obb<double> scaled(const Obb<double>& b, double s) noexcept { return {s * b.center, s * b.half_extents, b.axes}; }

/// Two solids in one frame: x in the caller's is origin + x / scale here, and back.
template <class CoreA, class CoreB>
struct Pair {
    CoreA a;
    CoreB b;
    double radius_a = 0.0;
    double radius_b = 0.0;
    dvec3 origin{0.0};
    double scale = 1.0;  ///< a power of two; 1 unless the pair is larger than 2^200 or smaller than 2^-200
    double size = 0.0;   ///< the largest coordinate, half extent or radius
    bool valid = false;  ///< finite, and neither solid is void
};

template <class ShapeA, class ShapeB>
[[nodiscard]] auto make_pair(const ShapeA& a, const ShapeB& b) noexcept {
    const dvec3 o = anchor(a);
    Pair<decltype(core(a, o)), decltype(core(b, o))> pair{core(a, o), core(b, o), radius(a), radius(b), o, 1.0, 0.0, false};
    Reach reach;
    reach.add(pair.a), reach.add(pair.b), reach.add(pair.radius_a), reach.add(pair.radius_b);
    pair.size = reach.largest();
    pair.valid = reach.is_finite() && !is_void(a) && !is_void(b);
    // Up to the fourth power of a length is formed.
    if (!(pair.size < 0x1p200 && pair.size > 0x1p-200) && pair.valid && pair.size > 0.0) {
        pair.scale = std::ldexp(1.0, -std::max(std::ilogb(pair.size), -1000));
        pair.a = scaled(pair.a, pair.scale), pair.b = scaled(pair.b, pair.scale);
        pair.radius_a *= pair.scale, pair.radius_b *= pair.scale, pair.size *= pair.scale;
    }
    return pair;
}

}  // namespace carom::geo::detail
