// What is done with all vertices, planes or edges of a polytope at once, in lanes.
//
//   const Extreme low = lowest(b, normal);                                   // a support point
//   const FaceSeparations faces = best_faces(a, b, point_of_a, point_of_b, margin); // the faces that separate best
//
// A double a lane, eight lanes to a bundle, the same bits at every width: what is compared are dot products that each lane computes as a
// scalar would, and of equal ones the lowest number counts.
#pragma once

#include <carom/narrowphase/detail/polytope.hpp>

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace carom::detail {

/// Moves points and planes: x goes to axes * x + origin.
void place_polytope(std::span<const PointBundle> points, std::span<const PlaneBundle> planes, const dmat3& axes, const dvec3& origin,
                    PointBundle* to_points, PlaneBundle* to_planes);

/// Which of many, and what it has there.
struct Extreme {
    double value = 0.0;
    std::uint32_t number = 0;
};

/// @return the vertex with the least dot product with `direction`, and the product.
[[nodiscard]] Extreme lowest(std::span<const PointBundle> points, const dvec3& direction) noexcept;
[[nodiscard]] inline Extreme lowest(const Polytope& p, const dvec3& direction) noexcept { return lowest(p.points, direction); }
/// @return the face whose normal has the greatest dot product with `direction`, and the product.
[[nodiscard]] Extreme face_along(const Polytope& p, const dvec3& direction) noexcept;

/// A plane that separates, and the vertex of the other polytope farthest below it.
struct FaceSeparation {
    double separation = -std::numeric_limits<double>::infinity();
    std::uint32_t plane = 0;
    std::uint32_t deepest = 0;
};

struct FaceSeparations {
    FaceSeparation of_a, of_b;
};

/// For each polytope the face that has the other one's deepest vertex highest over it. Any point of the other one bounds each face from
/// above, so faces are tried in the order of what they promise, each vertex that is met lowers the promises, and few are left to be tried.
/// Where a face separates by more than `enough`, nothing more is looked for.
/// @param point_of_a, point_of_b  any points of the two; the nearer to the contact, the fewer faces are tried.
/// b's faces count where they do better than a's; where none does, `of_b.separation` is a's, and `deepest` some vertex of a.
[[nodiscard]] FaceSeparations best_faces(const Polytope& a, const Polytope& b, const dvec3& point_of_a, const dvec3& point_of_b, double enough);

/// The same for the sides of a triangle against `other`, for what does better than `floor`.
[[nodiscard]] FaceSeparation best_side(const Polytope& triangle, const Polytope& other, double floor);

/// Numbers of edges.
struct EdgePair {
    double separation = -std::numeric_limits<double>::infinity();
    dvec3 normal{0.0};  ///< unit, from a to b
    std::uint32_t a = 0;
    std::uint32_t b = 0;
};

/// Of the pairs of edges whose arcs on the Gauss map cross (Gregorius, The Separating Axis Test between Convex Polyhedra, GDC 2013)
/// the one that separates best, among those of list_edges_above_both() for two points of the other polytope. Edges nearly parallel by
/// kParallelSine make no axis.
[[nodiscard]] EdgePair best_edges(const Polytope& a, const Polytope& b, const dvec3 (&points_of_a)[2], const dvec3 (&points_of_b)[2],
                                  double floor);

/// @return the face over whose plane the lower end of the segment is highest, and its height.
[[nodiscard]] Extreme highest_face(const Polytope& p, const dvec3& from, const dvec3& to) noexcept;

/// Lists the edges between whose planes a normal may separate by more than `floor`: from one of the two points, or from both. No normal
/// between those of two planes separates from a point by more than the better of the two does.
void list_edges_above_one(const Polytope& p, const dvec3 (&points)[2], double floor, std::vector<std::uint32_t>& numbers);
void list_edges_above_both(const Polytope& p, const dvec3 (&points)[2], double floor, std::vector<std::uint32_t>& numbers);

}  // namespace carom::detail
