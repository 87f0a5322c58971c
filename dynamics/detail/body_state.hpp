// What the step knows of a body: where its mass is and how it moves. Indexed by the slot of the body's id.
#pragma once

#include <carom/core/pose.hpp>
#include <carom/dynamics/body.hpp>
#include <carom/dynamics/free_rotation.hpp>

namespace carom::dynamics {

/// State of the principal frame: origin at the centre of mass, axes along the principal moments.
struct BodyState {
    Pose pose;                  ///< of the principal frame in the world
    dvec3 velocity{0.0};        ///< of the centre of mass [m/s]
    dvec3 spin{0.0};            ///< angular velocity, world axes [rad/s]
};

struct BodyMass : FreeRotation {
    BodyMass() : FreeRotation{dvec3{0.0}, dvec3{0.0}} {}

    double mass = 0.0;               ///< [kg]; zero: static or kinematic
    double inverse_mass = 0.0;
    bool given = false;              ///< set by the user: adding shapes does not change it
    unsigned char locked = 0;        ///< bits of LockedAxes that keep it from moving and turning
};

/// What few bodies ask for beyond gravity. Forces are those of the next step, and zero after it.
struct BodyTraits {
    double gravity_scale = 1.0;
    double linear_damping = 0.0, angular_damping = 0.0;  ///< [1/s]
    dvec3 force{0.0};   ///< at the centre of mass [N]
    dvec3 torque{0.0};  ///< [N m]

    friend bool operator==(const BodyTraits&, const BodyTraits&) = default;
};

inline constexpr unsigned char kLockedTurns = LockedAxes::TurnX | LockedAxes::TurnY | LockedAxes::TurnZ;

/// @return 0 for the world axes along which the bits of LockedAxes forbid to move, 1 for the others.
[[nodiscard]] inline dvec3 free_moves(unsigned char locked) noexcept {
    return {(locked & LockedAxes::MoveX) != 0 ? 0.0 : 1.0, (locked & LockedAxes::MoveY) != 0 ? 0.0 : 1.0,
            (locked & LockedAxes::MoveZ) != 0 ? 0.0 : 1.0};
}

/// @return the velocity of a body at a point of the world [m/s].
[[nodiscard]] inline dvec3 point_velocity(const BodyState& state, const dvec3& at) noexcept {
    return state.velocity + glm::cross(state.spin, at - state.pose.position);
}

[[nodiscard]] inline bool is_finite(const BodyState& s) noexcept {
    return carom::is_finite(s.pose) && carom::is_finite(s.velocity) && carom::is_finite(s.spin);
}

/// How far, how fast and how many turns a step can follow: squares of these fit into the solver's floats, and the free rotation
/// takes some 10,000 cycles at its default tolerance.
inline constexpr double kMostDistance = 1e30;  ///< from the world's origin [m]
inline constexpr double kMostSpeed = 1e15;     ///< [m/s], and of the points by the spin, [rad/s]
inline constexpr double kMostTurn = 2000.0;    ///< [rad] in one step

/// Whether what moves in a step of `dt` stays within the range of floats.
[[nodiscard]] inline bool can_step(double dt, const dvec3& gravity) noexcept {
    return kMostSpeed * dt <= kMostDistance && glm::length(gravity) * dt * dt <= kMostDistance;
}
inline constexpr const char* kTooLong = "dt is so long that positions would leave the range of floats";

/// Whether a step of `dt` can take this state on.
[[nodiscard]] inline bool is_usable(const BodyState& s, double dt) noexcept {
    const auto within = [](const dvec3& v, double most) { return glm::dot(v, v) <= most * most; };  // so it is finite
    return carom::is_finite(s.pose.orientation) && within(s.pose.position, kMostDistance) && within(s.velocity, kMostSpeed) &&
           within(s.spin, kMostSpeed) && within(s.spin * dt, kMostTurn);
}

}  // namespace carom::dynamics
