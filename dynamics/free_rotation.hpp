// How a rigid body turns when nothing touches it, by the class of its inertia, in double.
//
//   const FreeRotation body = classify({2.0, 3.0, 4.0});
//   Rotation r{kIdentityRotation, {0.01, 5.0, 0.01}};
//   rotate_free(r, body, 1.0 / 240.0, {.tolerance = 1e-6});
#pragma once

#include <carom/core/pose.hpp>

namespace carom {

/// How the principal moments of a body relate: each class has its own exact or nearly exact rotation.
enum class InertiaClass : unsigned char {
    Isotropic,   ///< all equal: turns at a constant angular velocity
    Symmetric,   ///< two equal: two exact rotations
    Asymmetric,  ///< none equal: splitting into rotations about two of its axes
};

/// What free rotation needs of a body.
struct FreeRotation {
    dvec3 moments{1.0};          ///< principal, about the centre of mass [kg m²]
    dvec3 inverse_moments{1.0};
    InertiaClass inertia = InertiaClass::Isotropic;
    int axis = 0;                ///< symmetric: the axis whose moment differs; asymmetric: that of the middle moment
};

/// @param moments  positive and finite; otherwise reports misuse and gives a unit ball. Equal means equal to 1e-12 of the largest.
[[nodiscard]] FreeRotation classify(const dvec3& moments);

struct Rotation {
    dquat orientation = kIdentityRotation;  ///< of the principal axes in the world
    dvec3 spin{0.0};                        ///< angular velocity, world axes [rad/s]
};

/// Which splitting an asymmetric body gets.
enum class SpinScheme : unsigned char {
    Automatic,    ///< whichever keeps the tolerance by fewer rotations
    Strang,       ///< second order, 3 rotations a cycle
    FourthOrder,  ///< 13 rotations a cycle
};

struct SpinSettings {
    double tolerance = 1e-6;  ///< of kinetic energy, relative, within 1e-12 .. 1: sets how many cycles the time is cut into
    SpinScheme scheme = SpinScheme::Automatic;
};

/// Turns a body without torque by `dt` [s], which may be negative.
///
/// With L the angular momentum and I1 < I2 < I3, the kinetic energy is |L|²/(2 I2) + r1 L1²/2 - r3 L3²/2, r1 = 1/I1 - 1/I2 and
/// r3 = 1/I2 - 1/I3. The first term turns the body about L by |L| dt / I2, exactly, and commutes with the rest. What is left are rotations
/// about axes 1 and 3 at the rates r1 L1 and r3 L3, which vanish as moments become equal. They are composed by Strang's splitting, or to
/// fourth order by Blanes and Moan, Practical symplectic partitioned Runge-Kutta and Runge-Kutta-Nystrom methods (2002), table 2, S6
/// (Hairer, Lubich, Wanner, Geometric Numerical Integration, 2006, V.3 and VII.5.3, has splitting of the free rigid body into three axes).
///
/// Accuracy: L to rounding, whatever the step. Of a cycle in which neither axis turns further than x [rad], the energy is off by at
/// most 0.08 x² (Strang) or 2e-4 x⁴ (fourth order, x <= 1/4), which does not grow with time: seen over bodies from rods to plates with ratios of
/// moments up to 1e6. Isotropic and symmetric bodies: exact but for rounding.
/// At most a million cycles are made, which keeps the tolerance but for moments of ratios beyond 1e6 at many turns a call.
/// Misuse: a state or dt that is not finite, a tolerance out of range; nothing changes.
/// Cost: asymmetric, 3 or 13 sines and cosines a cycle.
void rotate_free(Rotation& rotation, const FreeRotation& body, double dt, const SpinSettings& settings = {});

/// @return the cycles that rotate_free() cuts `dt` into; 1 for isotropic and symmetric bodies; 0 after the same misuse.
[[nodiscard]] int count_cycles(const Rotation& rotation, const FreeRotation& body, double dt, const SpinSettings& settings = {});

}  // namespace carom
