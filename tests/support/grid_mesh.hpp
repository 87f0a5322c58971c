// A ground of square cells, two triangles each, that face up.
//
//   const TriangleMeshPtr ground = grid_mesh(31, [](float i, float j) { return vec3{0.5f * i, 0.0f, 0.5f * j}; });
#pragma once

#include <carom/collision/triangle_mesh.hpp>

#include <cstdint>
#include <vector>

namespace carom::test {

/// @param side   vertices along each edge.
/// @param place  of the vertex in column i of row j.
template <class Place>
TriangleMeshPtr grid_mesh(std::uint32_t side, const Place& place) {
    std::vector<vec3> vertices;
    std::vector<TriangleMesh::Triangle> triangles;
    for (std::uint32_t i = 0; i < side * side; ++i) vertices.push_back(place(static_cast<float>(i % side), static_cast<float>(i / side)));
    for (std::uint32_t j = 0; j + 1 < side; ++j) {
        for (std::uint32_t i = 0; i + 1 < side; ++i) {
            const std::uint32_t k = j * side + i;
            triangles.push_back({k, k + side, k + 1});
            triangles.push_back({k + 1, k + side, k + side + 1});
        }
    }
    return *TriangleMesh::build(vertices, triangles);
}

}  // namespace carom::test
