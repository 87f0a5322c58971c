// What makes a pair unfit for collide().
#pragma once

#include <carom/narrowphase/detail/kernel.hpp>

namespace carom::detail {

/// @return what is wrong with the pair, or null.
[[nodiscard]] inline const char* fault_of(const ShapePair& pair) noexcept {
    if (pair.a == nullptr || pair.b == nullptr) return "collide: a shape is null";
    if (!is_finite(pair.pose_a) || !is_finite(pair.pose_b)) return "collide: a pose is not finite";
    if (!is_finite(pair.margin) || pair.margin < 0.0f) return "collide: the margin must be finite and not negative";
    if (kernel_for(type_of(*pair.a), type_of(*pair.b)).function == nullptr) return "collide: no kernel for this pair of shape types";
    return nullptr;
}

}  // namespace carom::detail
