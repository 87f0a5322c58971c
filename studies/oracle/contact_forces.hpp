// Whether the forces that a world reports hold its resting bodies up: statics, in long double, from the public contacts alone.
//
//   const ContactForces forces = oracle::contact_forces(world, dt);
//   if (forces.unbalanced < 1e-3) ...     // every body at rest is carried
#pragma once

#include <carom/dynamics/world.hpp>

#include <vector>

namespace carom::oracle {

struct ContactForces {
    double unbalanced = 0.0;  ///< largest over the dynamic bodies: force that is left with gravity's, and torque about the centre of mass over the body's reach (from there
                              ///< to its farthest contact), over the sum of the forces on it, gravity's included
    double pull = 0.0;        ///< largest share of a body's forces that pull instead of push (0: none)
    double beyond_cone = 0.0; ///< largest excess of friction over μ times the normal force, over the largest normal force
    std::vector<double> carried;  ///< of each dynamic body, in order of creation: what presses it from below, the sum of the upward forces on it [N]
};

/// @param world  after a step of `dt` from rest, whose bodies should have stayed there; friction of two shapes is their geometric mean.
/// @param dt     of that step [s].
/// A force is `substeps` times the impulse of the last substep over dt. Shares no code with the solvers. Cost: linear.
[[nodiscard]] ContactForces contact_forces(const World& world, double dt);

}  // namespace carom::oracle
