// The one fused multiply-add that kernels may use: a b + c rounded once, with the same bits at every width.
//
//   #include <carom/core/lanes_fused.hpp>      // where lanes.hpp would be included, which it includes
//   Floats d = fused(a, b, c);                 // a b + c
//
// Rounding once is an operation of IEEE 754 like any other. It is kept apart because a compiler that contracts a * b + c where
// it likes makes bits depend on flags; here the source says where. Targets with the instruction use it. The others compute in
// double: the product of two floats is exact there, and the sum is rounded to odd (Boldo and Melquiond, Emulation of FMA and
// correctly rounded sums: proved algorithms using rounding to odd, IEEE Trans. Computers 2008, theorem 1), so that rounding it
// once more to float, denormal ones too, gives what one rounding gives. That costs some ten times as much.

// This guard lets the file through once for each target.
#if defined(CAROM_CORE_LANES_FUSED_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_CORE_LANES_FUSED_HPP
#undef CAROM_CORE_LANES_FUSED_HPP
#else
#define CAROM_CORE_LANES_FUSED_HPP
#endif

#include <carom/core/lanes.hpp>

#include <cstdint>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {

/// True where `fused` is one instruction.
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_NEON
#define CAROM_HARDWARE_FUSED 1
#else
#define CAROM_HARDWARE_FUSED 0
#endif
constexpr bool kHardwareFused = CAROM_HARDWARE_FUSED != 0;

/// @return a b + c rounded once, for one number.
HWY_INLINE float fused_emulated(float a, float b, float c) {
    const double product = static_cast<double>(a) * static_cast<double>(b);
    const double addend = static_cast<double>(c);
    const double sum = product + addend;
    // Knuth's two-sum: what `sum` lost.
    const double addend_kept = sum - product;
    const double lost = (product - (sum - addend_kept)) + (addend - addend_kept);
    std::uint64_t word = 0;
    std::memcpy(&word, &sum, sizeof(word));
    // NaN where the sum is not finite, which compares false: such a sum is what it is.
    if ((lost < 0.0 || lost > 0.0) && (word & 1u) == 0) {
        word = (lost > 0.0) == (sum > 0.0) ? word + 1 : word - 1;
    }
    double odd = 0.0;
    std::memcpy(&odd, &word, sizeof(odd));
    return static_cast<float>(odd);
}

/// @return a b + c rounded once.
HWY_INLINE Floats fused(Floats a, Floats b, Floats c) {
#if CAROM_HARDWARE_FUSED
    return Floats{hn::MulAdd(a.raw, b.raw, c.raw)};
#else
    alignas(64) float x[kLanes], y[kLanes], z[kLanes];
    store(a, x), store(b, y), store(c, z);
    for (int lane = 0; lane < kLanes; ++lane) z[lane] = fused_emulated(x[lane], y[lane], z[lane]);
    return load(z);
#endif
}

/// @return a b - c d within 1.5 ulp, without over- or underflow.
/// Its sign is exact or zero whatever underflows: rounding is monotone, so a b > c d never gives a negative result. It is zero for
/// different products only where the error of c d is below the denormals.
/// Source: Kahan; error bound by Jeannerod, Louvet, Muller, Further analysis of Kahan's algorithm for the accurate computation of
/// 2 x 2 determinants (Math. Comp. 2013), theorem 1.
HWY_INLINE Floats difference_of_products(Floats a, Floats b, Floats c, Floats d) {
    const Floats product = c * d;
#if CAROM_HARDWARE_FUSED
    const Floats error{hn::NegMulAdd(c.raw, d.raw, product.raw)};  // product - c d, exact without underflow
    return Floats{hn::MulSub(a.raw, b.raw, product.raw)} + error;
#else
    const Floats error = fused(-c, d, product);
    return fused(a, b, -product) + error;
#endif
}

#undef CAROM_HARDWARE_FUSED

}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
