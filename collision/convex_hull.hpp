// Convex hulls: built once from points, immutable, shared.
//
//   Result<ConvexHullPtr> hull = ConvexHull::build(points);
//   if (!hull) return hull.error();
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/polytope_bundles.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/bundle.hpp>
#include <carom/core/types.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom {

/// A convex polyhedron with coplanar faces merged, as a half-edge structure in structure-of-arrays form.
///
/// Invariants: every face is a convex polygon whose vertices run counter-clockwise seen from outside; V - E + F = 2; half
/// edges come in pairs (2k, 2k + 1), each the other's twin; no vertex is strictly inside the hull.
class ConvexHull {
public:
    struct Face {
        dvec3 normal{0.0};              ///< outward, unit
        double offset = 0.0;            ///< dot(normal, x) = offset on the face [m]
        std::uint32_t first_edge = 0;   ///< any half edge of the face
        std::uint32_t edge_count = 0;   ///< vertices of the polygon
    };
    struct HalfEdge {
        std::uint32_t origin = 0;  ///< vertex it starts at
        std::uint32_t next = 0;    ///< next half edge round the same face
        std::uint32_t face = 0;
    };

    /// Builds the hull of `points` [m]: Quickhull (Barber, Dobkin, Huhdanpaa 1996) in double with merging of coplanar faces.
    /// @param points  (n,), finite, any order, duplicates allowed; needs four that are not coplanar.
    /// @return the hull; NotFinite, Empty (fewer than 4 points) or Degenerate (coplanar to 1e-6 of the largest extent).
    /// Accuracy: no input point is farther than 1e-5 of the largest extent from the hull or above a face's plane; no vertex is above
    /// a plane except by rounding in double. Cost: O(n log n) expected; about 20 µs for 12 points.
    [[nodiscard]] static Result<ConvexHullPtr> build(std::span<const vec3> points);

    /// Sixteen vertices as lanes read them.
    struct VertexBundle {
        FloatBundle x, y, z;  ///< [m]
    };

    [[nodiscard]] std::span<const vec3> vertices() const noexcept { return vertices_; }
    /// @return the vertices once more, vertex i in lane i mod 16 of bundle i div 16; lanes beyond the last repeat vertex 0.
    [[nodiscard]] std::span<const VertexBundle> vertex_bundles() const noexcept { return vertex_bundles_; }
    [[nodiscard]] std::span<const Face> faces() const noexcept { return faces_; }
    [[nodiscard]] std::span<const HalfEdge> edges() const noexcept { return edges_; }
    [[nodiscard]] static constexpr std::uint32_t twin(std::uint32_t edge) noexcept { return edge ^ 1u; }

    /// The vertices and the faces' planes in lanes, in the same order, in double. Corners of a merged face may lie off its plane: here the
    /// planes have been moved out to hold all of them.
    [[nodiscard]] std::span<const PointBundle> point_bundles() const noexcept { return point_bundles_; }
    [[nodiscard]] std::span<const PlaneBundle> plane_bundles() const noexcept { return plane_bundles_; }
    /// Box of the vertices, and their mean, which lies inside.
    [[nodiscard]] const Aabb& local_bounds() const noexcept { return bounds_; }
    [[nodiscard]] const dvec3& centre() const noexcept { return centre_; }
    /// @return the largest distance of a vertex from the origin [m], rounded up.
    [[nodiscard]] double reach() const noexcept { return reach_; }

    /// @return the index of a vertex farthest along `direction` (any length, not zero); ties go to the lowest index.
    [[nodiscard]] std::uint32_t support(const dvec3& direction) const noexcept;

private:
    ConvexHull() = default;
    void fill_bundles();
    std::vector<vec3> vertices_;
    std::vector<VertexBundle> vertex_bundles_;
    double reach_ = 0.0;
    std::vector<Face> faces_;
    std::vector<HalfEdge> edges_;
    std::vector<PointBundle> point_bundles_;
    std::vector<PlaneBundle> plane_bundles_;
    Aabb bounds_;
    dvec3 centre_{0.0};
};

}  // namespace carom
