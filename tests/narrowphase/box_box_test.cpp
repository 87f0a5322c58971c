// Box against box: depth and axis against brute force, resting contacts, names that survive motion.
#include "oracle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace carom {
namespace {

using namespace test;

vec3 random_half(Random& r) {
    return {static_cast<float>(r.range(0.1, 1.0)), static_cast<float>(r.range(0.1, 1.0)), static_cast<float>(r.range(0.1, 1.0))};
}

// Poses of all sorts: free, almost aligned, faces on faces, deep.
Pose random_pose(Random& random, int kind) {
    Pose pose;
    pose.position = random_direction(random) * random.range(kind == 3 ? 0.0 : 0.3, kind == 3 ? 0.2 : 2.0);
    pose.orientation = random_rotation(random);
    if (kind == 1) pose.orientation = about(random_direction(random), random.range(-1e-6, 1e-6));
    if (kind == 2) pose.orientation = kIdentityRotation;
    return pose;
}

TEST(BoxBox, DepthIsTheLeastOverAllAxes) {
    Random random(20261122);
    const float margin = 0.05f;
    int touching = 0;
    for (int i = 0; i < 20000; ++i) {
        const Box a{random_half(random)}, b{random_half(random)};
        const Pose pa{random_direction(random) * 3.0, random_rotation(random)};
        const Pose local = random_pose(random, i % 4);
        const Pose pb = pa * local;
        const Separation truth = greatest_separation(solid_of(a, pa, pa.position), solid_of(b, pb, pa.position));
        const std::vector<Manifold> m = collide_all(a, pa, b, pb, margin);
        if (truth.value > Real(margin) + 1e-6L) {
            EXPECT_TRUE(m.empty()) << i;
        } else if (truth.value < 0) {
            ASSERT_EQ(m.size(), 1u) << i;
            ++touching;
            EXPECT_NEAR(static_cast<double>(truth.value), static_cast<double>(least_separation(m[0])), 2e-6) << i << " kind " << i % 4;
            const double length = std::sqrt(glm::dot(dvec3(m[0].normal), dvec3(m[0].normal)));
            EXPECT_NEAR(length, 1.0, 1e-6);
        }
    }
    EXPECT_GT(touching, 4000);
}

TEST(BoxBox, RestingFaceHasItsFourCorners) {
    const Shape ground = Box{{5.0f, 0.5f, 5.0f}};
    const Shape crate = Box{{0.5f, 0.25f, 0.375f}};
    const Pose pa{{0.0, -0.5, 0.0}, kIdentityRotation};
    const Pose pb{{1.0, 0.249, 2.0}, about({0, 1, 0}, 0.3)};
    const std::vector<Manifold> m = collide_all(ground, pa, crate, pb, 0.01f);
    ASSERT_EQ(m.size(), 1u);
    ASSERT_EQ(m[0].count, 4u);
    EXPECT_NEAR(m[0].normal.y, 1.0f, 1e-7f);
    std::set<std::uint64_t> names;
    for (const ContactPoint& p : m[0].used()) {
        EXPECT_NEAR(p.separation, -0.001f, 1e-7f);
        const dvec3 local = inverse_transform_point(pb, pa.position + dvec3(p.position));
        EXPECT_NEAR(std::abs(local.x), 0.5, 1e-6);
        EXPECT_NEAR(std::abs(local.z), 0.375, 1e-6);
        EXPECT_NEAR(p.position.y, 0.5f - 0.0005f, 1e-6f);
        names.insert(p.feature);
    }
    EXPECT_EQ(names.size(), 4u);
}

}  // namespace
}  // namespace carom
