// Triangles as plain data: what the generators return and what TriangleMesh::build takes.
//
//   MeshData data = height_grid(128, 128, 0.5, [](double x, double z) { return 0.1 * x * z; });
//   Result<TriangleMeshPtr> mesh = TriangleMesh::build(data.vertices, data.triangles);
#pragma once

#include <carom/core/types.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace carom {

/// Vertices [m] and triangles of vertex indices, counter-clockwise seen from outside.
struct MeshData {
    std::vector<vec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Makes one vertex of all vertices with exactly the same position (-0 and 0 are the same), in the order of their first use,
/// and leaves out triangles of which two corners became one and vertices that no triangle uses.
/// @param mesh  finite vertices, indices in range.
/// Cost: O(n log n) in the number of vertices.
[[nodiscard]] MeshData weld(const MeshData& mesh);

}  // namespace carom
