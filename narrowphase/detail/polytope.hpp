// A convex polytope laid out flat for the pair kernels: a box, a hull or a two-sided triangle, in the frame of the pair.
//
//   load_box(workspace.first, half_extents, dmat3{1.0}, dvec3{0.0});
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/types.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace carom::detail {

struct Polytope {
    struct Face {
        dvec3 normal{0.0};        ///< unit, outward
        double offset = 0.0;      ///< the largest dot(normal, x) of its corners [m]
        std::uint32_t first = 0;  ///< into `loop` and `loop_edge`
        std::uint32_t count = 0;
    };
    /// An edge with the normals of the faces beside it: `left` of the face in whose loop it runs from `from` to `to`.
    struct Edge {
        std::uint32_t from = 0;
        std::uint32_t to = 0;
        dvec3 direction{0.0};  ///< to - from [m]
        dvec3 left{0.0};
        dvec3 right{0.0};
        std::uint32_t name = 0;
    };

    std::vector<dvec3> vertices;
    std::vector<Face> faces;
    std::vector<std::uint32_t> loop;       ///< corners of the faces, counter-clockwise from outside
    std::vector<std::uint32_t> loop_edge;  ///< name of the edge from that corner to the next
    std::vector<Edge> edges;
    dvec3 lower{0.0};   ///< bounds of the vertices
    dvec3 upper{0.0};
    double size = 0.0;  ///< largest extent of the bounds [m]
};

/// Each replaces what `out` held; `axes` and `origin` place the shape in the frame of the pair. Nothing is allocated once `out` has
/// held a polytope as large.
void load_box(Polytope& out, const dvec3& half_extents, const dmat3& axes, const dvec3& origin);

/// A hull comes in two steps, because a pair that is apart needs its vertices only.
void load_hull_vertices(Polytope& out, const ConvexHull& hull, const dmat3& axes, const dvec3& origin);
void load_hull_faces(Polytope& out, const ConvexHull& hull, const dmat3& axes);

/// A triangle as a solid without thickness: two faces, and each edge twice, once towards either face, because the normals that
/// support an edge of a triangle sweep half a turn, which is no arc on the sphere of directions.
/// @return false, with `out` unusable, for a triangle whose area is below 1e-12 of its longest edge squared.
bool load_triangle(Polytope& out, const std::array<dvec3, 3>& corners);

/// @return the face whose normal is most along `direction`; ties go to the lower index.
[[nodiscard]] std::uint32_t face_along(const Polytope& p, const dvec3& direction) noexcept;

}  // namespace carom::detail
