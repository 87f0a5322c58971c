// The angle of a vector in the plane: core/math.hpp's arctan2.
#include <carom/core/detail/double2.hpp>
#include <carom/core/math.hpp>

#include <cmath>
#include <limits>

namespace carom {
namespace {

using detail::Double2;
using detail::two_product;
using detail::two_sum;

constexpr Double2 kPi2{0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};
constexpr Double2 kHalfPi2{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};

// arctan(k / 16)
constexpr Double2 kArctan[17] = {{0x0.0p+0, 0x0.0p+0},
                                 {0x1.ff55bb72cfdeap-5, -0x1.c934d86d23f1dp-60},
                                 {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
                                 {0x1.7b97b4bce5b02p-3, 0x1.347b0b4f881cap-58},
                                 {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                 {0x1.362773707ebccp-2, -0x1.963a544b672d8p-57},
                                 {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
                                 {0x1.a64eec3cc23fdp-2, -0x1.24dec1b50b7ffp-56},
                                 {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                 {0x1.0657e94db30d0p-1, -0x1.d5b495f6349e6p-56},
                                 {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
                                 {0x1.345f01cce37bbp-1, 0x1.1021137c71102p-55},
                                 {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
                                 {0x1.5d58987169b18p-1, 0x1.0028e4bc5e7cap-57},
                                 {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
                                 {0x1.819d0b7158a4dp-1, -0x1.bf76229d3b917p-56},
                                 {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}};

Double2 minus(const Double2& a, const Double2& b) noexcept {
    const Double2 s = two_sum(a.high, -b.high);
    return two_sum(s.high, s.low + (a.low - b.low));
}

// arctan(y / x) for 2^-60 x <= y <= x, x in [1, 2): arctan(c) + arctan((y - c x) / (x + c y)) with c the multiple of 1/16 nearest to
// y / x, so that the second is at most 1/32 and a few terms of Taylor's series leave 2^-64 of it.
Double2 arctan_of_ratio(double y, double x) noexcept {
    const int k = static_cast<int>(16.0 * (y / x) + 0.5);
    const double c = static_cast<double>(k) / 16.0;
    const Double2 cx = two_product(c, x), cy = two_product(c, y);
    const Double2 top = two_sum(y, -cx.high), bottom = two_sum(x, cy.high);
    const double top_low = top.low - cx.low, bottom_low = bottom.low + cy.low;
    const double t = (top.high + top_low) / bottom.high;
    const Double2 back = two_product(t, bottom.high);
    const double t_low = (((top.high - back.high) - back.low) + (top_low - t * bottom_low)) / bottom.high;
    const double z = t * t;
    const double series =
        -0x1.5555555555555p-2 +
        z * (0x1.999999999999ap-3 +
             z * (-0x1.2492492492492p-3 + z * (0x1.c71c71c71c71cp-4 + z * (-0x1.745d1745d1746p-4 + z * 0x1.3b13b13b13b14p-4))));
    const Double2 sum = two_sum(kArctan[k].high, t);
    return two_sum(sum.high, sum.low + (kArctan[k].low + (t_low + t * z * series)));
}

}  // namespace

double arctan2(double y, double x) noexcept {
    if (!(x == x && y == y)) return x + y;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    double across = std::fabs(x), up = std::fabs(y);
    if (across == kInfinity || up == kInfinity) {
        across = across == kInfinity ? 1.0 : 0.0;
        up = up == kInfinity ? 1.0 : 0.0;
    }
    const bool steep = up > across, left = std::signbit(x);
    const double lesser = steep ? across : up, greater = steep ? up : across;
    Double2 angle;
    if (greater == 0.0) {
        angle = {0.0, 0.0};
    } else if (lesser / greater < 0x1p-60) {
        angle = {lesser / greater, 0.0};  // the next term is below 2^-120 of it
    } else {
        const int exponent = std::ilogb(greater);
        angle = arctan_of_ratio(std::ldexp(lesser, -exponent), std::ldexp(greater, -exponent));
    }
    if (steep) angle = minus(kHalfPi2, angle);
    if (left) angle = minus(kPi2, angle);
    return std::copysign(angle.high + angle.low, y);
}

}  // namespace carom
