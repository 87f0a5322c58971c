// Resistance to rolling and spinning, against the textbook.
#include "table.hpp"

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

namespace carom {
namespace {

using namespace test;

constexpr double kG = 9.81;

// a = g rho / (r (1 + I/(m r^2))), with I = 2/5 m r^2: in every direction alike, at every size and mass.
TEST(Rolling, BallsSlowDownAsTheyShould) {
    for (const double radius : {0.05, 0.5, 5.0}) {
        for (const double angle : {0.0, 0.5, 0.7854, 2.0}) {
            Table table;
            const double rho = 0.01 * radius, speed = 2.0 * std::sqrt(kG * radius), expected = kG * rho / (radius * 1.4);
            const dvec3 way{std::cos(angle), 0.0, std::sin(angle)};
            const BodyId ball = table.add({.position = {0, radius, 0}, .linear_velocity = speed * way, .angular_velocity = glm::cross(dvec3{0, 1, 0}, speed * way) / radius},
                                          Sphere{static_cast<float>(radius)}, {.density = 200.0 * radius, .rolling_resistance = static_cast<float>(rho)});
            table.run(60);  // a second
            const dvec3 velocity = table.world.linear_velocity(ball), turns = table.world.angular_velocity(ball) * radius;
            EXPECT_NEAR(glm::dot(velocity, way), speed - expected * 1.0, 0.01 * expected) << radius << ' ' << angle;
            EXPECT_NEAR(glm::length(glm::cross(velocity, way)), 0.0, 1e-4 * speed) << "straight on";
            EXPECT_NEAR(glm::length(turns), glm::length(velocity), 1e-3 * speed) << "without slipping";
        }
    }
}

TEST(Rolling, BallsComeToRestAndStayThere) {
    Table table;
    const BodyId ball = table.add({.position = {0, 0.5, 0}, .linear_velocity = {1, 0, 0}, .angular_velocity = {0, 0, -2}}, Sphere{0.5f}, {.rolling_resistance = 0.02f});
    const double way = 1.0 / (2.0 * kG * 0.02 / (0.5 * 1.4));
    table.run(300);
    const double rests = table.world.pose(ball).position.x;
    EXPECT_NEAR(rests, way, 0.02 * way);
    table.run(600);
    EXPECT_NEAR(table.world.pose(ball).position.x, rests, 1e-6);
}

TEST(Rolling, SlopesBelowTheRollingAngleHoldBalls) {
    const double rho = 0.1, radius = 0.5;  // tan = 0.2
    for (const double slope : {0.5, 0.9, 0.99, 1.01, 1.1, 2.0}) {
        const double angle = std::atan(slope * rho / radius);
        const dquat turn = rotation_from_vector({0, 0, -angle});
        World world;
        world.add_shape(world.create_body({.type = BodyType::Static, .orientation = turn}), Plane{{0, 1, 0}, 0}, {.friction = 1.0f});
        const BodyId ball = world.create_body({.position = rotate(turn, dvec3{0, radius, 0})});
        world.add_shape(ball, Sphere{static_cast<float>(radius)}, {.friction = 1.0f, .rolling_resistance = static_cast<float>(rho)});
        for (int i = 0; i < 120; ++i) world.step(kDt);
        const double expected = std::max(0.0, kG * (std::sin(angle) - std::cos(angle) * rho / radius) / 1.4) * 2.0;
        EXPECT_NEAR(glm::length(world.linear_velocity(ball)), expected, slope < 1.0 ? 1e-6 : 1e-3 * 2.0 * kG * rho / radius / 1.4) << slope;
        if (slope < 1.0) {
            EXPECT_LT(glm::length(world.pose(ball).position - rotate(turn, dvec3{0, radius, 0})), 1e-3 * radius) << slope;
        }
    }
}

// I dw/dt = -tau m g.
TEST(Torsion, TopsSpinDownAndStop) {
    for (const double mass : {1e-3, 1.0, 1e4}) {
        Table table;
        const double radius = 0.2, tau = 1e-3, inertia = 0.4 * mass * radius * radius, spin = 3.0, slows = tau * mass * kG / inertia;
        const double volume = 4.0 / 3.0 * kPi * radius * radius * radius;
        const BodyId ball = table.add({.position = {0, radius, 0}, .angular_velocity = {0, spin, 0}}, Sphere{static_cast<float>(radius)},
                                      {.density = mass / volume, .torsion = static_cast<float>(tau)});
        table.run(60);
        EXPECT_NEAR(table.world.angular_velocity(ball).y, spin - slows, 0.01 * slows);
        table.run(static_cast<int>(60.0 * spin / slows));
        EXPECT_NEAR(glm::length(table.world.angular_velocity(ball)), 0.0, 1e-6);
        EXPECT_NEAR(table.world.pose(ball).position.x, 0.0, 1e-6);
    }
}

/// Balls and capsules with resistances, thrown. @return the greatest rise of the energy over the least before, share of the first.
double greatest_rise(double apart, int layers, double moved) {
    Table table;
    for (int i = 0; i < 40; ++i) {
        const BodyDef def{.position = {apart * (0.9 * (i % 5) + moved), 0.5 + (layers > 1 ? 0.8 * (i / 10) : 0.0), apart * 0.8 * (layers > 1 ? i % 10 / 5 : i / 5)},
                          .linear_velocity = {1, 0, 0.3},
                          .angular_velocity = {3, 5, -4}};
        if (i % 2 == 0) table.add(def, Sphere{0.35f}, {.rolling_resistance = 0.05f, .torsion = 0.1f});
        else table.add(def, Capsule{0.2f, 0.2f}, {.rolling_resistance = 10.0f});
    }
    double energy = table.world.energy().total(), rise = 0.0;
    const double scale = std::abs(energy);
    for (int i = 0; i < 300; ++i) {
        table.world.step(kDt);
        const double now = table.world.energy().total();
        rise = std::max(rise, (now - energy) / scale);
        energy = std::min(energy, now);
    }
    return rise;
}

// Each by itself: to rounding. A heap that is hit is left by one pass over its contacts a substep with some of the blow, resistances or none (docs/stability.md).
TEST(Rolling, TakesEnergyOutOnly) {
    const double alone = greatest_rise(4.0, 1, 0.0);
    EXPECT_LT(alone, 1e-5);
    double heap = 0.0;
    for (int k = 0; k < 6; ++k) heap = std::max(heap, greatest_rise(1.0, 4, 0.01 * k));
    std::printf("energy rises by %.2g of the first where bodies roll alone, by %.2g in a heap\n", alone, heap);
    EXPECT_LT(heap, 5e-3);
}

// The rule of friction_rule: the one that is named, the later of two, the maximum of none.
TEST(Rolling, TwoShapesCombine) {
    const auto slows = [](float of_ball, float of_ground, std::optional<CombineRule> rule) {
        World world;
        world.add_shape(world.create_body({.type = BodyType::Static}), Plane{{0, 1, 0}, 0}, {.rolling_resistance = of_ground, .rolling_rule = rule});
        const BodyId ball = world.create_body({.position = {0, 0.5, 0}, .linear_velocity = {4, 0, 0}, .angular_velocity = {0, 0, -8}});
        world.add_shape(ball, Sphere{0.5f}, {.rolling_resistance = of_ball});
        for (int i = 0; i < 60; ++i) world.step(kDt);
        return (4.0 - world.linear_velocity(ball).x) * 0.5 * 1.4 / kG;
    };
    EXPECT_NEAR(slows(0.01f, 0.04f, std::nullopt), 0.04, 1e-3);
    EXPECT_NEAR(slows(0.01f, 0.04f, CombineRule::Minimum), 0.01, 1e-3);
    EXPECT_NEAR(slows(0.01f, 0.04f, CombineRule::GeometricMean), 0.02, 1e-3);
    EXPECT_NEAR(slows(0.01f, 0.03f, CombineRule::Average), 0.02, 1e-3);
    EXPECT_NEAR(slows(0.0f, 0.0f, std::nullopt), 0.0, 1e-5) << "a ball rolls on where nobody asks";
}

// What asks stays with the soft solver, and the plan says so.
TEST(Rolling, IslandsWithItAreNotSolvedDirectly) {
    for (const float resistance : {0.0f, 0.01f}) {
        Table table({.contact_method = ContactMethod::Direct});
        table.add({.position = {0, 0.5, 0}}, Sphere{0.5f}, {.rolling_resistance = resistance});
        table.run(5);
        EXPECT_EQ(table.world.step(kDt).direct.stiff, resistance == 0.0f ? 1u : 0u);
        bool said = false;
        for (const std::string& setting : table.world.plan(kDt).settings) said |= setting.find("1 shapes resist to rolling") != std::string::npos;
        EXPECT_EQ(said, resistance > 0.0f);
    }
}

TEST(Rolling, RefusesBadInput) {
    Table table;
    const BodyId body = table.world.create_body({});
    for (const float bad : {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        EXPECT_THROW(table.world.add_shape(body, Sphere{}, {.rolling_resistance = bad}), MisuseError);
        EXPECT_THROW(table.world.add_shape(body, Sphere{}, {.torsion = bad}), MisuseError);
    }
    EXPECT_THROW(table.world.add_shape(body, Sphere{}, {.rolling_rule = static_cast<CombineRule>(9)}), MisuseError);
    EXPECT_TRUE(table.world.shapes(body).empty());
}

}  // namespace
}  // namespace carom
