// When a convex shape that moves and turns first meets a standing shape of any kind: plane, mesh and compound too.
//
//   ShapeImpact hit = cast_shape(Capsule{0.4f, 0.5f}, {.start = player, .translation = dt * velocity}, level, level_pose);
//   if (may_touch(hit.status)) player = pose_at(motion, hit.t);
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/pose.hpp>
#include <carom/narrowphase/time_of_impact.hpp>

#include <cstdint>

namespace carom {

/// The first contact of a moving shape with a standing one, and where on it.
struct ShapeImpact : Impact {
    std::uint32_t triangle = 0;  ///< of a mesh, the lowest of several at one t; otherwise 0
    std::uint32_t part = 0;      ///< of a compound, likewise; otherwise 0
};

/// The first contact of the convex shape A, which moves, and of B, which stands at `pose_b`. All that impact.hpp promises holds: t is never later
/// than the true time, and what is Separated is apart at every t up to settings.until.
///
/// Method: balls and capsules that do not turn (of balls that turn about their centre: too) meet planes, balls, capsules and meshes, and balls
/// boxes, in closed form (sweep.hpp), grown by E for what rounding may do on the way into B's frame; all others by time_of_impact().
/// @param a  sphere, box, capsule, hull, cylinder or cone; anything else is Invalid.
/// @param b  any shape. A mesh is its surface, a one-sided one only to what has its centre in front of it (time_of_impact.hpp); the parts of a
/// compound stand where `pose_b` times their pose puts them, to rounding.
/// @return `point` on B and `normal` from A to B, both in the world. Clamped and Invalid as time_of_impact() has them; a pose that is not finite
/// or beyond 1e70 m is Invalid too. settings.tolerance and most_checks are not needed in closed form.
/// Accuracy: Touching within separation + tolerance as there, or within the bounds of sweep.hpp and E = 1.4e-14 (sizes, distance, motion).
/// Cost: 0.1 to 0.4 µs in closed form, 1 to 10 µs otherwise; of meshes and compounds the sum over what the path comes near. No allocation;
/// thread-safe.
[[nodiscard]] ShapeImpact cast_shape(const Shape& a, const RigidMotion& motion, const Shape& b, const Pose& pose_b,
                                     const TimeOfImpactSettings& settings = {});

}  // namespace carom
