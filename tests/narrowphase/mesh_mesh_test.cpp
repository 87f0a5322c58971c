// Meshes on meshes: where they touch, how deep, and along which normal; resting, sliding, and moving in each other's hollows.
#include "oracle.hpp"
#include "standing.hpp"

#include <carom/collision/closest_points.hpp>
#include <carom/collision/mesh_pairs.hpp>
#include <carom/collision/teapot.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/studies/oracle/hull_surface.hpp>

#include <support/box_mesh.hpp>
#include <support/grid_mesh.hpp>

#include <gtest/gtest.h>

#include <set>

namespace carom {
namespace {

using namespace test;
using oracle::seeded_surface_of;
using oracle::surface_of;

TriangleMeshPtr flat_ground() {
    return grid_mesh(33, [](float i, float j) { return vec3{0.125f * (i - 16.0f), 0.0f, 0.125f * (j - 16.0f)}; });
}

TEST(MeshMesh, BoxMeshRestsOnItsFourCorners) {
    const Shape ground = flat_ground();
    Random r(1);
    for (const int n : {1, 4}) {
        const Shape crate = box_mesh({0.5f, 0.25f, 0.375f}, n);
        for (int i = 0; i < 30; ++i) {
            const Pose pose{{r.range(-0.2, 0.2), i % 2 == 0 ? 0.249 : 0.251, r.range(-0.2, 0.2)}, about({0, 1, 0}, i == 0 ? 0.0 : r.range(0, 6))};
            const std::vector<Manifold> m = collide_all(crate, pose, ground, {}, 0.01f);
            expect_stands_on_corners(m, pose, 0.5, 0.375, i % 2 == 0 ? -0.001f : 0.001f);
        }
    }
}

// Flush, overhanging by little, crossed: what decides is never the side that is nearer.
TEST(MeshMesh, BoxMeshesStack) {
    const Shape a = box_mesh({0.5f, 0.25f, 0.375f}, 1), b = box_mesh({0.5f, 0.25f, 0.375f}, 3), plank = box_mesh({2.0f, 0.05f, 0.1f}, 1);
    for (const dvec3& shift : {dvec3{0.0}, dvec3{1e-5, 0, 0}, dvec3{-1e-5, 0, 2e-5}, dvec3{0.003, 0, 0}, dvec3{0.9, 0, 0.5}, dvec3{0.997, 0, 0}}) {
        for (const Shape* top : {&a, &b}) {
            const std::vector<Manifold> m = collide_all(*top, {shift + dvec3{0, 0.499, 0}}, a, {}, 0.01f);
            ASSERT_EQ(m.size(), 1u) << shift.x;
            EXPECT_EQ(m[0].count, 4u) << shift.x;
            EXPECT_NEAR(m[0].normal.y, -1.0f, 1e-6f) << shift.x;
            for (const ContactPoint& p : m[0].used()) EXPECT_NEAR(p.separation, -0.001f, 1e-6f);
        }
    }
    for (const double gap : {-0.001, 0.001}) {
        const std::vector<Manifold> m = collide_all(plank, {{0.3, 0.1 + gap, 0.2}, about({0, 1, 0}, 1.2)}, plank, {}, 0.01f);
        ASSERT_EQ(m.size(), 1u);
        EXPECT_EQ(m[0].count, 4u);
        EXPECT_NEAR(m[0].normal.y, -1.0f, 1e-6f);
        for (const ContactPoint& p : m[0].used()) EXPECT_NEAR(static_cast<double>(p.separation), gap, 1e-6);
    }
}

struct Part {
    TriangleMeshPtr mesh;
    vec3 at{0.0f};
};
TriangleMeshPtr joined(const std::vector<Part>& parts) {
    std::vector<vec3> vertices;
    std::vector<TriangleMesh::Triangle> triangles;
    for (const Part& part : parts) {
        const auto base = static_cast<std::uint32_t>(vertices.size());
        for (const vec3& v : part.mesh->vertices()) vertices.push_back(v + part.at);
        for (const auto& t : part.mesh->triangles()) triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    }
    return *TriangleMesh::build(vertices, triangles);
}

// Far sides of thin plates are within the margin of each other, and look at each other from behind.
TEST(MeshMesh, ThinPlatesTouchOnTheirNearSides) {
    const TriangleMeshPtr sheet = box_mesh({0.5f, 0.003f, 0.5f}, 2);
    std::vector<Manifold> m = collide_all(Shape{sheet}, {{0, 0.0055, 0}}, Shape{sheet}, {}, 0.02f);
    ASSERT_EQ(m.size(), 1u);
    EXPECT_NEAR(m[0].normal.y, -1.0f, 1e-6f);
    for (const ContactPoint& p : m[0].used()) EXPECT_NEAR(p.separation, -0.0005f, 1e-6f);
    // In a slot between two sheets, on the lower one.
    m = collide_all(Shape{sheet}, {{0, 0.0055, 0}}, Shape{joined({{sheet}, {sheet, {0.0f, 0.015f, 0.0f}}})}, {}, 0.02f);
    ASSERT_EQ(m.size(), 2u);
    EXPECT_NEAR(m[0].normal.y, -1.0f, 1e-6f);
    for (const ContactPoint& p : m[0].used()) EXPECT_NEAR(p.separation, -0.0005f, 1e-6f);
    EXPECT_NEAR(m[1].normal.y, 1.0f, 1e-6f);
    for (const ContactPoint& p : m[1].used()) EXPECT_NEAR(p.separation, 0.0035f, 1e-6f);
    // Sheets that hover over each other, beside blocks that overlap.
    const TriangleMeshPtr block = box_mesh({0.1f, 0.1f, 0.1f}, 1);
    m = collide_all(Shape{joined({{sheet}, {block, {2.0f, 0.0f, 0.0f}}})}, {{0.05, 0.008, 0.03}},
                    Shape{joined({{sheet}, {block, {2.0f, -0.19f, 0.0f}}})}, {}, 0.02f);
    ASSERT_EQ(m.size(), 1u);
    EXPECT_NEAR(m[0].normal.y, -1.0f, 1e-6f);
    EXPECT_NEAR(least_separation(m[0]), -0.002f, 1e-6f);
}

TEST(MeshMesh, ACornerOfARoomPushesOnBothWalls) {
    // A room of one box, wound inwards.
    const TriangleMeshPtr outside = box_mesh({2.0f, 2.0f, 2.0f}, 4);
    std::vector<TriangleMesh::Triangle> inwards(outside->triangles().begin(), outside->triangles().end());
    for (auto& t : inwards) std::swap(t[1], t[2]);
    const Shape room = *TriangleMesh::build(outside->vertices(), inwards), crate = box_mesh({0.5f, 0.5f, 0.5f}, 2);
    const std::vector<Manifold> m = collide_all(crate, {{1.501, -1.501, 0.2}}, room, {}, 0.01f);
    ASSERT_EQ(m.size(), 2u);
    for (const Manifold& x : m) {
        EXPECT_EQ(x.count, 4u);
        EXPECT_NEAR(least_separation(x), -0.001f, 1e-6f);
        EXPECT_NEAR(std::abs(x.normal.x) + std::abs(x.normal.y), 1.0f, 1e-5f);
    }
    EXPECT_NEAR(m[0].normal.x + m[1].normal.x, 1.0f, 1e-5f);
    // However deep: no way out of the whole takes the place of two that lead out together.
    const std::vector<Manifold> deep = collide_all(crate, {{1.6, -1.6, 0.2}}, room, {}, 0.01f);
    ASSERT_EQ(deep.size(), 2u);
    for (const Manifold& x : deep) {
        EXPECT_NEAR(least_separation(x), -0.1f, 1e-6f);
        EXPECT_NEAR(std::abs(x.normal.x) + std::abs(x.normal.y), 1.0f, 1e-5f);
    }
}

// Surfaces of hulls: apart as far as the hulls, with their normal; a little overlapping, as deep as the hulls.
TEST(MeshMesh, SurfacesOfHullsAreAsFarAsTheHulls) {
    Random r(4);
    int near = 0, shallow = 0, agree = 0;
    for (int i = 0; i < 2500; ++i) {
        const ConvexHullPtr p = random_hull(r, 16, 0.4, 0.8), q = random_hull(r, 24, 0.3, 0.6);
        // Of the second kind contacts are those of triangles.
        const Shape solid_p = p, solid_q = q, surface_p = surface_of(*p), surface_q = i % 2 == 0 ? surface_of(*q) : seeded_surface_of(*q);
        const Pose pose{random_direction(r) * r.range(0.5, 1.4), random_rotation(r)};
        const std::vector<Manifold> s = collide_all(solid_p, pose, solid_q, {}, 0.1f), m = collide_all(surface_p, pose, surface_q, {}, 0.1f);
        if (s.empty()) {
            EXPECT_TRUE(m.empty()) << i;
        } else if (least_separation(s[0]) > 1e-5f) {
            ++near;
            ASSERT_FALSE(m.empty()) << i;
            EXPECT_NEAR(least_separation(m[0]), least_separation(s[0]), 3e-6f) << i;
            EXPECT_GT(glm::dot(dvec3(m[0].normal), dvec3(s[0].normal)), 1.0 - 1e-5) << i;
        } else if (least_separation(s[0]) > -0.03f && least_separation(s[0]) < 0.0f) {
            ++shallow;
            ASSERT_FALSE(m.empty()) << i;
            // Every manifold leads out, and the deepest is about as deep as the solids.
            float deepest = 0.0f;
            for (const Manifold& x : m) {
                deepest = std::min(deepest, least_separation(x));
                if (least_separation(x) >= 0.0f) continue;
                EXPECT_GT(glm::dot(dvec3(x.normal), dvec3(s[0].normal)), 0.0) << i;
            }
            EXPECT_LT(deepest, 0.5f * least_separation(s[0])) << i;
            EXPECT_GT(deepest, 3.0f * least_separation(s[0]) - 0.01f) << i;
            agree += std::abs(deepest - least_separation(s[0])) < 1e-5f;
        }
    }
    EXPECT_GT(near, 100);
    EXPECT_GT(shallow, 60);
    EXPECT_GT(agree, shallow * 8 / 10) << shallow;
}

// Deeper than triangles are large: one way out of the whole, about as long as that of the solids, and it does lead out.
TEST(MeshMesh, DeepInEachOtherAWayOutOfTheWholeIsFound) {
    Random r(9);
    int deep = 0, held = 0;
    double sum = 0.0;
    for (int i = 0; i < 600; ++i) {
        const ConvexHullPtr p = random_hull(r, 32, 0.4, 0.9), q = random_hull(r, 24, 0.3, 0.8);
        const TriangleMeshPtr mesh_p = seeded_surface_of(*p), mesh_q = seeded_surface_of(*q);
        const Shape solid_p = p, solid_q = q, surface_p = mesh_p, surface_q = mesh_q;
        Pose pose{random_direction(r) * r.range(1.2, 1.6), random_rotation(r)};
        const std::vector<Manifold> apart = collide_all(solid_p, pose, solid_q, {}, 2.0f);
        ASSERT_EQ(apart.size(), 1u);
        pose.position += (static_cast<double>(least_separation(apart[0])) + r.range(0.05, 0.15)) * dvec3(apart[0].normal);
        const std::vector<Manifold> s = collide_all(solid_p, pose, solid_q, {}, 0.0f), m = collide_all(surface_p, pose, surface_q, {}, 0.0f);
        ASSERT_FALSE(s.empty()) << i;
        ASSERT_FALSE(m.empty()) << i;
        const double truth = static_cast<double>(least_separation(s[0])), found = static_cast<double>(least_separation(m[0]));
        EXPECT_LT(found, 0.9 * truth) << i;
        EXPECT_GT(found, 1.5 * truth) << i;
        ++deep;
        sum += std::abs(found - truth);
        Pose out = pose;
        out.position += (found - 1e-4) * dvec3(m[0].normal);
        held += meshes_overlap(mesh_q->bvh(), mesh_p->bvh(), out);
    }
    EXPECT_LT(sum / deep, 2e-3);
    EXPECT_LT(held, deep / 50);
}

// A crate that lies deep in a flat surface lies on all its corners, however deep: on one alone it would tip.
TEST(MeshMesh, DeepInAFlatSurfaceACrateStandsOnFourCorners) {
    std::vector<vec3> grid;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    constexpr std::uint32_t kCells = 20;
    for (std::uint32_t i = 0; i <= kCells; ++i) {
        for (std::uint32_t j = 0; j <= kCells; ++j) grid.push_back({0.5f * static_cast<float>(i) - 5.0f, 0.0f, 0.5f * static_cast<float>(j) - 5.0f});
    }
    for (std::uint32_t i = 0; i < kCells; ++i) {
        for (std::uint32_t j = 0; j < kCells; ++j) {
            const std::uint32_t a = i * (kCells + 1) + j, b = a + kCells + 1;
            triangles.push_back({a, a + 1, b + 1});
            triangles.push_back({a, b + 1, b});
        }
    }
    const Shape ground = *TriangleMesh::build(grid, triangles), crate = box_mesh({0.2f, 0.2f, 0.2f}, 2);
    for (const double depth : {0.005, 0.01, 0.05, 0.11}) {
        std::size_t points = 0;
        for (const Manifold& m : collide_all(crate, {{0.06, 0.2 - depth, 0.07}}, ground, {}, 0.01f)) {
            EXPECT_LT(m.normal.y, -0.999f);
            for (const ContactPoint& point : m.used()) EXPECT_NEAR(static_cast<double>(point.separation), -depth, 1e-5);
            points += m.count;
        }
        EXPECT_EQ(points, 4u) << depth;
    }
}

TEST(MeshMesh, InsideOfAClosedMeshIsLedOutAndSaidToBeUndecided) {
    // Beside the outer one stands another box, so that together they are no convex solid.
    const TriangleMeshPtr large = box_mesh({1.0f, 1.0f, 1.0f}, 3), small = box_mesh({0.1f, 0.1f, 0.1f}, 1);
    const Shape outer = joined({{large}, {small, {2.0f, 0.0f, 0.0f}}}), inner = small;
    std::vector<Manifold> out;
    const ShapePair pair{&inner, &outer, {{0.3, 0.1, 0.05}}, {}, 0.01f};
    EXPECT_EQ(collide(pair, 0, out), CollideStatus::Undecided);
    ASSERT_EQ(out.size(), 1u);
    EXPECT_LT(least_separation(out[0]), -0.5f);
    EXPECT_NEAR(glm::length(dvec3(out[0].normal)), 1.0, 1e-6);
    // A surface that is open encloses nothing.
    const Shape ground = flat_ground();
    EXPECT_TRUE(collide_all(inner, {{0.3, -0.5, 0.05}}, ground, {}, 0.01f).empty());
}

TEST(MeshMesh, AnOpenMeshHasTwoSidesForWhatIsSmall) {
    const Shape ground = flat_ground(), crate = box_mesh({0.5f, 0.5f, 0.5f}, 1);
    for (const double side : {1.0, -1.0}) {
        const std::vector<Manifold> m = collide_all(crate, {{0.1, side * 0.499, 0.2}}, ground, {}, 0.01f);
        ASSERT_EQ(m.size(), 1u);
        EXPECT_NEAR(m[0].normal.y, static_cast<float>(-side), 1e-6f);
        EXPECT_NEAR(least_separation(m[0]), -0.001f, 1e-6f);
    }
}

// Every second triangle wound the other way round, a crack along each row, and corners in the middle of neighbours' edges.
TEST(MeshMesh, DefectsOfTheGroundDoNotSwallowABox) {
    std::vector<vec3> v;
    std::vector<TriangleMesh::Triangle> t;
    for (int row = -8; row < 8; ++row) {
        for (int k = -8; k < 8; ++k) {
            const float x = 0.125f * (static_cast<float>(k) + (row % 2 == 0 ? 0.5f : 0.0f)), z = 0.125f * static_cast<float>(row);
            const auto base = static_cast<std::uint32_t>(v.size());
            for (const vec3& p : {vec3{x, 0, z + 1e-4f}, vec3{x, 0, z + 0.125f}, vec3{x + 0.125f, 0, z + 0.125f}, vec3{x + 0.125f, 0, z + 1e-4f}}) v.push_back(p);
            t.push_back({base, base + 1, base + 2});
            t.push_back(k % 2 == 0 ? TriangleMesh::Triangle{base, base + 2, base + 3} : TriangleMesh::Triangle{base, base + 3, base + 2});
        }
    }
    const TriangleMeshPtr broken = *TriangleMesh::build(v, t);
    EXPECT_FALSE(broken->is_oriented());
    const Shape ground = broken, crate = box_mesh({0.3f, 0.25f, 0.3f}, 1);
    Random r(7);
    for (int i = 0; i < 50; ++i) {
        const std::vector<Manifold> m = collide_all(crate, {{r.range(-0.3, 0.3), 0.2495, r.range(-0.3, 0.3)}, about({0, 1, 0}, r.range(0, 6))}, ground, {}, 0.005f);
        ASSERT_FALSE(m.empty());
        EXPECT_NEAR(m[0].normal.y, -1.0f, 1e-5f) << i;
        EXPECT_NEAR(least_separation(m[0]), -0.0005f, 1e-6f) << i;
        EXPECT_GE(m[0].count, 3u);
    }
}

// A dish whose bottom has a ring that is lower than its rim: that rests on the ring, not on the rim, however much more area the rim spans.
TEST(MeshMesh, WhatIsNotFlatRestsOnWhatIsLowest) {
    std::vector<vec3> vertices{{0, 0.01f, 0}};
    std::vector<TriangleMesh::Triangle> triangles;
    constexpr std::uint32_t kRound = 24;
    const float radii[] = {0.1f, 0.15f}, heights[] = {0.0f, 0.006f};
    for (int ring = 0; ring < 2; ++ring) {
        for (std::uint32_t k = 0; k < kRound; ++k) {
            const auto angle = static_cast<float>(2.0 * kPi * k / kRound);
            vertices.push_back({radii[ring] * std::cos(angle), heights[ring], radii[ring] * std::sin(angle)});
        }
    }
    vertices.push_back({0, 0.2f, 0});
    for (std::uint32_t k = 0; k < kRound; ++k) {
        const std::uint32_t n = (k + 1) % kRound, a = 1 + k, b = 1 + n, c = a + kRound, d = b + kRound;
        for (const TriangleMesh::Triangle& t : {TriangleMesh::Triangle{0, a, b}, {a, c, d}, {a, d, b}, {c, 2 * kRound + 1, d}}) triangles.push_back(t);
    }
    const TriangleMeshPtr dish = *TriangleMesh::build(vertices, triangles);
    ASSERT_TRUE(dish->is_closed());
    ASSERT_EQ(dish->solid(), nullptr);
    const std::vector<vec3> square{{-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}};
    const Shape shape = dish, ground = *TriangleMesh::build(square, std::vector<TriangleMesh::Triangle>{{0, 1, 2}, {0, 2, 3}});
    for (const double lean : {0.0, 1e-4, 2e-3}) {
        const std::vector<Manifold> m = collide_all(shape, {{0, 0.1 * lean, 0}, about({1, 0, 0.3}, lean)}, ground, {}, 0.02f);
        ASSERT_EQ(m.size(), 1u) << lean;
        EXPECT_EQ(m[0].count, 4u);
        dvec3 low{1.0}, high{-1.0};
        for (const ContactPoint& p : m[0].used()) {
            EXPECT_LT(std::abs(p.separation), 2.0f * 0.1f * static_cast<float>(lean) + 1e-5f) << lean << ": on the ring";
            low = glm::min(low, dvec3(p.position));
            high = glm::max(high, dvec3(p.position));
        }
        EXPECT_GT(high.x - low.x, 0.15) << lean;
        EXPECT_GT(high.z - low.z, 0.15) << lean;
    }
}

// A spout in a handle touches the handle, not the pot that the handle belongs to.
TEST(MeshMesh, TeapotsTouchWhereTheirTrianglesAreNearest) {
    const Result<MeshData> data = teapot(1.0, 0.01);
    const TriangleMeshPtr pot = *TriangleMesh::build(data->vertices, data->triangles);
    const Shape shape = pot;
    Random r(8);
    int near = 0;
    std::vector<TrianglePair> pairs;
    for (int i = 0; i < 400; ++i) {
        const Pose pose{dvec3{r.range(-0.9, 0.9), r.range(-0.5, 0.5), r.range(-0.9, 0.9)}, random_rotation(r)};
        if (meshes_overlap(pot->bvh(), pot->bvh(), pose)) continue;
        // The least distance of two triangles, from all that may be near.
        near_pairs(pot->bvh(), pot->bvh(), pose, 0.03, pairs);
        double least = 0.03;
        for (const TrianglePair& pair : pairs) {
            const auto a = pot->corners(pair.a), b = pot->corners(pair.b);
            geo::Triangle<double> x{dvec3(a[0]), dvec3(a[1]), dvec3(a[2])};
            geo::Triangle<double> y{transform_point(pose, dvec3(b[0])), transform_point(pose, dvec3(b[1])), transform_point(pose, dvec3(b[2]))};
            least = std::min(least, std::sqrt(geo::closest_points(x, y).distance_sq));
        }
        const std::vector<Manifold> m = collide_all(shape, {}, shape, pose, 0.03f);
        if (least == 0.03) {
            EXPECT_TRUE(m.empty()) << i;
            continue;
        }
        ++near;
        ASSERT_FALSE(m.empty()) << i;
        EXPECT_NEAR(static_cast<double>(least_separation(m[0])), least, 2e-6) << i;
    }
    EXPECT_GT(near, 20);
}

}  // namespace
}  // namespace carom
