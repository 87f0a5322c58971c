// The Utah teapot: Martin Newell's 32 Bézier patches (1975), and triangles of it.
//
//   Result<MeshData> pot = teapot(0.3, 0.001);                         // 30 cm from handle to spout
//   Result<TriangleMeshPtr> mesh = TriangleMesh::build(pot->vertices, pot->triangles);
#pragma once

#include <carom/collision/bezier.hpp>

#include <array>
#include <cstdint>
#include <span>

namespace carom {

inline constexpr std::size_t kTeapotPointCount = 306;
inline constexpr std::size_t kTeapotPatchCount = 32;

/// The control points as Newell's data set gives them: z up, in its own unit, x from the handle at -3 to the spout.
[[nodiscard]] std::span<const dvec3, kTeapotPointCount> teapot_points() noexcept;

/// Sixteen indices into teapot_points() per patch. In order: rim 0-3, body 4-11, handle 12-15, spout 16-19, lid 20-27,
/// bottom 28-31. Four points (204, 205, 215, 222) belong to no patch: the lid's top is drawn together to point 203.
[[nodiscard]] std::span<const std::array<std::uint16_t, 16>, kTeapotPatchCount> teapot_indices() noexcept;

/// The patches in the unit and frame of the data, outer sides out.
[[nodiscard]] std::span<const BezierPatch, kTeapotPatchCount> teapot_patches();

/// Triangles of the whole teapot: y up, the spout towards +x, the lowest point of the base at y = 0 on the y axis.
///
/// The classic teapot is no closed solid. Open edges are the inner ring of the rim (the lid, 0.1 units narrower, does not touch
/// it), the outer ring of the lid, both ends of the handle, the root of the spout inside the body, and the mouth of the spout;
/// handle and spout pass through the body without sharing edges with it. A dynamic body of it has the mass of its hull.
///
/// @param size         the extent in x from handle to spout [m], > 0 and finite.
/// @param chord_error  as of tessellate [m].
/// @return InvalidArgument or NotFinite for a bad size; otherwise as tessellate.
[[nodiscard]] Result<MeshData> teapot(double size, double chord_error);

}  // namespace carom
