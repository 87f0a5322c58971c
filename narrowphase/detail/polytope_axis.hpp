// The direction in which two polytopes touch.
//
//   ContactAxis axis;
//   if (!find_axis(a, b, margin, axis)) return;
#pragma once

#include <carom/narrowphase/detail/polytope.hpp>
#include <carom/narrowphase/detail/triangle.hpp>

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

/// The size that tolerances of a pair are shares of: the larger one's, but of a shape much larger than the other not more than a few of the
/// other, above what doubles round of the larger one.
[[nodiscard]] inline double common_size(double a, double b) noexcept {
    const double larger = a > b ? a : b, smaller = a > b ? b : a;
    const double few = 8.0 * smaller + 1e-8 * larger;
    return few < larger ? few : larger;
}
/// Of a triangle only its being large counts: a mesh may be as fine as it likes.
[[nodiscard]] inline double common_size(const Polytope& a, const Polytope& b) noexcept {
    return b.side_count > 0 && b.size < a.size ? a.size : common_size(a.size, b.size);
}

/// The greatest separation over the faces of both polytopes and the pairs of their edges whose arcs on the Gauss map cross (Gregorius,
/// The Separating Axis Test between Convex Polyhedra, GDC 2013); where they overlap, the least depth. A face wins over edges within
/// kFacePreference of the size.
/// @param point_of_a, point_of_b  any points of the two; the nearer to the contact, the faster.
/// @param enough  a face that separates by more ends the search.
/// Accuracy: 1e-6 of the larger size. Cost: some three supports a polytope, and the pairs of the few edges that may win.
[[nodiscard]] ContactAxis greatest_separation(const Polytope& a, const Polytope& b, const dvec3& point_of_a, const dvec3& point_of_b,
                                              double enough);

/// Whether the face of a triangle that looks to the middle of `a` is the axis for certain: a's deepest corner lies over or under the inside of it. With s
/// its height over the face, p its foot and s > 0, the two points are s apart, and no axis separates by more. With s < 0, p at least |s| from all sides:
/// the triangle holds a disc of that radius about p, so along a normal n at an angle θ to the face's the two separate by at most -|s| (cos θ + sin θ), up
/// to a right angle; beyond it the same holds of the point of a above p's side of the face, on the way to its middle, at the height |s|, if its foot is as
/// far inside. No axis does better than s.
/// @return true with `axis`; false: nothing is known.
/// Cost: one support of a.
[[nodiscard]] bool face_decides(const Polytope& a, const Polytope& triangle, ContactAxis& axis) noexcept;

/// Whether the triangle is farther from `a` than `margin`, by a plane square to the way from a's middle to the triangle's nearest point, and by more than
/// find_axis() may be wrong: then that finds no axis. Of random triangles that are farther 87 % are found so.
/// Cost: one support of a.
[[nodiscard]] bool passes_by(const Polytope& a, const Corners& triangle, double margin) noexcept;

/// The same of a hull that `axes` and `origin` place, which need not have been loaded: by a plane square to the way between the two middles (80 %).
/// Cost: two supports.
[[nodiscard]] bool passes_by(const Polytope& a, const ConvexHull& hull, const dmat3& axes, const dvec3& origin, double margin) noexcept;

/// The axis of contact of two polytopes: where they are apart, the direction of their distance; otherwise that of their least depth.
/// A separating axis whose own points lie in the face, or within the edges, is that of the distance; where it is not, GJK finds it.
/// @param point_of_a, point_of_b  as above.
/// @return false where the two are farther apart than `margin`.
bool find_axis(Polytope& a, Polytope& b, const dvec3& point_of_a, const dvec3& point_of_b, double margin, ContactAxis& axis);

}  // namespace carom::detail
