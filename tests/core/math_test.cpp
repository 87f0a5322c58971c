// sin_cos against 200-digit arithmetic over the whole range of double, and the rotations built on it.
#include <carom/core/math.hpp>
#include <carom/core/pose.hpp>
#include <carom/core/random.hpp>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

namespace carom {
namespace {

// 1300 bits: the integer part of 2^1024 / (pi/2) and 250 bits of fraction.
using Real = boost::multiprecision::number<
    boost::multiprecision::cpp_bin_float<1400, boost::multiprecision::digit_base_2, void, std::int32_t>>;
// After the reduction 200 bits are plenty.
using Short = boost::multiprecision::number<
    boost::multiprecision::cpp_bin_float<200, boost::multiprecision::digit_base_2, void, std::int32_t>>;

const Real& half_pi() {
    static const Real value = boost::math::constants::half_pi<Real>();
    return value;
}

struct Oracle {
    Short sin;
    Short cos;
};

Oracle oracle(double x) {
    const Real k = boost::multiprecision::round(Real(x) / half_pi());
    const Short r(Real(Real(x) - k * half_pi()));
    const Real quadrant_real = k - 4 * boost::multiprecision::floor(Real(k / 4));
    const int quadrant = quadrant_real.convert_to<int>();
    Short s = 0, c = 0, power = 1;  // Taylor's series to r^59
    for (int n = 0; n < 60; n += 2) {
        c += power;
        power *= r / Short(n + 1);
        s += power;
        power *= -r / Short(n + 2);
    }
    switch (quadrant) {
        case 0: return {s, c};
        case 1: return {c, -s};
        case 2: return {-s, -c};
        default: return {-c, s};
    }
}

double ulp_of(double x) {
    x = std::fabs(x);
    if (x == 0.0) return std::numeric_limits<double>::denorm_min();
    return std::nextafter(x, std::numeric_limits<double>::infinity()) - x;
}

double error_in_ulp(double got, const Short& want) {
    const Short error = abs(Short(Short(got) - want)) / Short(ulp_of(want.convert_to<double>()));
    return error.convert_to<double>();
}

struct Worst {
    double error = 0.0;
    double at = 0.0;
    void see(double x) {
        const SinCos got = sin_cos(x);
        const Oracle want = oracle(x);
        const double e = std::max(error_in_ulp(got.sin, want.sin), error_in_ulp(got.cos, want.cos));
        if (!(e <= error)) error = e, at = x;
    }
};

// What core/math.hpp promises; the worst seen here is 0.74.
constexpr double kPromise = 0.85;

TEST(SinCos, IsAccurateAtEveryExponent) {
    Random random(0x51c05);
    Worst worst;
    for (int exponent = -1074; exponent <= 1023; ++exponent) {
        for (int i = 0; i < 3; ++i) worst.see(std::ldexp(random.range(1.0, 2.0), exponent) * (i == 1 ? -1.0 : 1.0));
    }
    EXPECT_LE(worst.error, kPromise) << "at " << std::hexfloat << worst.at;
    RecordProperty("worst_ulp", std::to_string(worst.error));
}

TEST(SinCos, IsAccurateForEverydayAngles) {
    Random random(0xe7e7);
    Worst worst;
    for (int i = 0; i < 8000; ++i) worst.see(random.range(-8.0, 8.0));
    for (int i = 0; i < 3000; ++i) worst.see(random.range(-1e6, 1e6));
    for (int i = 0; i < 2000; ++i) worst.see(random.range(0x1p20 * 0.99, 0x1p20 * 1.01));  // where the reduction changes
    EXPECT_LE(worst.error, kPromise) << "at " << std::hexfloat << worst.at;
    RecordProperty("worst_ulp", std::to_string(worst.error));
}

TEST(SinCos, IsAccurateNextToMultiplesOfHalfPi) {
    Worst worst;
    std::vector<double> multiples;
    for (int k = 1; k < 400; ++k) multiples.push_back(k);
    for (int e = 9; e < 1022; e += 7) multiples.push_back(std::ldexp(1.0, e) + 1.0);
    for (const double k : multiples) {
        const double nearest = Real(Real(k) * half_pi()).convert_to<double>();
        for (const double x : {nearest, std::nextafter(nearest, 0.0), std::nextafter(nearest, 1e308)}) worst.see(x);
        const double odd = Real((Real(k) - Real(0.5)) * half_pi()).convert_to<double>();  // where the quadrant changes
        for (const double x : {odd, std::nextafter(odd, 0.0), std::nextafter(odd, 1e308)}) worst.see(x);
    }
    EXPECT_LE(worst.error, kPromise) << "at " << std::hexfloat << worst.at;
}

TEST(SinCos, IsAccurateAtKnownHardArguments) {
    Worst worst;
    // 6381956970095103 * 2^797 is the double nearest to a multiple of pi/2, relatively (Muller, Elementary Functions, 2016, sec. 11.1).
    for (const double x : {std::ldexp(6381956970095103.0, 797), 1e22, 1e300, std::numeric_limits<double>::max(), 0x1p1023, 0x1p20,
                           std::nextafter(0x1p20, 0.0), 0x1p-27, std::nextafter(0x1p-27, 0.0), 0x1p-1074, 0x1p-1022, 1e-8, 0.785,
                           kPi, kPi / 2, kPi / 4}) {
        worst.see(x);
        worst.see(-x);
    }
    EXPECT_LE(worst.error, kPromise) << "at " << std::hexfloat << worst.at;
    EXPECT_EQ(sin_cos(1e22).sin, -0.8522008497671888);
    EXPECT_EQ(sin_cos(kPi).sin, 1.2246467991473532e-16);
}

TEST(SinCos, SpecialValues) {
    EXPECT_EQ(sin_cos(0.0).sin, 0.0);
    EXPECT_FALSE(std::signbit(sin_cos(0.0).sin));
    EXPECT_TRUE(std::signbit(sin_cos(-0.0).sin));
    EXPECT_EQ(sin_cos(-0.0).cos, 1.0);
    for (const double x : {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_TRUE(std::isnan(sin_cos(x).sin));
        EXPECT_TRUE(std::isnan(sin_cos(x).cos));
    }
}

TEST(SinCos, IsOddAndEvenToTheBit) {
    Random random(0x0dd);
    for (int i = 0; i < 20000; ++i) {
        const double x = std::ldexp(random.range(1.0, 2.0), static_cast<int>(random.range(-60.0, 1023.0)));
        EXPECT_EQ(sin_cos(-x).sin, -sin_cos(x).sin);
        EXPECT_EQ(sin_cos(-x).cos, sin_cos(x).cos);
    }
}

struct WorstAngle {
    double error = 0.0;
    double y = 0.0, x = 0.0;
    void see(double up, double across) {
        const double got = arctan2(up, across);
        const double e = error_in_ulp(got, boost::multiprecision::atan2(Short(up), Short(across)));
        if (!(e <= error)) error = e, y = up, x = across;
    }
};

// What core/math.hpp promises; the worst seen here is 0.499997.
constexpr double kAnglePromise = 0.51;

TEST(Arctan2, IsAccurateOverTheWholeRange) {
    Random random(0xa7a2);
    WorstAngle worst;
    for (int i = 0; i < 6000; ++i) worst.see(random.range(-1.0, 1.0), random.range(-1.0, 1.0));
    for (int i = 0; i < 6000; ++i) {  // any exponents
        worst.see(std::ldexp(random.range(-2.0, 2.0), static_cast<int>(random.range(-1074, 1023))),
                  std::ldexp(random.range(-2.0, 2.0), static_cast<int>(random.range(-1074, 1023))));
    }
    for (int i = 0; i < 3000; ++i) {  // ratios of any size
        const double x = random.range(-2.0, 2.0);
        worst.see(std::ldexp(random.range(-2.0, 2.0), static_cast<int>(random.range(-70, 70))), x);
    }
    for (int k = 1; k <= 64; ++k) {  // at the table's entries and half-way between them
        for (const double x : {1.0, 1.7, -1.3, std::nextafter(2.0, 0.0)}) {
            const double y = x * static_cast<double>(k) / 32.0;
            for (const double near : {y, std::nextafter(y, 10.0), std::nextafter(y, -10.0)}) worst.see(near, x);
        }
    }
    EXPECT_LE(worst.error, kAnglePromise) << "at " << std::hexfloat << worst.y << " " << worst.x;
    RecordProperty("worst_ulp", std::to_string(worst.error));
}

TEST(Arctan2, SpecialValuesAreThoseOfIeee) {
    const double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    for (const double y : {0.0, -0.0, 1.0, -1.0, infinity, -infinity}) {
        for (const double x : {0.0, -0.0, 1.0, -1.0, infinity, -infinity}) {
            EXPECT_EQ(arctan2(y, x), std::atan2(y, x)) << y << " " << x;
            EXPECT_EQ(std::signbit(arctan2(y, x)), std::signbit(y)) << y << " " << x;
        }
        EXPECT_TRUE(std::isnan(arctan2(y, nan)));
        EXPECT_TRUE(std::isnan(arctan2(nan, y)));
    }
    const double tiny = std::numeric_limits<double>::denorm_min(), huge = std::numeric_limits<double>::max();
    EXPECT_EQ(arctan2(tiny, 1.0), tiny);
    EXPECT_EQ(arctan2(tiny, huge), 0.0);
    EXPECT_EQ(arctan2(tiny, tiny), kPi / 4);
    EXPECT_EQ(arctan2(huge, huge), kPi / 4);
    EXPECT_EQ(arctan2(huge, tiny), kPi / 2);
    EXPECT_EQ(arctan2(tiny, -huge), kPi);
}

TEST(Arctan2, UndoesSineAndCosine) {
    Random random(0xa7a3);
    for (int i = 0; i < 2000; ++i) {
        const double angle = random.range(-kPi, kPi);
        const SinCos turn = sin_cos(angle);
        EXPECT_NEAR(arctan2(turn.sin, turn.cos), angle, 4e-16);
    }
}

TEST(Rotation, FromVectorKeepsRelativeAccuracyHoweverTiny) {
    Random random(0x7071);
    for (int exponent = -1040; exponent <= 300; exponent += 3) {
        const dvec3 v{std::ldexp(random.range(-1.0, 1.0), exponent), std::ldexp(random.range(-1.0, 1.0), exponent),
                      std::ldexp(random.range(-1.0, 1.0), exponent)};
        const dquat q = rotation_from_vector(v);
        const Short x(v.x), y(v.y), z(v.z);
        const Short angle = sqrt(Short(x * x + y * y + z * z));
        // The rounding of |v| is amplified by |v| itself, so the direct comparison is for moderate angles.
        if (exponent < 3) {
            Short s = 0, c = 0, power = 1;
            const Short h = angle / 2;
            for (int n = 0; n < 80; n += 2) {
                c += power;
                power *= h / Short(n + 1);
                s += power;
                power *= -h / Short(n + 2);
            }
            EXPECT_LE(error_in_ulp(q.w, c), 40.0) << exponent;  // |v| up to 14 rad, a few roundings of it
            const Short scale = s / angle;
            EXPECT_LE(error_in_ulp(q.x, Short(scale * x)), 40.0) << exponent;
            EXPECT_LE(error_in_ulp(q.y, Short(scale * y)), 40.0) << exponent;
            EXPECT_LE(error_in_ulp(q.z, Short(scale * z)), 40.0) << exponent;
        }
        EXPECT_NEAR(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z, 1.0, 1e-15);
    }
}

TEST(Rotation, FromVectorOfZeroIsTheIdentityAndNaNIsNaN) {
    EXPECT_EQ(rotation_from_vector(dvec3{0.0}), kIdentityRotation);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    for (const dvec3& v : {dvec3{nan, 1.0, 0.0}, dvec3{1.0, nan, 0.0}, dvec3{0.0, 0.0, nan}, dvec3{0.0, nan, 0.0},
                           dvec3{infinity, 0.0, 0.0}, dvec3{0.0, -infinity, 1.0}, dvec3{nan, nan, nan}}) {
        const dquat q = rotation_from_vector(v);
        EXPECT_FALSE(is_finite(q)) << v.x << " " << v.y << " " << v.z;
    }
}

TEST(Rotation, AboutAnAxisTurnsCounterClockwise) {
    const dquat quarter = rotation_about({0.0, 1.0, 0.0}, kPi / 2);
    const dvec3 turned = rotate(quarter, dvec3{1.0, 0.0, 0.0});
    EXPECT_NEAR(turned.x, 0.0, 1e-15);
    EXPECT_NEAR(turned.y, 0.0, 1e-15);
    EXPECT_NEAR(turned.z, -1.0, 1e-15);
    Random random(0xab0);
    for (int i = 0; i < 1000; ++i) {
        const double angle = random.range(-6.0, 6.0);
        const dquat a = rotation_about({0.0, 0.0, 1.0}, angle);
        const dquat b = rotation_from_vector({0.0, 0.0, angle});
        EXPECT_NEAR(a.w, b.w, 1e-15);
        EXPECT_NEAR(a.z, b.z, 1e-15);
    }
}

TEST(AnyPerpendicular, IsUnitAndPerpendicularEvenAtThePoles) {
    Random random(0x9e9);
    std::vector<dvec3> normals{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {1e-9, 0, -1}, {0, 1e-300, -1}};
    for (int i = 0; i < 10000; ++i) {
        const dvec3 v{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
        normals.push_back(v / std::sqrt(glm::dot(v, v)));
    }
    for (const dvec3& n : normals) {
        const dvec3 t = any_perpendicular(n);
        EXPECT_NEAR(glm::dot(t, n), 0.0, 1e-15);
        EXPECT_NEAR(glm::dot(t, t), 1.0, 1e-14);
    }
}

}  // namespace
}  // namespace carom
