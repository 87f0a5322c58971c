// What must hold for any bytes that parse_mesh is given: refused with an error that names the place, or a mesh that builds. For the
// fuzzer and for tests.
//
//   EXPECT_EQ(test::mesh_file_fault(bytes), "");        // the first byte chooses the format
#pragma once

#include <carom/collision/import/read_mesh.hpp>
#include <carom/collision/triangle_mesh.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace carom::test {

inline std::string mesh_file_fault(std::span<const std::uint8_t> bytes) {
    if (bytes.empty()) return "";
    const auto format = static_cast<MeshFormat>(bytes[0] % 5);
    const std::string_view contents(reinterpret_cast<const char*>(bytes.data()) + 1, bytes.size() - 1);
    const Result<MeshData> mesh = parse_mesh(contents, format, "place");
    if (!mesh) return mesh.error().where == "place" && !mesh.error().message.empty() ? "" : "an error without a place or a message";
    if (mesh->vertices.size() > 3 * bytes.size() + 3) return "more vertices than the file can hold";
    const Result<TriangleMeshPtr> built = TriangleMesh::build(mesh->vertices, mesh->triangles);
    return built ? "" : "a mesh that does not build: " + built.error().message;
}

}  // namespace carom::test
