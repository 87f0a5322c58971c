// On which side of a plane through three points a fourth one lies, without rounding.
//
//   if (orientation(a, b, c, d) > 0) { /* d is above the triangle abc, seen counter-clockwise from above */ }
#pragma once

#include <carom/core/types.hpp>

namespace carom::detail {

/// The exact sign of the determinant (b - a) × (c - a) · (d - a).
///
/// Method: with coordinates of 24 bits the determinant is a sum of 24 triple products, each of which two doubles hold
/// exactly; they are summed without error as an expansion (Shewchuk, Adaptive Precision Floating-Point Arithmetic, 1997,
/// sec. 2.4). Nothing can overflow or underflow.
///
/// @param a, b, c, d  finite, and each coordinate a float's value (CAROM_ASSERT).
/// @return +1, 0 or -1. Cost: about 2 µs; meant to back a filter that rarely fails.
[[nodiscard]] int orientation(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) noexcept;

}  // namespace carom::detail
