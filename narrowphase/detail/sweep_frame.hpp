// What every sweep in closed form begins and ends with: bad input, the frame about A's start, and the way back to the caller's.
#pragma once

#include <carom/collision/closest_points.hpp>
#include <carom/collision/primitives.hpp>
#include <carom/narrowphase/detail/sweep_parts.hpp>
#include <carom/narrowphase/impact.hpp>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace carom::geo {

/// The sweep of a pair: A's reference point at t = 0 is `from`, to which all else is relative.
struct SweepFrame {
    dvec3 from{0.0};
    dvec3 motion{0.0};
    double radius_a = 0.0;
    double radius_b = 0.0;

    [[nodiscard]] dvec3 local(const dvec3& p) const noexcept { return p - from; }
    /// @param size  the largest distance of B's points from A's.
    [[nodiscard]] carom::detail::SweepPath path(double size) const noexcept {
        using namespace carom::detail;
        const double all = size + radius_a + radius_b;
        return {motion, radius_a + radius_b + (kGrowth * all + kLeastGrowth), all};
    }
};

/// @return whether all are numbers of a usual size; what is not a number compares false.
template <class... Numbers>
[[nodiscard]] bool usual(Numbers... x) noexcept {
    return ((std::abs(x) <= carom::detail::kLargestSwept) && ...);
}
[[nodiscard]] inline bool usual_vector(const dvec3& v) noexcept { return usual(v.x, v.y, v.z); }

// Whether a shape is one.
template <class T>
[[nodiscard]] bool fit(const Sphere<T>& s) noexcept {
    return usual_vector(s.center) && s.radius >= T(0) && usual(double(s.radius));
}
template <class T>
[[nodiscard]] bool fit(const Capsule<T>& c) noexcept {
    return usual_vector(c.axis.a) && usual_vector(c.axis.b) && c.radius >= T(0) && usual(double(c.radius));
}
template <class T>
[[nodiscard]] bool fit(const Aabb<T>& b) noexcept {
    return usual_vector(b.lower) && usual_vector(b.upper) && b.lower.x <= b.upper.x && b.lower.y <= b.upper.y && b.lower.z <= b.upper.z;
}
template <class T>
[[nodiscard]] bool fit(const Obb<T>& b) noexcept {
    return usual_vector(b.center) && usual_vector(b.half_extents) && b.half_extents.x >= T(0) && b.half_extents.y >= T(0) &&
           b.half_extents.z >= T(0) && usual_vector(b.axes[0]) && usual_vector(b.axes[1]) && usual_vector(b.axes[2]);
}
template <class T>
[[nodiscard]] bool fit(const Triangle<T>& t) noexcept {
    return usual_vector(t.a) && usual_vector(t.b) && usual_vector(t.c);
}
template <class T>
[[nodiscard]] bool fit(const Cylinder<T>& c) noexcept {
    return usual_vector(c.axis.a) && usual_vector(c.axis.b) && c.radius >= T(0) && usual(double(c.radius));
}
template <class T>
[[nodiscard]] bool fit(const Cone<T>& c) noexcept {
    return usual_vector(c.tip) && usual_vector(c.base_center) && c.radius >= T(0) && usual(double(c.radius));
}
template <class T>
[[nodiscard]] bool fit(const Plane<T>& p) noexcept {
    return usual_vector(p.normal) && usual(double(p.offset)) && glm::length(dvec3(p.normal)) >= carom::detail::kShortestNormal;
}

inline constexpr Impact kInvalidImpact{.status = ImpactStatus::Invalid, .t = 0.0};

/// @return `part` as an answer; its point is set where A is a sphere of radius_a.
[[nodiscard]] inline Impact impact_of(const carom::detail::SweepPart& part, const SweepFrame& frame) noexcept {
    if (part.t > 1.0) return {};
    if (part.t <= 0.0) return {.status = ImpactStatus::Overlapping, .t = 0.0};
    return {ImpactStatus::Touching, part.t, frame.from + part.t * frame.motion + frame.radius_a * part.normal, part.normal, 0};
}

/// @return where B is nearest to a capsule's axis that begins at `at`.
template <class B>
[[nodiscard]] dvec3 nearest_under(const dvec3& at, const dvec3& axis, const B& b) noexcept {
    return closest_points(Segment<double>{at, at + axis}, b).on_b;
}

/// Rounds to T, the time downward.
template <class T>
[[nodiscard]] BasicImpact<T> rounded(const Impact& impact) noexcept {
    if constexpr (std::is_same_v<T, double>) {
        return impact;
    } else {
        T t = static_cast<T>(impact.t);
        if (static_cast<double>(t) > impact.t) t = std::nextafter(t, T(0));
        return {impact.status, t, glm::vec<3, T>(impact.point), glm::vec<3, T>(impact.normal), impact.checks};
    }
}

/// The same of what `make` returns, which is not copied where there is nothing to round.
template <class T, class Make>
[[nodiscard]] BasicImpact<T> rounded_from(const Make& make) noexcept {
    if constexpr (std::is_same_v<T, double>) {
        return make();
    } else {
        return rounded<T>(make());
    }
}

/// Capsules against what has edges: the single call is a batch of one, and what a kernel is not sure of goes part by part.
template <class A, class B, class T>
inline constexpr bool kSweptAsBatch = std::is_same_v<A, Capsule<T>> && (std::is_same_v<B, Capsule<T>> || std::is_same_v<B, Aabb<T>> ||
                                                                        std::is_same_v<B, Obb<T>> || std::is_same_v<B, Triangle<T>>);
template <class T>
[[nodiscard]] BasicImpact<T> sweep_by_parts(const Capsule<T>& a, const Vec3<T>& motion, const Capsule<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep_by_parts(const Capsule<T>& a, const Vec3<T>& motion, const Aabb<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep_by_parts(const Capsule<T>& a, const Vec3<T>& motion, const Obb<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep_by_parts(const Capsule<T>& a, const Vec3<T>& motion, const Triangle<T>& b) noexcept;

}  // namespace carom::geo
