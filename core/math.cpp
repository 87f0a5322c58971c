#include <carom/core/detail/double2.hpp>
#include <carom/core/math.hpp>

#include <bit>
#include <cstdint>
#include <cmath>
#include <limits>

namespace carom {
namespace {

using detail::Double2;
using detail::two_product;
using detail::two_sum;

// x == quadrant * pi/2 + remainder modulo 2 pi, |remainder| at most pi/4 and a little.
struct Reduced {
    Double2 remainder;
    unsigned quadrant;
};

// Cody and Waite, Software Manual for the Elementary Functions (1980): pi/2 in three parts of 33 bits and a rest, so that
// multiples below 2^20 of the parts are exact.
Reduced reduce_moderate(double x) noexcept {
    constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
    constexpr double kPart[4] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2ep-69, 0x1.b839a252049c1p-104};
    constexpr double kRound = 0x1.8p52;  // adding and taking it away rounds to the nearest integer
    const double k = (x * kTwoOverPi + kRound) - kRound;
    const double first = x - k * kPart[0];
    const Double2 second = two_sum(first, -(k * kPart[1]));
    const Double2 third = two_sum(second.high, -(k * kPart[2]));
    const double rest = (second.low + third.low) - k * kPart[3];
    return {two_sum(third.high, rest), static_cast<unsigned>(static_cast<std::int32_t>(k))};
}

// 2/pi in binary after 64 zero bits; enough for the largest double.
constexpr std::uint64_t kTwoOverPiBits[20] = {
    0,                  0xa2f9836e4e441529, 0xfc2757d1f534ddc0, 0xdb6295993c439041, 0xfe5163abdebbc561,
    0xb7246e3a424dd2e0, 0x06492eea09d1921c, 0xfe1deb1cb129a73e, 0xe88235f52ebb4484, 0xe99c7026b45f7e41,
    0x3991d639835339f4, 0x9c845f8bbdf9283b, 0x1ff897ffde05980f, 0xef2f118b5a0a6d1f, 0x6d367ecf27cb09b7,
    0x4f463f669e5fea2d, 0x7527bac7ebe5f17b, 0x3d0739f78a5292ea, 0x6bfb5fb11f8d5d08, 0x56033046fc7b6bab};

struct Product {
    std::uint64_t high;
    std::uint64_t low;
};

Product multiply(std::uint64_t a, std::uint64_t b) noexcept {
    const std::uint64_t a1 = a >> 32, a0 = a & 0xffffffffu, b1 = b >> 32, b0 = b & 0xffffffffu;
    const std::uint64_t low = a0 * b0, cross = a1 * b0 + (low >> 32);
    const std::uint64_t middle = a0 * b1 + (cross & 0xffffffffu);
    return {a1 * b1 + (cross >> 32) + (middle >> 32), (middle << 32) | (low & 0xffffffffu)};
}

// 192 bits, word[0] the highest.
struct Wide {
    std::uint64_t word[3];
};

// The bits of 2/pi that matter for a number m * 2^exponent, m an integer: those above only add multiples of 4 to the product.
Wide window(int exponent) noexcept {
    const auto position = static_cast<unsigned>(exponent - 1 + 63);
    const unsigned first = position / 64, shift = position % 64;
    Wide result{};
    for (unsigned i = 0; i < 3; ++i) {
        const std::uint64_t next = shift == 0 ? 0 : kTwoOverPiBits[first + i + 1] >> (64 - shift);
        result.word[i] = (kTwoOverPiBits[first + i] << shift) | next;
    }
    return result;
}

// m * w modulo 2^192.
Wide multiply(std::uint64_t m, const Wide& w) noexcept {
    const Product p2 = multiply(m, w.word[2]), p1 = multiply(m, w.word[1]);
    const std::uint64_t word1 = p1.low + p2.high;
    const std::uint64_t carry = word1 < p1.low ? 1 : 0;
    return {{m * w.word[0] + p1.high + carry, word1, p2.low}};
}

// The 192-bit fraction f / 2^190, f non-zero, as a sum of two doubles.
Double2 to_fraction(Wide f) noexcept {
    int exponent = 2;
    while (f.word[0] == 0) {
        f = {{f.word[1], f.word[2], 0}};
        exponent -= 64;
    }
    const int zeros = std::countl_zero(f.word[0]);
    if (zeros > 0) {
        f.word[0] = (f.word[0] << zeros) | (f.word[1] >> (64 - zeros));
        f.word[1] = (f.word[1] << zeros) | (f.word[2] >> (64 - zeros));
    }
    exponent -= zeros;
    const std::uint64_t top = f.word[0] >> 11;
    const std::uint64_t next = ((f.word[0] & 0x7ffu) << 42) | (f.word[1] >> 22);
    return two_sum(std::ldexp(static_cast<double>(top), exponent - 53), std::ldexp(static_cast<double>(next), exponent - 106));
}

// Payne and Hanek, Radian Reduction for Trigonometric Functions (SIGNUM 1983): only the bits of 2/pi whose product with x is
// neither a multiple of 4 nor below the result's precision. No double comes nearer than 2^-61 to a multiple of pi/2, so the
// 137 correct bits after the point leave 76 significant ones.
Reduced reduce_huge(double x) noexcept {
    const std::uint64_t word = std::bit_cast<std::uint64_t>(x);
    const std::uint64_t mantissa = (word & 0xfffffffffffffu) | 0x10000000000000u;
    const int exponent = static_cast<int>(word >> 52) - 1075;
    Wide product = multiply(mantissa, window(exponent));
    auto quadrant = static_cast<unsigned>(product.word[0] >> 62);
    product.word[0] &= ~std::uint64_t{0} >> 2;
    const bool above_half = (product.word[0] >> 61) != 0;
    if (above_half) {  // f - 1 instead, so that the remainder is at most pi/4
        ++quadrant;
        product = {{~product.word[0] & (~std::uint64_t{0} >> 2), ~product.word[1], ~product.word[2]}};
    }
    Double2 fraction = to_fraction(product);
    if (above_half) fraction = {-fraction.high, -fraction.low};
    constexpr double kHalfPi = 0x1.921fb54442d18p+0, kHalfPiLow = 0x1.1a62633145c07p-54;
    const Double2 p = two_product(fraction.high, kHalfPi);
    return {two_sum(p.high, p.low + (fraction.high * kHalfPiLow + fraction.low * kHalfPi)), quadrant};
}

// Taylor's series on [-pi/4, pi/4], where the first term left out is below 2^-63 of the result.
SinCos sin_cos_reduced(const Double2& r) noexcept {
    const double z = r.high * r.high;
    const double s = -0x1.5555555555555p-3 +
                     z * (0x1.1111111111111p-7 +
                          z * (-0x1.a01a01a01a01ap-13 +
                               z * (0x1.71de3a556c734p-19 +
                                    z * (-0x1.ae64567f544e4p-26 +
                                         z * (0x1.6124613a86d09p-33 +
                                              z * (-0x1.ae7f3e733b81fp-41 + z * 0x1.952c77030ad4ap-49))))));
    const double c = 0x1.5555555555555p-5 +
                     z * (-0x1.6c16c16c16c17p-10 +
                          z * (0x1.a01a01a01a01ap-16 +
                               z * (-0x1.27e4fb7789f5cp-22 +
                                    z * (0x1.1eed8eff8d898p-29 +
                                         z * (-0x1.93974a8c07c9dp-37 +
                                              z * (0x1.ae7f3e733b81fp-45 - z * 0x1.6827863b97d97p-53))))));
    // The remainder's low part enters by its first derivatives: cos r = 1 - z/2 and -sin r = -r.
    const double sin = r.high + (r.high * z * s + r.low * (1.0 - 0.5 * z));
    const Double2 square = two_product(r.high, r.high);
    const Double2 leading = two_sum(1.0, -0.5 * square.high);
    const double cos = leading.high + (leading.low + ((z * z * c - 0.5 * square.low) - r.high * r.low));
    return {sin, cos};
}

}  // namespace

SinCos sin_cos(double x) noexcept {
    const double magnitude = x < 0.0 ? -x : x;
    if (!(magnitude <= std::numeric_limits<double>::max())) return {x - x, x - x};
    if (magnitude < 0x1p-27) return {x, 1.0};  // the next terms are below half an ulp; keeps -0
    const Reduced reduced = magnitude < 0x1p20 ? reduce_moderate(magnitude) : reduce_huge(magnitude);
    const SinCos r = sin_cos_reduced(reduced.remainder);
    SinCos result;
    switch (reduced.quadrant & 3u) {
        case 0: result = {r.sin, r.cos}; break;
        case 1: result = {r.cos, -r.sin}; break;
        case 2: result = {-r.sin, -r.cos}; break;
        default: result = {-r.cos, r.sin}; break;
    }
    if (x < 0.0) result.sin = -result.sin;
    return result;
}

dquat rotation_from_vector(const dvec3& rotation) noexcept {
    const auto magnitude = [](double a) { return a < 0.0 ? -a : a; };
    double largest = magnitude(rotation.x);
    if (magnitude(rotation.y) > largest) largest = magnitude(rotation.y);
    if (magnitude(rotation.z) > largest) largest = magnitude(rotation.z);
    // 1 - a^2/8 and a/2 - a^3/48 round to 1 and a/2 here, and the square below would underflow.
    if (largest < 0x1p-28) return {1.0, 0.5 * rotation.x, 0.5 * rotation.y, 0.5 * rotation.z};
    const dvec3 unit{rotation.x / largest, rotation.y / largest, rotation.z / largest};  // the squares cannot overflow
    const double length = std::sqrt(unit.x * unit.x + unit.y * unit.y + unit.z * unit.z);
    const SinCos half = sin_cos(0.5 * largest * length);
    const double scale = half.sin / length;
    return {half.cos, scale * unit.x, scale * unit.y, scale * unit.z};
}

dquat rotation_about(const dvec3& axis, double angle) noexcept {
    const SinCos half = sin_cos(0.5 * angle);
    return {half.cos, half.sin * axis.x, half.sin * axis.y, half.sin * axis.z};
}

dvec3 any_perpendicular(const dvec3& n) noexcept {
    const double sign = n.z < 0.0 ? -1.0 : 1.0;
    const double a = -1.0 / (sign + n.z);
    const double b = n.x * n.y * a;
    return {1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x};
}

}  // namespace carom
