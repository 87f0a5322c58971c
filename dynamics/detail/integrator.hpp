// Motion without contact, by inertia class, in double.
#pragma once

#include <carom/dynamics/detail/body_state.hpp>

namespace carom::dynamics {

/// What moves a free body over a step.
struct FreeMotion {
    dvec3 acceleration{0.0};  ///< constant, world axes [m/s²]
    dvec3 torque{0.0};        ///< constant, world axes [N m]
    double linear_damping = 0.0, angular_damping = 0.0;  ///< [1/s]
    double spin_tolerance = 1e-6;                        ///< of the kinetic energy of the rotation, relative
};

/// Advances a body that nothing touches by `dt` [s].
///
/// Translation is exact: half a kick, drift, half a kick; with damping c the solution of v' = a - c v. Rotation is that of rotate_free(),
/// between two half kicks of the torque. Damping takes L down by exp(-c t) in all its parts alike, which is the free motion on a clock that slows
/// down: the body turns for (1 - exp(-c dt)) / c, and the spin falls by exp(-c dt). That is exact too.
/// Locked axes: what is locked of velocity and acceleration is taken out; of the angular momentum the components about free axes are kept.
/// Requires is_usable(state, dt).
void integrate_free(BodyState& state, const BodyMass& mass, const FreeMotion& motion, double dt) noexcept;

/// @return how the spin of a body changes over `dt` by its gyroscopic torque alone [rad/s]; zero for isotropic bodies.
/// For bodies in contact: the solver adds it evenly over the substeps. By rotate_free() to 1e-3 of the energy, where friction takes out
/// more than that puts in; for turns below 1/40 rad by Euler's equations to second order, whose error is then below 1.6e-5 of the spin.
[[nodiscard]] dvec3 gyroscopic_change(const BodyState& state, const BodyMass& mass, double dt) noexcept;

/// How a quantity that decays at the rate c goes over the time t, x = c t >= 0: exp(-x), the mean of exp over the time, and the mean of
/// that. All 1, 1, 1/2 at x = 0. Relative error below 1e-15 each; by Taylor's series and squaring.
struct Decay {
    double left = 1.0;    ///< exp(-x)
    double first = 1.0;   ///< (1 - exp(-x)) / x
    double second = 0.5;  ///< (1 - first) / x
};
[[nodiscard]] Decay decay(double x) noexcept;

/// @return the inverse inertia in world axes; with locked axes, of what is left to turn about.
[[nodiscard]] dmat3 world_inverse_inertia(const BodyState& state, const BodyMass& mass) noexcept;

/// The same, of which the solver wants each number once: Ixx Iyy Izz, and Ixy Ixz Iyz.
struct SymmetricInertia {
    dvec3 diagonal{0.0}, others{0.0};
};
[[nodiscard]] SymmetricInertia symmetric_inverse_inertia(const BodyState& state, const BodyMass& mass) noexcept;

/// @return angular momentum about the centre of mass, world axes [kg m²/s].
[[nodiscard]] dvec3 angular_momentum(const BodyState& state, const BodyMass& mass) noexcept;

}  // namespace carom::dynamics
