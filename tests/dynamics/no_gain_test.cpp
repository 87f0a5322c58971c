// Places where energy once came from nothing, or valid input stopped the program.
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/dynamics/world.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace carom {
namespace {

constexpr double kDt = 1.0 / 60.0;

BodyId add_body(World& world, const Shape& shape, const BodyDef& body, const ShapeDef& def = {}) {
    const BodyId id = world.create_body(body);
    world.add_shape(id, shape, def);
    return id;
}

double most_energy(World& world, int steps) {
    double most = world.energy().total();
    for (int i = 0; i < steps; ++i) {
        world.step(kDt);
        most = std::max(most, world.energy().total());
    }
    return most;
}

TEST(NoGain, ABoxThatBouncesAndTumbles) {
    for (int k = 0; k < 20; ++k) {
        World world({.gravity = dvec3{0.0}});
        for (const double x : {-4.0, 4.0}) {
            add_body(world, Plane{{x < 0.0 ? 1.0f : -1.0f, 0.0f, 0.0f}, -4.0f}, {.type = BodyType::Static}, {.restitution = 1.0f});
        }
        const double turn = 0.1 * k;
        add_body(world, Box{{0.5f, 0.4f, 0.6f}},
                 {.orientation = glm::normalize(dquat{1.0, 0.3, turn, 0.2}), .linear_velocity = {5.0, 0.0, 0.0}, .angular_velocity = {1.0, turn, 0.5}},
                 {.friction = 0.0f, .restitution = 1.0f});
        const double before = world.energy().total();
        EXPECT_LT(most_energy(world, 400), 1.001 * before) << k;
    }
}

// A rod 1:50, whose ends come to a wall and away from it several times a step.
TEST(NoGain, ARodThatBouncesAndTumbles) {
    Random random(50);
    for (int k = 0; k < 20; ++k) {
        World world({.gravity = dvec3{0.0}});
        for (const double y : {-2.0, 2.0}) {
            add_body(world, Box{{20.0f, 0.5f, 20.0f}}, {.type = BodyType::Static, .position = {0.0, y, 0.0}}, {.friction = 0.0f, .restitution = 1.0f});
        }
        const auto draw = [&](double most) { return dvec3{random.range(-most, most), random.range(-most, most), random.range(-most, most)}; };
        const dquat turn = rotation_from_vector(draw(3.0));
        add_body(world, Box{{0.02f, 1.0f, 0.02f}},
                 {.orientation = turn, .linear_velocity = draw(5.0), .angular_velocity = random.range(10.0, 70.0) * glm::normalize(draw(1.0))},
                 {.friction = 0.0f, .restitution = 1.0f});
        const double before = world.energy().total();
        EXPECT_LT(most_energy(world, 400), 1.001 * before) << k;
    }
}

TEST(NoGain, AHeavyBoxThatFallsOnALightStack) {
    for (const double ratio : {1e3, 1e4, 1e6}) {
        World world;
        add_body(world, Plane{}, {.type = BodyType::Static});
        for (int i = 0; i < 4; ++i) add_body(world, Box{{0.5f, 0.5f, 0.5f}}, {.position = {0.0, 0.5 + i, 0.0}});
        add_body(world, Box{{0.5f, 0.5f, 0.5f}}, {.position = {0.0, 5.5, 0.0}}, {.density = 1000.0 * ratio});
        const double before = world.energy().total();
        EXPECT_LT(most_energy(world, 300), 1.001 * before) << ratio;
        for (const BodyId body : world.bodies()) EXPECT_GT(world.center_of_mass(body).y, -0.5) << ratio;
    }
}

// Contacts are as soft as the longest step of late: a spring that is let loose stiffer than it was compressed would throw the stack.
TEST(NoGain, ABoxThatFallsOnAStackInStepsOfAnyLength) {
    for (const double ratio : {1.0, 100.0}) {
        World world;
        Random random(5);
        add_body(world, Plane{}, {.type = BodyType::Static});
        for (int i = 0; i < 8; ++i) add_body(world, Box{{0.5f, 0.5f, 0.5f}}, {.position = {0.0, 0.5 + i, 0.0}});
        const BodyId top = add_body(world, Box{{0.5f, 0.5f, 0.5f}}, {.position = {0.0, 9.5, 0.0}}, {.density = 1000.0 * ratio});
        const double before = world.energy().total();
        double most = before, length = 0.0;
        for (int i = 0; i < 1200; ++i) {
            if (i % 4 == 0) length = kDt * (random.unit() < 0.5 ? 1.0 : random.range(0.01, 1.0));
            world.step(length);
            most = std::max(most, world.energy().total());
        }
        EXPECT_LT(most, 1.001 * before) << ratio;
        EXPECT_NEAR(world.center_of_mass(top).y, 8.5, 0.05) << ratio;
    }
}

// The impulses of an impact are no force: in a longer step they do not grow.
TEST(NoGain, ABoxThatLandsInStepsOfTwoLengths) {
    for (int k = 0; k < 120; ++k) {
        const float resistance = k < 60 ? 0.0f : 0.05f;
        World world;
        add_body(world, Plane{}, {.type = BodyType::Static}, {.friction = 1.0f, .rolling_resistance = resistance, .torsion = resistance});
        add_body(world, Box{{0.25f, 0.2f, 0.12f}}, {.position = {0, 1, 0}, .orientation = glm::normalize(dquat{1.0, 0.1 * k, 0.7, 0.07 * k})}, {.friction = 1.0f});
        double before = world.energy().total();
        const double first = before;
        const double length = k < 60 ? kDt : 0.25 * kDt;
        for (int i = 0; i < 480; ++i) {
            world.step(i % 2 == 0 ? 0.1 * length : length);
            const double now = world.energy().total();
            EXPECT_LT(now, before + 0.05 * first) << k << ' ' << i;
            before = now;
        }
    }
}

// What pushes, slows or lifts a body a little does not take its stack from the direct solve.
TEST(NoGain, AStackUnderAHeavyBoxThatIsPushedALittle) {
    for (int way = 0; way < 4; ++way) {
        World world;
        add_body(world, Plane{}, {.type = BodyType::Static});
        std::vector<BodyId> boxes;
        for (int i = 0; i < 8; ++i) boxes.push_back(add_body(world, Box{{0.5f, 0.5f, 0.5f}}, {.position = {0.0, 0.5 + i, 0.0}}));
        add_body(world, Box{{0.5f, 0.5f, 0.5f}}, {.position = {0.0, 8.5, 0.0}}, {.density = 1e6});
        for (int i = 0; i < 100; ++i) world.step(kDt);
        const double before = world.energy().total();
        if (way == 1) world.set_damping(boxes[0], 0.01, 0.01);
        if (way == 2) world.set_gravity_scale(boxes[0], 0.999);
        for (int i = 0; i < 200; ++i) {
            if (way == 0 && i == 0) world.apply_force(boxes[0], {1.0, 0.0, 0.0}, world.center_of_mass(boxes[0]));
            if (way == 3 && i % 2 == 0) world.apply_torque(boxes[0], {0.0, 1.0, 0.0});
            EXPECT_EQ(world.step(kDt).direct.solved, 1u) << way << " step " << i;
        }
        EXPECT_NEAR(world.energy().total(), before, 1e-4 * before) << way;
        EXPECT_NEAR(world.center_of_mass(boxes[7]).y, 7.5, 1e-3) << way;
    }
}

TEST(NoGain, BoxesThatBounceOnOneAnother) {
    World world;
    add_body(world, Plane{}, {.type = BodyType::Static}, {.restitution = 0.9f});
    for (int i = 0; i < 10; ++i) add_body(world, Box{{0.5f, 0.5f, 0.5f}}, {.position = {0.0, 0.55 + 1.05 * i, 0.0}}, {.restitution = 0.9f});
    const double before = world.energy().total();
    double deepest = 0.0;
    for (int i = 0; i < 600; ++i) {
        deepest = std::max(deepest, world.step(kDt).max_penetration);
        ASSERT_LT(world.energy().total(), 1.001 * before) << i;
    }
    EXPECT_LT(deepest, 0.1);
}

TEST(NoGain, ATurnWithOneAxisLocked) {
    for (const unsigned char locked : {LockedAxes::TurnX, LockedAxes::TurnY, LockedAxes::TurnZ}) {
        World world({.gravity = dvec3{0.0}});
        add_body(world, Box{{0.1f, 0.2f, 1.0f}},
                 {.orientation = glm::normalize(dquat{1.0, 0.2, 0.3, 0.1}), .angular_velocity = {6.0, 5.0, 4.0}, .locked = locked});
        const double before = world.energy().total();
        EXPECT_LT(most_energy(world, 1200), 1.001 * before);
        EXPECT_GT(world.energy().total(), 0.999 * before);
    }
}

TEST(NoGain, WhatNoStepCanTurnGoesIntoQuarantine) {
    World world({.gravity = dvec3{0.0}});
    const BodyId speck = add_body(world, Box{{5e-4f, 6.5e-4f, 8e-4f}}, {.position = {0.0, 1.0, 0.0}});
    const BodyId other = add_body(world, Box{{0.5f, 0.5f, 0.5f}}, {.position = {5.0, 1.0, 0.0}, .linear_velocity = {1.0, 0.0, 0.0}});
    world.apply_force(speck, {0.0, 0.1, 0.0}, {5e-4, 1.0, 2.5e-4});  // 1e8 rad/s² and more
    const StepReport report = world.step(kDt);
    ASSERT_EQ(report.quarantined.size(), 1u);
    EXPECT_EQ(report.quarantined[0], speck);
    EXPECT_TRUE(world.is_quarantined(speck));
    EXPECT_NEAR(world.center_of_mass(other).x, 5.0 + kDt, 1e-12);
}

// A light box creeps out from under a heavy one without friction, solved directly, until a solve does not converge: what that one left is no force for the soft
// solver to start from (it made 91,400 m/s of 18 once).
TEST(NoGain, ALightBoxThatSlipsOutFromUnderAHeavyOne) {
    World world;
    add_body(world, Plane{}, {.type = BodyType::Static}, {.friction = 0.0f});
    const auto about_y = [](double angle) { return rotation_from_vector({0.0, angle, 0.0}); };
    const BodyId light = add_body(world, Box{{0.28301f, 0.0652287f, 0.405155f}},
                                  {.position = {0.0183397, 0.0652287, -0.0441214}, .orientation = about_y(1.52111)}, {.friction = 0.0f});
    add_body(world, Box{{0.5f, 0.4f, 0.5f}}, {.position = {0.0, 0.530457, 0.0}, .orientation = about_y(4.55303)}, {.density = 1e9f, .friction = 0.0f});
    const double before = world.energy().total();
    std::size_t fell_back = 0;
    for (int i = 0; i < 30; ++i) {
        fell_back += world.step(kDt).direct.fell_back;
        EXPECT_LT(world.energy().total(), 1.001 * before) << i;
        EXPECT_LT(glm::length(world.linear_velocity(light)), 100.0) << i;
    }
    EXPECT_GT(fell_back, 0u);
}

// Small boxes bear a million times their weight, solved directly, until that is taken away: what it pressed with is nothing for the soft solver to start from.
TEST(NoGain, SmallBoxesWhoseLoadIsTakenAway) {
    for (int k = 0; k < 8; ++k) {
        World world;
        Random random(static_cast<std::uint64_t>(70 + k));
        add_body(world, Plane{}, {.type = BodyType::Static}, {.friction = 0.5f});
        double y = 0.0;
        for (int i = 0; i < 1 + k % 3; ++i) {
            const vec3 half{static_cast<float>(random.range(0.2, 0.5)), static_cast<float>(random.range(0.05, 0.2)),
                            static_cast<float>(random.range(0.2, 0.5))};
            const double side = random.range(-0.05, 0.05);
            add_body(world, Box{half},
                     {.position = {side, y + static_cast<double>(half.y), 0.0},
                      .orientation = rotation_from_vector({0.0, random.range(0.0, 6.0), 0.0})});
            y += 2.0 * static_cast<double>(half.y);
        }
        const BodyId load = add_body(world, Box{{0.5f, 0.4f, 0.5f}}, {.position = {0.05, y + 0.4, 0.05}}, {.density = 1e9});
        std::size_t solved = 0;
        for (int i = 0; i < 60; ++i) solved += world.step(kDt).direct.solved;
        EXPECT_GT(solved, 50u) << k;
        world.destroy_body(load);
        const double before = world.energy().total();
        EXPECT_LT(most_energy(world, 30), before + 0.001 * std::abs(before)) << k;
    }
}

// Boxes a fifth inside each other are pushed apart, all at once: together little faster than what lifts the top by a hundredth of one.
TEST(NoGain, AStackInItselfUnderAHeavyBox) {
    World world;
    add_body(world, Plane{}, {.type = BodyType::Static});
    for (int i = 0; i < 6; ++i) add_body(world, Box{{0.5f, 0.5f, 0.5f}}, {.position = {0.0, 0.3 + 0.8 * i, 0.0}});
    const BodyId top = add_body(world, Box{{0.5f, 0.5f, 0.5f}}, {.position = {0.0, 0.3 + 0.8 * 6, 0.0}}, {.density = 1e8});
    std::size_t solved = 0;
    double fastest = 0.0;
    for (int i = 0; i < 600; ++i) {
        solved += world.step(kDt).direct.solved;
        fastest = std::max(fastest, world.linear_velocity(top).y);
    }
    EXPECT_GT(solved, 500u);
    EXPECT_LT(fastest, 1.25 * std::sqrt(2.0 * 9.81 * 0.01));
    EXPECT_NEAR(world.center_of_mass(top).y, 6.5, 0.01);
}

// Boxes pushed apart by the direct solve, whatever small thing lies on them.
TEST(NoGain, OverlapGoesUnderAPebbleToo) {
    for (const float pebble : {0.05f, 0.005f, 5e-4f}) {
        World world({.contact_method = ContactMethod::Direct});
        add_body(world, Plane{}, {.type = BodyType::Static});
        for (int i = 0; i < 6; ++i) add_body(world, Box{{0.5f, 0.5f, 0.5f}}, {.position = {0.0, 0.45 + 0.95 * i, 0.0}});
        add_body(world, Box{vec3{pebble}}, {.position = {0.0, 0.45 + 0.95 * 5 + 0.5 + static_cast<double>(pebble), 0.0}});
        double left = 0.0;
        for (int i = 0; i < 120; ++i) left = world.step(kDt).max_penetration;
        EXPECT_LT(left, 1e-3) << pebble;
    }
}

// What is held back of a push is so for all points of a manifold, or nothing would right a column that leans while it is pushed apart.
TEST(NoGain, AColumnThatIsPushedApartStandsUpright) {
    for (const int boxes : {30, 60}) {
        World world({.contact_method = ContactMethod::Direct});
        add_body(world, Plane{}, {.type = BodyType::Static});
        BodyId top;
        for (int i = 0; i < boxes; ++i) top = add_body(world, Box{{0.5f, 0.5f, 0.5f}}, {.position = {0.0, 0.47 + 0.97 * i, 0.0}});
        for (int i = 0; i < 1200; ++i) world.step(kDt);
        EXPECT_LT(std::hypot(world.center_of_mass(top).x, world.center_of_mass(top).z), 0.2) << boxes;
        EXPECT_NEAR(world.center_of_mass(top).y, boxes - 0.5, 0.1) << boxes;
    }
}

}  // namespace
}  // namespace carom
