// Seeded directions, rotations, boxes and hulls for the rows that compare pair by pair.
//
//   Random random(12);
//   const Shape box = box_of(random);
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/random.hpp>

namespace carom::bench {

/// Even over the sphere.
[[nodiscard]] dvec3 direction_of(Random& random);
/// Uniform: a point of the unit sphere in four dimensions.
[[nodiscard]] dquat rotation_of(Random& random);
/// Half extents r(.2, 1).
[[nodiscard]] Shape box_of(Random& random);
/// 32 points of the unit sphere scaled along each axis by r(.4, 1).
[[nodiscard]] Shape hull_of(Random& random);

}  // namespace carom::bench
