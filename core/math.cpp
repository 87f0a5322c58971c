#include <carom/core/math.hpp>

namespace carom {

dvec3 any_perpendicular(const dvec3& n) noexcept {
    const double sign = n.z < 0.0 ? -1.0 : 1.0;
    const double a = -1.0 / (sign + n.z);
    const double b = n.x * n.y * a;
    return {1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x};
}

}  // namespace carom
