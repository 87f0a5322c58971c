// On which side of a plane through three points a fourth one lies, and of a line through two points a third one, without rounding.
//
//   if (orientation(a, b, c, d) > 0) { /* d is above the triangle abc, seen counter-clockwise from above */ }
#pragma once

#include <carom/core/types.hpp>

#include <glm/common.hpp>

#include <cmath>

namespace carom::detail {

/// The exact sign of the determinant (b - a) × (c - a) · (d - a).
///
/// Method: in double with the error bound of Shewchuk (Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
/// Predicates, 1997, sec. 4.3); where that does not decide, the 24 triple products of coordinates are summed without error as an
/// expansion (sec. 2.4), or the 6 of differences where these are exact.
///
/// @param a, b, c, d  finite; coordinates are zero or of magnitude 2^-300 to 2^300.
/// @return +1, 0 or -1. Cost: 10 ns where rounding decides nothing, else about 5 µs, or 0.3 where the differences are exact.
[[nodiscard]] int orientation(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) noexcept;

/// The same by the slow method alone.
[[nodiscard]] int exact_orientation(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) noexcept;

/// The cross product of two differences of points, with which the fast method tells the sides of many points.
class FilteredCross {
public:
    FilteredCross(const dvec3& u, const dvec3& v) noexcept {
        const dvec3 first{u.y * v.z, u.z * v.x, u.x * v.y}, second{u.z * v.y, u.x * v.z, u.y * v.x};
        normal_ = first - second;
        size_ = glm::abs(first) + glm::abs(second);
    }
    /// @param w  the difference of two points. @return the sign of u × v · w, or 0 where rounding leaves it open.
    [[nodiscard]] int side(const dvec3& w) const noexcept {
        const double determinant = w.x * normal_.x + w.y * normal_.y + w.z * normal_.z;
        const double size = std::abs(w.x) * size_.x + std::abs(w.y) * size_.y + std::abs(w.z) * size_.z;
        const double error = (7.0 * 0x1p-53 + 56.0 * 0x1p-106) * size + 0x1p-1000;  // the last for products that underflow
        return (determinant > error ? 1 : 0) - (determinant < -error ? 1 : 0);
    }

private:
    dvec3 normal_, size_;
};

/// The exact sign of the determinant (b - a) × (c - a): +1 where a, b, c turn counter-clockwise. As above.
[[nodiscard]] int orientation(const dvec2& a, const dvec2& b, const dvec2& c) noexcept;

}  // namespace carom::detail
