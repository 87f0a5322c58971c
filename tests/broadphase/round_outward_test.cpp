// round_outward against exact rational arithmetic: it holds the box, and the next smaller float would not.
#include <carom/broadphase/proxy.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>
#include <boost/multiprecision/cpp_int.hpp>

#include <algorithm>
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

TEST(RoundOutward, WhatIsBeyondIsToldWithoutRounding) {
    Random random(0x0b7);
    int beyond = 0, within = 0;
    for (int i = 0; i < 20000; ++i) {
        const double a = adversarial(random), b = adversarial(random), origin = i % 3 == 0 ? a : adversarial(random);
        const Aabb box{dvec3{std::fmin(a, b)}, dvec3{std::fmax(a, b)}};
        const FloatAabb r = round_outward(box, dvec3{origin});
        EXPECT_FALSE(is_beyond(box, dvec3{origin}, r));
        for (int k = 0; k < 6; ++k) {  // one bound of six moved by a float, inward or outward
            FloatAabb known = r;
            float& bound = k < 3 ? known.lower[k] : known.upper[k - 3];
            bound = std::nextafter(bound, i % 2 == 0 ? INFINITY : -INFINITY);
            const bool rounded = r.lower[k % 3] < known.lower[k % 3] || r.upper[k % 3] > known.upper[k % 3];
            ASSERT_EQ(is_beyond(box, dvec3{origin}, known), rounded) << std::hexfloat << a << " " << b << " " << origin << " " << k;
            ++(rounded ? beyond : within);
        }
    }
    EXPECT_GT(beyond, 50000);
    EXPECT_GT(within, 50000);
}

TEST(RoundOutward, ABoxAboutAPathHoldsIt) {
    Random random(0x9a7);
    for (int i = 0; i < 20000; ++i) {
        SweepPath path;
        for (int k = 0; k < 3; ++k)
            path.origin[k] = adversarial(random), path.direction[k] = adversarial(random), path.grow[k] = std::abs(adversarial(random));
        path.t_max = std::abs(adversarial(random));
        const FloatAabb box = box_about(path);
        for (const double t : {0.0, random.unit() * path.t_max, path.t_max}) {
            for (int k = 0; k < 3; ++k) {
                const Rational at = Rational(path.origin[k]) + Rational(t) * Rational(path.direction[k]);
                // Beyond every float there is no box.
                const Rational most = Rational(std::numeric_limits<float>::max());
                const Rational lower = at - Rational(path.grow[k]), upper = at + Rational(path.grow[k]);
                ASSERT_TRUE(lower < -most || Rational(box.lower[k]) <= lower) << i;
                ASSERT_TRUE(upper > most || Rational(box.upper[k]) >= upper) << i;
            }
        }
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
