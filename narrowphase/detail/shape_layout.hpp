// How poses and boxes lie in memory, where lanes read them.
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/pose.hpp>

#include <cstddef>

namespace carom::detail {

static_assert(offsetof(Pose, position) == 0 && offsetof(Pose, orientation) == 24 && sizeof(Pose) == 56, "seven doubles: x y z, x y z w");
// Four floats are read where a box's three half extents lie.
static_assert(sizeof(Shape) >= 16 && sizeof(Box) == 12, "a Box is the first member of a Shape, which is longer than four floats");

}  // namespace carom::detail
