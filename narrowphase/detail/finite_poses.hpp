// Whether poses are finite: one of them, those that pairs name, or all of a row.
//
//   if (finite_residue(a) + finite_residue(b) != 0.0) ...   // a number of either is not finite
#pragma once

#include <carom/core/pose.hpp>
#include <carom/narrowphase/detail/kernel.hpp>

#include <algorithm>
#include <span>

namespace carom::detail {

/// x - x is 0 for finite numbers and NaN for all others, and a NaN survives the sum: one comparison for all.
[[nodiscard]] inline double finite_residue(const Pose& p) noexcept {
    const dvec3 d = p.position - p.position;
    const dquat& q = p.orientation;
    return d.x + d.y + d.z + (q.x - q.x) + (q.y - q.y) + (q.z - q.z) + (q.w - q.w);
}

/// @return whether the poses are that pairs name, all of which name some.
[[nodiscard]] inline bool named_poses_are_finite(const BatchInput& input) noexcept {
    return std::ranges::all_of(input.pairs, [&](const NumberedPair& pair) {
        return finite_residue(input.placed.poses[pair.a]) + finite_residue(input.placed.poses[pair.b]) == 0.0;
    });
}

/// @return whether all are, as wide as the machine allows.
[[nodiscard]] bool poses_are_finite(std::span<const Pose> poses);

}  // namespace carom::detail
