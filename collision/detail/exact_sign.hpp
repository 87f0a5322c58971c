// Signs of small determinants without rounding error.
//
//   double u = difference_of_products(cx, by, cy, bx);   // the sign is exact
//   int side = orientation_sign({a.x, a.y}, {b.x, b.y}, {c.x, c.y});
#pragma once

#include <carom/core/types.hpp>

#include <array>
#include <cmath>
#include <cstddef>

namespace carom {

/// Products below this have errors that a double does not hold.
inline constexpr double kLeastProduct = 0x1p-968;

/// @return the rounding error of the product `p` = a * b, exactly (Dekker 1971). Needs |a|, |b| < 2^995, and a product
/// that is zero or above 2^-968.
[[nodiscard]] inline double product_error(double a, double b, double p) noexcept {
    constexpr double kSplitter = 0x1p27 + 1.0;
    const double a_scaled = kSplitter * a;
    const double a_high = a_scaled - (a_scaled - a);
    const double a_low = a - a_high;
    const double b_scaled = kSplitter * b;
    const double b_high = b_scaled - (b_scaled - b);
    const double b_low = b - b_high;
    return a_low * b_low - (((p - a_high * b_high) - a_low * b_high) - a_high * b_low);
}

/// @return a b - c d with the exact sign, zero only where it is exactly zero; in the range of product_error.
/// Accuracy: within 1.5 ulp of the larger product. Rounding is monotone, so rounded products that differ are already in the right
/// order; only equal ones need their errors. Swapping the products negates the result exactly. Below that range: zero where rounded
/// products are equal.
[[nodiscard]] inline double difference_of_products(double a, double b, double c, double d) noexcept {
    const double p = a * b;
    const double q = c * d;
    if (p != q) [[likely]] {
        return p - q;
    }
    if (std::abs(p) < kLeastProduct) [[unlikely]] {
        return 0.0;
    }
    return product_error(a, b, p) - product_error(c, d, q);
}

/// @return the sum of `terms` within 2 ulp, zero only where it is exactly zero, by an expansion of non-overlapping parts (Shewchuk
/// 1997, Grow-Expansion).
template <std::size_t N>
[[nodiscard]] double accurate_sum(const std::array<double, N>& terms) noexcept {
    std::array<double, N> parts{};  // in ascending order of magnitude, zeros anywhere
    for (std::size_t n = 0; n < N; ++n) {
        double sum = terms[n];
        for (std::size_t k = 0; k < n; ++k) {
            const double x = sum + parts[k];
            const double part_kept = x - sum;
            const double error = (sum - (x - part_kept)) + (parts[k] - part_kept);
            parts[k] = error;
            sum = x;
        }
        parts[n] = sum;
    }
    double total = 0.0;
    for (const double part : parts) {
        total += part;
    }
    return total;
}

/// @return the sign of the exact sum of `terms`.
template <std::size_t N>
[[nodiscard]] int sign_of_sum(const std::array<double, N>& terms) noexcept {
    const double sum = accurate_sum(terms);
    return (sum > 0.0 ? 1 : 0) - (sum < 0.0 ? 1 : 0);
}

/// @return the rounding error of the sum `s` = a + b, exactly (Knuth).
[[nodiscard]] inline double sum_error(double a, double b, double s) noexcept {
    const double b_kept = s - a;
    return (a - (s - b_kept)) + (b - b_kept);
}

/// @return dot(a, b) - c within 4 eps of itself, zero only where it is exactly zero; products in the range of product_error.
/// As it is where little cancels: no term is rounded more than four times, so with u = eps / 2 it errs by 4 u (1 + 2 u) of the sum of
/// sizes, which is 1 / 0.51 times the result at most: 7.9 u. Else with the errors of products and sums added (Ogita, Rump, Oishi, Accurate
/// Sum and Dot Product, SIAM J. Sci. Comput. 2005, Dot2), whose own error is below u of the result, plus 2^-100 of the sizes. Else by
/// an exact expansion.
[[nodiscard]] inline double accurate_dot(const dvec3& a, const dvec3& b, double c) noexcept {
    const dvec3 p = a * b;
    const double xy = p.x + p.y, xyz = xy + p.z, sum = xyz - c;
    const double size = std::abs(p.x) + std::abs(p.y) + std::abs(p.z) + std::abs(c);
    if (std::abs(sum) > 0.51 * size) [[likely]] {
        return sum;
    }
    const dvec3 lost{product_error(a.x, b.x, p.x), product_error(a.y, b.y, p.y), product_error(a.z, b.z, p.z)};
    const double errors =
        (lost.x + lost.y + lost.z) + (sum_error(p.x, p.y, xy) + sum_error(xy, p.z, xyz) + sum_error(xyz, -c, sum));
    const double compensated = sum + errors;
    if (std::abs(compensated) > 0x1p-45 * size) {
        return compensated;
    }
    return accurate_sum<7>({lost.x, lost.y, lost.z, p.x, p.y, p.z, -c});
}

/// @return 1 if a, b, c turn counter-clockwise, -1 if clockwise, 0 if they are exactly collinear.
[[nodiscard]] inline int orientation_sign(const vec2& a, const vec2& b, const vec2& c) noexcept {
    const dvec2 p(a);
    const dvec2 q(b);
    const dvec2 r(c);
    // Products of two floats are exact in double.
    return sign_of_sum<6>({p.x * q.y, -(p.y * q.x), q.x * r.y, -(q.y * r.x), r.x * p.y, -(r.y * p.x)});
}

}  // namespace carom
