// Where a picture is taken from.
//
//   Camera camera = automatic_camera(frame, 1.6);     // from above at an angle, everything that moves in view
#pragma once

#include <carom/core/types.hpp>
#include <carom/viz/debug_frame.hpp>

namespace carom {

/// A perspective camera; positions in the world, not relative to a frame's origin [m].
struct Camera {
    dvec3 position{0.0, 5.0, 10.0};
    dvec3 target{0.0};
    dvec3 up{0.0, 1.0, 0.0};       ///< not along the view
    double field_of_view = 0.5;    ///< vertical, full angle [rad], in (0, 3)
};

/// @return NotFinite or InvalidArgument: a component that is not finite, position = target, `up` along the view, an angle out of range.
[[nodiscard]] Status validate(const Camera& camera);

/// From which side automatic_camera looks.
struct CameraAngle {
    double azimuth = 0.6;          ///< about frame.up, from the side that faces z (or x where up is z) [rad]
    double elevation = 0.75;       ///< above the horizon, in (-1.5, 1.5) [rad]
    double field_of_view = 0.5;    ///< [rad], in (0, 3)
    double margin = 0.08;          ///< of the picture left free on each side, in [0, 0.4]
};

/// Frames the layer "shapes" (what moves) and those of sweeps; where these are empty, whatever the frame has. Outliers (farther from the middle
/// than three times what nine tenths of the points are) are left out of view.
/// @param aspect  width over height > 0.
/// @return a camera that sees all but the outliers; the default camera for an empty frame.
/// Misuse (an angle out of range, aspect <= 0) is reported; then the default camera.
/// Cost: linear in the frame's points.
[[nodiscard]] Camera automatic_camera(const DebugFrame& frame, double aspect, const CameraAngle& angle = {});

}  // namespace carom
