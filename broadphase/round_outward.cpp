#include <carom/broadphase/proxy.hpp>

#include <cmath>
#include <limits>

namespace carom {
namespace {

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
    return rounded > s || (rounded == s && error < 0.0) ? std::nextafter(nearest, -kInfinity) : nearest;
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
