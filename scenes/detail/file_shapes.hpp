// The shapes of a scene file.
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/dynamics/body.hpp>
#include <carom/scenes/detail/json_fields.hpp>

namespace carom::scenes::detail {

struct FileShape {
    Shape shape;
    ShapeDef def;
};

/// Reads one element of "shapes" for a body of the given type; throws SceneFileError where it is not fit for that body.
[[nodiscard]] FileShape read_shape(const Node& node, BodyType body);

}  // namespace carom::scenes::detail
