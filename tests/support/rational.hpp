// Exact rationals for the oracles, quick where all numbers come from floats.
//
//   exact::Rational x(0.1f), y = (x + 1) / 3;
//   EXPECT_TRUE(y * 3 - 1 == x);
//
// A value is n / d 2^e with n and d odd: sums and products of floats and doubles have d = 1 and need no common divisor, which is what
// boost::multiprecision::cpp_rational spends its time on. Integers of up to 1,024 bits, as almost all here are, stay off the heap, which
// counts under AddressSanitizer, where the fuzzers run.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>

#include <algorithm>
#include <cmath>
#include <compare>
#include <concepts>
#include <cstdint>
#include <limits>
#include <ostream>
#include <utility>

namespace carom::exact {

/// Without expression templates, so that `auto` and `?:` hold values.
using Integer = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<1024>, boost::multiprecision::et_off>;

class Rational {
public:
    Rational() = default;
    template <std::integral T>
    Rational(T x) : Rational(Integer(x), Integer(1), 0) {}
    /// `x` is finite.
    template <std::floating_point T>
    explicit Rational(T x) {
        static_assert(std::numeric_limits<T>::digits <= 53, "more bits than a double has");
        int power = 0;
        const double fraction = std::frexp(static_cast<double>(x), &power);
        *this = Rational(Integer(static_cast<std::int64_t>(std::ldexp(fraction, 53))), Integer(1), power - 53);
    }
    [[nodiscard]] static Rational power_of_two(int k) { return Rational(Integer(1), Integer(1), k); }

    [[nodiscard]] int sign() const { return over_.sign(); }
    /// @return the power of two at or next above or below |x|, for x != 0.
    [[nodiscard]] int exponent() const { return power_ + bits(over_) - bits(under_); }
    /// Within 2^-52 of itself, or half the least denormal number; infinite beyond what doubles hold.
    [[nodiscard]] explicit operator double() const;

    friend Rational operator-(Rational a) {
        a.over_ = -a.over_;
        return a;
    }
    friend Rational operator+(const Rational& a, const Rational& b) { return sum(a, b, false); }
    friend Rational operator-(const Rational& a, const Rational& b) { return sum(a, b, true); }
    friend Rational operator*(const Rational& a, const Rational& b) {
        if (a.over_.is_zero() || b.over_.is_zero()) return {};
        return Rational(a.over_ * b.over_, product(a.under_, b.under_), a.power_ + b.power_);
    }
    /// @param b  not zero.
    friend Rational operator/(const Rational& a, const Rational& b) {
        if (a.over_.is_zero()) return {};
        const Integer over = a.over_ * b.under_;
        return Rational(b.over_.sign() < 0 ? Integer(-over) : over, product(a.under_, abs(b.over_)), a.power_ - b.power_);
    }
    Rational& operator+=(const Rational& b) { return *this = *this + b; }
    Rational& operator-=(const Rational& b) { return *this = *this - b; }
    Rational& operator*=(const Rational& b) { return *this = *this * b; }
    Rational& operator/=(const Rational& b) { return *this = *this / b; }

    friend bool operator==(const Rational& a, const Rational& b) {
        return a.power_ == b.power_ && a.over_ == b.over_ && a.under_ == b.under_;
    }
    friend std::strong_ordering operator<=>(const Rational& a, const Rational& b) {
        if (a.sign() != b.sign()) return a.sign() <=> b.sign();
        return difference(a, b, true).first.sign() <=> 0;
    }
    friend std::ostream& operator<<(std::ostream& out, const Rational& x) {
        return out << x.over_ << " / " << x.under_ << " * 2^" << x.power_;
    }

private:
    /// @param under  odd, above zero.
    Rational(Integer over, Integer under, int power) : over_(std::move(over)), under_(std::move(under)), power_(power) {
        if (over_.is_zero()) {
            under_ = 1;
            power_ = 0;
            return;
        }
        if (under_ != 1) {
            const Integer common = gcd(Integer(over_ % under_), under_);  // Boost 1.74 counts down from the larger to the smaller
            over_ /= common;
            under_ /= common;
        }
        if (const unsigned zeros = lsb(abs(over_)); zeros != 0) {
            over_ = over_.sign() < 0 ? Integer(-(abs(over_) >> zeros)) : Integer(over_ >> zeros);
            power_ += static_cast<int>(zeros);
        }
    }
    static int bits(const Integer& x) { return static_cast<int>(msb(abs(x))); }
    static Integer product(const Integer& a, const Integer& b) { return a == 1 ? b : b == 1 ? a : Integer(a * b); }
    /// @return what is above the line of a + b, or a - b, and the power of two it is counted in.
    static std::pair<Integer, int> difference(const Rational& a, const Rational& b, bool minus) {
        const int power = std::min(a.power_, b.power_);
        Integer x = a.over_ << static_cast<unsigned>(a.power_ - power), y = b.over_ << static_cast<unsigned>(b.power_ - power);
        if (a.under_ != b.under_) {
            x *= b.under_;
            y *= a.under_;
        }
        return {minus ? x - y : x + y, power};
    }
    static Rational sum(const Rational& a, const Rational& b, bool minus) {
        if (b.over_.is_zero()) return a;
        if (a.over_.is_zero()) return minus ? -b : b;
        auto [over, power] = difference(a, b, minus);
        return Rational(std::move(over), a.under_ == b.under_ ? a.under_ : product(a.under_, b.under_), power);
    }

    Integer over_ = 0, under_ = 1;  ///< without a common divisor, both odd, or 0 / 1
    int power_ = 0;
};

inline Rational::operator double() const {
    if (over_.is_zero()) return 0.0;
    // 64 bits of the quotient, or as many as there are.
    Integer whole = abs(over_);
    int shift = 0;
    if (under_ == 1) {
        if (shift = bits(whole) - 63; shift > 0) whole >>= static_cast<unsigned>(shift);
    } else if (shift = bits(whole) - bits(under_) - 63; shift > 0) {
        whole /= Integer(under_ << static_cast<unsigned>(shift));
    } else {
        whole = Integer(whole << static_cast<unsigned>(-shift)) / under_;
    }
    const int power = under_ == 1 ? std::max(shift, 0) + power_ : shift + power_;
    const double x = std::ldexp(static_cast<double>(static_cast<std::uint64_t>(whole)), power);
    return over_.sign() < 0 ? -x : x;
}

}  // namespace carom::exact
