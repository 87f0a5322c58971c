// round_outward against exact rational arithmetic: it holds the box, and the next smaller float would not.
#include <carom/broadphase/proxy.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>
#include <boost/multiprecision/cpp_int.hpp>

#include <cmath>
#include <limits>

namespace carom {
namespace {

using Rational = boost::multiprecision::cpp_rational;

double adversarial(Random& random) {
    const double what = random.unit();
    if (what < 0.1) return std::ldexp(1.0, static_cast<int>(random.range(-60, 60)));
    if (what < 0.2) return static_cast<double>(static_cast<float>(random.range(-1e3, 1e3)));
    if (what < 0.3) return std::nextafter(static_cast<double>(static_cast<float>(random.range(-2, 2))), random.range(-9, 9));
    if (what < 0.4) return static_cast<double>(static_cast<int>(random.range(-3, 3)));
    const int exponent = static_cast<int>(what < 0.6 ? random.range(-1070, 120) : random.range(-40, 40));
    return std::ldexp(random.range(-1.0, 1.0), exponent);
}

TEST(RoundOutward, IsTheTightestFloatBoxThatHoldsTheBox) {
    Random random(0x0a7);
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (int i = 0; i < 6000; ++i) {
        const double a = adversarial(random), b = adversarial(random), origin = i % 3 == 0 ? a : adversarial(random);
        const Aabb box{dvec3{std::fmin(a, b)}, dvec3{std::fmax(a, b)}};
        const FloatAabb r = round_outward(box, dvec3{origin});
        ASSERT_EQ(r.lower.x, r.lower.z);
        ASSERT_EQ(r.upper.x, r.upper.y);
        const Rational lower = Rational(box.lower.x) - Rational(origin), upper = Rational(box.upper.x) - Rational(origin);
        ASSERT_LE(Rational(r.lower.x), lower);
        ASSERT_GE(Rational(r.upper.x), upper);
        ASSERT_GT(Rational(std::nextafter(r.lower.x, kInfinity)), lower) << std::hexfloat << a << " " << b << " " << origin;
        ASSERT_LT(Rational(std::nextafter(r.upper.x, -kInfinity)), upper) << std::hexfloat << a << " " << b << " " << origin;
    }
}

TEST(RoundOutward, BeyondFloatTheBoxIsOpenOutwardAndStillHolds) {
    constexpr double kHuge = std::numeric_limits<double>::max();
    constexpr float kMax = std::numeric_limits<float>::max(), kInfinity = std::numeric_limits<float>::infinity();
    const FloatAabb r = round_outward({dvec3{1e300}, dvec3{kHuge}}, dvec3{-kHuge});
    EXPECT_EQ(r.lower.x, kMax);
    EXPECT_EQ(r.upper.x, kInfinity);
    const FloatAabb s = round_outward({dvec3{-1e300}, dvec3{-1e299}}, dvec3{0.0});
    EXPECT_EQ(s.lower.y, -kInfinity);
    EXPECT_EQ(s.upper.y, -kMax);
}

TEST(RoundOutward, KeepsInfinitiesAndNaN) {
    const FloatAabb empty = round_outward(Aabb{}, dvec3{3.0});
    EXPECT_EQ(empty.lower.x, std::numeric_limits<float>::infinity());
    EXPECT_EQ(empty.upper.x, -std::numeric_limits<float>::infinity());
    const FloatAabb nan = round_outward({dvec3{std::nan("")}, dvec3{1.0}}, dvec3{0.0});
    EXPECT_TRUE(std::isnan(nan.lower.z));
}

}  // namespace
}  // namespace carom
