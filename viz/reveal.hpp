// Opens the static bodies that hide what moves from a camera: the near walls of a pit, say.
//
//   Camera camera = automatic_camera(frame, 1.6);
//   reveal(frame, camera);
//   render_to_png(frame, "picture.png", {.camera = camera});
#pragma once

#include <carom/viz/camera.hpp>
#include <carom/viz/debug_frame.hpp>

#include <cstddef>

namespace carom {

/// The share of the moving bodies' middles that a static body may hide and still be drawn whole.
inline constexpr double kMostHidden = 1.0 / 8.0;

/// Draws each body of the layer "static" that hides more than kMostHidden of the bodies in the layer "shapes" by its edges alone: its
/// triangles go, and lines come where it ends or bends by more than 30 degrees. A body is hidden where the line from the camera to the
/// middle of its box crosses a triangle that is drawn. Where more than 64 bodies move, 64 of them, evenly taken, stand for all.
/// @return how many bodies were opened. A camera that validate() refuses is misuse, and opens none.
/// Cost: triangles of the layer "static" times at most 64.
std::size_t reveal(DebugFrame& frame, const Camera& camera);

}  // namespace carom
