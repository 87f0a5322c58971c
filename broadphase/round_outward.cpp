#include <carom/broadphase/proxy.hpp>

#include <bit>
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

}  // namespace

FloatAabb round_outward(const Aabb& box, const dvec3& origin) noexcept {
    FloatAabb result;
    for (int axis = 0; axis < 3; ++axis) {
        result.lower[axis] = difference_below(box.lower[axis], origin[axis]);
        result.upper[axis] = difference_above(box.upper[axis], origin[axis]);
    }
    return result;
}

}  // namespace carom
