// Which meshes bound convex solids.
#include "support/box_mesh.hpp"
#include "support/random_pose.hpp"

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/detail/convex_solid.hpp>
#include <carom/collision/teapot.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/random.hpp>
#include <carom/studies/oracle/hull_surface.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace carom {
namespace {

using Triangle = TriangleMesh::Triangle;
using test::box_mesh;

struct Data {
    std::vector<vec3> vertices;
    std::vector<Triangle> triangles;

    explicit Data(const TriangleMesh& mesh)
        : vertices(mesh.vertices().begin(), mesh.vertices().end()), triangles(mesh.triangles().begin(), mesh.triangles().end()) {}
    [[nodiscard]] TriangleMeshPtr build() const { return *TriangleMesh::build(vertices, triangles); }
    void add(const Data& other) {
        const auto base = static_cast<std::uint32_t>(vertices.size());
        vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
        for (const Triangle& t : other.triangles) triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    }
};

/// The surface of the hull of n points on a spiral round the unit ball: 2 n - 4 triangles.
Data ball(int n) {
    std::vector<vec3> points;
    for (int i = 0; i < n; ++i) {
        const double y = (2.0 * i + 1.0) / n - 1.0, angle = 2.399963 * i, r = std::sqrt(1.0 - y * y);
        points.push_back(vec3(dvec3{r * std::cos(angle), y, r * std::sin(angle)}));
    }
    return Data(*oracle::surface_of(**ConvexHull::build(points)));
}

TEST(ConvexSolid, BoxesOfAnyTrianglesAreBoxes) {
    Random r(1);
    for (int i = 0; i < 60; ++i) {
        const vec3 half{static_cast<float>(r.range(0.01, 2.0)), static_cast<float>(r.range(0.01, 2.0)),
                        static_cast<float>(r.range(0.01, 2.0))};
        Data data(*box_mesh(half, 1 + i % 12));
        // Turned and moved by up to its size, so that rounding leaves no three corners in a plane.
        const Pose pose{2.0 * test::random_direction(r), test::random_rotation(r)};
        for (vec3& v : data.vertices) v = vec3(transform_point(pose, dvec3(v)));
        const TriangleMeshPtr mesh = data.build();
        ASSERT_TRUE(mesh->is_closed());
        ASSERT_NE(mesh->solid(), nullptr) << i;
        EXPECT_EQ(mesh->solid()->vertices().size(), 8u) << i;
        EXPECT_EQ(mesh->solid()->faces().size(), 6u) << i;
    }
}

TEST(ConvexSolid, SurfacesOfHullsAre) {
    Random r(2);
    for (int i = 0; i < 200; ++i) {
        const dvec3 scale{r.range(0.05, 1), r.range(0.05, 1), r.range(0.05, 1)};
        std::vector<vec3> cloud;
        for (int k = 0; k < 8 + 2 * i; ++k) cloud.push_back(vec3(test::random_direction(r) * scale));
        const ConvexHullPtr hull = *ConvexHull::build(cloud);
        const TriangleMeshPtr mesh = oracle::surface_of(*hull);
        ASSERT_NE(mesh->solid(), nullptr) << i;
        EXPECT_EQ(mesh->solid()->vertices().size(), hull->vertices().size()) << i;
        EXPECT_EQ(oracle::seeded_surface_of(*hull)->solid(), nullptr) << i;
    }
    EXPECT_NE(ball(300).build()->solid(), nullptr);
}

TEST(ConvexSolid, WithCornersForEachSideAndTrianglesWithoutArea) {
    Data data(*box_mesh({0.5f, 0.4f, 0.3f}, 2));
    // A triangle whose third corner lies on its edge, in the place of that edge.
    const Triangle t = data.triangles[0];
    const auto middle = static_cast<std::uint32_t>(data.vertices.size());
    data.vertices.push_back(0.5f * (data.vertices[t[0]] + data.vertices[t[1]]));
    data.triangles[0] = {middle, t[1], t[2]};
    data.triangles.push_back({t[0], middle, t[2]});
    data.triangles.push_back({t[0], t[1], middle});
    const TriangleMeshPtr mesh = data.build();
    EXPECT_EQ(mesh->degenerate_count(), 1u);
    ASSERT_TRUE(mesh->is_closed());
    EXPECT_NE(mesh->solid(), nullptr);
}

TEST(ConvexSolid, OthersAreNot) {
    const Data box(*box_mesh({0.5f, 0.5f, 0.5f}, 4));
    const auto solid = [](const Data& data) { return data.build()->solid(); };
    ASSERT_NE(solid(box), nullptr);

    Data open = box;
    open.triangles.pop_back();
    EXPECT_EQ(solid(open), nullptr) << "open";
    Data inwards = box;
    for (Triangle& t : inwards.triangles) std::swap(t[1], t[2]);
    EXPECT_EQ(solid(inwards), nullptr) << "wound inwards";
    Data twice = box;
    twice.add(box);
    EXPECT_EQ(solid(twice), nullptr) << "twice the same";
    Data two = box, other = box;
    for (vec3& v : other.vertices) v.x += 3.0f;
    two.add(other);
    EXPECT_EQ(solid(two), nullptr) << "two bodies";
    // No edge is run along twice in one direction, and every triangle lies on the hull and faces outwards.
    Data layers(*box_mesh({0.5f, 0.5f, 0.5f}, 1));
    layers.add(Data(*box_mesh({0.5f, 0.5f, 0.5f}, 2)));
    ASSERT_TRUE(layers.build()->is_closed());
    EXPECT_EQ(solid(layers), nullptr) << "in two layers";
    const Result<MeshData> pot = teapot(1.0, 0.05);
    EXPECT_EQ((*TriangleMesh::build(pot->vertices, pot->triangles))->solid(), nullptr) << "a teapot";
}

// One corner in the middle of a box's side moved in or out: by ten times the tolerance and by a thirtieth of it. Of a ball, whose corners stand
// out by far more, it may be moved in by more.
TEST(ConvexSolid, ADentCountsFromTheTolerance) {
    const auto moved = [](Data data, std::size_t vertex, double share) {
        const vec3 at = data.vertices[vertex];
        for (vec3& v : data.vertices) {
            if (v == at) v = vec3(dvec3(v) * (1.0 - share));
        }
        const TriangleMeshPtr mesh = data.build();
        EXPECT_TRUE(mesh->is_closed());
        return mesh->solid() != nullptr;
    };
    const Data box(*box_mesh({0.5f, 0.5f, 0.5f}, 6)), round = ball(100);
    constexpr std::size_t kMiddle = 24;
    ASSERT_EQ(box.vertices[kMiddle], (vec3{0.5f, 0.0f, 0.0f}));
    for (const double sign : {1.0, -1.0}) {
        EXPECT_FALSE(moved(box, kMiddle, sign * 20.0 * detail::kSolidTolerance));
        EXPECT_TRUE(moved(box, kMiddle, sign * 0.06 * detail::kSolidTolerance));
    }
    EXPECT_TRUE(moved(round, 50, 1e-5));
    EXPECT_FALSE(moved(round, 50, 0.1));
}

TEST(ConvexSolid, WhatIsTooLargeIsNotLookedAt) {
    EXPECT_NE(Data(*box_mesh({1, 1, 1}, 36)).build()->solid(), nullptr);  // 15,552 triangles in six faces
    EXPECT_EQ(Data(*box_mesh({1, 1, 1}, 37)).build()->solid(), nullptr);  // 16,428
    EXPECT_NE(ball(500).build()->solid(), nullptr);                       // 996 faces
    EXPECT_EQ(ball(520).build()->solid(), nullptr);                       // 1,036
}

}  // namespace
}  // namespace carom
