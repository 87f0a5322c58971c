// A picture of a debug frame, drawn off screen.
//
//   Status s = render_to_png(make_debug_frame(world), "picture.png");
//   if (!s) print(s.error().message);
#pragma once

#include <carom/core/result.hpp>
#include <carom/viz/camera.hpp>
#include <carom/viz/debug_frame.hpp>

#include <optional>
#include <string>

namespace carom {

struct PictureSettings {
    int width = 1600;                ///< [pixels], 16..8192
    int height = 1000;               ///< [pixels], 16..8192
    std::optional<Camera> camera{};  ///< none: automatic_camera(frame, width / height)
};

/// Draws the visible layers of `frame`, and its caption, into the PNG file `path`, which is replaced.
/// @return Io where there is no display (DISPLAY is not set, or no server answers: run under xvfb-run) or the file cannot be
/// written; what validate(frame) and validate(camera) say; InvalidArgument for a size out of range.
/// Cost: software OpenGL needs about a second for 10^6 triangles. One thread at a time in a process.
[[nodiscard]] Status render_to_png(const DebugFrame& frame, const std::string& path, const PictureSettings& settings = {});

}  // namespace carom
