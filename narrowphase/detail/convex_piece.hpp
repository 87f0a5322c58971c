// One convex piece of a shape for explanations: a whole convex shape, a part of a compound or a triangle of a mesh, with everything that is
// asked of it on the way. Made for one pair; the pair kernels have leaner ones.
//
//   ConvexPiece box = make_piece(shape, axes, origin);
//   double gap = -b.reach(-normal) - a.reach(normal);
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/narrowphase/detail/polytope.hpp>
#include <carom/narrowphase/detail/truncated_cone.hpp>
#include <carom/narrowphase/explain.hpp>

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace carom::detail {

/// What supports a piece along a direction.
struct PieceSupport {
    SupportFeature feature;
    dvec3 middle{0.0};        ///< of the feature; of a round one the point
    std::array<dvec3, 2> ends{};  ///< of an edge
};

/// A core and a radius round it. The core is a truncated cone, or the hull of points, which are those of a polytope where it is flat.
struct ConvexPiece {
    std::vector<dvec3> points;              ///< of the core; none of a truncated cone
    std::shared_ptr<const Polytope> polytope;  ///< of boxes, hulls and triangles with an area; otherwise null
    std::optional<TruncatedCone> turned;
    double radius = 0.0;
    Aabb box;

    [[nodiscard]] double size() const noexcept;
    /// @return the point that tells on which side of a mesh it is.
    [[nodiscard]] dvec3 centre() const noexcept;
    /// @return the largest dot product of `direction`, a unit vector, with a point.
    [[nodiscard]] double reach(const dvec3& direction) const noexcept;
    [[nodiscard]] PieceSupport support(const dvec3& direction) const noexcept;
    /// @return the corners of a face of its polytope, counter-clockwise seen from outside.
    [[nodiscard]] std::vector<dvec3> corners_of(std::uint32_t face) const;
};

/// @param shape  convex: no plane, mesh or compound. `axes` and `origin` place it.
[[nodiscard]] ConvexPiece make_piece(const Shape& shape, const dmat3& axes, const dvec3& origin);
[[nodiscard]] ConvexPiece make_triangle(const std::array<dvec3, 3>& corners);

}  // namespace carom::detail
