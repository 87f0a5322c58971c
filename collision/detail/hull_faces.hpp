// From a hull of triangles to one of polygons: the second half of building a ConvexHull.
//
//   const FaceLabels labels = merge_coplanar(points, triangles, tolerance);
//   if (corners(triangles, labels).size() == 8) { /* as a box has */ }
#pragma once

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/detail/triangle_hull.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom::detail {

/// For each triangle, the face it belongs to; faces are numbered 0, 1, ..., those with the largest triangles first.
struct FaceLabels {
    std::vector<std::uint32_t> face;  ///< (triangles,)
    std::uint32_t count = 0;
};

/// Groups triangles into faces, each grown from its largest triangle over neighbours that lie in its plane.
/// @param tolerance  largest distance of a vertex from that plane [m]; with 0, only exactly coplanar triangles are joined.
[[nodiscard]] FaceLabels merge_coplanar(std::span<const dvec3> points, std::span<const HullTriangle> triangles,
                                        double tolerance);

/// @return the points at which three faces or more meet, in ascending order.
[[nodiscard]] std::vector<std::uint32_t> corners(std::span<const HullTriangle> triangles, const FaceLabels& labels);

/// The polygons of a hull, as ConvexHull stores them; vertices are indices of the points.
struct HullFaces {
    std::vector<ConvexHull::Face> faces;
    std::vector<ConvexHull::HalfEdge> edges;
};

/// Links the borders of the faces into polygons and gives each its supporting plane. Every point must be a corner.
[[nodiscard]] HullFaces link_faces(std::span<const dvec3> points, std::span<const HullTriangle> triangles,
                                   const FaceLabels& labels);

/// @return true if each face is one polygon, strictly convex, with its vertices within `tolerance` of its plane, if each edge is
/// strictly convex, and if Euler's formula holds. Triangles merged with a tolerance may fail.
[[nodiscard]] bool is_convex_polyhedron(std::span<const dvec3> points, const HullFaces& hull, double tolerance);

/// @return true if each of `others` is in the hull or no farther than `tolerance` from it. Planes alone cannot tell: where two meet
/// at a small angle, a point just above both may be far from their edge.
[[nodiscard]] bool is_near_hull(std::span<const dvec3> others, std::span<const dvec3> points, const HullFaces& hull,
                                double tolerance);

}  // namespace carom::detail
