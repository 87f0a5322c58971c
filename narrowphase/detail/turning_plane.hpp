// Planes that part two moving cores from now on for as long as they can.
//
//   const TurningPlane plane(now, turn);
//   now.part_by(normal);
//   double step = safe_step([&](double s) { return plane.gap(s, least); }, now.gap - least, plane.slope(), now.rest, 0.0);
#pragma once

#include <carom/narrowphase/detail/convex_core.hpp>
#include <carom/narrowphase/detail/moving_core.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom::detail {

/// The shapes at t, in the frame of A's pivot, and a normal that may part them.
struct Moment {
    const MovingPair& pair;
    ConvexCore a, b;
    dvec3 between{0.0};  ///< B's pivot
    double rest = 0.0;   ///< how far s goes
    dvec3 normal{0.0};
    dvec3 low_a{0.0}, low_b{0.0};  ///< the points of each that are foremost across it
    double gap = 0.0;              ///< between these along it

    /// @param n  zero where nothing is known to part them; the gap is 0 then.
    void part_by(const dvec3& n) noexcept {
        normal = n;
        gap = 0.0;
        if (n == dvec3{0.0}) return;
        low_a = a.support(n).point;
        low_b = b.support(-n).point;
        gap = glm::dot(n, low_b - low_a);
    }
};

/// A plane that parts the shapes of a moment and turns at a constant rate: with one of them its faces stay in it, with neither it stands.
class TurningPlane {
public:
    TurningPlane(const Moment& now, const dvec3& turn) noexcept : now_(now) {
        const dvec3 &n = now.normal, sway = glm::cross(turn, n), &along = now.pair.along;
        const double swing = glm::length(sway), pull = glm::dot(sway, along);
        const MovingCore &a = now.pair.a, &b = now.pair.b;
        rate_ = glm::dot(n, along) + glm::dot(sway, now.between);
        slope_a_ = glm::cross(n, a.rotation) + sway;
        slope_b_ = -(glm::cross(n, b.rotation) + sway);
        const auto curvature = [&](const MovingCore& core) {  // of a point's height in a frame that turns with the core
            const dvec3 differ = turn - core.rotation;
            const double most = glm::length(differ), first = glm::length(glm::cross(differ, n)) + now.rest * most * swing;
            return core.reach * (glm::length(core.rotation) * std::min(most, first) + most * swing);
        };
        const double carried = glm::length(turn) * swing * (glm::length(now.between) + 3.0 * now.rest * glm::length(along));
        bend_ = 0.5 * (curvature(a) + curvature(b) + carried) + std::max(0.0, -pull);
    }

    /// @return at least how far the shapes are apart across the plane at t + s; concave in s. `least` is taken off.
    [[nodiscard]] double gap(double s, double least) const noexcept {
        const dvec3 ma = now_.normal + s * slope_a_, mb = -now_.normal + s * slope_b_;
        const double top = now_.a.height(ma), bottom = now_.b.height(mb) - glm::dot(mb, now_.between);
        return (glm::dot(now_.normal, now_.between) + s * rate_) - top - bottom - (s * s * bend_ + least);
    }

    /// @return that of a line that is nowhere below the gap and meets it at 0: two points have it, which stay where they are.
    [[nodiscard]] double slope() const noexcept {
        return rate_ - glm::dot(slope_a_, now_.low_a) - glm::dot(slope_b_, now_.low_b - now_.between);
    }

private:
    const Moment& now_;
    dvec3 slope_a_{0.0}, slope_b_{0.0};
    double rate_ = 0.0, bend_ = 0.0;
};

/// @return the longest step found for which `gap` stays positive; 0 where none is. A secant of a concave function ends before its root, a line
/// that is nowhere below it after.
/// @param now  at 0. @param slope  of such a line from there. @param rest  the longest that is asked for.
/// @param known  shorter ones are not, and 0 may stand for them.
template <class Gap>
double safe_step(const Gap& gap, double now, double slope, double rest, double known) noexcept {
    double safe = 0.0, far = slope < 0.0 ? std::min(rest, now / -slope) : rest;
    if (!(far > known)) return 0.0;
    for (int k = 0; k < 5; ++k) {
        const double then = gap(far);
        if (then >= 0.0) return far;
        safe = std::max(safe, far * (now / (now - then)) * (1.0 - 0x1p-50));
        const double next = std::sqrt(safe * far);
        if (!(next > 1.05 * safe)) break;
        far = next;
    }
    return safe;
}

/// How a plane turns that two edges stay in; with B where they are all but parallel.
inline dvec3 turn_with_edges(const Moment& now, const dvec3& edge_a, const dvec3& edge_b) noexcept {
    const dvec3 &n = now.normal, &turn_a = now.pair.a.rotation, &turn_b = now.pair.b.rotation;
    const double area = glm::dot(n, glm::cross(edge_a, edge_b));
    const dvec3 sway =
        glm::dot(glm::cross(turn_a, n), edge_a) * glm::cross(edge_b, n) + glm::dot(glm::cross(turn_b, n), edge_b) * glm::cross(n, edge_a);
    constexpr double kMostSwing = 4.0;  // times the two rates
    const double most = kMostSwing * (glm::length(turn_a) + glm::length(turn_b)) * std::abs(area);
    return glm::dot(sway, sway) <= most * most && area != 0.0 ? glm::cross(n, sway) / area : turn_b;
}

}  // namespace carom::detail
