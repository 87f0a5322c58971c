// Grounds as they come out of modelling programs: cracks, T-junctions, faces wound either way, faces twice, faces of no area. What lies on them
// lies as on a whole one. The figures stand in docs/stability.md.
#include "support/box_mesh.hpp"
#include "table.hpp"

#include <carom/collision/convex_hull.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace carom {
namespace {

using namespace test;

constexpr float kCell = 0.4f;
constexpr int kCells = 12;

struct Soup {
    std::vector<vec3> vertices;
    std::vector<TriangleMesh::Triangle> triangles;

    void add(const vec3& a, const vec3& b, const vec3& c) {
        const auto k = static_cast<std::uint32_t>(vertices.size());
        vertices.insert(vertices.end(), {a, b, c});
        triangles.push_back({k, k + 1, k + 2});
    }
    [[nodiscard]] TriangleMeshPtr mesh() const { return *TriangleMesh::build(vertices, triangles); }
};

// Flat squares about the origin, those of odd columns cut into four times as many: T-junctions along every column.
Soup ground_with_junctions() {
    Soup soup;
    const auto square = [&](float x, float z, float side) {
        const vec3 a{x, 0, z}, b{x, 0, z + side}, c{x + side, 0, z}, d{x + side, 0, z + side};
        soup.add(a, b, c);
        soup.add(c, b, d);
    };
    for (int i = 0; i < kCells; ++i) {
        for (int j = 0; j < kCells; ++j) {
            const float x = kCell * (static_cast<float>(i) - 0.5f * kCells), z = kCell * (static_cast<float>(j) - 0.5f * kCells);
            const int parts = i % 2 == 0 ? 1 : 2;
            const float side = kCell / static_cast<float>(parts);
            for (int k = 0; k < parts * parts; ++k)
                square(x + side * static_cast<float>(k % parts), z + side * static_cast<float>(k / parts), side);
        }
    }
    return soup;
}

struct Ground {
    const char* name;
    TriangleMeshPtr mesh;
    bool oriented;
    std::size_t degenerate;
};

std::vector<Ground> broken_grounds() {
    Random random(31);
    const Soup whole = ground_with_junctions();
    std::vector<Ground> grounds{{"T-junctions", whole.mesh(), true, 0}};
    Soup soup = whole;
    for (vec3& v : soup.vertices)
        v.x += static_cast<float>(random.range(-1e-4, 1e-4)), v.z += static_cast<float>(random.range(-1e-4, 1e-4));
    grounds.push_back({"cracks of 0.1 mm", soup.mesh(), true, 0});
    soup = whole;
    for (std::size_t k = 0; k < soup.triangles.size(); k += 3) std::swap(soup.triangles[k][1], soup.triangles[k][2]);
    grounds.push_back({"a third of the faces wound the other way", soup.mesh(), false, 0});
    soup = whole;
    for (std::size_t k = 0; k < whole.triangles.size(); k += 2) soup.triangles.push_back(whole.triangles[k]);
    grounds.push_back({"every other face twice", soup.mesh(), false, 0});
    soup = whole;
    for (std::uint32_t k = 0; k < 60; k += 6) {  // the first of each square, whose first side runs along z
        soup.triangles.push_back({k, k, k + 1});
        soup.add(soup.vertices[k], 0.5f * (soup.vertices[k] + soup.vertices[k + 1]), soup.vertices[k + 1]);
    }
    grounds.push_back({"faces of no area", soup.mesh(), true, 20});
    return grounds;
}

TEST(BrokenMeshes, CarryWhatAWholeOneDoes) {
    std::vector<vec3> prism;
    for (const float y : {-0.25f, 0.25f}) prism.insert(prism.end(), {{-0.4f, y, -0.3f}, {0.4f, y, -0.3f}, {0.0f, y, 0.5f}});
    const std::array<Shape, 6> shapes{
        Box{{0.3f, 0.25f, 0.4f}},         Sphere{0.25f},           Cylinder{0.3f, 0.25f}, *ConvexHull::build(prism),
        box_mesh({0.3f, 0.25f, 0.4f}, 2), Box{{0.1f, 0.25f, 0.1f}}};
    for (const Ground& ground : broken_grounds()) {
        EXPECT_FALSE(ground.mesh->is_closed());
        EXPECT_EQ(ground.mesh->is_oriented(), ground.oriented) << ground.name;
        EXPECT_EQ(ground.mesh->degenerate_count(), ground.degenerate) << ground.name;
        double deepest = 0.0;
        for (std::size_t i = 0; i < shapes.size(); ++i) {
            World world;
            world.add_shape(world.create_body({.type = BodyType::Static}), ground.mesh);
            const BodyId body = world.create_body({.position = {0.137 * static_cast<double>(i) - 0.3, 0.2505, 0.211}});
            world.add_shape(body, shapes[i]);
            for (int k = 0; k < 240; ++k) world.step(kDt);
            const double sunk = 0.25 - world.pose(body).position.y;
            deepest = std::max(deepest, std::abs(sunk));
            EXPECT_LT(std::abs(sunk), 0.5e-3) << ground.name << " " << to_string(type_of(shapes[i])) << " "
                                              << i;  // a thousandth of its height
            EXPECT_LT(glm::length(world.linear_velocity(body)), 1e-4) << ground.name << " " << i;
        }
        std::printf("figure 31 %-45s sunk %.2g m\n", ground.name, deepest);
    }
}

}  // namespace
}  // namespace carom
