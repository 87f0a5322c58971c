// The surface of a box as triangles.
//
//   const TriangleMeshPtr crate = box_mesh({0.5f, 0.25f, 0.375f}, 4);
#pragma once

#include <carom/collision/triangle_mesh.hpp>

#include <cstdint>
#include <utility>
#include <vector>

namespace carom::test {

/// @param n  quads along each edge; corners and edges of the six sides are at the same positions, and closed.
inline TriangleMeshPtr box_mesh(const vec3& half, int n) {
    std::vector<vec3> vertices;
    std::vector<TriangleMesh::Triangle> triangles;
    const auto step = [n](int i) { return 2.0f * static_cast<float>(i) / static_cast<float>(n) - 1.0f; };
    for (int face = 0; face < 6; ++face) {
        const int axis = face % 3, u = (axis + 1) % 3, w = (axis + 2) % 3;
        const bool upper = face < 3;
        const auto base = static_cast<std::uint32_t>(vertices.size());
        for (int i = 0; i <= n; ++i) {
            for (int k = 0; k <= n; ++k) {
                vec3 p{0.0f};
                p[axis] = upper ? half[axis] : -half[axis];
                p[u] = half[u] * step(i);
                p[w] = half[w] * step(k);
                vertices.push_back(p);
            }
        }
        const auto at = [&](int i, int k) { return base + static_cast<std::uint32_t>(i * (n + 1) + k); };
        for (int i = 0; i < n; ++i) {
            for (int k = 0; k < n; ++k) {
                TriangleMesh::Triangle p{at(i, k), at(i + 1, k), at(i + 1, k + 1)}, q{at(i, k), at(i + 1, k + 1), at(i, k + 1)};
                if (!upper) std::swap(p[1], p[2]), std::swap(q[1], q[2]);
                triangles.push_back(p);
                triangles.push_back(q);
            }
        }
    }
    return *TriangleMesh::build(vertices, triangles);
}

}  // namespace carom::test
