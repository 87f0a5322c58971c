// The named meshes: what the catalogue says of them holds.
#include <carom/collision/triangle_mesh.hpp>
#include <carom/scenes/bumpy.hpp>
#include <carom/scenes/meshes.hpp>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace carom::scenes {
namespace {

TriangleMeshPtr built(const MeshData& data) {
    Result<TriangleMeshPtr> mesh = TriangleMesh::build(data.vertices, data.triangles);
    EXPECT_TRUE(mesh) << mesh.error().message;
    return *mesh;
}

TEST(Meshes, EveryNamedMeshBuilds) {
    for (const MeshInfo& info : mesh_catalogue()) {
        const Result<MeshData> data = make_mesh(info.name);
        ASSERT_TRUE(data) << info.name;
        EXPECT_GT(data->triangles.size(), 1000u) << info.name;
        EXPECT_NE(info.summary, "");
    }
    EXPECT_EQ(make_mesh("bumpy")->triangles.size(), 69'312u);
    EXPECT_EQ(make_mesh("bumpy1m")->triangles.size(), 1'002'252u);
}

TEST(Meshes, AnUnknownNameSaysWhichThereAre) {
    const Result<MeshData> mesh = make_mesh("kettle");
    ASSERT_FALSE(mesh);
    EXPECT_EQ(mesh.error().code, ErrorCode::UnknownName);
    for (const MeshInfo& info : mesh_catalogue()) {
        EXPECT_NE(mesh.error().message.find(info.name), std::string::npos);
    }
}

TEST(Meshes, WeldedBumpyBallsAreClosedAndFaceOutwards) {
    for (const int n : {1, 2, 3, 8, 23}) {
        const MeshData data = weld(bumpy(n));
        const auto quads = static_cast<std::size_t>(n * n);
        EXPECT_EQ(data.triangles.size(), 12 * quads);
        EXPECT_EQ(data.vertices.size(), 6 * quads + 2) << "Euler: every vertex on a seam is there once";
        const TriangleMeshPtr mesh = built(data);
        EXPECT_TRUE(mesh->is_closed()) << n;
        double volume = 0.0;
        for (std::uint32_t t = 0; t < data.triangles.size(); ++t) {
            const auto [a, b, c] = mesh->corners(t);
            volume += glm::dot(dvec3(a), glm::cross(dvec3(b), dvec3(c))) / 6.0;
        }
        EXPECT_GT(volume, 1.0) << n;
        EXPECT_LT(volume, 4.4) << n;
    }
}

}  // namespace
}  // namespace carom::scenes
