// Two neighbouring rows of four floats of each lane's body, read at once: half the loads and addresses of two gather_rows().
// Compiled once for each target.
//
//   const TwoRows r = gather_two_rows(bodies, rows, kBodyStride, 0);   // r.a r.b r.c: velocity, r.e r.f r.g: spin

#if defined(CAROM_DYNAMICS_BODY_ROWS_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_DYNAMICS_BODY_ROWS_HPP
#undef CAROM_DYNAMICS_BODY_ROWS_HPP
#else
#define CAROM_DYNAMICS_BODY_ROWS_HPP
#endif

#include <carom/core/lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

struct TwoRows {
    Floats a, b, c, d;  ///< of the first
    Floats e, f, g, h;  ///< of the second
};

/// Lane l of the result is the eight floats at base + rows[l] * stride + column, which lie at a multiple of 32 bytes.
template <int lanes = kLanes>
HWY_INLINE TwoRows gather_two_rows(const float* base, const std::int32_t* rows, std::size_t stride, std::size_t column) {
#if HWY_TARGET != HWY_SCALAR
    if constexpr (lanes >= 8) {
        // Register i holds the eight floats of row i, and of row i + 8 where it is sixteen long.
        const auto row = [&](int i) {
            const hn::Simd<float, lanes == 16 ? 8 : lanes, 0> whole;
            const auto first = hn::Load(whole, base + static_cast<std::size_t>(rows[i]) * stride + column);
            if constexpr (lanes == 16) {
                return Floats{hn::Combine(FloatTag(), hn::Load(whole, base + static_cast<std::size_t>(rows[i + 8]) * stride + column), first)};
            } else {
                return Floats{first};
            }
        };
        Floats p0 = row(0), p1 = row(1), p2 = row(2), p3 = row(3), q0 = row(4), q1 = row(5), q2 = row(6), q3 = row(7);
        transpose_blocks(p0, p1, p2, p3);
        transpose_blocks(q0, q1, q2, q3);
        // Even blocks are now of the first row, odd ones of the second.
        const auto evens = [](Floats p, Floats q) { return Floats{hn::OddEvenBlocks(hn::SwapAdjacentBlocks(q.raw), p.raw)}; };
        const auto odds = [](Floats p, Floats q) { return Floats{hn::OddEvenBlocks(q.raw, hn::SwapAdjacentBlocks(p.raw))}; };
        return {evens(p0, q0), evens(p1, q1), evens(p2, q2), evens(p3, q3), odds(p0, q0), odds(p1, q1), odds(p2, q2), odds(p3, q3)};
    } else
#endif
    {
        Floats a, b, c, d, e, f, g, h;
        gather_rows(base, rows, stride, column, a, b, c, d);
        gather_rows(base, rows, stride, column + 4, e, f, g, h);
        return {a, b, c, d, e, f, g, h};
    }
}

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
