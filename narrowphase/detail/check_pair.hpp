// What makes a pair unfit for collide().
#pragma once

#include <carom/narrowphase/detail/kernel.hpp>

#include <algorithm>

namespace carom::detail {

struct PairFault {
    const char* what = nullptr;  ///< null: nothing is wrong
    ErrorCode code = ErrorCode::InvalidArgument;
};

/// x - x is 0 for finite numbers and NaN for all others, and a NaN survives the sum: one comparison for all.
[[nodiscard]] inline double finite_residue(const Pose& p) noexcept {
    const dvec3 d = p.position - p.position;
    const dquat& q = p.orientation;
    return d.x + d.y + d.z + (q.x - q.x) + (q.y - q.y) + (q.z - q.z) + (q.w - q.w);
}

/// @return whether the poses are that pairs name.
[[nodiscard]] inline bool named_poses_are_finite(const BatchInput& input) noexcept {
    return std::ranges::all_of(input.pairs, [&](const NumberedPair& pair) {
        return finite_residue(input.placed.poses[pair.a]) + finite_residue(input.placed.poses[pair.b]) == 0.0;
    });
}

[[nodiscard]] inline PairFault fault_of(const ShapePair& pair) noexcept {
    if (pair.a == nullptr || pair.b == nullptr) return {"collide: a shape is null"};
    if (finite_residue(pair.pose_a) + finite_residue(pair.pose_b) != 0.0) return {"collide: a pose is not finite", ErrorCode::NotFinite};
    if (!is_finite(pair.margin)) return {"collide: the margin is not finite", ErrorCode::NotFinite};
    if (pair.margin < 0.0f) return {"collide: the margin is negative"};
    if (!kernel_for(type_of(*pair.a), type_of(*pair.b)).exists()) {
        return {"collide: two unbounded or mesh shapes have no contact", ErrorCode::WrongType};
    }
    return {};
}

}  // namespace carom::detail
