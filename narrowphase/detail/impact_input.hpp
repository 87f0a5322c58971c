// What searches for a time of impact take, and what they call Invalid.
//
//   if (!fit(motion) || !fit(settings) || !is_shape(shape)) return invalid;
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/narrowphase/time_of_impact.hpp>

namespace carom::detail {

/// Beyond, squares of lengths overflow [m], and turns are lost to rounding [rad].
inline constexpr double kLargestLength = 1e70;
inline constexpr double kLargestTurn = 1e9;

/// Finite and within the above.
[[nodiscard]] bool fit(const Pose& pose) noexcept;
[[nodiscard]] bool fit(const RigidMotion& motion) noexcept;
[[nodiscard]] bool fit(const TimeOfImpactSettings& settings) noexcept;

/// Sizes of zero are fit: a point, a segment, a rectangle. validate() asks for more, and allocates to say what. Null pointers are fit.
[[nodiscard]] bool is_shape(const Shape& shape) noexcept;

}  // namespace carom::detail
