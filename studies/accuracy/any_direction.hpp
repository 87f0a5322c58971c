// Directions and rotations for cases, from a seeded stream.
#pragma once

#include <carom/core/random.hpp>
#include <carom/core/types.hpp>

#include <glm/geometric.hpp>

#include <cmath>

namespace carom::accuracy {

/// @return a unit vector, all directions alike.
inline dvec3 any_direction(Random& random) {
    for (;;) {
        const dvec3 v{random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0)};
        const double length = glm::length(v);
        if (length > 0.1 && length <= 1.0) return v / length;
    }
}

/// @return a rotation, all alike: a point of the unit sphere in four dimensions.
inline dquat any_rotation(Random& random) {
    for (;;) {
        const double w = random.range(-1.0, 1.0), x = random.range(-1.0, 1.0), y = random.range(-1.0, 1.0), z = random.range(-1.0, 1.0);
        const double length = std::sqrt(w * w + x * x + y * y + z * z);
        if (length > 0.1 && length <= 1.0) return {w / length, x / length, y / length, z / length};
    }
}

}  // namespace carom::accuracy
