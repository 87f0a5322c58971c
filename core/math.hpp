// Deterministic elementary functions: the same bits with every compiler, standard library and optimisation level.
//
//   auto [s, c] = sin_cos(angle);
#pragma once

#include <carom/core/types.hpp>

namespace carom {

inline constexpr double kPi = 3.141592653589793238462643383279502884;

struct SinCos {
    double sin = 0.0;
    double cos = 1.0;
};

/// Sine and cosine of `x` [rad] over the whole range of double.
/// NaN and infinities give NaN for both.
[[nodiscard]] SinCos sin_cos(double x) noexcept;

/// @return the unit quaternion that rotates by |rotation| [rad] about `rotation`; the identity for zero.
[[nodiscard]] dquat rotation_from_vector(const dvec3& rotation) noexcept;

/// @return the unit quaternion that rotates by `angle` [rad] about the unit vector `axis`.
[[nodiscard]] dquat rotation_about(const dvec3& axis, double angle) noexcept;

/// Any unit vector at a right angle to the unit vector `n`; the same for the same bits of n.
/// Source: Duff et al., Building an Orthonormal Basis, Revisited (JCGT 2017).
[[nodiscard]] dvec3 any_perpendicular(const dvec3& n) noexcept;

}  // namespace carom
