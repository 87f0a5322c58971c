// The pair kernels. Each takes its shapes in the order of its name; detail/kernel_table.cpp says which pair uses which.
#pragma once

#include <carom/narrowphase/detail/kernel.hpp>

namespace carom::detail {

CollideStatus sphere_sphere(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus sphere_box(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus sphere_capsule(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus sphere_plane(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus box_plane(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus capsule_capsule(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus capsule_plane(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus capsule_box(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus capsule_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus sphere_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus box_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus hull_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
/// The same where the second shape of the pair is a mesh that bounds a convex solid: the solid takes its place.
CollideStatus sphere_hull(const PairFrame& pair, const ConvexHull& second, Workspace& workspace, ManifoldSink& sink);
CollideStatus capsule_hull(const PairFrame& pair, const ConvexHull& second, Workspace& workspace, ManifoldSink& sink);
/// The same of meshes in both places.
CollideStatus hull_hull(const PairFrame& pair, const ConvexHull& first, const ConvexHull& second, Workspace& workspace, ManifoldSink& sink);
CollideStatus hull_plane(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus sphere_mesh(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus box_mesh(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus capsule_mesh(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus hull_mesh(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);

CollideStatus mesh_mesh(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus mesh_plane(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);

/// Many at once: the same bits as those for one pair, but for two boxes, which are worked on in float.
void sphere_sphere_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace, ManifoldList& out);
void sphere_capsule_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace, ManifoldList& out);
void sphere_box_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace, ManifoldList& out);
void sphere_plane_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace, ManifoldList& out);
void capsule_capsule_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace, ManifoldList& out);
void capsule_plane_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace, ManifoldList& out);
void box_plane_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace, ManifoldList& out);
void capsule_box_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace, ManifoldList& out);
void box_box(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace, ManifoldList& out);

/// The same for poses that nobody has looked at. @return whether they are known to be finite, all of them; otherwise they may be too. Pairs
/// of which one is not have no manifolds.
bool box_box_proving(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace, ManifoldList& out);

/// Two boxes by themselves, with the bits that they have among many.
void box_box_single(const ShapePair& pair, std::uint32_t index, Workspace& workspace, ManifoldList& out);

/// The polytopes that the workspace holds.
CollideStatus touch_polytopes(const Asked& asked, Workspace& workspace, ManifoldSink& sink);

/// Two boxes as polytopes in double: where they are not many, as parts of compounds are not.
CollideStatus box_box_alone(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);

// "turned" is a cylinder or a cone.
CollideStatus turned_sphere(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus turned_box(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus turned_capsule(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus turned_plane(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus turned_hull(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus turned_hull(const PairFrame& pair, const ConvexHull& second, Workspace& workspace, ManifoldSink& sink);
CollideStatus turned_mesh(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus turned_turned(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);

// Of what touches a compound, each part has manifolds of its own.
CollideStatus compound_any(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
CollideStatus compound_plane(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);

}  // namespace carom::detail
