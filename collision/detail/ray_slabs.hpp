// A ray against boxes, conservatively: what a triangle's test can accept, the box's test never rejects.
//
//   RaySlabs slabs(origin, direction, largest_coordinate);
//   double t = slabs.enter(lower, upper);      // kMiss on a miss
#pragma once

#include <carom/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom {

/// A ray prepared for the slab test (Kay and Kajiya 1986), in double against float boxes.
///
/// Boxes are widened by `pad` = 2^-45 (D + |o|) on every side, D the largest coordinate of any box and |o| that of the origin.
/// The rounding of this test, and of a triangle's test in double, moves a point by at most some tens of ulp of D + |o|, which is
/// 2^-53 (D + |o|) each; so a ray that the triangle's test lets hit at distance t enters the triangle's box at or before t.
class RaySlabs {
public:
    static constexpr double kMiss = std::numeric_limits<double>::infinity();

    /// @param direction  unit length; components may be ±0.
    RaySlabs(const dvec3& origin, const dvec3& direction, double largest_coordinate) noexcept {
        const double reach =
            largest_coordinate + std::max({std::abs(origin.x), std::abs(origin.y), std::abs(origin.z)});
        const double pad = 0x1p-45 * reach;
        for (int k = 0; k < 3; ++k) {
            // A ray whose component is below this drifts by less than the pad over any distance that matters, so that it may
            // count as slanted by this little: 0 * infinity never arises.
            const double d = std::abs(direction[k]) < 0x1p-60 ? std::copysign(0x1p-60, direction[k]) : direction[k];
            inverse_[k] = 1.0 / d;
            const double side = d < 0.0 ? -pad : pad;
            near_[k] = -(origin[k] + side) * inverse_[k];
            far_[k] = -(origin[k] - side) * inverse_[k];
            backward_[k] = d < 0.0;
        }
    }

    /// @return a lower bound of the distance at which the ray enters the box, 0 from inside; kMiss where it misses.
    [[nodiscard]] double enter(const vec3& lower, const vec3& upper) const noexcept {
        double t_near = 0.0;
        double t_far = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 3; ++k) {
            const double first = backward_[k] ? static_cast<double>(upper[k]) : static_cast<double>(lower[k]);
            const double last = backward_[k] ? static_cast<double>(lower[k]) : static_cast<double>(upper[k]);
            t_near = std::max(t_near, first * inverse_[k] + near_[k]);
            t_far = std::min(t_far, last * inverse_[k] + far_[k]);
        }
        return t_near <= t_far ? t_near : kMiss;
    }

private:
    dvec3 inverse_{0.0};
    dvec3 near_{0.0};
    dvec3 far_{0.0};
    bool backward_[3] = {false, false, false};
};

}  // namespace carom
