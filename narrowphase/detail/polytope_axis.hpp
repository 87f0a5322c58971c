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

/// Lists of edges that may touch, kept to save allocations.
struct EdgeLists {
    std::vector<std::uint32_t> of_a, of_b;
};

/// Finds the axis of contact of two polytopes in one frame.
///
/// Apart: GJK gives the distance and its direction. Touching or overlapping: the axis of least depth over the faces of both and
/// the pairs of edges whose arcs on the Gauss map cross (Gregorius, The Separating Axis Test between Convex Polyhedra, GDC 2013).
/// At the least depth d the closest points of the two edges are d apart, so only edges within the least face depth of the
/// other's bounds are looked at. A face wins over edges within kFacePreference of the size.
/// @return false where the two are farther apart than `margin`.
/// Accuracy: 1e-6 of the larger size. Total: where GJK stops at its cap, all axes are looked at instead.
/// Cost: O(F_a V_b + F_b V_a + E_a E_b), and about 6 (V_a + V_b) for polytopes that are apart.
/// @param distance  gjk() of the vertices of a and b, with `margin` as the cutoff and not beyond it.
bool find_axis(const Polytope& a, const Polytope& b, const GjkResult& distance, double margin, EdgeLists& lists, ContactAxis& axis);

/// The axis of least depth alone, for polytopes that overlap; where they are apart, the greatest separation over the axes within reach.
[[nodiscard]] ContactAxis least_depth_axis(const Polytope& a, const Polytope& b, double reach, EdgeLists& lists);

}  // namespace carom::detail
