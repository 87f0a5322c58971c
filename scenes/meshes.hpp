// Named meshes for queries: what studies, benchmarks and `carom cast` cast rays against.
//
//   Result<MeshData> data = scenes::make_mesh("bumpy");
//   Result<TriangleMeshPtr> mesh = TriangleMesh::build(data->vertices, data->triangles);
#pragma once

#include <carom/collision/mesh_data.hpp>
#include <carom/core/result.hpp>

#include <span>
#include <string>

namespace carom::scenes {

/// One entry of the catalogue of meshes.
struct MeshInfo {
    std::string name;
    std::string summary;
};

/// @return every named mesh, in the order that lists show them.
[[nodiscard]] std::span<const MeshInfo> mesh_catalogue();

/// @return the mesh of that name, welded; the same bits each time. UnknownName, with the names there are, for any other.
[[nodiscard]] Result<MeshData> make_mesh(const std::string& name);

}  // namespace carom::scenes
