// Sums and products with their rounding errors: what the elementary functions keep their last half ulp with.
//
//   Double2 s = two_sum(a, b);      // a + b == s.high + s.low, exactly
#pragma once

namespace carom::detail {

/// An unevaluated sum, |low| at most half an ulp of high.
struct Double2 {
    double high = 0.0;
    double low = 0.0;
};

/// Exact: a + b == high + low (Knuth 1969, vol. 2, 4.2.2, theorem B).
[[nodiscard]] inline Double2 two_sum(double a, double b) noexcept {
    const double s = a + b;
    const double t = s - a;
    return {s, (a - (s - t)) + (b - t)};
}

/// Exact short of overflow: a * b == high + low (Dekker 1971, with Veltkamp's split).
[[nodiscard]] inline Double2 two_product(double a, double b) noexcept {
    constexpr double kSplit = 0x1p27 + 1.0;
    const double ca = kSplit * a, cb = kSplit * b;
    const double a1 = ca - (ca - a), b1 = cb - (cb - b);
    const double a2 = a - a1, b2 = b - b1;
    const double p = a * b;
    return {p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2};
}

}  // namespace carom::detail
