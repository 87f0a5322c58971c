// Problems with known answers: Coulomb friction, rolling, bouncing, momentum, moving platforms, far origins, scale.
#include "table.hpp"

#include <carom/core/math.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace carom {
namespace {

using namespace test;

TEST(KnownAnswers, BoxComesToRestOnThePlane) {
    Table table;
    const BodyId box = table.add({.position = {0, 1.0, 0}}, Box{{0.5f, 0.5f, 0.5f}});
    table.run(180);
    EXPECT_NEAR(table.world.pose(box).position.y, 0.5, 1e-3);
    EXPECT_LT(glm::length(table.world.linear_velocity(box)), 1e-5);
    ASSERT_EQ(table.world.contact_count(), 1u);
    const ContactView contact = table.world.contact(0);
    EXPECT_EQ(contact.manifold.count, 4u);
    double force = 0.0;
    for (int k = 0; k < 4; ++k) force += static_cast<double>(contact.normal_impulse[static_cast<std::size_t>(k)]);
    // impulses are of one substep
    EXPECT_NEAR(force * 60.0 * table.world.settings().substeps, 1000.0 * 9.81, 10.0);
}

// All contacts share the plate: there are more than colours, and the last ones, on which it lands first, are solved one after the other.
TEST(KnownAnswers, APlateLandsOnFortyPostsWithoutABounce) {
    World world({.gravity = dvec3{0.0}, .contact_method = ContactMethod::Soft});
    for (int i = 0; i < 40; ++i) {
        const BodyId post = world.create_body({.type = BodyType::Static, .position = {0.5 * (i % 8) - 1.75, i < 32 ? -0.502 : -0.5, 0.5 * (i / 8) - 1.0}});
        world.add_shape(post, Box{{0.1f, 0.5f, 0.1f}}, {.friction = 0.0f});
    }
    const BodyId plate = world.create_body({.position = {0, 0.1001, 1}, .linear_velocity = {0, -0.2, 0}});
    world.add_shape(plate, Box{{2.0f, 0.1f, 2.2f}}, {.friction = 0.0f});
    const double before = world.energy().total();
    const StepReport report = world.step(kDt);
    ASSERT_EQ(report.manifolds, 40u);
    EXPECT_EQ(report.overflow, 8u);
    for (int i = 0; i < 10; ++i) world.step(kDt);
    EXPECT_LT(world.energy().total(), 0.1 * before);
}

// Coulomb: v0²/(2 mu g), along the axes and between them; a friction pyramid would stop too early at 45 degrees.
TEST(KnownAnswers, SlidingBoxStopsWhereCoulombSays) {
    for (const double degrees : {0.0, 30.0, 45.0, 90.0}) {
        Table table({}, 0.5f);
        const SinCos heading = sin_cos(degrees * kPi / 180.0);
        const double speed = 3.0;
        const dvec3 direction{heading.cos, 0.0, heading.sin};
        const BodyId box = table.add({.position = {0, 0.25, 0}, .linear_velocity = speed * direction},
                                     Box{{0.5f, 0.25f, 0.5f}}, {.friction = 0.5f});
        table.run(120);
        const double expected = speed * speed / (2.0 * 0.5 * 9.81);
        const dvec3 path = table.world.pose(box).position;
        EXPECT_NEAR(glm::dot(path, direction), expected, 0.02 * expected) << degrees;
        EXPECT_LT(glm::length(glm::cross(path, direction) * dvec3{0, 1, 0}), 0.01 * expected) << degrees;
    }
}

TEST(KnownAnswers, BlockOnInclineSticksBelowTheFrictionAngleAndSlidesAbove) {
    const double mu = 0.5;  // critical angle 26.57 degrees
    for (const double degrees : {25.0, 28.0}) {
        const SinCos a = sin_cos(degrees * kPi / 180.0);
        World world({.gravity = {9.81 * a.sin, -9.81 * a.cos, 0.0}});
        const BodyId ground = world.create_body({.type = BodyType::Static});
        world.add_shape(ground, Plane{{0, 1, 0}, 0}, {.friction = 0.5f});
        const BodyId box = world.create_body({.position = {0, 0.25, 0}});
        world.add_shape(box, Box{{0.5f, 0.25f, 0.5f}}, {.friction = 0.5f});
        for (int i = 0; i < 120; ++i) world.step(kDt);
        const double path = world.pose(box).position.x;
        if (a.sin < mu * a.cos) {
            EXPECT_LT(path, 0.01) << "sticks";
        } else {
            const double expected = 0.5 * 9.81 * (a.sin - mu * a.cos) * 4.0;
            EXPECT_NEAR(path, expected, 0.1 * expected) << "slides";
        }
    }
}

TEST(KnownAnswers, SphereSlipsThenRolls) {
    Table table({}, 0.3f);
    const BodyId ball = table.add({.position = {0, 0.5, 0}, .linear_velocity = {4, 0, 0}}, Sphere{0.5f}, {.friction = 0.3f});
    table.run(180);
    EXPECT_NEAR(table.world.linear_velocity(ball).x, 4.0 * 5.0 / 7.0, 0.01);
    EXPECT_NEAR(table.world.angular_velocity(ball).z, -4.0 * 5.0 / 7.0 / 0.5, 0.02);
}

TEST(KnownAnswers, BouncingBallKeepsTheRestitutionOfItsImpact) {
    Table table;
    const BodyId ball = table.add({.position = {0, 2.5, 0}}, Sphere{0.5f}, {.restitution = 0.5f});
    double apex = 0.0;
    bool fell = false;
    for (int i = 0; i < 120; ++i) {
        table.world.step(kDt);
        const bool rising = table.world.linear_velocity(ball).y > 0.0;
        fell |= rising;
        if (fell && !rising) break;
        apex = fell ? table.world.pose(ball).position.y - 0.5 : 0.0;
    }
    EXPECT_NEAR(apex, 2.0 * 0.25, 0.06);  // impact is placed to within a step
}

// A block between two that cannot give way is pushed harder, but not harder and harder.
TEST(KnownAnswers, WhatIsWedgedForeverIsPushedWithinBounds) {
    const auto pressed = [](int steps) {
        World world({.gravity = {0, 0, 0}});
        for (const double y : {0.0, 1.75}) world.add_shape(world.create_body({.type = BodyType::Static, .position = {0, y, 0}}), Box{{2, 0.5f, 2}});
        const BodyId block = world.create_body({.position = {0, 0.875, 0}});
        world.add_shape(block, Box{{0.5f, 0.5f, 0.5f}});
        for (int i = 0; i < steps; ++i) world.step(kDt);
        float most = 0.0f;
        for (std::size_t i = 0; i < world.contact_count(); ++i) {
            for (const float impulse : world.contact(i).normal_impulse) most = std::max(most, impulse);
        }
        EXPECT_NEAR(world.pose(block).position.y, 0.875, 0.125);  // neither of the two is passed through
        return most;
    };
    const float soon = pressed(60);
    EXPECT_GT(soon, 0.0f);
    EXPECT_LT(pressed(1800), 1.2f * soon);
}

TEST(KnownAnswers, MomentumOfACollisionIsConserved) {
    World world({.gravity = {0, 0, 0}, .report_balance = true});
    const BodyId a = world.create_body({.position = {-2, 0, 0}, .linear_velocity = {3, 0, 0}});
    world.add_shape(a, Box{{0.5f, 0.5f, 0.5f}});
    const BodyId b = world.create_body({.position = {2, 0.3, 0.2}, .linear_velocity = {-1, 0, 0}});
    world.add_shape(b, Sphere{0.7f});
    const Momentum before = world.momentum();
    // Until ten steps after they met: every pass that still pushes rounds both velocities to floats.
    int left = 120;
    bool met = false;
    for (; left > 0; --left) {
        if (world.step(kDt).touching > 0 && !met) {
            met = true;
            left = 11;
        }
    }
    EXPECT_TRUE(met);
    const Momentum after = world.momentum();
    EXPECT_LT(glm::length(after.linear - before.linear), 1e-6 * 3000.0);
    // Within a step both bodies keep their lever arms, so friction acts at points as far apart as they moved: at most
    // |v| dt times the friction impulse, mu m v.
    EXPECT_LT(glm::length(after.angular - before.angular), 4.0 * kDt * 0.6 * 1000.0 * 4.0);
}

TEST(KnownAnswers, KinematicPlatformCarriesWhatStandsOnIt) {
    World world;
    const BodyId platform = world.create_body({.type = BodyType::Kinematic, .linear_velocity = {1, 0, 0}});
    world.add_shape(platform, Box{{2, 0.25f, 2}});
    const BodyId box = world.create_body({.position = {0, 0.75, 0}});
    world.add_shape(box, Box{{0.5f, 0.5f, 0.5f}});
    for (int i = 0; i < 120; ++i) world.step(kDt);
    EXPECT_NEAR(world.pose(platform).position.x, 2.0, 1e-12);
    EXPECT_NEAR(world.linear_velocity(box).x, 1.0, 1e-3);
    EXPECT_GT(world.pose(box).position.x, 1.8);
}

TEST(KnownAnswers, StackFarFromTheOriginSettlesTheSame) {
    const auto settle = [](double offset) {
        World world;
        const BodyId ground = world.create_body({.type = BodyType::Static, .position = {offset, -0.5, offset}});
        world.add_shape(ground, Box{{10, 0.5f, 10}});
        std::vector<BodyId> boxes;
        for (int i = 0; i < 5; ++i) {
            boxes.push_back(world.create_body({.position = {offset, 0.5 + i, offset}}));
            world.add_shape(boxes.back(), Box{{0.5f, 0.5f, 0.5f}});
        }
        for (int i = 0; i < 120; ++i) world.step(kDt);
        return world.pose(boxes.back()).position - dvec3{offset, 0.0, offset};
    };
    EXPECT_LT(glm::length(settle(1e6) - settle(0.0)), 1e-4);
}

TEST(KnownAnswers, KinematicPlaneLiftsWhatLiesOnIt) {
    World world;
    const BodyId floor = world.create_body({.type = BodyType::Kinematic, .linear_velocity = {0, 10, 0}});
    world.add_shape(floor, Plane{{0, 1, 0}, 0});
    const BodyId ball = world.create_body({.position = {0, 0.6, 0}});
    world.add_shape(ball, Sphere{0.5f});
    double deepest = 0.0;
    for (int i = 0; i < 60; ++i) {
        world.step(kDt);
        deepest = std::min(deepest, world.pose(ball).position.y - world.pose(floor).position.y - 0.5);
    }
    EXPECT_GT(deepest, -5e-3);
}

// The static body's own origin may be as far away as the world is wide.
TEST(KnownAnswers, ContactKeepsItsDigitsFarFromTheStaticBodysOrigin) {
    for (const double d : {0.0, 1e5, 1e7}) {
        World world;
        const BodyId ground = world.create_body({.type = BodyType::Static});
        world.add_shape(ground, Box{{10, 0.5f, 10}}, {.local = {{d, -0.5, 0}}});
        const BodyId box = world.create_body({.position = {d, 0.5, 0}});
        world.add_shape(box, Box{{0.5f, 0.5f, 0.5f}});
        for (int i = 0; i < 120; ++i) world.step(kDt);
        EXPECT_NEAR(world.pose(box).position.y, 0.5, 1e-4) << d;
        EXPECT_LT(glm::length(world.linear_velocity(box)), 1e-5) << d;
    }
}

// Lengths times s, times times sqrt(s): the same path at every size and density, friction included.
TEST(KnownAnswers, SlidingScalesWithSizeAndDensity) {
    const auto slide = [](double s, double density) {
        World world;
        const BodyId ground = world.create_body({.type = BodyType::Static});
        world.add_shape(ground, Plane{{0, 1, 0}, 0}, {.friction = 0.5f});
        const auto f = static_cast<float>(s);
        const BodyId box = world.create_body({.position = {0, 0.5 * s, 0}, .linear_velocity = {5.0 * std::sqrt(s), 0, 0}});
        world.add_shape(box, Box{{f, 0.5f * f, f}}, {.density = density, .friction = 0.5f});
        for (int i = 0; i < 120; ++i) world.step(kDt * std::sqrt(s));
        return world.pose(box).position.x / s;
    };
    const double expected = slide(1.0, 1000.0);
    EXPECT_NEAR(expected, 2.548, 0.02);
    for (const double s : {1e-4, 1e-2, 1e2, 1e5}) EXPECT_NEAR(slide(s, 1000.0), expected, 1e-3 * expected) << s;
    for (const double density : {1e-20, 1e-10, 1e10, 1e20}) EXPECT_NEAR(slide(1.0, density), expected, 1e-3 * expected) << density;
}

}  // namespace
}  // namespace carom
