// Bicubic Bézier patches: evaluation, normals, and triangles within a stated distance of the surface.
//
//   Result<MeshData> mesh = tessellate(teapot_patches(), {.chord_error = 0.001});
//   SurfacePoint p = evaluate(patch, 0.5, 0.5);        // p.position, p.normal
#pragma once

#include <carom/collision/mesh_data.hpp>
#include <carom/core/result.hpp>
#include <carom/core/types.hpp>

#include <array>
#include <span>

namespace carom {

/// S(u, v) = sum over i, j of B_i(v) B_j(u) points[4 i + j], with u, v in [0, 1]: u runs along a row of four points, v from
/// row to row. The outer side is the one from which u and v turn counter-clockwise.
struct BezierPatch {
    std::array<dvec3, 16> points{};
};

/// A point of the surface with its first derivatives.
struct SurfacePoint {
    dvec3 position{0.0};
    dvec3 along_u{0.0};  ///< dS/du
    dvec3 along_v{0.0};  ///< dS/dv
    dvec3 normal{0.0};   ///< unit, outward; zero where a patch that is only a curve or a point has none
};

/// Evaluates by de Casteljau's algorithm.
///
/// Where the cross product of the derivatives vanishes (poles: an edge drawn together to a point, or two edges that meet in a
/// line), the normal is its limit along the straight way in (u, v) towards the farther corner of the patch: the first
/// coefficient of the Taylor series of the cross product that is not zero.
///
/// @param patch  finite points [m].
/// @param u, v   in [0, 1]. Misuse: NotFinite or InvalidArgument is reported, and a default SurfacePoint returned.
/// Accuracy: position within a few ulp of the largest coordinate; corners and collapsed edges are exact.
[[nodiscard]] SurfacePoint evaluate(const BezierPatch& patch, double u, double v);

struct TessellationSettings {
    double chord_error = 1e-3;  ///< > 0 [m]: no point of the surface is farther from the triangles, nor the other way round
};

/// Triangles of a set of patches, counter-clockwise seen from outside, with shared vertices.
///
/// A triangle whose corners lie on S over a box of w x h in (u, v) is within (w^2 Muu + 2 w h Muv + h^2 Mvv) / 8 of S, with M
/// the largest second derivatives (Filip, Magedson, Markot 1986, Surface algorithms using bounds on derivatives, sec. 3; for
/// any triangle in the box, because the variance of a number spread over a width w is at most w^2 / 4). Second and mixed
/// differences of the control points bound the M. Each edge of a patch is divided by the same rule from its own four points
/// alone and evaluated from a fixed end, so two patches that share an edge (the same four points, in either direction) get the
/// same vertices, bit by bit: no cracks, whatever the interiors need. Where an edge is coarser than the interior, a strip
/// just so thin that the bound still holds is sewn in between. Triangles that a pole makes degenerate are left out.
///
/// @param patches  finite points [m]; an error names the patch.
/// @return NotFinite, InvalidArgument (chord_error not positive and finite, or so small that a side of a patch would need more
///         than 4096 divisions or the whole more than 2^27 triangles) or Empty (no patch; every patch is a curve or a point).
/// Accuracy: the bound above, and then each vertex is rounded to float. Cost: O(area / chord_error).
[[nodiscard]] Result<MeshData> tessellate(std::span<const BezierPatch> patches, const TessellationSettings& settings = {});

}  // namespace carom
