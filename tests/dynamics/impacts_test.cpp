// Impacts: each at its own time inside the step, at the speed it has there; energy and momentum.
#include "table.hpp"

#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace carom {
namespace {

using namespace test;

constexpr double kStep = 1.0 / 240.0;

World weightless() { return World({.gravity = {0, 0, 0}}); }

BodyId add_ball(World& world, const dvec3& at, const dvec3& velocity, float restitution = 1.0f, double density = 1000.0, float radius = 0.5f) {
    const BodyId id = world.create_body({.position = at, .linear_velocity = velocity});
    world.add_shape(id, Sphere{radius}, {.density = density, .friction = 0.0f, .restitution = restitution});
    return id;
}

/// Height of the next apex, from energy, so that nothing is lost between two steps [m].
double apex(const World& world, BodyId ball) {
    const double v = world.linear_velocity(ball).y;
    return world.pose(ball).position.y + v * v / (2.0 * 9.81);
}

// A7 and case 38: with e = 1 an apex changes by at most 1e-6 a bounce. The sum over all bounces is what is asked here.
TEST(Impacts, BallBouncesForever) {
    Table table;
    const BodyId ball = table.add({.position = {0, 1.5, 0}}, Sphere{0.5f}, {.friction = 0.0f, .restitution = 1.0f});
    std::size_t bounces = 0;
    while (bounces < 1000) bounces += table.world.step(kStep).impacts;
    EXPECT_NEAR(apex(table.world, ball) - 0.5, 1.0, 1e-10) << bounces;
}

// A7: h_n = h0 e^(2n), and the times of the impacts, until what is left is slower than two steps of gravity.
TEST(Impacts, EachBounceTakesItsShare) {
    Table table;
    const double e = 0.8;
    const BodyId ball = table.add({.position = {0, 5.5, 0}}, Sphere{0.5f}, {.restitution = 0.8f});
    double wanted = 5.0;
    int bounces = 0;
    for (int i = 0; i < 2400 && bounces < 10; ++i) {
        if (table.world.step(kStep).impacts == 0) continue;
        wanted *= e * e;
        ++bounces;
        EXPECT_NEAR(apex(table.world, ball) - 0.5, wanted, 1e-6 * wanted) << bounces;
    }
    EXPECT_EQ(bounces, 10);
    for (int i = 0; i < 2400; ++i) table.world.step(kStep);
    EXPECT_LT(glm::length(table.world.linear_velocity(ball)), 1e-5) << "comes to rest";
    EXPECT_NEAR(table.world.pose(ball).position.y, 0.5, 1e-3);
}

// A7: at rest after sqrt(2 h0 / g) (1 + e) / (1 - e).
TEST(Impacts, BallRestsWhenTheSeriesEnds) {
    Table table;
    const BodyId ball = table.add({.position = {0, 1.5, 0}}, Sphere{0.5f}, {.restitution = 0.5f});
    double last = 0.0;
    for (int i = 0; i < 960; ++i) {
        table.world.step(kStep);
        if (std::abs(table.world.linear_velocity(ball).y) > 1e-3) last = (i + 1) * kStep;
    }
    EXPECT_NEAR(last, std::sqrt(2.0 / 9.81) * 3.0, 10.0 * kStep);
}

// A11.
TEST(Impacts, TwoBodiesPartAsNewtonSays) {
    Random random(11);
    for (int i = 0; i < 50; ++i) {
        World world = weightless();
        const double v1 = random.range(1.0, 20.0), v2 = random.range(-20.0, 0.5), e = 0.25 * (i % 5);
        const double d1 = random.range(10.0, 1e4), d2 = random.range(10.0, 1e4);
        const double start = random.range(1.05, 1.2);
        const BodyId a = add_ball(world, {0, 0, 0}, {v1, 0, 0}, static_cast<float>(e), d1);
        const BodyId b = add_ball(world, {start, 0, 0}, {v2, 0, 0}, static_cast<float>(e), d2);
        const double m1 = world.mass_properties(a).mass, m2 = world.mass_properties(b).mass;
        const double p = m1 * v1 + m2 * v2;
        std::size_t impacts = 0;
        for (int k = 0; k < 240; ++k) impacts += world.step(kStep).impacts;
        if (e == 0.0) continue;  // is the solver's
        EXPECT_EQ(impacts, 1u);
        const double after = ((m1 - e * m2) * v1 + (1.0 + e) * m2 * v2) / (m1 + m2);
        EXPECT_NEAR(world.linear_velocity(a).x, after, 1e-13 * 20.0) << i;
        const double momentum = m1 * world.linear_velocity(a).x + m2 * world.linear_velocity(b).x;
        EXPECT_NEAR(momentum, p, 1e-14 * (m1 * std::abs(v1) + m2 * std::abs(v2)));
    }
}

// A12: as many balls leave as came, at every gap between them.
TEST(Impacts, CradleSendsOutWhatCameIn) {
    for (const double gap : {0.0, 1e-7, 1e-3}) {
        for (int in = 1; in <= 4; ++in) {
            World world = weightless();
            std::vector<BodyId> balls;
            const double spacing = 1.0 + gap;
            for (int i = 0; i < 5; ++i) {
                const bool moves = i < in;
                balls.push_back(add_ball(world, {i * spacing - (moves ? 0.5 : 0.0), 0, 0}, {moves ? 2.0 : 0.0, 0, 0}));
            }
            const Energy before = world.energy();
            for (int k = 0; k < 240; ++k) world.step(kStep);
            for (int i = 0; i < 5; ++i) EXPECT_NEAR(world.linear_velocity(balls[static_cast<std::size_t>(i)]).x, i >= 5 - in ? 2.0 : 0.0, 1e-6) << in << " " << i << " " << gap;
            EXPECT_NEAR(world.energy().kinetic, before.kinetic, 1e-12 * before.kinetic);
        }
    }
}

// Case 37: one ball meets two at once. What is symmetric stays so, and nothing is lost.
TEST(Impacts, SimultaneousImpactsAreSymmetric) {
    World world = weightless();
    const double c = std::sqrt(0.75);
    const BodyId left = add_ball(world, {c, 0.5, 0}, {0, 0, 0}), right = add_ball(world, {c, -0.5, 0}, {0, 0, 0});
    const BodyId cue = add_ball(world, {-1.0, 0, 0}, {3, 0, 0});
    const Energy energy = world.energy();
    const Momentum momentum = world.momentum();
    for (int k = 0; k < 240; ++k) world.step(kStep);
    EXPECT_NEAR(world.energy().kinetic, energy.kinetic, 1e-12 * energy.kinetic);
    EXPECT_LT(glm::length(world.momentum().linear - momentum.linear), 1e-12 * glm::length(momentum.linear));
    const dvec3 vl = world.linear_velocity(left), vr = world.linear_velocity(right);
    EXPECT_NEAR(vl.x, vr.x, 1e-12);
    EXPECT_NEAR(vl.y, -vr.y, 1e-12);
    EXPECT_NEAR(vl.x, 3.0 * 1.2 * 0.5, 1e-6);  // each gets 2 c / 2.5 along its own line of centres
    EXPECT_NEAR(world.linear_velocity(cue).x, -0.6, 1e-6);
}

/// A19: fifteen balls in a triangle and the cue ball. @param mirror  puts everything at -z, in the same order.
World break_shot(double mirror, double offset) {
    World world = weightless();
    const double c = std::sqrt(0.75);
    for (int row = 0; row < 5; ++row) {
        for (int i = 0; i <= row; ++i) add_ball(world, {1.0001 * c * row, 0, mirror * 1.0001 * (i - 0.5 * row)}, {0, 0, 0});
    }
    add_ball(world, {-5.0, 0, mirror * offset}, {10, 0, 0});
    return world;
}

TEST(Impacts, BilliardBreakKeepsEnergyAndMomentum) {
    World world = break_shot(1.0, 0.05);
    const Energy energy = world.energy();
    const Momentum momentum = world.momentum();
    std::size_t impacts = 0, left = 0;
    for (int k = 0; k < 480; ++k) {
        const StepReport report = world.step(kStep);
        impacts += report.impacts;
        left += report.impacts_left;
    }
    EXPECT_GT(impacts, 15u);
    EXPECT_EQ(left, 0u);
    EXPECT_NEAR(world.energy().kinetic, energy.kinetic, 1e-10 * energy.kinetic);
    EXPECT_LT(glm::length(world.momentum().linear - momentum.linear), 1e-12 * glm::length(momentum.linear));
    EXPECT_LT(glm::length(world.momentum().angular - momentum.angular), 1e-6 * 5.0 * glm::length(momentum.linear));
}

// Columns that come down at once: their impacts run up and down for thousands of rounds. What the step has no budget for is stopped, not lost.
TEST(Impacts, AStepThatWouldBounceForTooLongSaysSo) {
    World world;
    const BodyId ground = world.create_body({.type = BodyType::Static});
    world.add_shape(ground, Plane{}, {.restitution = 0.5f});
    for (int i = 0; i < 125; ++i) {
        const BodyId box = world.create_body({.position = {1.1 * (i % 5), 0.6 + 1.05 * (i / 25), 1.1 * (i / 5 % 5)}, .linear_velocity = {0, -20, 0}});
        world.add_shape(box, Box{{0.5f, 0.5f, 0.5f}}, {.restitution = 0.5f});
    }
    const double first = world.energy().total();
    std::size_t left = 0;
    for (int i = 0; i < 240; ++i) {
        left += world.step(1.0 / 60.0).impacts_left;
        EXPECT_LT(world.energy().total(), 1.0001 * first) << i;
    }
    EXPECT_GT(left, 0u);
    for (const BodyId body : world.bodies()) EXPECT_GT(world.center_of_mass(body).y, -0.01);
}

TEST(Impacts, MirroredBreakIsTheMirrorImage) {
    World one = break_shot(1.0, 0.05), other = break_shot(-1.0, 0.05);
    for (int k = 0; k < 480; ++k) one.step(kStep), other.step(kStep);
    for (std::size_t i = 0; i < one.bodies().size(); ++i) {
        const dvec3 v = one.linear_velocity(one.bodies()[i]), w = other.linear_velocity(other.bodies()[i]);
        EXPECT_EQ(v.x, w.x) << i;
        EXPECT_EQ(v.z, -w.z) << i;
    }
}

// A box that falls flat meets the ground with four corners at once, and rises flat.
TEST(Impacts, FlatBoxRisesFlat) {
    Table table;
    const BodyId box = table.add({.position = {0, 1.25, 0}}, Box{{0.5f, 0.25f, 0.4f}}, {.restitution = 0.5f});
    std::size_t impacts = 0;
    while (impacts == 0) impacts += table.world.step(kStep).impacts;
    EXPECT_EQ(impacts, 4u);
    EXPECT_NEAR(apex(table.world, box) - 0.25, 0.25, 1e-6);
    EXPECT_LT(glm::length(table.world.angular_velocity(box)), 1e-9);
}

// Rule G with rough, spinning boxes that bounce off the ground and each other: impacts take energy out, never in.
TEST(Impacts, EnergyNeverGrows) {
    Table table;
    Random random(37);
    for (int i = 0; i < 20; ++i) {
        const dvec3 at{random.range(-2, 2), 1.0 + i, random.range(-2, 2)}, spin{random.range(-5, 5), random.range(-5, 5), random.range(-5, 5)};
        const auto e = static_cast<float>(random.range(0.0, 1.0));
        table.add({.position = at, .angular_velocity = spin}, Box{{0.3f, 0.2f, 0.4f}}, {.friction = 0.5f, .restitution = e});
    }
    double energy = table.world.energy().total();
    const double whole = energy;
    std::size_t impacts = 0;
    for (int k = 0; k < 1200; ++k) {
        impacts += table.world.step(kStep).impacts;
        const double now = table.world.energy().total();
        EXPECT_LE(now, energy + 1e-4 * whole) << k;
        energy = std::min(energy, now);
    }
    EXPECT_GT(impacts, 100u);
    EXPECT_LE(table.world.energy().total(), energy + 1e-3 * whole);
}

// A ball on a moving kinematic platform bounces at the speed relative to it.
TEST(Impacts, PlatformHitsBack) {
    World world = weightless();
    const BodyId racket = world.create_body({.type = BodyType::Kinematic, .linear_velocity = {0, 4, 0}});
    world.add_shape(racket, Box{{2, 0.25f, 2}});
    const BodyId ball = add_ball(world, {0, 1.5, 0}, {0, -1, 0});
    for (int k = 0; k < 120; ++k) world.step(kStep);
    EXPECT_NEAR(world.linear_velocity(ball).y, 9.0, 1e-12);
}

// Two spheres that graze: the normal is the line of their centres at the impact, not at the start of the step.
TEST(Impacts, GrazingSpheresTurnAboutTheirLineOfCentres) {
    World world = weightless();
    const double miss = 0.9;  // of the diameter
    const BodyId still = add_ball(world, {0, 0, 0}, {0, 0, 0});
    add_ball(world, {-2.0, miss, 0}, {30, 0, 0});
    for (int k = 0; k < 120; ++k) world.step(kStep);
    const dvec3 direction = glm::normalize(world.linear_velocity(still));
    const dvec3 centres{std::sqrt(1.0 - miss * miss), -miss, 0.0};
    EXPECT_LT(glm::length(direction - centres), 1e-5);
    EXPECT_LT(glm::length(world.angular_velocity(still)), 1e-12);
}

// What rests on the ground and what bounces on top of it: the first stays the solver's, and stays.
TEST(Impacts, BallBouncesOnARestingBox) {
    Table table;
    const BodyId box = table.add({.position = {0, 0.5, 0}}, Box{{1, 0.5f, 1}}, {.density = 1e5});
    const BodyId ball = table.add({.position = {0, 2.5, 0}}, Sphere{0.5f}, {.density = 100.0, .restitution = 1.0f});
    table.run(60);
    std::size_t bounces = 0;
    for (int k = 0; k < 960; ++k) bounces += table.world.step(kStep).impacts;
    EXPECT_GE(bounces, 2u);
    EXPECT_NEAR(apex(table.world, ball), 2.5, 0.02);
    EXPECT_NEAR(table.world.pose(box).position.y, 0.5, 1e-3);
}

}  // namespace
}  // namespace carom
