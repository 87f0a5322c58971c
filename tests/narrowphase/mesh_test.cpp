// Convex shapes on triangle meshes: resting, rolling over inner edges, ridges and steps, huge triangles.
#include "oracle.hpp"
#include "standing.hpp"

#include <carom/collision/triangle_mesh.hpp>
#include <carom/studies/oracle/hull_surface.hpp>

#include <gtest/gtest.h>

#include <set>

namespace carom {
namespace {

using namespace test;

// n x n quads of edge `cell`, centred, y = height(x, z), counter-clockwise from above.
template <class Height>
TriangleMeshPtr grid(int n, double cell, const Height& height) {
    std::vector<vec3> vertices;
    for (int i = 0; i <= n; ++i) {
        for (int k = 0; k <= n; ++k) {
            const double x = (i - 0.5 * n) * cell, z = (k - 0.5 * n) * cell;
            vertices.push_back(vec3(dvec3{x, height(x, z), z}));
        }
    }
    std::vector<TriangleMesh::Triangle> triangles;
    const auto at = [n](int i, int k) { return static_cast<std::uint32_t>(i * (n + 1) + k); };
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) {
            triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k + 1)});
            triangles.push_back({at(i, k), at(i + 1, k + 1), at(i + 1, k)});
        }
    }
    return *TriangleMesh::build(vertices, triangles);
}

TriangleMeshPtr flat(int n, double cell) {
    return grid(n, cell, [](double, double) { return 0.0; });
}

TEST(Mesh, BoxOnManyTrianglesRestsOnItsFourCorners) {
    const Shape ground = flat(16, 0.125);
    const Shape crate = Box{{0.5f, 0.25f, 0.375f}};
    Random r(1);
    for (int i = 0; i < 50; ++i) {
        const Pose pose{{r.range(-0.2, 0.2), 0.249, r.range(-0.2, 0.2)}, about({0, 1, 0}, i == 0 ? 0.0 : r.range(0, 6))};
        const std::vector<Manifold> m = collide_all(crate, pose, ground, {}, 0.01f);
        expect_stands_on_corners(m, pose, 0.5, 0.375, -0.001f);
    }
}

TEST(Mesh, TiltedBoxTouchesAlongTheVertical) {
    const Shape ground = flat(16, 0.25);
    Random r(2);
    for (int i = 0; i < 300; ++i) {
        const Box box{{0.5f, 0.25f, 0.375f}};
        const dquat tilt = about(random_direction(r), r.range(-0.3, 0.3)) * about({0, 1, 0}, r.range(0, 6));
        // Lowest corner 5 mm under the ground.
        double lowest = 0.0;
        for (const vec3& c : corners_of(box)) lowest = std::min(lowest, rotate(tilt, dvec3(c)).y);
        const Pose pose{{r.range(-0.5, 0.5), -lowest - 0.005, r.range(-0.5, 0.5)}, tilt};
        const std::vector<Manifold> m = collide_all(Shape{box}, pose, ground, {}, 0.01f);
        ASSERT_EQ(m.size(), 1u) << i;
        EXPECT_LT(m[0].normal.y, -1.0f + 1e-5f) << i;
        EXPECT_NEAR(least_separation(m[0]), -0.005f, 2e-6f) << i;
    }
}

// The four chosen of the rim's sixteen corners, whatever triangles lie under it, and under the same names a little farther on.
TEST(Mesh, ACylinderOnManyTrianglesRestsOnItsRim) {
    const Shape ground = flat(16, 0.125);
    Random r(11);
    for (const Shape& shape : {Shape{Cylinder{0.5f, 0.25f}}, Shape{Cone{0.5f, 0.25f}}}) {
        for (int i = 0; i < 50; ++i) {
            const Pose pose{{r.range(-0.2, 0.2), 0.249, r.range(-0.2, 0.2)}, about({0, 1, 0}, i == 0 ? 0.0 : r.range(0, 6))};
            const std::vector<Manifold> m = collide_all(shape, pose, ground, {}, 0.01f);
            ASSERT_EQ(m.size(), 1u) << i;
            ASSERT_EQ(m[0].count, 4u) << i;
            EXPECT_NEAR(m[0].normal.y, -1.0f, 1e-6f);
            for (const ContactPoint& p : m[0].used()) {
                EXPECT_NEAR(p.separation, -0.001f, 1e-6f);
                EXPECT_GT(std::hypot(p.position.x, p.position.z), 0.48f);
                EXPECT_LT(std::hypot(p.position.x, p.position.z), 0.5f + 1e-5f);
            }
        }
    }
}

TEST(Mesh, RoundShapesRollOverInnerEdges) {
    const Shape ground = flat(16, 0.25);
    const Shape ball = Sphere{0.3f};
    const Shape roll = Capsule{0.3f, 0.5f}, drum = Cylinder{0.3f, 0.5f};
    for (int i = 0; i < 400; ++i) {
        const Pose pose{{-1.0 + i * 0.005, 0.299, -0.3 + i * 0.0017}, about({1, 0, 1}, 0.5 * kPi)};
        for (const Shape* shape : {&ball, &roll, &drum}) {
            const std::vector<Manifold> m = collide_all(*shape, pose, ground, {}, 0.02f);
            ASSERT_EQ(m.size(), 1u) << i << " " << to_string(type_of(*shape));
            // A corner of the mesh beside the drum's line, and as deep to 1e-6, may come along.
            if (shape == &drum) {
                EXPECT_GE(m[0].count, 2u) << i;
            } else {
                EXPECT_EQ(m[0].count, shape == &ball ? 1u : 2u) << i;
            }
            EXPECT_LT(m[0].normal.y, -1.0f + 1e-6f);
            EXPECT_NEAR(least_separation(m[0]), -0.001f, 1e-6f);
        }
    }
}

TEST(Mesh, SphereDistanceIsThatOfAllTriangles) {
    const TriangleMeshPtr bumps = grid(12, 0.3, [](double x, double z) { return 0.4 * std::sin(3 * x) * std::cos(4 * z + 1); });
    const Shape ground = bumps;
    Random r(3);
    int touching = 0;
    for (int i = 0; i < 2000; ++i) {
        const double radius = static_cast<double>(static_cast<float>(r.range(0.05, 0.4)));
        const Pose pose{{r.range(-1.5, 1.5), r.range(-0.6, 1.0), r.range(-1.5, 1.5)}, random_rotation(r)};
        Real distance = 1e30L;
        for (std::uint32_t t = 0; t < bumps->triangles().size(); ++t) {
            const auto c = bumps->corners(t);
            distance = std::min(distance, distance_to_triangle({real(dvec3(c[0])), real(dvec3(c[1])), real(dvec3(c[2]))}, real(pose.position)));
        }
        const double truth = static_cast<double>(distance) - radius;
        const std::vector<Manifold> m = collide_all(Sphere{static_cast<float>(radius)}, pose, ground, {}, 0.02f);
        if (truth > 0.02 + 1e-6) {
            EXPECT_TRUE(m.empty());
        } else if (truth < 0.02 - 1e-6) {
            ++touching;
            ASSERT_FALSE(m.empty()) << i;
            EXPECT_NEAR(static_cast<double>(least_separation(m[0])), truth, 1e-6) << i;
        }
    }
    EXPECT_GT(touching, 300);
}

TEST(Mesh, RidgesPushOutwardsAndStepsSideways) {
    // A step: treads at y = 0 (x < 0) and y = 1 (x > 0), riser between.
    const std::vector<vec3> v = {{-4, 0, -4}, {-4, 0, 4}, {0, 0, -4}, {0, 0, 4}, {0, 1, -4}, {0, 1, 4}, {4, 1, -4}, {4, 1, 4}};
    const std::vector<TriangleMesh::Triangle> t = {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}, {4, 5, 7}, {4, 7, 6}};
    const Shape step = *TriangleMesh::build(v, t);
    const Shape crate = Box{{0.5f, 0.75f, 0.5f}};
    // In front of the riser, 1 mm into it, clear of the tread, its face reaching above the upper tread.
    std::vector<Manifold> m = collide_all(crate, {{-0.499, 0.8, 0.1}, kIdentityRotation}, step, {}, 0.01f);
    ASSERT_EQ(m.size(), 1u);
    EXPECT_NEAR(m[0].normal.x, 1.0f, 1e-6f);
    EXPECT_NEAR(least_separation(m[0]), -0.001f, 1e-6f);
    // Standing in the corner: one manifold for the tread, one for the riser.
    m = collide_all(crate, {{-0.499, 0.749, 0.1}, kIdentityRotation}, step, {}, 0.01f);
    ASSERT_EQ(m.size(), 2u);
    // On the ridge of the step, tilted by 45 degrees: the ridge pushes along the box's own face.
    const dquat tilt = about({0, 0, 1}, 0.25 * kPi);
    const dvec3 up = rotate(tilt, dvec3{0, 1, 0});
    m = collide_all(crate, {dvec3{0, 1, 0} + 0.749 * up, tilt}, step, {}, 0.01f);
    ASSERT_EQ(m.size(), 1u);
    EXPECT_EQ(m[0].count, 2u);
    EXPECT_NEAR(glm::dot(dvec3(m[0].normal), up), -1.0, 1e-6);
    EXPECT_NEAR(least_separation(m[0]), -0.001f, 1e-6f);
}

TEST(Mesh, HugeTriangleUnderTinyShapes) {
    const std::vector<vec3> v = {{-1000, 0, -1000}, {0, 0, 1500}, {1200, 0, -900}};
    const std::vector<TriangleMesh::Triangle> t = {{0, 1, 2}};
    const Shape ground = *TriangleMesh::build(v, t);
    const Pose pose{{37.5, 0.0245, -211.0}, about({0, 1, 0}, 0.4)};
    const std::vector<Manifold> m = collide_all(Shape{Box{{0.025f, 0.025f, 0.025f}}}, pose, ground, {}, 0.001f);
    ASSERT_EQ(m.size(), 1u);
    EXPECT_EQ(m[0].count, 4u);
    for (const ContactPoint& p : m[0].used()) {
        EXPECT_NEAR(static_cast<double>(p.separation), 0.0245 - static_cast<double>(0.025f), 5e-7 * 0.05);
    }
}

TEST(Mesh, TheSurfaceOfAHullIsAsFarAsTheHull) {
    Random r(4);
    int near = 0, shallow = 0;
    for (int i = 0; i < 3000; ++i) {
        const ConvexHullPtr hull = random_hull(r, 16, 0.4, 0.8);
        const Shape solid = hull, surface = i % 4 == 0 ? oracle::surface_of(*hull) : oracle::seeded_surface_of(*hull);
        const Shape others[] = {Sphere{0.3f},        Box{{0.3f, 0.2f, 0.4f}},        Capsule{0.2f, 0.3f},
                                Cylinder{0.3f, 0.3f}, random_hull(r, 12, 0.3, 0.5), Cone{0.3f, 0.4f}};
        const Shape& other = others[i % 6];
        const Pose pose{random_direction(r) * r.range(0.6, 1.3), random_rotation(r)};
        const float margin = 0.1f;
        const std::vector<Manifold> s = collide_all(other, pose, solid, {}, margin), m = collide_all(other, pose, surface, {}, margin);
        if (s.empty()) {
            EXPECT_TRUE(m.empty()) << i;
        } else if (least_separation(s[0]) > 1e-5f) {
            ++near;
            ASSERT_FALSE(m.empty()) << i;
            // The leader is the nearest; its normal is that of the solid.
            EXPECT_NEAR(least_separation(m[0]), least_separation(s[0]), 3e-6f) << i << " " << to_string(type_of(other));
            EXPECT_GT(glm::dot(dvec3(m[0].normal), dvec3(s[0].normal)), 1.0 - 1e-5) << i << " " << to_string(type_of(other));
        } else if (least_separation(s[0]) > -0.05f && least_separation(s[0]) < 0.0f) {
            ++shallow;
            // A shape a little way into a sharp ridge is pushed out, by all manifolds, and not from far.
            ASSERT_FALSE(m.empty()) << i;
            for (const Manifold& x : m) {
                EXPECT_GT(least_separation(x), 3.0f * least_separation(s[0]) - 0.01f) << i << " " << to_string(type_of(other));
                if (least_separation(x) > 0.0f) continue;
                EXPECT_GT(glm::dot(dvec3(x.normal), dvec3(s[0].normal)), 0.0) << i << " " << to_string(type_of(other));
            }
        }
    }
    EXPECT_GT(near, 100);
    EXPECT_GT(shallow, 100);
}

TEST(Mesh, PushesToTheSideOfTheCentre) {
    const Shape ground = flat(4, 1.0);
    for (const double side : {1.0, -1.0}) {
        const std::vector<Manifold> m = collide_all(Shape{Box{{0.5f, 0.5f, 0.5f}}}, {{0.1, side * 0.4, 0.2}, kIdentityRotation}, ground, {}, 0.0f);
        ASSERT_EQ(m.size(), 1u);
        EXPECT_NEAR(m[0].normal.y, static_cast<float>(-side), 1e-6f);
    }
}

}  // namespace
}  // namespace carom
