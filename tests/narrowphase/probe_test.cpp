// Ray probes: exact where they say so, wrong by no more than they say, the same on any number of threads, bad input refused.
#include "broadphase/executors.hpp"
#include "oracle.hpp"
#include "support/grid_mesh.hpp"

#include <carom/collision/ray_cast.hpp>
#include <carom/core/check.hpp>
#include <carom/narrowphase/probe.hpp>

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace carom {
namespace {

using namespace test;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Ground {
    std::vector<const Shape*> shapes;
    std::vector<Pose> poses;
    std::vector<std::uint32_t> near;
    void add(const Shape& shape, const Pose& pose = {}) {
        near.push_back(static_cast<std::uint32_t>(shapes.size()));
        shapes.push_back(&shape);
        poses.push_back(pose);
    }
    [[nodiscard]] PlacedShapes placed() const { return {shapes, poses}; }
    [[nodiscard]] std::vector<ProbeContact> feel(const RayProbe& wheel, const Pose& pose) const {
        std::vector<ProbeContact> out;
        probe(wheel, pose, placed(), near, out);
        return out;
    }
};

Shape hills() {
    return grid_mesh(16, [](float i, float j) { return vec3{0.25f * (i - 8.0f), 0.1f * std::sin(i + 2.0f * j), 0.25f * (j - 8.0f)}; });
}

double least_separation(const std::vector<ProbeContact>& contacts) {
    double least = std::numeric_limits<double>::infinity();
    for (const ProbeContact& c : contacts) least = std::min(least, c.separation);
    return least;
}

TEST(Probe, OnFlatGroundEachRayIsAsLongAsTheCosineSays) {
    const Shape plane = Plane{{0, 1, 0}, 0.25f};
    Ground ground;
    ground.add(plane);
    const RayProbe wheel{.angle = kPi / 2, .rays = 5, .radius = 0.5, .reach = 0.5};
    const std::vector<ProbeContact> contacts = ground.feel(wheel, {{3, 0.7, 0}});
    ASSERT_EQ(contacts.size(), 5u);
    for (std::uint32_t k = 0; k < 5; ++k) {
        EXPECT_EQ(contacts[k].ray, k);
        const double angle = (static_cast<double>(k) - 2.0) * kPi / 8;
        EXPECT_NEAR(contacts[k].separation, 0.45 / std::cos(angle) - 0.5, 1e-12);
        EXPECT_NEAR(contacts[k].clearance, -0.05, 1e-12) << "exact on flat ground, whatever the ray";
        EXPECT_NEAR(contacts[k].point.y, 0.25, 1e-12);
        EXPECT_NEAR(contacts[k].normal.y, -1.0, 1e-12) << "from the wheel to the ground";
    }
    EXPECT_LT(contacts[2].separation, contacts[1].separation);
    EXPECT_TRUE(ground.feel(wheel, {{3, 1.3, 0}}).empty()) << "the ground is beyond the reach";
}

TEST(Probe, FansTurnAboutTheAxisAndRowsSpanTheWidth) {
    const Shape ball = Sphere{10.0f};  // all rays start inside
    Ground ground;
    ground.add(ball);
    const RayProbe whole{.axis = {0, 0, 3}, .middle = {2, 0, 5}, .angle = 2 * kPi, .rays = 4, .rows = 3, .width = 0.4};
    const std::vector<ProbeContact> contacts = ground.feel(whole, {});
    ASSERT_EQ(contacts.size(), 12u);
    const dvec3 directions[4] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    for (std::size_t i = 0; i < 12; ++i) {
        EXPECT_EQ(contacts[i].row, i / 4);
        EXPECT_NEAR(glm::length(contacts[i].normal - directions[i % 4]), 0.0, 1e-12) << "a ray that starts inside has its own direction";
        EXPECT_NEAR(contacts[i].separation, -whole.radius, 1e-15);
        EXPECT_NEAR(contacts[i].point.z, -0.2 + 0.2 * static_cast<double>(i / 4), 1e-12);
    }
    const Aabb box = bounds(whole, {{1, 2, 3}});
    EXPECT_NEAR(glm::length(box.lower - dvec3(0.5, 1.5, 2.8)), 0.0, 1e-12);
    EXPECT_NEAR(glm::length(box.upper - dvec3(1.5, 2.5, 3.2)), 0.0, 1e-12);
}

TEST(Probe, FlatGroundIsMissedByNoMoreThanTheStatedBound) {
    Random r(601);
    const Shape plane = Plane{{0, 1, 0}, 0.0f};
    Ground ground;
    ground.add(plane);
    double worst = 0.0;
    for (int i = 0; i < 4000; ++i) {
        const auto rays = static_cast<std::uint32_t>(r.range(4, 60));
        const RayProbe wheel{.angle = 2 * kPi, .rays = rays, .radius = r.range(0.2, 1.0), .reach = 2.0};
        const double height = r.range(0.05, 1.2), step = 2 * kPi / rays;
        const std::vector<ProbeContact> contacts = ground.feel(wheel, {{0, height, 0}, about({1, 0, 0}, r.range(0.0, 7.0))});
        ASSERT_FALSE(contacts.empty());
        const double excess = least_separation(contacts) - (height - wheel.radius), bound = height * (1.0 / std::cos(0.5 * step) - 1.0);
        EXPECT_GE(excess, -1e-12);
        EXPECT_LE(excess, bound + 1e-12);
        worst = std::max(worst, excess / bound);
    }
    EXPECT_GT(worst, 0.9) << "the bound is met";
}

TEST(Probe, EveryContactIsTheNearestThatItsRayMeets) {
    Random r(602);
    const Shape box = Box{{0.3f, 0.2f, 0.5f}}, ball = Sphere{0.3f}, hill = hills();
    int met = 0;
    for (int i = 0; i < 200; ++i) {
        Ground ground;
        for (const Shape* shape : {&box, &ball, &hill}) {
            ground.add(*shape, {random_direction(r) * r.range(0.0, 0.8), random_rotation(r)});
        }
        const RayProbe wheel{.centre = random_direction(r), .angle = 4.0, .rays = 9, .rows = 2, .width = 0.3, .radius = 0.5, .reach = 0.3};
        const Pose pose{random_direction(r), random_rotation(r)};
        for (const ProbeContact& c : ground.feel(wheel, pose)) {
            const dvec3 axle = transform_point(pose, wheel.centre + dvec3{c.row == 0 ? -0.15 : 0.15, 0, 0});
            const double distance = c.separation + wheel.radius;
            if (distance == 0.0) continue;
            ++met;
            const Ray ray{axle, c.point - axle};
            for (std::size_t k = 0; k < ground.shapes.size(); ++k) {
                const auto hit = cast_ray(*ground.shapes[k], ground.poses[k], ray);
                EXPECT_TRUE(!hit || hit->distance >= distance - 1e-9);
                if (k == c.shape) {
                    ASSERT_TRUE(hit);
                    EXPECT_NEAR(hit->distance, distance, 1e-9);
                    EXPECT_NEAR(glm::length(hit->normal + c.normal), 0.0, 1e-6);
                }
            }
        }
    }
    EXPECT_GT(met, 300);
}

TEST(Probe, WhatIsNarrowPassesBetweenTheRaysUntilThereAreEnough) {
    const Shape rail = Box{{5.0f, 0.5f, 0.01f}};
    Ground ground;
    ground.add(rail, {{0, -0.9, 0.16}});
    RayProbe wheel{.angle = kPi, .rays = 8, .radius = 0.5};
    EXPECT_TRUE(ground.feel(wheel, {}).empty());
    wheel.rays = 128;
    EXPECT_FALSE(ground.feel(wheel, {}).empty());
}

TEST(Probe, ABatchIsEachOfItsProbesOnAnyNumberOfThreads) {
    Random r(603);
    const Shape box = Box{{0.3f, 0.2f, 0.5f}}, plane = Plane{}, hill = hills();
    Ground ground;
    for (const Shape* shape : {&box, &plane, &hill}) ground.add(*shape, {random_direction(r), random_rotation(r)});
    std::vector<PlacedProbe> probes;
    std::vector<ProbeContact> expected;
    for (std::uint32_t i = 0; i < 50; ++i) {
        const RayProbe wheel{.rays = 1 + i % 7, .rows = 1 + i % 3, .width = 0.2, .reach = 0.4};
        probes.push_back({wheel, {random_direction(r), random_rotation(r)}, i % 3, 3 - i % 3});
        std::vector<ProbeContact> alone;
        probe(wheel, probes.back().pose, ground.placed(), std::span(ground.near).subspan(i % 3), alone);
        for (ProbeContact& c : alone) {
            c.probe = i;
            expected.push_back(c);
        }
    }
    SerialExecutor serial;
    ScatteringExecutor three(3);
    for (Executor* executor : {static_cast<Executor*>(&serial), static_cast<Executor*>(&three)}) {
        std::vector<ProbeContact> contacts(3);
        probe(probes, ground.placed(), ground.near, *executor, contacts);
        ASSERT_EQ(contacts.size(), expected.size());
        ASSERT_GT(contacts.size(), 50u);
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            EXPECT_EQ(contacts[i].probe, expected[i].probe);
            EXPECT_EQ(contacts[i].ray, expected[i].ray);
            EXPECT_EQ(contacts[i].shape, expected[i].shape);
            EXPECT_EQ(contacts[i].point, expected[i].point);
            EXPECT_EQ(contacts[i].separation, expected[i].separation);
        }
    }
}

TEST(Probe, BadInputIsRefused) {
    const auto refused = [](const std::function<void(RayProbe&)>& spoil) {
        RayProbe wheel;
        spoil(wheel);
        return !validate(wheel).ok();
    };
    EXPECT_TRUE(validate(RayProbe{}).ok());
    EXPECT_TRUE(refused([](RayProbe& p) { p.centre.x = kNaN; }));
    EXPECT_TRUE(refused([](RayProbe& p) { p.axis = dvec3{0.0}; }));
    EXPECT_TRUE(refused([](RayProbe& p) { p.axis.y = kNaN; }));
    EXPECT_TRUE(refused([](RayProbe& p) { p.middle = dvec3{0.0}; }));
    EXPECT_TRUE(refused([](RayProbe& p) { p.middle = 2.0 * p.axis; }));
    EXPECT_TRUE(refused([](RayProbe& p) { p.angle = -0.1; }));
    EXPECT_TRUE(refused([](RayProbe& p) { p.angle = 6.3; }));
    EXPECT_TRUE(refused([](RayProbe& p) { p.angle = kNaN; }));
    EXPECT_TRUE(refused([](RayProbe& p) { p.rays = 0; }));
    EXPECT_TRUE(refused([](RayProbe& p) { p.rays = 4097; }));
    EXPECT_TRUE(refused([](RayProbe& p) { p.rows = 0; }));
    EXPECT_TRUE(refused([](RayProbe& p) { p.rows = 65; }));
    EXPECT_TRUE(refused([](RayProbe& p) { p.width = -1.0; }));
    EXPECT_TRUE(refused([](RayProbe& p) { p.radius = 0.0; }));
    EXPECT_TRUE(refused([](RayProbe& p) { p.radius = std::numeric_limits<double>::infinity(); }));
    EXPECT_TRUE(refused([](RayProbe& p) { p.reach = -0.1; }));

    const Shape box = Box{};
    Ground ground;
    ground.add(box);
    const std::uint32_t beyond[] = {1};
    std::vector<ProbeContact> out(2);
    EXPECT_THROW(probe({.rays = 0}, {}, ground.placed(), ground.near, out), MisuseError);
    EXPECT_THROW(probe({}, {{kNaN, 0, 0}}, ground.placed(), ground.near, out), MisuseError);
    EXPECT_THROW(probe({}, {}, ground.placed(), beyond, out), MisuseError);
    EXPECT_THROW(probe({}, {}, {ground.shapes, {}}, ground.near, out), MisuseError);
    EXPECT_THROW(static_cast<void>(bounds(RayProbe{.radius = -1.0}, Pose{})), MisuseError);
    SerialExecutor executor;
    const PlacedProbe past_the_list{{}, {}, 0, 2};
    EXPECT_THROW(probe({&past_the_list, 1}, ground.placed(), ground.near, executor, out), MisuseError);
    ground.shapes[0] = nullptr;
    EXPECT_THROW(probe({}, {}, ground.placed(), ground.near, out), MisuseError);
    EXPECT_EQ(out.size(), 2u) << "nothing changed";
}

}  // namespace
}  // namespace carom
