// The bounds of boxes over their motion in a step, sixteen at a time.
//
//   sweep_boxes({boxes, count}, dt, origin);
#pragma once

#include <carom/broadphase/proxy.hpp>
#include <carom/core/pose.hpp>
#include <carom/dynamics/detail/body_state.hpp>

#include <span>

namespace carom::dynamics {

/// A box on a body that moves, and where its results go.
struct SweptBox {
    const BodyState* state = nullptr;
    const Pose* local = nullptr;  ///< of the shape in its body's principal frame
    vec3 half{0.0f};              ///< half extents [m]
    double reach = 0.0;           ///< farthest point from the centre of mass [m]
    double pull = 0.0;            ///< what gravity may do: |g| dt² [m]; of what has room, that too
    bool has_room = false;        ///< velocity and spin count for nothing
    Pose* pose = nullptr;         ///< of the shape in the world
    FloatAabb* box = nullptr;     ///< about its motion, relative to the origin
    double* motion = nullptr;     ///< how far any point may move [m]
};

/// What bounds(), the margins of motion and round_outward() give for each, to the bit, at every SIMD width.
/// @param boxes  whose states can be stepped: nothing leaves the range of floats.
void sweep_boxes(std::span<const SweptBox> boxes, double dt, const dvec3& origin);

}  // namespace carom::dynamics
