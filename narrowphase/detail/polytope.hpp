// A convex polytope in the frame of a pair: a box, a hull or a two-sided triangle, all read alike by the pair kernels.
//
//   load_box(workspace.first, half_extents, dmat3{1.0}, dvec3{0.0});
#pragma once

#include <carom/collision/convex_hull.hpp>
#include <carom/core/types.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::detail {

/// Vertices and planes are placed in the frame of the pair; the topology is that of the hull, or a table, and is not copied.
struct Polytope {
    struct Face {
        dvec3 normal{0.0};             ///< unit, outward
        double offset = 0.0;           ///< the largest dot(normal, x) of its corners [m]
        std::uint32_t first_edge = 0;  ///< half edge at which its loop begins
        std::uint32_t edge_count = 0;
    };
    /// An edge with the normals of the faces beside it: `left` of the face in whose loop it runs along `direction`.
    struct Edge {
        dvec3 from{0.0};
        dvec3 direction{0.0};  ///< to the other end [m]
        dvec3 left{0.0};
        dvec3 right{0.0};
        std::uint32_t name = 0;
    };

    std::vector<dvec3> vertices;
    std::vector<Face> planes;      ///< the faces; of a triangle then three planes square to it, with the edge that they stand on
    std::size_t face_count = 0;
    std::span<const ConvexHull::HalfEdge> half_edges;  ///< in pairs (2 k, 2 k + 1), twins of each other
    std::uint32_t edge_name_count = 0;                 ///< edge k is called k modulo this
    dvec3 centre{0.0};   ///< a point inside
    dvec3 lower{0.0};    ///< bounds of the vertices
    dvec3 upper{0.0};
    double size = 0.0;   ///< largest extent of the bounds [m]

    [[nodiscard]] std::span<const Face> faces() const noexcept { return {planes.data(), face_count}; }
    [[nodiscard]] std::span<const Face> sides() const noexcept { return std::span<const Face>(planes).subspan(face_count); }
    [[nodiscard]] std::uint32_t edge_count() const noexcept { return static_cast<std::uint32_t>(half_edges.size() / 2); }
    [[nodiscard]] std::uint32_t edge_name(std::uint32_t k) const noexcept { return k % edge_name_count; }
    [[nodiscard]] const dvec3& origin_of(std::uint32_t half_edge) const noexcept { return vertices[half_edges[half_edge].origin]; }
    [[nodiscard]] Edge edge(std::uint32_t k) const noexcept {
        const ConvexHull::HalfEdge &e = half_edges[2 * k], &twin = half_edges[2 * k + 1];
        const dvec3& from = vertices[e.origin];
        return {from, vertices[twin.origin] - from, planes[e.face].normal, planes[twin.face].normal, edge_name(k)};
    }
};

/// Each replaces what `out` held; `axes` and `origin` place the shape in the frame of the pair. Nothing is allocated once `out` has
/// held a polytope as large. A loaded hull must outlive `out`'s use.
void load_box(Polytope& out, const dvec3& half_extents, const dmat3& axes, const dvec3& origin);

/// A hull comes in two steps, because a pair that is apart needs its vertices only.
void load_hull_vertices(Polytope& out, const ConvexHull& hull, const dmat3& axes, const dvec3& origin);
void load_hull_faces(Polytope& out, const ConvexHull& hull, const dmat3& axes, const dvec3& origin);

/// A triangle as a solid without thickness: two faces, and each edge twice, once towards either face, because the normals that
/// support an edge of a triangle sweep half a turn, which is no arc on the sphere of directions.
/// @return false, with `out` unusable, for a triangle whose area is below 1e-12 of its longest edge squared.
bool load_triangle(Polytope& out, const std::array<dvec3, 3>& corners);

/// @return the face whose normal is most along `direction`; ties go to the lower index.
[[nodiscard]] std::uint32_t face_along(const Polytope& p, const dvec3& direction) noexcept;

/// @return the vertex farthest along `direction`; ties go to the lower index.
[[nodiscard]] std::uint32_t vertex_along(const Polytope& p, const dvec3& direction) noexcept;

/// @return how far the polytope reaches along `direction`: the largest dot product with a vertex.
[[nodiscard]] double reach_along(const Polytope& p, const dvec3& direction) noexcept;

}  // namespace carom::detail
