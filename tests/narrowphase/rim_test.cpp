// Capsules beside the open edge of a mesh, exactly square to its triangles or in their plane, where edges have nothing to offer but their sides.
#include "oracle.hpp"

#include <carom/collision/triangle_mesh.hpp>

#include <gtest/gtest.h>

namespace carom {
namespace {

using namespace test;

const Shape& floor_mesh() {  // z in [0, 1], x >= 0
    static const Shape mesh = *TriangleMesh::build(std::vector<vec3>{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 0, 1}},
                                                   std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {2, 1, 3}});
    return mesh;
}

Manifold only_manifold(const Capsule& capsule, const Pose& pose) {
    const auto found = collide_all(capsule, pose, floor_mesh(), {}, 0.0f);
    EXPECT_EQ(found.size(), 1u);
    return found.empty() ? Manifold{} : found[0];
}

TEST(Rim, AnUprightCapsuleBesideAnEdgeIsPushedAway) {
    for (const double tilt : {0.0, 1e-12, -1e-12, 1e-9, 1e-6}) {
        const Pose pose{{-0.25, 0.05, 0.3}, about({0, 0, 1}, tilt)};
        const Manifold m = only_manifold({.radius = 0.3f, .half_segment = 0.2f}, pose);
        EXPECT_NEAR(m.normal.x, 1.0, 1e-5) << tilt;
        EXPECT_NEAR(least_separation(m), -0.05, 1e-6) << tilt;
    }
}

TEST(Rim, ACapsuleInThePlaneBesideAnEdgeIsPushedAway) {
    for (const double height : {0.0, 1e-12, 1e-9, -1e-9, 1e-7}) {
        const Pose pose{{-0.25, height, 0.5}, about({1, 0, 0}, 0.5 * 3.14159265358979323846)};
        const Manifold m = only_manifold({.radius = 0.3f, .half_segment = 0.2f}, pose);
        EXPECT_NEAR(m.normal.x, 1.0, 1e-5) << height;
        EXPECT_NEAR(least_separation(m), -0.05, 1e-6) << height;
    }
}

TEST(Rim, ACapsuleThroughTheSurfaceLeavesByTheNearerWay) {
    for (const double tilt : {0.0, 1e-12, 1e-7}) {
        const Pose pose{{0.04, 0.05, 0.3}, about({0, 0, 1}, tilt)};  // 0.04 from the rim; its lower end is 0.15 below the floor
        const Manifold m = only_manifold({.radius = 0.3f, .half_segment = 0.2f}, pose);
        EXPECT_NEAR(m.normal.x, 1.0, 1e-5) << tilt;
        EXPECT_NEAR(least_separation(m), -0.34, 1e-5) << tilt;
    }
}

TEST(Rim, AnUprightCapsuleOverTheInsideStandsOnTheFace) {
    for (const double x : {0.05, 0.3, 0.5, 0.7}) {  // also over the edge that the two triangles share
        const Manifold m = only_manifold({.radius = 0.3f, .half_segment = 0.2f}, {{x, 0.49, 0.5}, kIdentityRotation});
        EXPECT_NEAR(m.normal.y, -1.0, 1e-6) << x;
        EXPECT_NEAR(least_separation(m), -0.01, 1e-6) << x;
    }
}

Solid solid_of_triangle(const std::array<vec3, 3>& corners) {
    Solid solid;
    for (const vec3& v : corners) solid.vertices.push_back(oracle::real(dvec3(v)));
    solid.triangles.push_back({solid.vertices[0], solid.vertices[1], solid.vertices[2]});
    const auto unit = [](const oracle::RealVec& v) { return v / oracle::length_of(v); };
    const oracle::RealVec normal = unit(glm::cross(solid.vertices[1] - solid.vertices[0], solid.vertices[2] - solid.vertices[0]));
    solid.normals = {normal, -normal};
    for (std::size_t k = 0; k < 3; ++k) {
        solid.edges.push_back(solid.vertices[(k + 1) % 3] - solid.vertices[k]);
        solid.normals.push_back(unit(glm::cross(solid.edges.back(), normal)));
    }
    return solid;
}

// A segment and a triangle that do not touch: their distance, whatever the angle between them.
TEST(Rim, SegmentsSquareToTrianglesOrInTheirPlaneHaveTheirTrueDistance) {
    Random r(0x417);
    for (int i = 0; i < 2000; ++i) {
        const Shape mesh = *TriangleMesh::build(std::vector<vec3>{{0, 0, 0}, {static_cast<float>(r.range(0.3, 1.0)), 0, 0}, {0, 0, static_cast<float>(r.range(0.3, 1.0))}},
                                                std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}});
        const double angle = r.range(0.0, 6.28);
        const dquat lying = about({0, 1, 0}, angle) * about({1, 0, 0}, 0.5 * 3.14159265358979323846);
        const Pose pose{{r.range(-0.8, 1.4), i % 2 == 0 ? r.range(-0.3, 0.3) : r.range(-1e-9, 1e-9), r.range(-0.8, 1.4)}, i % 2 == 0 ? kIdentityRotation : lying};
        const Capsule capsule{.radius = 0.25f, .half_segment = 0.2f};
        const dvec3 half = rotate(pose.orientation, dvec3{0.0, 0.2f, 0.0});
        const auto& mesh_ptr = std::get<TriangleMeshPtr>(mesh);
        const Solid triangle = solid_of_triangle(mesh_ptr->corners(0));
        const double distance = static_cast<double>(signed_distance(oracle::solid_of_segment(oracle::real(pose.position - half), oracle::real(pose.position + half)), triangle));
        if (distance < 1e-6) continue;  // the core touches
        const auto found = collide_all(capsule, pose, mesh, {}, 0.0f);
        if (std::abs(distance - 0.25) < 1e-6) continue;
        ASSERT_EQ(found.size(), distance < 0.25 ? 1u : 0u) << i << " distance " << distance;
        if (!found.empty()) {
            ASSERT_NEAR(least_separation(found[0]), distance - 0.25, 1e-6) << i;
        }
    }
}

}  // namespace
}  // namespace carom
