// A convex polytope in the frame of a pair: a box, a hull or a two-sided triangle, all read alike by the pair kernels.
//
//   load_box(workspace.first, half_extents);
//   load_hull(workspace.second, hull, pair.rotation, pair.translation);
#pragma once

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/polytope_bundles.hpp>
#include <carom/core/types.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::detail {

/// Vertices and planes in lanes, in the frame of the pair; the topology is that of the hull, or a table, and is not copied.
struct Polytope {
    /// An edge with the normals of the faces beside it: `left` of the face in whose loop it runs along `direction`.
    struct Edge {
        dvec3 from{0.0};
        dvec3 direction{0.0};  ///< to the other end [m]
        dvec3 left{0.0};
        dvec3 right{0.0};
        std::uint32_t name = 0;
    };

    std::span<const PointBundle> points;             ///< the vertices
    std::span<const PlaneBundle> planes;             ///< the faces' planes, which hold all their corners
    std::span<const ConvexHull::Face> loops;         ///< the faces' first edges and numbers of edges; planes there mean nothing
    std::span<const ConvexHull::HalfEdge> half_edges;  ///< in pairs (2 k, 2 k + 1), twins of each other
    std::uint32_t vertex_count = 0;
    std::uint32_t edge_name_count = 0;  ///< edge k is called k modulo this
    std::uint32_t side_count = 0;       ///< of a triangle 3: planes square to it, one on each edge, numbered after the faces
    PlaneBundle sides;
    dvec3 centre{0.0};  ///< a point inside
    double size = 0.0;  ///< largest extent of its bounds in its own frame [m]

    std::vector<PointBundle> own_points;  ///< what `points` and `planes` show, where they were moved
    std::vector<PlaneBundle> own_planes;
    std::vector<dvec3> listed;            ///< of list_vertices()

    [[nodiscard]] std::uint32_t face_count() const noexcept { return static_cast<std::uint32_t>(loops.size()); }
    [[nodiscard]] std::uint32_t edge_count() const noexcept { return static_cast<std::uint32_t>(half_edges.size() / 2); }
    [[nodiscard]] std::uint32_t edge_name(std::uint32_t k) const noexcept { return k % edge_name_count; }
    [[nodiscard]] dvec3 vertex(std::uint32_t k) const noexcept { return point_of(points, k); }
    /// @param plane  a face, or a side.
    [[nodiscard]] dvec3 normal(std::uint32_t plane) const noexcept {
        return plane < loops.size() ? normal_of(planes, plane) : normal_of({&sides, 1}, plane - loops.size());
    }
    [[nodiscard]] double offset(std::uint32_t face) const noexcept { return offset_of(planes, face); }
    [[nodiscard]] dvec3 origin_of(std::uint32_t half_edge) const noexcept { return vertex(half_edges[half_edge].origin); }
    [[nodiscard]] Edge edge(std::uint32_t k) const noexcept {
        const ConvexHull::HalfEdge &e = half_edges[2 * k], &twin = half_edges[2 * k + 1];
        const dvec3 from = vertex(e.origin);
        return {from, vertex(twin.origin) - from, normal(e.face), normal(twin.face), edge_name(k)};
    }
};

/// Each replaces what `out` held. Without a pose the shape stays in its own frame; otherwise `axes` and `origin` place it. Nothing is
/// allocated once `out` has held a polytope as large. A loaded hull must outlive `out`'s use.
void load_box(Polytope& out, const dvec3& half_extents);
void load_box(Polytope& out, const dvec3& half_extents, const dmat3& axes, const dvec3& origin);
void load_hull(Polytope& out, const ConvexHull& hull);
void load_hull(Polytope& out, const ConvexHull& hull, const dmat3& axes, const dvec3& origin);

/// A triangle as a solid without thickness: two faces, and each edge twice, once towards either face, because the normals that
/// support an edge of a triangle sweep half a turn, which is no arc on the sphere of directions.
/// @return false, with `out` unusable, for a triangle whose area is below 1e-12 of its longest edge squared.
bool load_triangle(Polytope& out, const std::array<dvec3, 3>& corners);

/// @return whether `p` lies over the inside of the face.
[[nodiscard]] bool is_over_face(const Polytope& polytope, std::uint32_t face, const dvec3& p) noexcept;

/// @return the vertices one after the other, until `p` is loaded anew.
[[nodiscard]] std::span<const dvec3> list_vertices(Polytope& p);

}  // namespace carom::detail
