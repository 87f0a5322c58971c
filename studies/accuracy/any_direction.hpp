// Directions for cases, from a seeded stream.
#pragma once

#include <carom/core/random.hpp>
#include <carom/core/types.hpp>

#include <glm/geometric.hpp>

namespace carom::accuracy {

/// @return a unit vector, all directions alike.
inline dvec3 any_direction(Random& random) {
    for (;;) {
        const dvec3 v{random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0)};
        const double length = glm::length(v);
        if (length > 0.1 && length <= 1.0) return v / length;
    }
}

}  // namespace carom::accuracy
