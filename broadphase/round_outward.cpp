#include <carom/broadphase/proxy.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace carom {
namespace {

// The next float below a finite one.
float float_below(float x) noexcept {
    const auto bits = std::bit_cast<std::int32_t>(x);
    if (x == 0.0f) return -std::numeric_limits<float>::denorm_min();
    return std::bit_cast<float>(bits < 0 ? bits + 1 : bits - 1);  // sign and magnitude
}

// The largest float at most a - b in exact arithmetic.
float difference_below(double a, double b) noexcept {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    if (!is_finite(a)) return static_cast<float>(a);
    const double s = a - b;
    if (!is_finite(s)) return s > 0.0 ? std::numeric_limits<float>::max() : -kInfinity;
    const double t = s - a;
    const double error = (a - (s - t)) + (-b - t);  // a - b == s + error (Knuth 1969, vol. 2, 4.2.2, theorem B)
    const auto nearest = static_cast<float>(s);
    const auto rounded = static_cast<double>(nearest);
    if (!(rounded > s || (rounded == s && error < 0.0))) return nearest;
    return rounded > std::numeric_limits<double>::max() ? std::numeric_limits<float>::max() : float_below(nearest);
}

float difference_above(double a, double b) noexcept { return -difference_below(-a, -b); }

// Whether a - b < least in exact arithmetic, and so the largest float at most a - b is: a difference that rounds to something else is on the same side of it.
bool is_difference_below(double a, double b, float least) noexcept {
    const double s = a - b, bound{least};
    if (s != bound) return s < bound;
    const double t = s - a;
    return (a - (s - t)) + (-b - t) < 0.0;
}

}  // namespace

bool is_beyond(const Aabb& box, const dvec3& origin, const FloatAabb& known) noexcept {
    for (int axis = 0; axis < 3; ++axis) {
        if (is_difference_below(box.lower[axis], origin[axis], known.lower[axis])) return true;
        if (is_difference_below(-box.upper[axis], -origin[axis], -known.upper[axis])) return true;
    }
    return false;
}

FloatAabb box_about(const SweepPath& path) noexcept {
    constexpr double kRounding =
        0x1p-22;  // of the sum of what goes into a coordinate: that to float, and far more than all of walk and test
    constexpr double kHuge = 1e300, kLeast{std::numeric_limits<float>::min()}, kMost{std::numeric_limits<float>::max()};
    const auto rounded = [kMost](double x) { return static_cast<float>(std::clamp(x, -kMost, kMost)); };
    FloatAabb box;
    for (int k = 0; k < 3; ++k) {
        const double way = path.t_max * path.direction[k];
        if (!(std::abs(path.origin[k]) + std::abs(way) + path.grow[k] < kHuge)) {  // nothing is left of sums; and not a number
            box.lower[k] = static_cast<float>(-kMost), box.upper[k] = static_cast<float>(kMost);
            continue;
        }
        const double reach = path.grow[k] + (kRounding * (std::abs(path.origin[k]) + std::abs(way) + path.grow[k]) + kLeast);
        box.lower[k] = rounded((path.origin[k] + std::min(0.0, way)) - reach);
        box.upper[k] = rounded((path.origin[k] + std::max(0.0, way)) + reach);
    }
    return box;
}

FloatAabb round_outward(const Aabb& box, const dvec3& origin) noexcept {
    FloatAabb result;
    for (int axis = 0; axis < 3; ++axis) {
        result.lower[axis] = difference_below(box.lower[axis], origin[axis]);
        result.upper[axis] = difference_above(box.upper[axis], origin[axis]);
    }
    return result;
}

}  // namespace carom
