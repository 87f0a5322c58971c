// Directions and rotations spread evenly.
//
//   const Pose pose{random_direction(random) * 3.0, random_rotation(random)};
#pragma once

#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/core/types.hpp>

#include <cmath>

namespace carom::test {

inline dvec3 random_direction(Random& random) {
    for (;;) {
        const double x = random.range(-1, 1), y = random.range(-1, 1), z = random.range(-1, 1);
        const double length = std::sqrt(x * x + y * y + z * z);
        if (length > 0.1 && length <= 1.0) return dvec3{x, y, z} / length;
    }
}

/// About an even direction by an even angle.
inline dquat random_rotation(Random& random) {
    const dvec3 axis = random_direction(random);
    const double angle = random.range(0.0, 2.0 * kPi);
    const double s = std::sin(0.5 * angle);
    return {std::cos(0.5 * angle), s * axis.x, s * axis.y, s * axis.z};
}

}  // namespace carom::test
