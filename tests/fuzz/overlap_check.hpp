// What must hold for any two primitives: overlaps() and closest_points() judged by exact rationals, for the fuzzer and for tests.
//
//   EXPECT_EQ(test::overlap_fault(box, sphere), "");
//   EXPECT_EQ(test::overlap_fault(bytes), "");
#pragma once

#include <carom/collision/overlap_tests.hpp>

#include <support/exact_distance.hpp>
#include <support/query_cases.hpp>

#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

namespace carom::test {

/// A pair with what the headers state their bounds in.
struct ExactPair {
    exact::Solid a, b;
    exact::Rational size;      ///< the largest coordinate difference or radius
    exact::Rational farthest;  ///< the largest coordinate: results are stored as T, which rounds them by parts of that
    exact::Rational core_sq;   ///< squared distance of the cores
    exact::Rational distance;  ///< of the solids, rounded up by 1e-15 of itself; 0 where they overlap

    [[nodiscard]] bool overlap() const { return core_sq <= exact::square(a.radius + b.radius); }
};

template <class A, class B>
[[nodiscard]] ExactPair exact_pair(const A& a, const B& b) {
    ExactPair pair{exact::solid(a), exact::solid(b), 0, 0, 0, 0};
    const exact::Rational radii = pair.a.radius + pair.b.radius;
    pair.size = std::max(pair.a.radius, pair.b.radius);
    for (const exact::Solid* s : {&pair.a, &pair.b}) {
        for (const exact::Vec& p : s->corners) {
            pair.size = std::max(pair.size, exact::largest(p - pair.a.corners[0]));
            pair.farthest = std::max(pair.farthest, exact::Rational(exact::largest(p) + radii));
        }
    }
    pair.core_sq = exact::core_distance_sq(pair.a, pair.b);
    const exact::Rational gap = exact::sqrt_up(pair.core_sq) - radii;
    pair.distance = pair.overlap() || gap.sign() < 0 ? exact::Rational(0) : gap;
    return pair;
}

template <class A>
inline constexpr bool kTurned = std::is_same_v<A, geo::Obb<float>> || std::is_same_v<A, geo::Obb<double>>;
template <class A>
inline constexpr double kUnit = static_cast<double>(std::numeric_limits<geo::detail::Scalar<A>>::epsilon());

/// The bound of overlaps(): `false` is always right, and `true` where the two are this close.
template <class A, class B>
[[nodiscard]] std::string verdict_fault(const A& a, const B& b, const ExactPair& pair) {
    const double k = kTurned<A> || kTurned<B> ? 128.0 * kUnit<A> : 32.0 * 0x1p-52;
    const bool overlap = pair.overlap();
    for (const bool got : {geo::overlaps(a, b), geo::overlaps(b, a)}) {
        if (!got && overlap) return "solids that overlap are reported as apart";
        if (got && !overlap && pair.core_sq > exact::square(pair.a.radius + pair.b.radius + exact::number(k) * pair.size)) {
            return "solids that are apart are reported as overlapping";
        }
    }
    return "";
}

/// The bound of closest_points(): the distance, and that each point lies on its solid.
template <class A, class B>
[[nodiscard]] std::string closest_fault(const A& a, const B& b, const ExactPair& pair) {
    using T = geo::detail::Scalar<A>;
    const geo::ClosestPoints<T> got = geo::closest_points(a, b);
    if (!is_finite(got.on_a) || !is_finite(got.on_b)) return "a closest point is not finite";
    const exact::Rational unit = exact::number(kUnit<A>), last = exact::number(std::numeric_limits<T>::denorm_min());
    const exact::Rational own = exact::number(16.0 * 0x1p-52 + (kTurned<A> || kTurned<B> ? 4.0 * kUnit<A> : 0.0)) * pair.size;
    const exact::Rational stored = unit * pair.farthest + last;
    const auto lies_on = [&](const exact::Vec& p, const exact::Solid& s) {
        return exact::core_distance_sq(p, s) <= exact::square(s.radius + own + 2 * stored);
    };
    if (!lies_on(exact::vec(got.on_a), pair.a) || !lies_on(exact::vec(got.on_b), pair.b)) return "a closest point is not on its solid";
    // Squares, so that what underflows needs no root.
    const exact::Rational least = std::max(exact::Rational(0), exact::Rational(pair.distance - own)), most = pair.distance + own;
    if (!std::isfinite(got.distance_sq)) {
        return exact::square(most) * (1 + unit) >= exact::number(std::numeric_limits<T>::max()) ? "" : "the squared distance is not finite";
    }
    const exact::Rational sq = exact::number(got.distance_sq);
    if (sq + last < exact::square(least) * (1 - 2 * unit)) return "the distance is too small";
    if (sq - last > exact::square(most) * (1 + 2 * unit)) return "the distance is too large";
    return "";
}

/// What is wrong with the answers for a pair, or nothing.
template <class A, class B>
[[nodiscard]] std::string overlap_fault(const A& a, const B& b) {
    const ExactPair pair = exact_pair(a, b);
    if constexpr (geo::Overlappable<A> && geo::Overlappable<B>) {
        const std::string fault = verdict_fault(a, b, pair);
        if (!fault.empty()) return fault;
    }
    return closest_fault(a, b, pair);
}

template <class T>
[[nodiscard]] bool is_finite_pair(const geo::ClosestPoints<T>& c) {
    return std::isfinite(c.on_a.x) && std::isfinite(c.distance_sq);
}

/// Calls `visit` with the primitive that `which`, 0 to 6, stands for.
template <class T, class Visit>
[[nodiscard]] std::string with_primitive(int which, Draw<T>& draw, const Visit& visit) {
    switch (which) {
        case 0:
            return visit(draw.point());
        case 1:
            return visit(draw.segment());
        case 2:
            return visit(draw.triangle());
        case 3:
            return visit(draw.aabb());
        case 4:
            return visit(draw.obb());
        case 5:
            return visit(draw.capsule());
        default:
            return visit(draw.sphere());
    }
}
inline constexpr int kOverlapPrimitives = 7;

/// A solid moved by v, as far as its numbers hold the place.
template <class T>
[[nodiscard]] geo::Vec3<T> shifted(const geo::Vec3<T>& p, const geo::Vec3<T>& v) {
    return p + v;
}
template <class T>
[[nodiscard]] geo::Segment<T> shifted(const geo::Segment<T>& s, const geo::Vec3<T>& v) {
    return {s.a + v, s.b + v};
}
template <class T>
[[nodiscard]] geo::Triangle<T> shifted(const geo::Triangle<T>& t, const geo::Vec3<T>& v) {
    return {t.a + v, t.b + v, t.c + v};
}
template <class T>
[[nodiscard]] geo::Aabb<T> shifted(const geo::Aabb<T>& b, const geo::Vec3<T>& v) {
    return {b.lower + v, b.upper + v};
}
template <class T>
[[nodiscard]] geo::Obb<T> shifted(const geo::Obb<T>& b, const geo::Vec3<T>& v) {
    return {b.center + v, b.half_extents, b.axes};
}
template <class T>
[[nodiscard]] geo::Capsule<T> shifted(const geo::Capsule<T>& c, const geo::Vec3<T>& v) {
    return {shifted(c.axis, v), c.radius};
}
template <class T>
[[nodiscard]] geo::Sphere<T> shifted(const geo::Sphere<T>& s, const geo::Vec3<T>& v) {
    return {s.center + v, s.radius};
}

/// What is wrong with the answers for the pair that `bytes` describe, or nothing. The first two bytes choose the primitives and the
/// precision; of two pairs one is brought to touch.
template <class T>
[[nodiscard]] std::string overlap_fault_of(int first, int second, bool touch, std::span<const std::uint8_t> bytes) {
    Draw<T> draw(bytes);
    return with_primitive(first, draw, [&](const auto& a) {
        return with_primitive(second, draw, [&](const auto& drawn) {
            auto b = drawn;
            if (touch) {
                const auto c = geo::closest_points(a, b);
                if (is_finite_pair(c)) b = shifted(b, c.on_a - c.on_b);
            }
            return overlap_fault(a, b);
        });
    });
}
[[nodiscard]] inline std::string overlap_fault(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < 2) return "";
    const int first = bytes[0] % kOverlapPrimitives, second = bytes[1] % kOverlapPrimitives;
    const bool touch = bytes[0] >= 128, doubles = bytes[1] >= 128;
    return doubles ? overlap_fault_of<double>(first, second, touch, bytes.subspan(2))
                   : overlap_fault_of<float>(first, second, touch, bytes.subspan(2));
}

}  // namespace carom::test
