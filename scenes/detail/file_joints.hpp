// The joints of a scene file.
#pragma once

#include <carom/dynamics/world.hpp>
#include <carom/scenes/detail/json_fields.hpp>

namespace carom::scenes::detail {

/// Reads one element of "joints" between bodies of `world`, which has those of the file in their order; throws SceneFileError where it is not fit for them.
[[nodiscard]] JointDef read_joint(const Node& node, const World& world);

}  // namespace carom::scenes::detail
