// How one Bézier patch is divided into triangles: the lines of its inside and the points of its four edges.
//
//   std::optional<PatchGrid> grid = plan_grid(patch, 1e-3);
//   append(mesh, patch, *grid);
#pragma once

#include <carom/collision/bezier.hpp>

#include <array>
#include <optional>
#include <vector>

namespace carom::detail {

/// The most parts into which a side of a patch is divided.
inline constexpr int kMaxDivisions = 4096;

/// The edges in the order of a walk round the patch, counter-clockwise: v = 0 (u rising), u = 1 (v rising), v = 1 (u falling),
/// u = 0 (v falling).
struct PatchGrid {
    std::vector<double> u, v;     ///< the parameters of the grid lines, rising; with 0 and 1 if `whole`, without if not
    std::array<int, 4> edge{};    ///< parts of each edge
    bool whole = false;           ///< every edge has the division of the inside: one grid, nothing to sew
};

/// @return the parts into which an edge of these four points is divided, from the edge alone; more than kMaxDivisions means that
/// it would need too many.
[[nodiscard]] int edge_divisions(const std::array<dvec3, 4>& edge, double chord_error);

/// @param patch  finite points. @param chord_error  > 0.
/// @return the division, or nothing if a side would need more than kMaxDivisions parts.
[[nodiscard]] std::optional<PatchGrid> plan_grid(const BezierPatch& patch, double chord_error);

/// Adds the triangles of the patch, with vertices of their own (weld joins those of neighbours).
void append(MeshData& mesh, const BezierPatch& patch, const PatchGrid& grid);

}  // namespace carom::detail
