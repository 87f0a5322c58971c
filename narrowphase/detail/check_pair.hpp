// What makes a pair unfit for collide().
#pragma once

#include <carom/narrowphase/detail/finite_poses.hpp>
#include <carom/narrowphase/detail/kernel.hpp>

namespace carom::detail {

struct PairFault {
    const char* what = nullptr;  ///< null: nothing is wrong
    ErrorCode code = ErrorCode::InvalidArgument;
};

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
