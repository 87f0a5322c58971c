// A world as debug geometry, through its const interface alone.
//
//   DebugFrame frame = make_debug_frame(world, {.color_by = ColorBy::ShapeType});
//   frame.caption = "pile_boxes, step 600";
#pragma once

#include <carom/dynamics/world.hpp>
#include <carom/viz/debug_frame.hpp>
#include <carom/viz/layer.hpp>

#include <string>

namespace carom {

/// What the colour of a body that moves says.
enum class ColorBy : unsigned char { Body, ShapeType };

struct DebugFrameSettings {
    unsigned layers = kAllLayers;    ///< layers to fill; the others are there and empty
    dvec3 origin{0.0};               ///< DebugFrame::origin; give the scene's middle where it is far from the world's [m]
    ColorBy color_by = ColorBy::Body;
    int segments = 20;               ///< round spheres and capsules: a multiple of 4, 4..256
    int bvh_depth = 6;               ///< deepest level of the layer "bvh" (the root is 0), >= 0
    double line_length = 0.0;        ///< of a normal and of the largest impulse [m]; 0: a thirtieth of the moving bodies' radius
    double plane_half_size = 0.0;    ///< half the side of a plane's patch [m]; 0: one and a half times the scene's radius
};

/// Builds the frame of a world as it stands, with the contacts of its last step. `up` is against gravity (y without gravity).
/// A quarantined body is drawn at its last valid pose, in dark red.
/// Misuse (non-finite origin, a negative or non-finite length, segments out of range, negative depth) is reported; then an
/// empty frame.
/// Cost: linear in bodies, their vertices and contacts. Deterministic.
[[nodiscard]] DebugFrame make_debug_frame(const World& world, const DebugFrameSettings& settings = {});

/// @return what a viewer prints of a picked body: id, name, type, shapes, pose and velocities, one line each. Says so of a dead id.
[[nodiscard]] std::string describe_body(const World& world, BodyId body);

}  // namespace carom
