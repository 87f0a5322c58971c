// Two meshes, for explanations: how far they are apart, between which triangles, or which contact leads out.
//
//   if (const auto gap = compare_meshes(a, b, manifolds)) { gap->finding.distance.lower; gap->triangle_a; }
#pragma once

#include <carom/collision/triangle_mesh.hpp>
#include <carom/narrowphase/detail/convex_piece.hpp>
#include <carom/narrowphase/detail/piece_pair.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace carom::detail {

/// In a frame that both share.
struct PlacedMesh {
    const TriangleMesh& mesh;
    dmat3 axes{1.0};
    dvec3 origin{0.0};

    [[nodiscard]] std::array<dvec3, 3> corners(std::uint32_t triangle) const;
};

struct MeshGap {
    PieceFinding finding;
    ConvexPiece a, b;  ///< the solids that they bound, where both do; otherwise the two triangles
    std::uint32_t triangle_a = 0, triangle_b = 0;
    bool of_solids = false;
};

/// @param manifolds  of the two, as collide() has them, about the frame's origin.
/// @return of meshes that both bound convex solids what compare() says of these. Of others that are apart the bounds of their distance, and the axis
/// between the two triangles that are nearest. Of others that meet, or that are inside of each other, the deepest contact, and the triangles
/// on which it lies. Nothing where they are farther apart than numbers go.
[[nodiscard]] std::optional<MeshGap> compare_meshes(const PlacedMesh& a, const PlacedMesh& b, std::span<const Manifold> manifolds);

}  // namespace carom::detail
