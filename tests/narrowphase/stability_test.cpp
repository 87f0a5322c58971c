// What a solver relies on: names that survive motion, points on both surfaces, boxes that are hulls, edges that are nearly parallel.
#include "oracle.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace carom {
namespace {

using namespace test;

std::map<std::uint64_t, vec3> names_of(const std::vector<Manifold>& m) {
    std::map<std::uint64_t, vec3> names;
    for (const Manifold& x : m) {
        for (const ContactPoint& p : x.used()) names[p.feature] = p.position;
    }
    return names;
}

// Faces of `b` on the upper face of the box `a`, turned by `yaw`.
Pose resting(double half_a, double half_b, double x, double z, double yaw) {
    return {{x, half_a + half_b - 0.001, z}, about({0, 1, 0}, yaw)};
}

TEST(Stability, NamesSurviveSmallMotion) {
    Random r(21);
    for (int i = 0; i < 500; ++i) {
        const Shape a = Box{{1.0f, 0.5f, 1.0f}}, box = Box{{0.5f, 0.5f, 0.5f}};
        const Shape hull = hull_of(corners_of(Box{{0.5f, 0.5f, 0.5f}}));
        // Half of the boxes hang over the edge; yaw keeps clear of the parallel, where two corners change places.
        const Pose pose = resting(0.5, 0.5, r.range(-0.9, 0.9), r.range(-0.9, 0.9), r.range(0.1, 0.7));
        for (const Shape* b : {&box, &hull}) {
            const auto before = names_of(collide_all(a, {}, *b, pose, 0.02f));
            Pose moved = pose;
            moved.position += random_direction(r) * 1e-4;
            moved.orientation = about(random_direction(r), 1e-4) * moved.orientation;
            const auto after = names_of(collide_all(a, {}, *b, moved, 0.02f));
            int kept = 0;
            for (const auto& [name, position] : after) {
                const auto found = before.find(name);
                if (found == before.end()) continue;
                ++kept;
                // A name stands for all points within 2 % of the shortest side of a corner.
                EXPECT_LT(glm::length(dvec3(position) - dvec3(found->second)), 0.04) << i;
            }
            // Where more than four points compete for the largest area, one may give way to another.
            EXPECT_GE(kept, 3) << i;
        }
    }
}

TEST(Stability, AlignedStackKeepsItsNamesUnderJitter) {
    Random r(22);
    const Shape a = Box{{0.5f, 0.5f, 0.5f}};
    const auto before = names_of(collide_all(a, {}, a, resting(0.5, 0.5, 0, 0, 0), 0.02f));
    ASSERT_EQ(before.size(), 4u);
    for (int i = 0; i < 500; ++i) {
        const Pose pose = resting(0.5, 0.5, r.range(-1e-3, 1e-3), r.range(-1e-3, 1e-3), r.range(-1e-3, 1e-3));
        const auto after = names_of(collide_all(a, {}, a, pose, 0.02f));
        ASSERT_EQ(after.size(), 4u);
        for (const auto& [name, position] : after) EXPECT_TRUE(before.contains(name)) << i;
    }
}

TEST(Stability, ABoxAsAHullTouchesLikeABox) {
    Random r(23);
    int touching = 0;
    for (int i = 0; i < 3000; ++i) {
        const auto size = [&] { return static_cast<float>(r.range(0.2, 0.8)); };
        const Box box_a{{size(), size(), size()}}, box_b{{size(), size(), size()}};
        const Pose pose{random_direction(r) * r.range(0.2, 1.6), i % 3 == 0 ? about({0, 1, 0}, r.range(0, 1)) : random_rotation(r)};
        const std::vector<Manifold> m = collide_all(Shape{box_a}, {}, Shape{box_b}, pose, 0.0f);
        const std::vector<Manifold> h = collide_all(Shape{hull_of(corners_of(box_a))}, {}, Shape{hull_of(corners_of(box_b))}, pose, 0.0f);
        if (m.size() != h.size()) {
            ASSERT_GT(least_separation(m.empty() ? h[0] : m[0]), -2e-6f) << i;
            continue;
        }
        if (m.empty()) continue;
        ++touching;
        ASSERT_NEAR(least_separation(m[0]), least_separation(h[0]), 2e-6f) << i;
        if (glm::dot(dvec3(m[0].normal), dvec3(h[0].normal)) < 0.9999) continue;  // two axes tie
        ASSERT_EQ(m[0].count, h[0].count) << i;
    }
    EXPECT_GT(touching, 800);
}

TEST(Stability, EdgesParallelToTheLastBitKeepTheDepth) {
    for (double angle = 0.1; angle > 1e-17; angle *= 0.1) {
        for (const dvec3& axis : {dvec3{0, 1, 0}, dvec3{1, 0, 0}, dvec3{1, 2, 3}}) {
            // Edge over edge: A turned by 45 degrees about z, B too, nearly parallel.
            const dquat diamond = about({0, 0, 1}, 0.25 * kPi);
            const Box a{{0.5f, 0.5f, 1.0f}}, b{{0.3f, 0.3f, 0.7f}};
            const Pose pa{{0, 0, 0}, diamond};
            const Pose pb{{0.001, std::sqrt(0.5) + std::sqrt(0.18) - 0.01, 0.1}, about(axis, angle) * diamond};
            const Separation truth = greatest_separation(solid_of(a, pa, {}), solid_of(b, pb, {}));
            const std::vector<Manifold> m = collide_all(Shape{a}, pa, Shape{b}, pb, 0.01f);
            ASSERT_EQ(m.size(), 1u);
            EXPECT_NEAR(static_cast<double>(least_separation(m[0])), static_cast<double>(truth.value), 2e-6) << angle;
        }
    }
}

TEST(Stability, PointsLieMidwayBetweenTheSurfaces) {
    Random r(24);
    for (int i = 0; i < 2000; ++i) {
        const Box a{{0.5f, 0.4f, 0.6f}}, b{{0.3f, 0.5f, 0.4f}};
        const Pose pose{random_direction(r) * r.range(0.4, 1.3), random_rotation(r)};
        for (const Manifold& m : collide_all(Shape{a}, {}, Shape{b}, pose, 0.02f)) {
            for (const ContactPoint& p : m.used()) {
                const dvec3 half = 0.5 * static_cast<double>(p.separation) * dvec3(m.normal);
                const auto outside = [](const Box& box, const dvec3& local) {
                    const dvec3 d = glm::abs(local) - dvec3(box.half_extents);
                    return std::max({d.x, d.y, d.z});
                };
                // The point on A is at p - half, the one on B at p + half; each lies on its box.
                EXPECT_NEAR(outside(a, dvec3(p.position) - half), 0.0, 3e-6) << i;
                EXPECT_NEAR(outside(b, inverse_transform_point(pose, dvec3(p.position) + half)), 0.0, 3e-6) << i;
            }
        }
    }
}

TEST(Stability, ABoxOnAPlaneRestsOnItsFourCorners) {
    const Shape ground = Plane{{0.0f, 1.0f, 0.0f}, 0.25f}, crate = Box{{0.5f, 0.25f, 0.375f}};
    const Shape hull = hull_of(corners_of(Box{{0.5f, 0.25f, 0.375f}}));
    for (const Shape* shape : {&crate, &hull}) {
        const std::vector<Manifold> m = collide_all(ground, {}, *shape, {{3, 0.499, 1}, about({0, 1, 0}, 0.7)}, 0.01f);
        ASSERT_EQ(m.size(), 1u);
        ASSERT_EQ(m[0].count, 4u);
        EXPECT_EQ(m[0].normal, (vec3{0.0f, 1.0f, 0.0f}));
        std::set<std::uint64_t> names;
        for (const ContactPoint& p : m[0].used()) {
            EXPECT_NEAR(p.separation, -0.001f, 1e-7f);
            EXPECT_NEAR(p.position.y, 0.2495f, 1e-6f);
            names.insert(p.feature);
        }
        EXPECT_EQ(names.size(), 4u);
    }
}

TEST(Stability, CapsulesAlongAFaceAPlaneOrEachOtherHaveTwoPoints) {
    const Shape capsule = Capsule{0.2f, 0.4f}, box = Box{{1.0f, 0.5f, 1.0f}}, plane = Plane{{0.0f, 1.0f, 0.0f}, 0.5f};
    const Shape hull = hull_of(corners_of(Box{{1.0f, 0.5f, 1.0f}}));
    for (const double tilt : {0.0, 1e-9, 1e-4, -1e-3, 0.01}) {
        const Pose lying{{0.1, 0.699, 0.2}, about({0, 0, 1}, 0.5 * kPi + tilt)};
        for (const Shape* ground : {&box, &plane, &hull}) {
            const std::vector<Manifold> m = collide_all(capsule, lying, *ground, {}, 0.02f);
            ASSERT_EQ(m.size(), 1u);
            EXPECT_EQ(m[0].count, 2u) << to_string(type_of(*ground)) << " " << tilt;
            EXPECT_NEAR(m[0].normal.y, -1.0f, 1e-6f);
            EXPECT_NEAR(static_cast<double>(least_separation(m[0])), -0.001 - 0.4 * std::abs(std::sin(tilt)), 1e-6);
        }
        const std::vector<Manifold> m = collide_all(capsule, lying, capsule, {{0.3, 0.3, 0.2}, about({0, 0, 1}, 0.5 * kPi)}, 0.02f);
        ASSERT_EQ(m.size(), 1u);
        EXPECT_EQ(m[0].count, 2u) << tilt;
    }
}

}  // namespace
}  // namespace carom
