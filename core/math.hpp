// Deterministic elementary functions: the same bits with every compiler, standard library and optimisation level.
//
//   auto [s, c] = sin_cos(angle);
//   double angle = arctan2(y, x);
#pragma once

#include <carom/core/types.hpp>

namespace carom {

inline constexpr double kPi = 3.141592653589793238462643383279502884;

struct SinCos {
    double sin = 0.0;
    double cos = 1.0;
};

/// Sine and cosine of `x` [rad] over the whole range of double, without a library call.
/// NaN and infinities give NaN for both; sin(-0) is -0.
/// Accuracy: error at most 0.85 ulp each over the whole range, near multiples of pi/2 too (tests/core/math_test.cpp has
/// the worst seen). Monotony is not promised. Cost: some 25 ns; twice that from |x| = 2^20 on.
/// Sources: Cody and Waite (1980) for |x| < 2^20, Payne and Hanek (SIGNUM 1983) beyond; Taylor's series.
[[nodiscard]] SinCos sin_cos(double x) noexcept;

/// The angle of the vector (x, y) from the x axis [rad], in [-pi, pi]; its sign is that of y.
/// NaN for NaN. Zeros and infinities as IEEE 754 has them: (±0, +0) gives ±0, (±0, -0) ±pi, (±inf, +inf) ±pi/4.
/// Accuracy: error at most 0.51 ulp over the whole range, denormal results included (tests/core/math_test.cpp has the worst seen).
/// Source: a table and Taylor's series, Muller, Elementary Functions (2016), sec. 6.3; quotient and sums carry their
/// rounding errors.
[[nodiscard]] double arctan2(double y, double x) noexcept;

/// @return the unit quaternion that rotates by |rotation| [rad] about `rotation`; the identity for zero. Every component
/// keeps its relative accuracy (a few ulp) however tiny the rotation. NaN or infinity in any component gives
/// a result that is not finite.
[[nodiscard]] dquat rotation_from_vector(const dvec3& rotation) noexcept;

/// @return the unit quaternion that rotates by `angle` [rad] about the unit vector `axis`, as unit as the axis is.
[[nodiscard]] dquat rotation_about(const dvec3& axis, double angle) noexcept;

/// Any unit vector at a right angle to the unit vector `n`; the same for the same bits of n.
/// Source: Duff et al., Building an Orthonormal Basis, Revisited (JCGT 2017).
[[nodiscard]] dvec3 any_perpendicular(const dvec3& n) noexcept;

}  // namespace carom
