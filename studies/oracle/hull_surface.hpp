// The surface of a hull as a mesh, whose depths and distances are those of the hull.
#pragma once

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>

#include <cstdint>
#include <vector>

namespace carom::oracle {

/// @return the faces of `hull` cut into fans, closed, with the hull's vertices.
inline TriangleMeshPtr surface_of(const ConvexHull& hull) {
    std::vector<TriangleMesh::Triangle> triangles;
    const auto edges = hull.edges();
    for (const ConvexHull::Face& face : hull.faces()) {
        for (std::uint32_t b = edges[face.first_edge].next; edges[b].next != face.first_edge; b = edges[b].next) {
            triangles.push_back({edges[face.first_edge].origin, edges[b].origin, edges[edges[b].next].origin});
        }
    }
    return *TriangleMesh::build(hull.vertices(), triangles);
}

}  // namespace carom::oracle
