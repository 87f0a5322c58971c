// The difference of two features whose corners move on straight lines: at each time a triangle or a parallelogram, and what proves over
// an interval of time that the origin is not near it.
//
//   const MovingDifference difference = ...;
//   TimeSpan proved = difference.separated_along(normal, separation);   // nothing within `separation` for from <= t <= to
//   Coplanarity coplanar(difference, separation);
//   t = coplanar.advance(t);
//
// Rounding, with u = 2^-53 and M the largest coordinate of any corner at either end:
//   corners     are differences of the input, each coordinate off by u of itself; |D| <= sqrt(3) M.
//   n . D       three products and two sums give 3 u (|n|.x |D|.x + ...), the corner u of the same more: together 4 u of it. kAlong = 6 u,
//               which leaves room for the rounding of the bound itself. The bound is formed for each corner, so that directions along an axis
//               are as exact as the coordinates: features that lie in one plane but for an ulp are told apart.
//   triple      D0 . (D1 x D2): the cross product's entries err by 8 u M^2, the products with D0 by 24 u M^3, the sums by 18 u M^3, the
//   product     corner D0 by 6 u M^3; a third of the sum of three such by 18 u M^3 more: together below 66 u M^3. Splitting the
//               polynomial at t, by means of values below 6 M^3, adds three levels of 18 u M^3. kTriple = 128 u.
//   underflow   each product adds half a least denormal: kUnderflow is 64 of them.
#pragma once

#include <carom/core/types.hpp>

#include <array>
#include <limits>

namespace carom::detail {

/// Quotients of differences of differences, rounded towards the safe side: four roundings of u.
inline constexpr double kEarlier = 1.0 - 0x1p-50;
inline constexpr double kLater = 1.0 + 0x1p-50;
/// And where such a quotient is so small that its rounding is no longer relative.
inline constexpr double kLeastTime = std::numeric_limits<double>::min();
inline constexpr double kAlong = 6.0 * 0x1p-53;
inline constexpr double kTriple = 128.0 * 0x1p-53;
inline constexpr double kUnderflow = 64.0 * std::numeric_limits<double>::denorm_min();
/// After the end of the motion.
inline constexpr double kNever = 2.0;

/// The closed interval from..to of times; empty where to < from.
struct TimeSpan {
    double from = 1.0;
    double to = 0.0;
};

struct MovingDifference {
    std::array<dvec3, 4> start{dvec3{0.0}, dvec3{0.0}, dvec3{0.0}, dvec3{0.0}};
    std::array<dvec3, 4> end{dvec3{0.0}, dvec3{0.0}, dvec3{0.0}, dvec3{0.0}};
    int count = 3;      ///< 3: a triangle. 4: the parallelogram 0, 1, 3, 2
    double size = 0.0;  ///< M of the above

    [[nodiscard]] dvec3 corner(int i, double t) const noexcept {
        const auto k = static_cast<std::size_t>(i);
        return (1.0 - t) * start[k] + t * end[k];
    }
    /// @return the times at which all corners are proved to lie farther than `separation` beyond the plane through the origin with the
    /// unit normal `n`; `to` is kNever where that lasts to the end.
    [[nodiscard]] TimeSpan separated_along(const dvec3& n, double separation) const noexcept;
    /// @return whether an axis separates over the whole motion.
    [[nodiscard]] bool separated_by_axis(double separation) const noexcept;
};

/// The triple product of three corners as a cubic in t: zero whenever the origin lies in the corners' plane.
class Coplanarity {
public:
    Coplanarity(const MovingDifference& difference, double separation) noexcept;
    /// @return a time >= t up to which the origin is proved to be farther than `separation` from the corners' plane; t where nothing is.
    [[nodiscard]] double advance(double t) const noexcept;

private:
    std::array<double, 4> value_{};  ///< Bernstein coefficients over [0, 1]
    double least_ = 0.0;             ///< what the product's magnitude has to exceed
};

/// The point of a triangle or parallelogram that is nearest to the origin, and the way to it: a guess that nothing relies on.
struct NearestCorner {
    dvec3 normal{0.0};      ///< towards the nearest point, unit; zero where nothing can be said
    double distance = 0.0;
    double u = 0.0;         ///< of parallelograms: the share of the way along their first side, corner 0 to corner 2
};
[[nodiscard]] NearestCorner nearest_of(const MovingDifference& difference, double t) noexcept;

}  // namespace carom::detail
