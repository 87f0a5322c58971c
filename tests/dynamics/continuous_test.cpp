// Continuous collision in the world: nothing passes through anything, and blows are those of mechanics.
#include "bullets.hpp"
#include "table.hpp"

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace carom {
namespace {

using namespace test;

/// Two that fly at each other along x, off centre by less than they are thick.
struct Duel {
    World world;
    BodyId left, right;
    Duel(const Shape& a, const Shape& b, double speed, std::uint64_t seed, const ShapeDef& matter = {}) : world(kSpace) {
        Random random(seed);
        const double apart = random.range(0.3, 1.9) * speed / 60.0 + 1.2;
        left = world.create_body({.position = {-0.5 * apart, random.range(-0.02, 0.02), random.range(-0.02, 0.02)}, .linear_velocity = {speed, 0.0, 0.0}});
        right = world.create_body({.position = {0.5 * apart, 0.0, 0.0}, .linear_velocity = {-random.range(0.0, 1.0) * speed, 0.0, 0.0}});
        world.add_shape(left, a, matter);
        world.add_shape(right, b, matter);
    }
};

TEST(Continuous, TwoFastBodiesMeet) {
    const std::array<Shape, 5> shapes{Sphere{0.05f}, Box{{0.05f, 0.06f, 0.07f}}, Capsule{0.05f, 0.04f}, hull_of_box({0.05f, 0.06f, 0.04f}), Cylinder{0.06f, 0.05f}};
    int met = 0, exact = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const Shape &a = shapes[seed % 5], &b = shapes[seed / 5 % 5];
        const double speed = std::array{50.0, 300.0, 2000.0, 1e4}[seed % 4];
        Duel duel(a, b, speed, seed);
        const Momentum before = duel.world.momentum();
        const double energy = duel.world.energy().total();
        StepReport report;
        for (int i = 0; i < 4 && report.continuous.impacts + report.contacts == 0; ++i) report = duel.world.step(kDt);
        ASSERT_GE(report.continuous.impacts + report.contacts, 1u) << seed << ": they passed";
        if (report.contacts > 0) continue;  // so near at the start of a step that the solver had them
        ++met;
        const Momentum after = duel.world.momentum();
        const double scale = speed * duel.world.mass_properties(duel.left).mass;
        EXPECT_LT(glm::length(after.linear - before.linear), 1e-12 * scale) << seed;
        // Two that are struck again while they touch are moved apart by 2 % of their thickness at most, at their speed.
        const double moved = 1e-10 + 0.02 * 0.12 * static_cast<double>(report.continuous.parted);
        EXPECT_LT(glm::length(after.angular - before.angular), moved * scale) << seed;
        exact += report.continuous.parted == 0;
        EXPECT_LE(duel.world.energy().total(), energy * (1.0 + 1e-12)) << seed;
    }
    EXPECT_GT(met, 180);
    EXPECT_GT(exact, 90);
}

// v1' = [(m1 - e m2) v1 + (1 + e) m2 v2] / (m1 + m2), in the middle of a step.
TEST(Continuous, CentralImpactsObeyNewtonsLaw) {
    for (const float e : {0.0f, 0.5f, 1.0f}) {
        World world(kSpace);
        const double v1 = 400.0, v2 = -130.0;
        const BodyId a = world.create_body({.position = {-3.0, 0.0, 0.0}, .linear_velocity = {v1, 0.0, 0.0}});
        const BodyId b = world.create_body({.position = {1.0, 0.0, 0.0}, .linear_velocity = {v2, 0.0, 0.0}});
        world.add_shape(a, Sphere{0.1f}, {.restitution = e});
        world.add_shape(b, Sphere{0.2f}, {.restitution = e});
        EXPECT_EQ(world.step(kDt).continuous.impacts, 1u);
        const double m1 = world.mass_properties(a).mass, m2 = world.mass_properties(b).mass, exact = static_cast<double>(e);
        EXPECT_NEAR(world.linear_velocity(a).x, ((m1 - exact * m2) * v1 + (1.0 + exact) * m2 * v2) / (m1 + m2), 1e-10);
        EXPECT_NEAR(world.linear_velocity(b).x, ((m2 - exact * m1) * v2 + (1.0 + exact) * m1 * v1) / (m1 + m2), 1e-10);
        // Placed where they met: within the tolerance of the search, 1e-4 of the smaller one.
        const double t = (4.0 - static_cast<double>(0.1f) - static_cast<double>(0.2f)) / (v1 - v2);
        EXPECT_NEAR(world.pose(a).position.x, -3.0 + v1 * t + world.linear_velocity(a).x * (kDt - t), 1e-4);
    }
}

// The ball beside the wall may not be pushed through it.
TEST(Continuous, ARestingBallThatIsHitBesideAWallStaysThere) {
    for (const double speed : {50.0, 1e3, 1e4}) {
        for (const float e : {0.0f, 1.0f}) {
            World world(kSpace);
            world.add_shape(world.create_body({.type = BodyType::Static}), Box{{5.0f, 5.0f, 0.005f}}, {.restitution = e});
            const BodyId resting = world.create_body({.position = {0.0, 0.0, -0.0551}}), fast = world.create_body({.position = {0.001, 0.0, -3.0}, .linear_velocity = {0.0, 0.0, speed}});
            world.add_shape(resting, Sphere{0.05f}, {.restitution = e});
            world.add_shape(fast, Sphere{0.05f}, {.restitution = e});
            for (int i = 0; i < 10; ++i) world.step(kDt);
            EXPECT_LT(world.pose(resting).position.z, 0.0) << speed << " " << e;
            EXPECT_LT(world.pose(fast).position.z, 0.0) << speed << " " << e;
        }
    }
}

// A rod that turns by 167 rad in the step sweeps its whole disc, which a short arc between two poses does not.
TEST(Continuous, ASpinningRodMeetsWhatItsTurnsSweepOver) {
    World world(kSpace);
    const BodyId rod = world.create_body({.orientation = rotation_about({0.0, 0.0, 1.0}, std::numbers::pi / 2), .angular_velocity = {0.0, 1e4, 0.0}});
    world.add_shape(rod, Capsule{0.0005f, 0.4995f});
    const BodyId ball = world.create_body({.position = {0.0, 0.0, 0.4}});
    world.add_shape(ball, Sphere{0.02f});
    EXPECT_GE(world.step(kDt).continuous.impacts, 1u);
    EXPECT_GT(glm::length(world.linear_velocity(ball)), 10.0);
    EXPECT_LT(world.energy().kinetic, 0.5 * 1e8 * world.mass_properties(rod).inertia[0][0] * (1.0 + 1e-9));
}

TEST(Continuous, KinematicWallsPushWhatIsInTheirWay) {
    for (const bool plane : {false, true}) {
        World world(kSpace);
        const BodyId door = world.create_body({.type = BodyType::Kinematic, .position = {0.0, 0.0, -5.0}, .linear_velocity = {0.0, 0.0, 600.0}});
        world.add_shape(door, plane ? Shape{Plane{{0.0f, 0.0f, 1.0f}, 0.0f}} : Shape{Box{{3.0f, 3.0f, 0.01f}}});
        const BodyId ball = world.create_body({});
        world.add_shape(ball, Sphere{0.05f});
        EXPECT_EQ(world.step(kDt).continuous.impacts, 1u) << plane;
        EXPECT_NEAR(world.linear_velocity(ball).z, 600.0, 1e-9);
        EXPECT_GT(world.pose(ball).position.z, world.pose(door).position.z);
        EXPECT_NEAR(world.pose(door).position.z, 5.0, 1e-12);
    }
}

TEST(Continuous, WakesASleeperThatIsHit) {
    Table table({.sleep = {.enabled = true}}, 0.0f);
    const BodyId crate = table.add({.position = {0.0, 0.5, 0.0}}, Box{});
    table.run(120);
    ASSERT_FALSE(table.world.is_awake(crate));
    const BodyId shot = table.add({.position = {-8.0, 0.6, 0.0}, .linear_velocity = {500.0, 0.0, 0.0}}, Sphere{0.2f}, {.density = 5000.0});
    const double before = table.world.momentum().linear.x;
    EXPECT_GE(table.world.step(kDt).continuous.impacts, 1u);
    EXPECT_TRUE(table.world.is_awake(crate));
    EXPECT_GT(table.world.linear_velocity(crate).x, 1.0);
    EXPECT_LT(table.world.pose(shot).position.x, table.world.pose(crate).position.x);
    EXPECT_NEAR(table.world.momentum().linear.x, before, 1e-9 * before);
}

// A plate that turns under a ball strikes it again and again; no blow lets it deeper.
TEST(Continuous, ABallStaysOnThePlateThatTurnsAgainstIt) {
    for (const BodyType type : {BodyType::Dynamic, BodyType::Kinematic}) {
        for (const double turn : {0.1, 0.3, 0.6, 1.0, 1.5}) {
            World world(kSpace);
            const BodyId plate = world.create_body({.type = type, .angular_velocity = {0.0, 0.0, turn / kDt}});
            world.add_shape(plate, Box{{1.5f, 0.02f, 1.0f}}, {.density = 1e5, .friction = 0.0f});
            const BodyId ball = world.create_body({.position = {0.7, 0.0721, 0.0}});
            world.add_shape(ball, Sphere{0.05f}, {.friction = 0.0f});
            for (int i = 0; i < 6; ++i) {
                EXPECT_EQ(world.step(kDt).continuous.overlapping, 0u);
                const dvec3 at = inverse_transform_point(world.pose(plate), world.center_of_mass(ball));
                if (std::abs(at.x) > 1.5) break;  // past the edge
                EXPECT_GT(at.y, 0.0) << to_string(type) << " " << turn << ", step " << i;
            }
        }
    }
}

// What an impact makes spin beyond what a step can follow is slowed to that, and counted, and not taken out.
TEST(Continuous, ANeedleThatIsHitDoesNotSpinOutOfTheWorld) {
    World world(kSpace);
    const BodyId needle = world.create_body({});
    world.add_shape(needle, Capsule{0.0005f, 0.02f});
    const BodyId shot = world.create_body({.position = {-5.0, 0.019, 0.0}, .linear_velocity = {8000.0, 0.0, 0.0}});
    world.add_shape(shot, Sphere{0.05f}, {.density = 1e4});
    const StepReport report = world.step(kDt);
    EXPECT_GE(report.continuous.impacts, 1u);
    EXPECT_GE(report.continuous.slowed, 1u);
    EXPECT_TRUE(world.step(kDt).quarantined.empty());
    EXPECT_LE(glm::length(world.angular_velocity(needle)) * kDt, 2000.0);
}

// Two balls that touch as the step begins rub each other to 2 10^5 rad/s, and fly: both are slowed before they are followed, from the start of their way.
TEST(Continuous, WhatBouncesAtOnceIntoTooFastASpinIsSlowedAllTheWay) {
    World world(kSpace);
    std::array<BodyId, 2> balls;
    for (int i = 0; i < 2; ++i) {
        const double side = i == 0 ? -1.0 : 1.0;
        balls[static_cast<std::size_t>(i)] =
            world.create_body({.position = {side * static_cast<double>(0.005f), 0.0, 0.0}, .linear_velocity = {-3000.0 * side, -3000.0 * side, 0.0}});
        world.add_shape(balls[static_cast<std::size_t>(i)], Sphere{0.005f}, {.friction = 1.0f, .restitution = 1.0f});
    }
    const StepReport report = world.step(kDt);
    EXPECT_EQ(report.impacts, 1u);
    EXPECT_EQ(report.continuous.slowed, 2u);
    EXPECT_TRUE(report.quarantined.empty());
    for (const BodyId ball : balls) {
        const dvec3 spin = world.angular_velocity(ball);
        EXPECT_NEAR(glm::length(spin) * kDt, 0.99 * 2000.0, 1e-6);
        const dquat turned = rotation_from_vector(kDt * spin);
        EXPECT_NEAR(std::abs(glm::dot(turned, world.pose(ball).orientation)), 1.0, 1e-9) << "by the spin that it has been given";
        EXPECT_NEAR(world.pose(ball).position.x, world.linear_velocity(ball).x * kDt, 0.006);
    }
}

// Bodies that step() moves little are not followed, and nothing of them depends on the stage.
TEST(Continuous, ChangesNothingWhereNothingIsFast) {
    Table with, without({.continuous = {.enabled = false}});
    for (Table* table : {&with, &without}) {
        for (int i = 0; i < 30; ++i) table->add({.position = {0.3 * (i % 3), 0.6 + 1.1 * (i / 3), 0.2 * (i % 2)}}, Box{});
    }
    for (int i = 0; i < 200; ++i) {
        EXPECT_EQ(with.world.step(kDt).continuous.followed, 0u);
        EXPECT_EQ(without.world.step(kDt).ms(Stage::Continuous), 0.0);
        ASSERT_EQ(with.world.state_hash(), without.world.state_hash()) << i;
    }
}

TEST(Continuous, IsTheSameWithEveryBroadphase) {
    std::vector<std::uint64_t> hashes;
    for (const BroadphaseMethod method : {BroadphaseMethod::Automatic, BroadphaseMethod::BruteForce, BroadphaseMethod::SweepAndPrune, BroadphaseMethod::DynamicTree}) {
        World world({.broadphase = method});
        world.add_shape(world.create_body({.type = BodyType::Static}), Box{{10.0f, 10.0f, 0.01f}});
        Random random(8);
        for (int i = 0; i < 100; ++i) {
            const BodyId body = world.create_body({.position = {random.range(-3.0, 3.0), random.range(-3.0, 3.0), random.range(-6.0, -0.5)},
                                                   .orientation = any_rotation(random),
                                                   .linear_velocity = {random.range(-50.0, 50.0), random.range(-50.0, 50.0), random.range(0.0, 500.0)},
                                                   .angular_velocity = {random.range(-50.0, 50.0), 0.0, 0.0}});
            world.add_shape(body, bullet(i % 7), {.restitution = i % 2 ? 0.5f : 0.0f});
        }
        std::size_t impacts = 0;
        for (int i = 0; i < 5; ++i) impacts += world.step(kDt).continuous.impacts;
        EXPECT_GT(impacts, 100u);
        hashes.push_back(world.state_hash());
    }
    for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes.front());
}

TEST(Continuous, NeverAndAlwaysAreObeyed) {
    const auto fly = [](Continuity continuity, double speed) {
        World world(kSpace);
        world.add_shape(world.create_body({.type = BodyType::Static}), Box{{5.0f, 5.0f, 0.005f}});
        const BodyId ball = world.create_body({.position = {0.0, 0.0, -1.0}, .linear_velocity = {0.0, 0.0, speed}, .continuity = continuity});
        world.add_shape(ball, Sphere{0.05f});
        const std::size_t followed = world.step(kDt).continuous.followed;
        world.step(kDt);
        EXPECT_EQ(world.pose(ball).position.z > 0.0, continuity == Continuity::Never);
        return followed;
    };
    EXPECT_EQ(fly(Continuity::Automatic, 100.0), 1u);
    EXPECT_EQ(fly(Continuity::Never, 100.0), 0u);
    EXPECT_EQ(fly(Continuity::Always, 1.0), 1u);
    EXPECT_EQ(fly(Continuity::Automatic, 1.0), 0u);
}

// A ball between two plates has more impacts than are followed: it stops between them, and goes on in the next step.
TEST(Continuous, WhatHasTooManyImpactsStaysWhereItIs) {
    World world({.gravity = dvec3{0.0}, .continuous = {.most_impacts = 3}});
    for (const double z : {-0.2, 0.2}) world.add_shape(world.create_body({.type = BodyType::Static, .position = {0.0, 0.0, z}}), Box{{5.0f, 5.0f, 0.005f}}, {.restitution = 1.0f});
    const BodyId ball = world.create_body({.linear_velocity = {0.0, 0.0, 500.0}});
    world.add_shape(ball, Sphere{0.05f}, {.restitution = 1.0f});
    std::size_t stopped = 0;
    for (int i = 0; i < 20; ++i) {
        const ContinuousCounts counts = world.step(kDt).continuous;
        stopped += counts.stopped;
        EXPECT_LE(counts.impacts, 3u);
        EXPECT_LT(std::abs(world.pose(ball).position.z), 0.2);
        EXPECT_NEAR(std::abs(world.linear_velocity(ball).z), 500.0, 1e-9);
    }
    EXPECT_GE(stopped, 19u);
}

TEST(Continuous, RefusesBadInput) {
    const auto refused = [](const ContinuousSettings& settings, ErrorCode code) {
        const Status status = validate(WorldDef{.continuous = settings});
        return !status && status.error().code == code;
    };
    EXPECT_TRUE(refused({.motion = 0.0}, ErrorCode::InvalidArgument));
    EXPECT_TRUE(refused({.motion = 0.6}, ErrorCode::InvalidArgument));
    EXPECT_TRUE(refused({.motion = std::numeric_limits<double>::quiet_NaN()}, ErrorCode::NotFinite));
    EXPECT_TRUE(refused({.most_impacts = 0}, ErrorCode::InvalidArgument));
    EXPECT_TRUE(refused({.most_impacts = 1001}, ErrorCode::InvalidArgument));
    World world;
    const BodyId fixed = world.create_body({.type = BodyType::Static}), free = world.create_body({});
    EXPECT_THROW(world.set_continuity(fixed, Continuity::Always), MisuseError);
    EXPECT_THROW(world.set_continuity(free, static_cast<Continuity>(3)), MisuseError);
    EXPECT_THROW(world.create_body({.type = BodyType::Static, .continuity = Continuity::Never}), MisuseError);
    EXPECT_EQ(world.continuity(free), Continuity::Automatic);
    world.set_continuity(free, Continuity::Never);
    EXPECT_EQ(world.continuity(free), Continuity::Never);
    world.destroy_body(free);
    EXPECT_THROW(world.set_continuity(free, Continuity::Always), MisuseError);
    EXPECT_THROW(static_cast<void>(world.continuity(free)), MisuseError);
    EXPECT_EQ(world.continuity(world.create_body({})), Continuity::Automatic);  // in the same slot
}

}  // namespace
}  // namespace carom
