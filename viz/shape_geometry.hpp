// Shapes as triangles and boxes as lines, appended to a debug layer.
//
//   append_shape(layer, Box{{1, 1, 1}}, pose, {.color = palette(0), .body = id});
//   append_box_edges(layer, box, Pose{}, color, id);
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/pose.hpp>
#include <carom/viz/debug_frame.hpp>

namespace carom {

/// How a shape looks.
struct ShapeStyle {
    Color color{};
    Color second{};      ///< of every other patch of round shapes and planes, so that one sees them turn; see two_tone
    BodyId body{};
    int segments = 20;   ///< round a sphere, capsule, cylinder or cone: a multiple of 4, 4..256
};

/// @return the style with `second` a slightly darker tint of `color`.
[[nodiscard]] ShapeStyle two_tone(Color color, BodyId body, int segments = 20) noexcept;

/// Appends the surface of a bounded shape, with normals for shading.
/// Triangles: box 12; sphere segments (segments - 2); capsule segments² (without a cylinder: as a sphere); cylinder 4 segments - 4;
/// cone 2 segments - 2; hull the fan of each face; mesh its own triangles, smooth across edges flatter than 40 degrees; compound
/// those of its parts.
/// @param pose  relative to the frame's origin, finite.
/// Misuse (a plane, a null pointer, non-finite pose, segments out of range) is reported and appends nothing.
/// Accuracy: vertices lie on the exact surface, rounded to float; round shapes lose radius (1 - cos²(pi / segments)) at most.
void append_shape(DebugLayer& layer, const Shape& shape, const Pose& pose, const ShapeStyle& style);

/// The finite part of a plane that is drawn: a square of checkered tiles.
struct PlanePatch {
    dvec3 center{0.0};        ///< relative to the frame's origin; projected onto the plane [m]
    double half_size = 10.0;  ///< of the square [m] > 0
    int tiles = 16;           ///< along a side, 1..256; two triangles each
};

/// Appends a square patch of the plane.
/// Misuse (non-finite values, half_size <= 0, tiles out of range) is reported and appends nothing.
void append_plane(DebugLayer& layer, const Plane& plane, const Pose& pose, const PlanePatch& patch, const ShapeStyle& style);

/// Appends the 12 edges of a box that is given in the frame of `pose`. An empty or unbounded box appends nothing.
void append_box_edges(DebugLayer& layer, const Aabb& box, const Pose& pose, Color color, BodyId body);

}  // namespace carom
