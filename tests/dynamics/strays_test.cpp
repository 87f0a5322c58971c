// A glance never says that a shape stays that strays, and says it of what falls freely.
#include <carom/collision/aabb.hpp>
#include <carom/core/random.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/strays.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <vector>

namespace carom::dynamics {
namespace {

constexpr double kDt = 1.0 / 60.0;
constexpr dvec3 kGravity{0, -9.81, 0};

dvec3 some_vector(Random& random, double length) { return random.range(0.0, length) * test::random_direction(random); }

Shape some_shape(int kind) {
    switch (kind % 5) {
        case 0:
            return Box{{0.5f, 0.2f, 0.9f}};
        case 1:
            return Sphere{0.4f};
        case 2:
            return Capsule{0.2f, 0.6f};
        case 3:
            return Cylinder{0.5f, 0.3f};
        default:
            return Cone{0.4f, 0.7f};
    }
}

struct Flyer {
    ProxySet proxies;
    BodyArrays bodies;
    BodyState from;

    Flyer(Random& random, int kind, double far, double speed, double spin, const dvec3& gravity = kGravity) {
        from.pose = {some_vector(random, far), test::random_rotation(random)};
        from.velocity = some_vector(random, speed);
        from.spin = some_vector(random, spin);
        bodies.states = {from};
        bodies.roles = {Role::Dynamic};
        bodies.masses.resize(1);
        NewProxy proxy;
        proxy.shape = some_shape(kind);
        const Pose local = kind % 3 == 0 ? Pose{} : Pose{some_vector(random, 1.0), test::random_rotation(random)};
        proxy.local = LocalPose(local);
        proxy.reach = glm::length(local.position) + bounding_radius(proxy.shape);
        proxy.extent = smallest_extent(proxy.shape);
        proxy.id = {0, 1};
        put_proxy(proxies, proxy, {});
        SerialExecutor executor;
        update_swept_bounds(proxies, bodies, {gravity, kDt}, {}, executor);
    }
    [[nodiscard]] bool stays(const BodyState& to) const { return surely_stays(proxies, 0, {from.pose, from.velocity, to, kDt}); }
    [[nodiscard]] bool is_astray(const BodyState& to) const { return strays(proxies, 0, {from.pose, from.velocity, to, kDt}); }
};

TEST(Strays, AGlanceIsNeverWrong) {
    Random random(11);
    int stay = 0, astray = 0, missed = 0;
    for (int i = 0; i < 60000; ++i) {
        const double far = i % 4 == 0 ? 1e7 : 10.0, speed = i % 3 == 0 ? 0.3 : 20.0, spin = i % 2 == 0 ? 0.2 : 8.0;
        const Flyer flyer(random, i, far, speed, spin);
        // Somewhere about where it was to be: on its path, beside it by about as much as there is room, turned otherwise.
        BodyState to = flyer.from;
        const double room = 9.81 * kDt * kDt;
        to.pose.position += random.range(-0.05, 1.05) * kDt * flyer.from.velocity + some_vector(random, random.range(0.0, 4.0) * room);
        to.spin += some_vector(random, i % 5 == 0 ? 12.0 : 0.01);
        const dvec3 turn = (i % 7 == 3 ? 0.0 : random.range(0.0, 1.2)) * kDt * flyer.from.spin;
        to.pose.orientation = glm::normalize(rotation_from_vector(turn) * to.pose.orientation);
        const bool exact = flyer.is_astray(to), glance = flyer.stays(to);
        EXPECT_FALSE(glance && exact) << i;
        stay += glance ? 1 : 0;
        astray += exact ? 1 : 0;
        missed += !glance && !exact ? 1 : 0;
    }
    EXPECT_GT(stay, 10000);
    EXPECT_GT(astray, 2000);
    EXPECT_GT(missed, 100) << "else the cases are not near the edge";
}

TEST(Strays, WhatFallsFreelyStaysAtAGlance) {
    Random random(5);
    for (int i = 0; i < 500; ++i) {
        const Flyer flyer(random, i, 20.0, 15.0, 1.0);
        BodyState to = flyer.from;
        to.velocity += kDt * kGravity;
        to.pose.position += 0.5 * kDt * (flyer.from.velocity + to.velocity);
        to.pose.orientation = glm::normalize(rotation_from_vector(kDt * to.spin) * to.pose.orientation);
        EXPECT_TRUE(flyer.stays(to)) << i;
    }
}

// Without gravity its box has no room but what rounding to floats gave it: the end is looked at, and what is off it by less than a float's step is told right.
TEST(Strays, ABallThatFliesStraightIsToldFromItsEnd) {
    constexpr int kBall = 6;  // about the centre of mass
    Random random(17);
    int stay = 0, astray = 0, plain = 0, sure = 0;
    for (int i = 0; i < 40000; ++i) {
        const double far = i % 4 == 0 ? 1e7 : 10.0;
        const Flyer flyer(random, kBall, far, 400.0, 0.0, dvec3{0.0});
        BodyState to = flyer.from;
        to.pose.position += kDt * to.velocity;
        if (i % 2 == 0) {
            ++plain;
            sure += flyer.stays(to) ? 1 : 0;
        } else {
            to.pose.position += some_vector(random, std::pow(10.0, random.range(-12.0, -4.0)));
        }
        const bool exact = flyer.is_astray(to), glance = flyer.stays(to);
        EXPECT_FALSE(glance && exact) << i;
        stay += glance ? 1 : 0;
        astray += exact ? 1 : 0;
    }
    EXPECT_GT(sure, plain * 9 / 10);
    EXPECT_GT(stay, 20000);
    EXPECT_GT(astray, 2000);
}

TEST(Strays, OfPlanesNothingIsKnown) {
    Random random(5);
    Flyer flyer(random, 0, 1.0, 1.0, 0.0);
    EXPECT_TRUE(flyer.stays(flyer.from));
    NewProxy plane;
    plane.shape = Plane{{0, 1, 0}, 0};
    plane.id = {0, 2};
    put_proxy(flyer.proxies, plane, {});
    EXPECT_FALSE(flyer.stays(flyer.from));
}

}  // namespace
}  // namespace carom::dynamics
