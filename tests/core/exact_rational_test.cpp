// The rationals that oracles compute in against Boost's, which reduces every one by a common divisor.
#include <support/rational.hpp>

#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace carom {
namespace {

using Plain = boost::multiprecision::number<boost::multiprecision::cpp_rational_backend, boost::multiprecision::et_off>;
using exact::Rational;

struct Both {
    Rational quick;
    Plain plain;
};

/// Whether both are the same number: 60 bits at a time, from the highest.
void expect_same(const Both& x) {
    ASSERT_EQ(x.quick.sign(), x.plain.sign());
    Rational quick = x.quick;
    Plain plain = x.plain;
    for (int digits = 0; plain.sign() != 0; ++digits) {
        ASSERT_LT(digits, 200);
        const double part = static_cast<double>(quick);
        if (!std::isfinite(part) || std::abs(part) < 0x1p-900) return;
        quick -= Rational(part);
        plain -= Plain(part);
        ASSERT_EQ(quick.sign(), plain.sign());
        if (digits == 3) return;
    }
}

double any_double(Random& random) {
    const double kind = random.unit();
    if (kind < 0.2) return std::floor(random.range(-4.0, 5.0));
    const double x = random.range(-1.0, 1.0);
    return kind < 0.4 ? static_cast<double>(static_cast<float>(x)) : std::ldexp(x, static_cast<int>(random.range(-40.0, 40.0)));
}

TEST(ExactRational, ComputesWhatBoostDoes) {
    Random random(0x4a71);
    int fractions = 0, negative = 0, equal = 0;
    for (int i = 0; i < 400; ++i) {
        std::vector<Both> pool;
        for (int k = 0; k < 3; ++k) {
            const double x = any_double(random);
            pool.push_back({Rational(x), Plain(x)});
        }
        for (int k = 0; k < 12; ++k) {
            const auto pick = [&] { return pool[static_cast<std::size_t>(random.range(0.0, static_cast<double>(pool.size())))]; };
            const Both a = pick(), b = pick();
            const int how = static_cast<int>(random.range(0.0, 4.0));
            if (how == 3 && b.plain.sign() == 0) continue;
            pool.push_back(how == 0   ? Both{a.quick + b.quick, a.plain + b.plain}
                           : how == 1 ? Both{a.quick - b.quick, a.plain - b.plain}
                           : how == 2 ? Both{a.quick * b.quick, a.plain * b.plain}
                                      : Both{a.quick / b.quick, a.plain / b.plain});
            ASSERT_NO_FATAL_FAILURE(expect_same(pool.back())) << i << " " << k;
            const Both& c = pool.back();
            ASSERT_EQ(a.quick < c.quick, a.plain < c.plain) << i;
            ASSERT_EQ(a.quick <= c.quick, a.plain <= c.plain) << i;
            ASSERT_EQ(a.quick == c.quick, a.plain == c.plain) << i;
            ASSERT_EQ(-a.quick > c.quick, Plain(-a.plain) > c.plain) << i;
            fractions += denominator(c.plain) % 2 != 0 && denominator(c.plain) != 1;
            negative += c.plain.sign() < 0;
            equal += a.plain == c.plain;
        }
    }
    EXPECT_GT(fractions, 50);
    EXPECT_GT(negative, 1000);
    EXPECT_GT(equal, 50);
}

TEST(ExactRational, IsReducedSoThatEqualNumbersAreTheSame) {
    EXPECT_EQ(Rational(6) / 4, Rational(1.5));
    EXPECT_EQ(Rational(-10) / 15, Rational(2) / -3);
    EXPECT_EQ(Rational(1) / 3 + Rational(1) / 6, Rational(0.5));
    EXPECT_EQ(Rational(1) / 3 * 3, Rational(1));
    EXPECT_EQ(Rational(0.1) - Rational(0.1), Rational(0));
    EXPECT_EQ(Rational::power_of_two(-3), Rational(0.125));
    EXPECT_EQ(Rational(0x1p-1074) * Rational::power_of_two(1074), Rational(1));
    EXPECT_EQ(Rational(0x1.fffffffffffffp1023) / Rational(0x1p-1074), Rational(0x1.fffffffffffffp0) * Rational::power_of_two(2097));
}

TEST(ExactRational, DoublesComeBackAsTheyWere) {
    Random random(0x4a72);
    for (int i = 0; i < 2000; ++i) {
        const double x = std::ldexp(random.range(-1.0, 1.0), static_cast<int>(random.range(-1060.0, 1024.0)));
        ASSERT_EQ(static_cast<double>(Rational(x)), x);
        const Rational third = Rational(x) / 3;
        if (std::abs(x) > 1e-300) {
            ASSERT_NEAR(static_cast<double>(third) / (x / 3.0), 1.0, 0x1p-51);
        }
        if (x != 0.0) {
            ASSERT_LE(std::abs(std::ilogb(x) - Rational(x).exponent()), 0);
        }
    }
    EXPECT_EQ(static_cast<double>(Rational(0x1p1000) * Rational(-0x1p1000)), -HUGE_VAL);
    EXPECT_EQ(static_cast<double>(Rational(0x1p-1000) * Rational(0x1p-1000)), 0.0);
}

}  // namespace
}  // namespace carom
