// The direction in which two polytopes touch.
//
//   const GjkResult distance = gjk(a.vertices, b.vertices, margin);
//   ContactAxis axis;
//   if (distance.beyond || !find_axis(a, b, distance, margin, workspace.edges, axis)) return;
#pragma once

#include <carom/narrowphase/detail/gjk.hpp>
#include <carom/narrowphase/detail/polytope.hpp>

#include <vector>

namespace carom::detail {

enum class AxisKind : unsigned char { Distance, FaceOfA, FaceOfB, Edges };

struct ContactAxis {
    AxisKind kind = AxisKind::Distance;
    dvec3 normal{0.0};        ///< unit, from a to b
    double separation = 0.0;  ///< along the normal [m]
    dvec3 on_a{0.0};          ///< where the two are closest or deepest; not for faces
    dvec3 on_b{0.0};
    std::uint32_t feature_a = 0;  ///< face, or name of the edge
    std::uint32_t feature_b = 0;
};

/// Lists of edges that may decide, and what tells them apart, kept to save allocations.
struct EdgeLists {
    std::vector<Polytope::Edge> of_a, of_b;
    std::vector<unsigned char> above;
};

/// The greatest separation over the faces of both polytopes and the pairs of their edges whose arcs on the Gauss map cross (Gregorius,
/// The Separating Axis Test between Convex Polyhedra, GDC 2013); where they overlap, the least depth.
///
/// What cannot win is left out: no normal between those of two faces separates a from a point of b by more than the better of the
/// two does, so an edge both of whose faces stay below the best face for one point of b is not looked at. The points are the given ones and
/// the vertices deepest under the best faces. A face wins over edges within
/// kFacePreference of the size.
/// @param point_of_a, point_of_b  any points of the two; the nearer to the contact, the more is left out.
/// Accuracy: 1e-6 of the larger size. Cost: O(F_a V_b + F_b V_a + E_a E_b) at worst.
[[nodiscard]] ContactAxis greatest_separation(const Polytope& a, const Polytope& b, const dvec3& point_of_a, const dvec3& point_of_b,
                                              EdgeLists& lists);

/// The axis of contact of two polytopes: where they are apart, the direction of their distance; otherwise that of their least depth.
/// @param distance  gjk() of the vertices of a and b, with `margin` as the cutoff, and not beyond it. Where it stopped at its cap, the
///                  separating axes decide alone.
/// @return false where the two are farther apart than `margin`.
bool find_axis(const Polytope& a, const Polytope& b, const GjkResult& distance, double margin, EdgeLists& lists, ContactAxis& axis);

}  // namespace carom::detail
