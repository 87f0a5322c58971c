// Convex shapes deep in meshes: as deep as they are, however small the triangles; and whatever overlaps has a manifold.
#include "oracle.hpp"

#include <carom/collision/aabb.hpp>
#include <carom/collision/terrain.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/narrowphase/explain.hpp>
#include <carom/studies/oracle/hull_surface.hpp>

#include <gtest/gtest.h>

#include <functional>

namespace carom {
namespace {

using namespace test;
using oracle::seeded_surface_of;
using oracle::surface_of;

constexpr ShapeType kSolids[] = {ShapeType::Sphere,     ShapeType::Box,      ShapeType::Capsule,
                                 ShapeType::ConvexHull, ShapeType::Cylinder, ShapeType::Cone};

TriangleMeshPtr ground_of(int side, const std::function<double(double, double)>& height) {
    const MeshData data = height_grid(side, side, 16.0 / side, height);
    return *TriangleMesh::build(data.vertices, data.triangles);
}

// Triangles from forty times the shapes' size to a twentieth of it, and the ground at any angle.
TEST(MeshDepth, OnFlatGroundIsThatOfTheLowestPoint) {
    for (const int side : {1, 8, 32, 96, 256}) {
        const Shape ground = ground_of(side, [](double, double) { return 0.0; });
        for (const ShapeType type : kSolids) {
            Random r(600 + static_cast<std::uint64_t>(type));
            for (int i = 0; i < (side > 96 ? 300 : 1500); ++i) {
                const Shape shape = random_shape(type, r);
                const dquat turn = random_rotation(r), tilt = i % 2 == 0 ? kIdentityRotation : random_rotation(r);
                const Aabb box = bounds(shape, {dvec3{0.0}, turn});
                const dvec3 extent = box.upper - box.lower;
                const double size = std::max({extent.x, extent.y, extent.z}), depth = 0.2 * smallest_extent(shape) * r.unit();
                const Pose at{rotate(tilt, {r.range(-3.0, 3.0), -box.lower.y - depth, r.range(-3.0, 3.0)}), tilt * turn};
                const std::vector<Manifold> m = collide_all(shape, at, ground, {dvec3{0.0}, tilt}, i % 3 == 0 ? 0.02f : 0.0f);
                ASSERT_EQ(m.size(), 1u) << side << " " << to_string(type) << " " << i;
                EXPECT_NEAR(static_cast<double>(least_separation(m[0])), -depth, 1e-6 * size) << side << " " << to_string(type) << " " << i;
                EXPECT_LT(glm::length(dvec3(m[0].normal) + rotate(tilt, {0, 1, 0})), 1e-6) << side << " " << to_string(type) << " " << i;
            }
        }
    }
}

// A cone's tip under a triangle that the cone does not meet: it goes in beside the diagonal, under which it slants.
TEST(MeshDepth, ATipUnderTheNeighbourOfWhatItMeetsCounts) {
    const Shape ground = ground_of(1, [](double, double) { return 0.0; }), cone = Cone{0.1f, 0.4f};
    const dquat turn = about({1, 0, -1}, kPi - 0.6);
    const dvec3 tip = rotate(turn, {0, static_cast<double>(0.4f), 0});
    for (const double side : {1.0, -1.0}) {
        const dquat facing = about({0, 1, 0}, side > 0 ? 0.0 : kPi);
        const Pose at{dvec3{0, -0.05, 0} - rotate(facing, tip) - 1e-3 * rotate(facing, {1, 0, 1}), facing * turn};
        const std::vector<Manifold> m = collide_all(cone, at, ground, {}, 0.0f);
        ASSERT_EQ(m.size(), 1u);
        EXPECT_NEAR(least_separation(m[0]), -0.05f, 1e-6f);
    }
}

// A tilted box has an edge deep in the ground between small triangles, and a spike a little way in its bottom: both push.
TEST(MeshDepth, AShallowSpikeDoesNotHideADeepEdge) {
    const auto spike = [](double x, double z) { return std::abs(x - 0.3125) < 1e-3 && std::abs(z) < 1e-3 ? 0.2 : 0.0; };
    const Shape ground = ground_of(256, spike), box = Box{{0.5f, 0.25f, 0.47f}};
    const dquat turn = about({0, 0, 1}, 0.4);
    const double lowest = bounds(box, {dvec3{0.0}, turn}).lower.y;
    const std::vector<Manifold> m = collide_all(box, {{0.0, -lowest - 0.1, 0.0}, turn}, ground, {}, 0.0f);
    ASSERT_GE(m.size(), 2u);
    EXPECT_NEAR(least_separation(m[0]), -0.1f, 1e-6f);
    EXPECT_NEAR(m[0].normal.y, -1.0f, 1e-6f);
    const bool pushes = std::ranges::any_of(m, [&](const Manifold& x) { return least_separation(x) > -0.02f && x.normal.x > 0.1f; });
    EXPECT_TRUE(pushes) << "along the box's own face";
}

// Beside the border of a triangle of 1,000 m a cylinder is nearer to the way out over the border than to the way up, by 0.5 mm.
TEST(MeshDepth, OfAHugeTriangleTheSizeOfTheShapeCounts) {
    const std::vector<vec3> corners{{0, 0, -700}, {-1000, 0, 0}, {0, 0, 700}};
    const std::vector<TriangleMesh::Triangle> triangles{{0, 1, 2}};
    const Shape ground = *TriangleMesh::build(corners, triangles), cylinder = Cylinder{0.25f, 0.25f};
    const std::vector<Manifold> m = collide_all(cylinder, {{0.25 - 0.0495, 0.25 - 0.05, 3.0}, kIdentityRotation}, ground, {}, 0.0f);
    ASSERT_EQ(m.size(), 1u);
    EXPECT_NEAR(least_separation(m[0]), -0.0495f, 5e-7f);
    EXPECT_NEAR(m[0].normal.x, -1.0f, 1e-5f);
}

// Triangles beside the contact, which it frees too, do not ask for more.
TEST(MeshDepth, ALittleWayInABallItIsThatOfTheSolid) {
    Random r(77);
    double sum = 0.0;
    int deeper = 0;
    constexpr int kPairs = 2000;
    for (int i = 0; i < kPairs; ++i) {
        const ConvexHullPtr hull = random_hull(r, 32, 0.4, 0.9);
        const Shape solid = hull, surface = seeded_surface_of(*hull), other = random_hull(r, 24, 0.3, 0.8);
        Pose at{random_direction(r) * r.range(1.2, 1.6), random_rotation(r)};
        const std::vector<Manifold> apart = collide_all(other, at, solid, {}, 2.0f);
        ASSERT_EQ(apart.size(), 1u);
        at.position += (static_cast<double>(least_separation(apart[0])) + 0.01 * r.unit()) * dvec3(apart[0].normal);
        const std::vector<Manifold> s = collide_all(other, at, solid, {}, 0.0f), m = collide_all(other, at, surface, {}, 0.0f);
        if (s.empty()) continue;
        ASSERT_FALSE(m.empty()) << i;
        const double error = std::abs(static_cast<double>(least_separation(m[0])) - static_cast<double>(least_separation(s[0])));
        sum += error;
        deeper += error > 1e-5 ? 1 : 0;
    }
    EXPECT_LT(sum / kPairs, 5e-5);
    EXPECT_LT(deeper, kPairs / 10);
}

// Deep in a surface each triangle has a way out of its own; what counts is the shortest after which the shape is free of all.
TEST(MeshDepth, DeepInABallItIsThatOfTheSolid) {
    Random r(78);
    double sum = 0.0;
    int deep = 0, wrong = 0;
    for (int i = 0; i < 2000; ++i) {
        const ConvexHullPtr hull = random_hull(r, 32, 0.4, 0.9);
        const Shape solid = hull, surface = seeded_surface_of(*hull), other = random_hull(r, 24, 0.3, 0.8);
        Pose at{random_direction(r) * r.range(1.2, 1.6), random_rotation(r)};
        const std::vector<Manifold> apart = collide_all(other, at, solid, {}, 2.0f);
        ASSERT_EQ(apart.size(), 1u);
        at.position += (static_cast<double>(least_separation(apart[0])) + r.range(0.01, 0.15)) * dvec3(apart[0].normal);
        const std::vector<Manifold> s = collide_all(other, at, solid, {}, 0.0f), m = collide_all(other, at, surface, {}, 0.0f);
        if (s.empty()) continue;
        ASSERT_FALSE(m.empty()) << i;
        const double error = static_cast<double>(least_separation(s[0])) - static_cast<double>(least_separation(m[0]));
        EXPECT_GT(error, -2e-6) << i << ": never shallower";
        ++deep;
        sum += std::abs(error);
        wrong += error > 1e-3 ? 1 : 0;
    }
    EXPECT_GT(deep, 1900);
    EXPECT_LT(sum / deep, 3e-4);   // 1.6e-3 where each triangle speaks for itself
    EXPECT_LT(wrong, deep / 40);  // a seventh
}

// Each wall of a valley is in the way of the other's way out: both push.
TEST(MeshDepth, DeepInAValleyBothWallsPush) {
    const Shape valley = ground_of(64, [](double x, double) { return std::abs(x); }), box = Box{{0.3f, 0.3f, 0.3f}};
    const dquat turn = about({0, 0, 1}, 0.25 * kPi);
    const double drop = 0.1;  // below where its lower edge lies in the bottom
    const std::vector<Manifold> m = collide_all(box, {{0.0, 0.3 * std::sqrt(2.0) - drop, 0.0}, turn}, valley, {}, 0.0f);
    ASSERT_EQ(m.size(), 2u);
    for (const Manifold& x : m) {
        EXPECT_NEAR(least_separation(x), -static_cast<float>(drop / std::sqrt(2.0)), 1e-5f);
        EXPECT_NEAR(std::abs(x.normal.x), std::sqrt(0.5f), 1e-4f);
    }
    EXPECT_NEAR(m[0].normal.x + m[1].normal.x, 0.0f, 1e-4f);
}

// Both judged without the kernels of meshes: explain() looks at each triangle by itself.
void expect_reported(const Shape& shape, const Pose& at, const Shape& mesh, int i) {
    const PairExplanation why = explain({&shape, &mesh, at, {}, 0.1f});
    const auto name = [&] { return testing::Message() << to_string(type_of(shape)) << " " << i << ", gap " << why.axis->gap; };
    EXPECT_EQ(why.disagreement, "") << name();
    if (why.verdict != PairVerdict::Touching) return;
    ASSERT_FALSE(why.manifolds.empty()) << name();
    float deepest = 1.0f;
    for (const Manifold& m : why.manifolds) {
        ASSERT_GE(m.count, 1u) << name();
        EXPECT_NEAR(glm::length(dvec3(m.normal)), 1.0, 1e-6) << name();
        for (const ContactPoint& p : m.used()) ASSERT_TRUE(is_finite(dvec3(p.position)) && std::isfinite(p.separation)) << name();
        deepest = std::min(deepest, least_separation(m));
    }
    EXPECT_LE(deepest, 0.0f) << name();
}

TEST(MeshDepth, WhateverOverlapsABallOfItsSizeHasAManifold) {
    for (const ShapeType type : kSolids) {
        Random r(700 + static_cast<std::uint64_t>(type));
        for (int i = 0; i < 2000; ++i) {
            const ConvexHullPtr hull = random_hull(r, 12 + 30 * (i % 4), 0.4, 0.9);
            const Shape ball = i % 3 == 0 ? surface_of(*hull) : seeded_surface_of(*hull), shape = random_shape(type, r);
            expect_reported(shape, {random_direction(r) * r.range(0.0, 1.6), random_rotation(r)}, ball, i);
        }
    }
}

TEST(MeshDepth, WhateverOverlapsBumpyGroundHasAManifold) {
    const Shape ground = ground_of(40, [](double x, double z) { return 0.5 * std::sin(2.0 * x) * std::cos(3.0 * z + 1.0); });
    for (const ShapeType type : kSolids) {
        Random r(800 + static_cast<std::uint64_t>(type));
        for (int i = 0; i < 1000; ++i) {
            const dvec3 at{r.range(-6.0, 6.0), r.range(-1.0, 1.0), r.range(-6.0, 6.0)};
            expect_reported(random_shape(type, r), {at, random_rotation(r)}, ground, i);
        }
    }
}

}  // namespace
}  // namespace carom
