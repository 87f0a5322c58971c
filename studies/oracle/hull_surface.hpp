// The surface of a hull as a mesh, whose depths and distances are those of the hull.
#pragma once

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace carom::oracle {

/// @return the faces of `hull` cut into fans, closed, with the hull's vertices.
inline std::vector<TriangleMesh::Triangle> fans_of(const ConvexHull& hull) {
    std::vector<TriangleMesh::Triangle> triangles;
    const auto edges = hull.edges();
    for (const ConvexHull::Face& face : hull.faces()) {
        for (std::uint32_t b = edges[face.first_edge].next; edges[b].next != face.first_edge; b = edges[b].next) {
            triangles.push_back({edges[face.first_edge].origin, edges[b].origin, edges[edges[b].next].origin});
        }
    }
    return triangles;
}

inline TriangleMeshPtr surface_of(const ConvexHull& hull) { return *TriangleMesh::build(hull.vertices(), fans_of(hull)); }

/// @return the same and, about the hull's centre, a tetrahedron of a thousandth of its size: closed, but not the surface of a convex solid, so that its
/// contacts are those of its triangles. They are as deep as those of the hull to what does not come to the tetrahedron.
inline TriangleMeshPtr seeded_surface_of(const ConvexHull& hull) {
    std::vector<vec3> vertices(hull.vertices().begin(), hull.vertices().end());
    std::vector<TriangleMesh::Triangle> triangles = fans_of(hull);
    const auto first = static_cast<std::uint32_t>(vertices.size());
    const dvec3 extent = hull.local_bounds().upper - hull.local_bounds().lower;
    const double size = 1e-3 * std::max({extent.x, extent.y, extent.z});
    for (const dvec3& corner : {dvec3{1, 1, 1}, dvec3{1, -1, -1}, dvec3{-1, 1, -1}, dvec3{-1, -1, 1}})
        vertices.push_back(vec3(hull.centre() + size * corner));
    for (const TriangleMesh::Triangle& t : {TriangleMesh::Triangle{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}) {
        triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    return *TriangleMesh::build(vertices, triangles);
}

}  // namespace carom::oracle
