// What a substep does with the bodies themselves, through the machine's SIMD lanes.
#pragma once

#include <carom/dynamics/detail/contact_bundle.hpp>

#include <cstddef>

namespace carom::dynamics {

enum class WarmStart { First, Again };

/// Kicks the movable rows of [begin, end) by their kicks and their gyroscopic change of spin, and notes the result as the base of the
/// substep. With Again, the contacts' impulses of the substep before come on top: what they changed the velocities by since its base.
/// Lever arms stay as they are over a step, so that equals applying each contact's accumulated impulse anew.
void kick(SolverBodies& bodies, std::size_t begin, std::size_t end, WarmStart warm_start);

/// Advances shift and turn of the rows [begin, end) by `h` at their velocities. @return the greatest square of a spin among them.
float advance(SolverBodies& bodies, std::size_t begin, std::size_t end, float h);

}  // namespace carom::dynamics
