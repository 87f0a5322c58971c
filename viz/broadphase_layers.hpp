// What a broadphase keeps, as layers of a debug frame: its boxes, and the cells, axes or tree of its method.
//
//   DebugFrame frame = make_debug_frame(world);
//   append_broadphase_layers(frame, world);
#pragma once

#include <carom/broadphase/broadphase.hpp>
#include <carom/dynamics/world.hpp>
#include <carom/viz/debug_frame.hpp>

namespace carom {

inline constexpr const char* kBroadphaseBounds = "broadphase-bounds";
inline constexpr const char* kBroadphaseCells = "broadphase-cells";
inline constexpr const char* kBroadphaseAxes = "broadphase-axes";
inline constexpr const char* kBroadphaseTree = "broadphase-tree";

/// Appends the layer of bounds and, where the method in use has any, those of cells, axes and tree nodes; none where no box is alive.
/// The frame holds no layer of these names yet.
/// @param origin  what the boxes are relative to, in the world [m].
/// @param depth  deepest level of the tree that is drawn (the root is 0), >= 0.
/// Misuse (a negative depth, an origin that is not finite) is reported; then nothing is appended. Cost: linear in boxes and parts.
void append_broadphase_layers(DebugFrame& frame, const Broadphase& broadphase, const dvec3& origin, int depth = 8);

/// The same of a world after its last step.
void append_broadphase_layers(DebugFrame& frame, const World& world);

}  // namespace carom
