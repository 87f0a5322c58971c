// Continuous collision in the world: what counts as an impact of a body, what a chord carries, and what happens when a step has looked at enough.
#include "table.hpp"

#include <carom/core/math.hpp>
#include <carom/dynamics/explain_sweep.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace carom {
namespace {

using namespace test;

constexpr WorldDef kWatched{.gravity = dvec3{0.0}, .record_paths = true};

// A ball on a rope's end goes round by some 2 rad, and its chord crosses a wall that its velocity has left again: it goes on from there as it moves, and
// has had no impact, of which it may have one.
TEST(ContinuousBudget, AChordThatIsLaidAnewIsNoImpact) {
    World world({.gravity = dvec3{0.0}, .record_paths = true, .continuous = {.most_impacts = 1}});
    const BodyId wall = world.create_body({.type = BodyType::Static, .position = {0.0, 0.65, 0.0}});
    world.add_shape(wall, Box{{5.0f, 0.01f, 5.0f}});
    const double spin = 2.6 / kDt;  // some of which the joint takes
    const BodyId ball =
        world.create_body({.position = {1.0, 0.0, 0.0}, .linear_velocity = {0.0, spin, 0.0}, .angular_velocity = {0.0, 0.0, spin}});
    world.add_shape(ball, Sphere{0.05f}, {.friction = 0.0f});
    world.create_joint(BallJointDef{.body_a = ball, .body_b = {}, .anchor_a = {-1.0, 0.0, 0.0}, .anchor_b = {0.0, 0.0, 0.0}});
    const ContinuousCounts counts = world.step(kDt).continuous;
    const SweepExplanation why = world.explain_sweep(ball, wall);
    EXPECT_FALSE(why.a.flew) << "or else nothing is tested";
    ASSERT_EQ(world.sweeps().bodies.at(0).times.size(), 3u) << "or else nothing is tested";
    EXPECT_EQ(counts.impacts, 0u);
    EXPECT_EQ(counts.stopped, 0u);
    EXPECT_EQ(why.a.impacts, 0);
    EXPECT_EQ(why.a.stopped, StopCause::None);
    EXPECT_TRUE(why.impacts.empty());
    const double relaid = world.sweeps().bodies[0].times[1];
    const dvec3 there = world.pose_within_step(ball, relaid).position, end = world.pose(ball).position;
    EXPECT_LT(end.y, 0.65 - 0.01 - 0.05 + 1e-4) << "this side of the wall";
    EXPECT_LT(end.x, there.x - 0.1) << "and not where it came to the wall";
    EXPECT_LT(end.y, there.y - 0.1);
}

/// A plate that tumbles on a joint, which holds it on a chord.
struct Tumbler {
    World world{kWatched};
    BodyId plate = world.create_body({.angular_velocity = {40.0, 60.0, 100.0}});
    Tumbler() {
        world.add_shape(plate, Box{{0.5f, 0.1f, 0.02f}}, {.friction = 0.0f});
        world.create_joint(BallJointDef{.body_a = plate, .body_b = {}});
    }
    [[nodiscard]] double energy() const {
        const dvec3 spin = rotate_inverse(world.pose(plate).orientation, world.angular_velocity(plate));
        return 0.5 * glm::dot(spin, world.mass_properties(plate).inertia * spin);
    }
};

// Struck by a speck in the middle of its chord: its spin is that of its frame then, so its energy is what it was.
TEST(ContinuousBudget, TheSpinOfAChordTurnsWithTheBody) {
    Tumbler alone;
    const BodyId aside = alone.world.create_body({.position = {9.0, 0.0, 0.0}});
    alone.world.add_shape(aside, Sphere{0.05f});
    ASSERT_EQ(alone.world.step(kDt).continuous.impacts, 0u);
    const dvec3 in_the_way = transform_point(alone.world.pose_within_step(alone.plate, 0.6), {0.4, 0.0, 0.0});

    Tumbler struck;
    const BodyId speck = struck.world.create_body({.position = in_the_way});
    struck.world.add_shape(speck, Sphere{0.05f}, {.density = 1e-9, .friction = 0.0f});
    ASSERT_GE(struck.world.step(kDt).continuous.impacts, 1u);
    ASSERT_FALSE(struck.world.explain_sweep(struck.plate, speck).a.flew);
    const double t = struck.world.sweeps().impacts.at(0).t;
    EXPECT_GT(t, 0.2) << "or else the body has hardly turned";
    EXPECT_LT(t, 0.6);
    EXPECT_NEAR(struck.energy(), alone.energy(), 1e-4 * alone.energy());
}

/// A rod that flies lengthwise along x, bounces off a wall and comes back past `count` specks that it does not touch, to another one.
/// @return the step's counts, and why the rod stopped.
std::pair<ContinuousCounts, StopCause> fly_past(int count, double& where) {
    World world(kWatched);
    BodyId walls[2];
    for (int i = 0; i < 2; ++i) {
        walls[i] = world.create_body({.type = BodyType::Static, .position = {i == 0 ? 1.6 : -0.6, 0.0, 0.0}});
        world.add_shape(walls[i], Box{{0.05f, 5.0f, 5.0f}}, {.restitution = 1.0f});
    }
    const BodyId specks = world.create_body({.type = BodyType::Static});
    for (int i = 0; i < count; ++i)
        world.add_shape(specks, Sphere{0.001f}, {.local = {{0.005 * (i % 200), 0.2 + 0.002 * (i / 200 % 100), 0.3}}});
    const BodyId rod = world.create_body({.orientation = rotation_about({0.0, 0.0, 1.0}, 0.5 * kPi), .linear_velocity = {150.0, 0.0, 0.0}});
    world.add_shape(rod, Capsule{0.02f, 0.48f}, {.friction = 0.0f, .restitution = 1.0f});
    const ContinuousCounts counts = world.step(kDt).continuous;
    where = world.pose(rod).position.x;
    EXPECT_NEAR(world.linear_velocity(rod).x, 150.0, 1e-6) << "it was struck by both in any case";
    EXPECT_EQ(counts.impacts, 2u);
    return {counts, world.explain_sweep(rod, walls[1]).a.stopped};
}

TEST(ContinuousBudget, AfterTooManyTimesOfImpactBodiesStopAtTheirNextImpact) {
    constexpr int kMost = 16'384 + 256;
    double where = 0.0;
    const auto [few, goes_on] = fly_past(kMost - 100, where);
    EXPECT_EQ(few.stopped, 0u);
    EXPECT_EQ(goes_on, StopCause::None);
    EXPECT_GT(where, 0.2) << "it bounced off";
    const auto [many, stops] = fly_past(kMost + 100, where);
    EXPECT_EQ(many.stopped, 1u);
    EXPECT_EQ(stops, StopCause::Budget);
    EXPECT_NEAR(where, -0.05, 1e-3) << "it stands at the wall";
}

/// A plate that tumbles at 10,000 rad/s beside `count` balls out of its reach, but in the box about it, and flies at a wall.
std::pair<ContinuousCounts, StopCause> tumble_past(int count) {
    World world(kWatched);
    const BodyId wall = world.create_body({.type = BodyType::Static, .position = {0.0, 0.0, 0.55}});
    world.add_shape(wall, Box{{5.0f, 5.0f, 0.05f}}, {.restitution = 1.0f});
    const BodyId balls = world.create_body({.type = BodyType::Static});
    for (int i = 0; i < count; ++i) world.add_shape(balls, Sphere{0.001f}, {.local = {{0.08, 0.08, 0.001 * (i % 300)}}});
    const BodyId plate = world.create_body({.linear_velocity = {0.0, 0.0, 40.0}, .angular_velocity = {6000.0, 7000.0, 3000.0}});
    world.add_shape(plate, Box{{0.09f, 0.04f, 0.02f}}, {.friction = 0.0f, .restitution = 1.0f});
    const ContinuousCounts counts = world.step(kDt).continuous;
    EXPECT_GE(counts.impacts, 1u);
    EXPECT_LT(counts.pairs, 16'384u) << "or else it is the other budget";
    return {counts, world.explain_sweep(plate, wall).a.stopped};
}

TEST(ContinuousBudget, AfterTooManyPiecesOfPathsBodiesStopAtTheirNextImpact) {
    const auto [few, goes_on] = tumble_past(100);
    EXPECT_EQ(few.stopped, 0u);
    EXPECT_EQ(goes_on, StopCause::None);
    const auto [many, stops] = tumble_past(1000);
    EXPECT_EQ(many.impacts, 1u);
    EXPECT_EQ(many.stopped, 1u);
    EXPECT_EQ(stops, StopCause::Budget);
}

}  // namespace
}  // namespace carom
