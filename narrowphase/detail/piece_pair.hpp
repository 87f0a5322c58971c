// Two convex pieces, or one and a half-space: their distance, and the axis along which they are farthest apart.
//
//   PieceFinding found = compare(a, b, {normal_of_contact});
//   if (found.verdict == PairVerdict::Apart) ...
#pragma once

#include <carom/narrowphase/detail/convex_piece.hpp>
#include <carom/narrowphase/explain.hpp>

#include <optional>
#include <span>

namespace carom::detail {

struct PieceFinding {
    DistanceBounds distance;
    SeparatingAxis axis;
    PairVerdict verdict = PairVerdict::Undecided;
};

/// @param contact_normals  directions, unit, from a to b, that may be the axis where the pieces overlap and no search of its own finds one.
[[nodiscard]] PieceFinding compare(const ConvexPiece& a, const ConvexPiece& b, std::span<const dvec3> contact_normals);

/// A half-space dot(normal, x) <= offset.
struct HalfSpace {
    dvec3 normal{0.0, 1.0, 0.0};
    double offset = 0.0;
};

[[nodiscard]] PieceFinding compare(const ConvexPiece& a, const HalfSpace& b);

/// The same seen from b.
[[nodiscard]] PieceFinding swapped(PieceFinding found);

/// @return what the two share where flat faces look at each other along `normal`; nothing where an edge or a corner does.
[[nodiscard]] std::optional<FacePatch> common_patch(const ConvexPiece& a, const ConvexPiece& b, const dvec3& normal, double height);

}  // namespace carom::detail
