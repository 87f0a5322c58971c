// Two bodies and what joins or parts them, as a debug frame: the separating axis, the last simplex, the manifold and what it was cut from.
//
//   DebugFrame frame = make_contact_frame(world, world.explain(a, b));
#pragma once

#include <carom/dynamics/explain.hpp>
#include <carom/dynamics/world.hpp>
#include <carom/viz/debug_frame.hpp>

namespace carom {

inline constexpr const char* kWhyBounds = "why-bounds";
inline constexpr const char* kWhyAxis = "why-axis";
inline constexpr const char* kWhySimplex = "why-simplex";
inline constexpr const char* kWhyManifold = "why-manifold";
inline constexpr const char* kWhyPatch = "why-patch";
inline constexpr const char* kWhyNodes = "why-nodes";

/// Builds a frame of the deciding pair of shapes where the last step saw them, A blue and B orange, half transparent: in the layer "shapes"
/// where they move and in "static" where they do not. The origin is A's shape; the caption is the sentence.
/// Bounds: the boxes of the broadphase. Axis: the line between the two shapes' supports, and a square across it at either. Simplex: the
/// corners of GJK's last simplex, not shown at first where the cores overlap. Manifold: points with their normals, red where they touch. Patch: the outlines of the two
/// faces that a manifold was cut from, and of what they share. Nodes, of two meshes: the boxes of their hierarchies that were looked at together within the
/// step's margin, each once, as it lies in its mesh, leaves solid and the nodes above them faint; not shown at first. A layer that has nothing is
/// not there.
/// @return an empty frame for an explanation without shapes, and for shapes that are dead by now. Cost: linear in the shapes' vertices.
[[nodiscard]] DebugFrame make_contact_frame(const World& world, const ContactExplanation& why);

}  // namespace carom
