// The law of a blow between two bodies at a point: what both the impacts of contacts and those on the way through a step go by.
//
//   const double mass = felt_mass({a, arm_a}, {b, arm_b}, normal);
//   const double impulse = stopping_impulse(so_far, mass, approach);
//   push({a, arm_a}, {b, arm_b}, (impulse - so_far) * normal);
//
// How fast the two points approach is for the caller to say: it may know more than the two velocities, and rounds as suits it.
#pragma once

#include <carom/core/types.hpp>

#include <algorithm>

namespace carom::dynamics {

/// What gives way to a blow; without mass it goes on as before.
struct BlowBody {
    dvec3 velocity{0.0}, spin{0.0};
    dvec3 inverse_mass{0.0};     ///< by axis: 0 along a locked one
    dmat3 inverse_inertia{0.0};  ///< world axes
};

/// A body and the point that is struck, from its centre of mass [m].
template <class Body>
struct Struck {
    Body& body;
    dvec3 arm;
};

[[nodiscard]] inline double inverse_mass_along(const Struck<const BlowBody>& s, const dvec3& direction) noexcept {
    const dvec3 turning = glm::cross(s.arm, direction);
    return glm::dot(direction, s.body.inverse_mass * direction) + glm::dot(turning, s.body.inverse_inertia * turning);
}

/// @return what the two weigh along a unit direction; 0 where nothing gives way.
[[nodiscard]] inline double felt_mass(const Struck<const BlowBody>& a, const Struck<const BlowBody>& b, const dvec3& direction) noexcept {
    const double inverse = inverse_mass_along(a, direction) + inverse_mass_along(b, direction);
    return inverse > 0.0 ? 1.0 / inverse : 0.0;
}

/// An impulse on B, and its opposite on A [N s].
inline void push(const Struck<BlowBody>& a, const Struck<BlowBody>& b, const dvec3& impulse) noexcept {
    a.body.velocity -= a.body.inverse_mass * impulse;
    a.body.spin -= a.body.inverse_inertia * glm::cross(a.arm, impulse);
    b.body.velocity += b.body.inverse_mass * impulse;
    b.body.spin += b.body.inverse_inertia * glm::cross(b.arm, impulse);
}

/// @return the impulse along the normal, with what has been given of it so far, after which the points no longer approach; none that pulls.
/// One step of projected Gauss-Seidel.
/// @param approach  of B against A along the normal: negative where they come nearer [m/s].
[[nodiscard]] inline double stopping_impulse(double so_far, double mass, double approach) noexcept {
    return std::max(0.0, so_far - mass * approach);
}

/// Friction within its cone, against the sliding, at most to a stop.
/// @param meeting  of B against A. @param most  of the impulse. @param still  slower does not slide [m/s].
inline void rub(const Struck<BlowBody>& a, const Struck<BlowBody>& b, const dvec3& normal, const dvec3& meeting, double most,
                double still) noexcept {
    const dvec3 sliding = meeting - glm::dot(meeting, normal) * normal;
    const double speed = glm::length(sliding);
    if (!(speed > still)) return;
    const dvec3 direction = sliding / speed;
    const double stop = felt_mass({a.body, a.arm}, {b.body, b.arm}, direction) * speed;
    push(a, b, -std::min(stop, most) * direction);
}

}  // namespace carom::dynamics
