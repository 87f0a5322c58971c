// Motion without contact, by inertia class, in double.
#pragma once

#include <carom/dynamics/detail/body_state.hpp>

namespace carom::dynamics {

/// Classifies principal moments: equal means equal to 1e-12 of the largest.
void classify_inertia(BodyMass& mass) noexcept;

/// Advances a body that nothing touches by `dt` [s] under the constant `acceleration` [m/s²].
///
/// Translation is exact: v is kicked by half before and half after the drift. Rotation is torque-free: isotropic bodies by the
/// exponential map; symmetric ones by two exact rotations, about L and about the symmetry axis; asymmetric ones by Strang
/// splitting of the energy into rotations about the body's axes (McLachlan 1993; Hairer, Lubich, Wanner 2006, VII.5.3),
/// sub-cycled so that no cycle turns further than kMaxCycleAngle. Splitting keeps |L| to rounding; its energy error is about
/// 0.02 times the square of the angle of a cycle, and does not grow.
/// Cost: one cycle is 5 sines and cosines. Requires is_usable(state, dt).
void integrate_free(BodyState& state, const BodyMass& mass, const dvec3& acceleration, double dt) noexcept;

/// 1/64 rad: the energy error of a 2:3:4 body is 5e-6.
inline constexpr double kMaxCycleAngle = 1.0 / 64.0;
/// The same for bodies in contact, where friction takes out more than the error of 1e-3 puts in.
inline constexpr double kMaxContactCycleAngle = 0.25;

/// @return how the spin of a body changes over `dt` by its gyroscopic torque alone [rad/s]; zero for isotropic bodies.
/// For bodies in contact: the solver adds it evenly over the substeps. By the splitting above; for turns below 1/40 rad by
/// Euler's equations to second order, whose error is then below 1.6e-5 of the spin.
[[nodiscard]] dvec3 gyroscopic_change(const BodyState& state, const BodyMass& mass, double dt) noexcept;

/// @return the inverse inertia in world axes.
[[nodiscard]] dmat3 world_inverse_inertia(const BodyState& state, const BodyMass& mass) noexcept;

/// @return angular momentum about the centre of mass, world axes [kg m²/s].
[[nodiscard]] dvec3 angular_momentum(const BodyState& state, const BodyMass& mass) noexcept;

}  // namespace carom::dynamics
