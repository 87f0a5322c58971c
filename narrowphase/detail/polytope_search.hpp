// Which face, or which pair of edges, of two polytopes separates them best.
//
//   const Separations best = find_separations(a, b, a.centre, b.centre, margin);
//
// Kept simple where it is exact: `tests/narrowphase/polytope_search_test.cpp` holds it against all faces and all pairs of edges.
#pragma once

#include <carom/narrowphase/detail/polytope.hpp>

#include <cstdint>
#include <limits>

namespace carom::detail {

/// A plane that separates, and how far.
struct FaceSeparation {
    double separation = -std::numeric_limits<double>::infinity();
    std::uint32_t plane = 0;
    std::uint32_t deepest = 0;  ///< vertex of the other polytope farthest below it
};

/// A pair of edges that separates.
struct EdgePair {
    double separation = -std::numeric_limits<double>::infinity();
    dvec3 normal{0.0};  ///< unit, from a to b
    std::uint32_t a = 0;
    std::uint32_t b = 0;
};

struct Separations {
    FaceSeparation of_a;
    FaceSeparation of_b;  ///< where no face of b does better than those of a, a's separation
    EdgePair edges;
    /// Of a triangle as b no side separates by more: some point of a that was met is no higher over any of them.
    double side_promise = std::numeric_limits<double>::infinity();
};

/// For each polytope the face that has the other one's deepest vertex highest over it, and the pair of edges that separates best among those
/// whose arcs on the Gauss map cross (Gregorius, The Separating Axis Test between Convex Polyhedra, GDC 2013) and that may do better than the
/// faces. Edges nearly parallel by kParallelSine make no axis.
///
/// Any point of the other polytope bounds each face from above, so faces are tried in the order of what they promise, each vertex that is met
/// lowers the promises, and few are left to be tried. The same points bound the edges: on the arc between the normals of two faces, no normal
/// separates from a point by more than the better of the two does, where both are below zero. Each face has been ruled out by some point
/// that was met, so few arcs are left.
/// @param point_of_a, point_of_b  any points of the two; the nearer to the contact, the fewer faces are tried.
/// @param enough  where a face separates by more, nothing more is looked for.
/// Against a triangle as `b` all faces meet its three corners at once, and the points are not needed.
/// Cost: of two hulls of 32 vertices some seven faces are tried and five edges left.
[[nodiscard]] Separations find_separations(const Polytope& a, const Polytope& b, const dvec3& point_of_a, const dvec3& point_of_b,
                                           double enough);

/// The best of the sides of a triangle against `other`, if it does better than `floor`.
[[nodiscard]] FaceSeparation best_side(const Polytope& triangle, const Polytope& other, double floor);

}  // namespace carom::detail
