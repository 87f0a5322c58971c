// What only passes by is left alone, though a contact ahead of it was predicted.
#include <carom/dynamics/explain.hpp>
#include <carom/dynamics/world.hpp>

#include <gtest/gtest.h>

#include "dynamics/table.hpp"

#include <cmath>

namespace carom {
namespace {

using test::kDt;
using test::Table;

constexpr double kFarBehind = -3.03;  // in no step where the edges are above each other

/// A crate of 1 m on the ground and a cart that drives across it at 6 m/s, with its floor `clearance` above the crate's lid.
struct CartAboveCrate {
    Table table;
    BodyId crate, cart;

    CartAboveCrate(const WorldDef& def, double clearance, double speed = 6.0) : table(def) {
        crate = table.add({.position = {0, 0.5, 0}}, Box{{0.5f, 0.5f, 0.5f}});
        table.run(60);
        const double lid = table.world.pose(crate).position.y + 0.5;
        cart = table.add({.type = BodyType::Kinematic, .position = {kFarBehind, lid + clearance + 0.2, 0.1}, .linear_velocity = {speed, 0, 0}},
                         Box{{0.6f, 0.2f, 0.4f}});
    }
    /// @return how many pairs were passing by, over all steps.
    std::size_t drive(int steps = 60) {
        std::size_t passing = 0;
        for (int i = 0; i < steps; ++i) passing += table.world.step(kDt).passing;
        return passing;
    }
    double moved() const { return glm::length(table.world.pose(crate).position - dvec3{0, 0.5, 0}); }
};

TEST(Passing, ACartThatDrivesOverACrateLeavesItWhereItIs) {
    for (const double reuse : {0.0, 1e-3}) {
        for (const ContactMethod method : {ContactMethod::Soft, ContactMethod::Automatic, ContactMethod::Impulses}) {
            for (const double clearance : {1e-3, 3e-3, 5e-3}) {
                CartAboveCrate scene({.contact_reuse = reuse, .contact_method = method}, clearance);
                EXPECT_GT(scene.drive(), 0u) << clearance;
                EXPECT_GT(scene.table.world.pose(scene.cart).position.x, 2.0);
                EXPECT_LT(scene.moved(), 1e-4) << reuse << ' ' << static_cast<int>(method) << ' ' << clearance;
            }
        }
    }
}

TEST(Passing, AndWithoutAnyStepThatFollowsBodies) {
    CartAboveCrate scene({.continuous = {.enabled = false}}, 3e-3);
    scene.drive();
    EXPECT_LT(scene.moved(), 1e-4);
}

TEST(Passing, ACartThatIsTooLowTakesItAlong) {
    CartAboveCrate scene({}, -0.05);
    EXPECT_EQ(scene.drive(), 0u);
    EXPECT_GT(scene.moved(), 1.0);
}

TEST(Passing, WhatFliesByKeepsItsMotionToTheLastBit) {
    for (const float restitution : {0.0f, 1.0f}) {
        // Edge past edge, turning, in the empty world.
        World world({.gravity = {0, 0, 0}});
        const auto add = [&](const BodyDef& def) {
            const BodyId id = world.create_body(def);
            world.add_shape(id, Box{{0.5f, 0.5f, 0.5f}}, {.restitution = restitution});
            return id;
        };
        const dquat on_edge = glm::angleAxis(glm::radians(45.0), dvec3{0, 0, 1});
        const BodyId a = add({.position = {0, 0, 0}, .orientation = on_edge});
        const BodyId b = add({.position = {-3.03, std::sqrt(2.0) + 0.003, 0}, .orientation = on_edge, .linear_velocity = {5.5, 0, 0}, .angular_velocity = {0, 0.4, 0}});
        std::size_t passing = 0;
        for (int i = 0; i < 60; ++i) passing += world.step(kDt).passing;
        EXPECT_GT(passing, 0u);
        EXPECT_EQ(world.linear_velocity(a), dvec3(0.0)) << restitution;
        EXPECT_EQ(world.angular_velocity(a), dvec3(0.0));
        EXPECT_EQ(world.linear_velocity(b), dvec3(5.5, 0, 0));
        // In the steps that look ahead of no plane: what bounces flies in double, the rest counts from the step's start in floats.
        EXPECT_NEAR(world.pose(b).position.x, -3.03 + 60 * kDt * 5.5, restitution > 0.0f ? 1e-13 : 1e-7);
    }
}

// Whatever the step thinks, nothing may come to overlap: the oracle is the narrowphase, after the step.
TEST(Passing, WhatDoesMeetIsNotTakenForPassing) {
    int met = 0, passed = 0;
    for (int i = 0; i < 400; ++i) {
        World world({.gravity = {0, 0, 0}});
        const auto add = [&](const BodyDef& def) {
            const BodyId id = world.create_body(def);
            world.add_shape(id, Box{{0.5f, 0.4f, 0.3f}});
            return id;
        };
        const double height = 0.55 + 0.0017 * i;
        const dquat turned = glm::angleAxis(0.01 * i, glm::normalize(dvec3{0.2, 1.0, 0.1}));
        const BodyId a = add({.position = {0, 0, 0}, .orientation = turned});
        const BodyId b = add({.position = {-2, height, 0.002 * i}, .linear_velocity = {8, 0, 0}, .angular_velocity = {0, 1, 0.5}});
        bool touched = false;
        for (int k = 0; k < 30; ++k) {
            const dvec3 before = world.linear_velocity(a);
            const StepReport report = world.step(kDt);
            touched = touched || glm::length(world.linear_velocity(a)) > 0.0;
            EXPECT_LT(report.max_penetration, 2e-2) << i << ' ' << k;
            if (report.passing > 0) {
                EXPECT_EQ(world.linear_velocity(a), before) << i;
            }
        }
        const bool through = world.linear_velocity(b) == dvec3(8, 0, 0);
        EXPECT_NE(touched, through) << i;
        ++(touched ? met : passed);
    }
    EXPECT_GT(met, 100);
    EXPECT_GT(passed, 100);
}

// In the step after, whoever else may have moved it.
TEST(Passing, WhatPassedIsLookedAtAgainWhereContactsAreKept) {
    World world({.gravity = {0, 0, 0}, .contact_reuse = 1e-3});
    const auto add = [&](const BodyDef& def) {
        const BodyId id = world.create_body(def);
        world.add_shape(id, Box{{0.5f, 0.5f, 0.5f}});
        return id;
    };
    // A stack at rest, so that most contacts are kept, and an edge that is to pass another, slowly.
    for (int i = 0; i < 8; ++i) add({.position = {20, i, 0}});
    add({.type = BodyType::Static, .position = {0, 0, 0}});
    const BodyId b = add({.position = {-1.0001, 1.0001, 0}, .linear_velocity = {0.0145, 0, 0}});
    ASSERT_EQ(world.step(kDt).passing, 1u);
    world.set_linear_velocity(b, {0, -0.0145, 0});
    for (int i = 0; i < 5; ++i) {
        const StepReport report = world.step(kDt);
        EXPECT_GE(report.reused, 7u) << i;
        EXPECT_LT(report.max_penetration, 2e-5) << i;
    }
}

// It has pushed in the step before: nobody does in this one.
TEST(Passing, WhatPassesHasNoImpulse) {
    World world({.gravity = {0, 0, 0}});
    const auto add = [&](const BodyDef& def) {
        const BodyId id = world.create_body(def);
        world.add_shape(id, Box{{0.5f, 0.5f, 0.5f}});
        return id;
    };
    add({.type = BodyType::Static});
    const dvec3 start{-1.0001, 1.0001, 0};
    const BodyId b = add({.position = start, .linear_velocity = {0.02, -0.02, 0}});
    const auto impulse = [&] {
        const ContactView view = world.contact(0);
        float sum = 0.0f;
        for (std::size_t k = 0; k < view.manifold.count; ++k) sum += view.normal_impulse[k];
        return sum;
    };
    ASSERT_EQ(world.step(kDt).passing, 0u);
    ASSERT_EQ(world.contact_count(), 1u);
    ASSERT_GT(impulse(), 0.0f);
    world.set_pose(b, {start, kIdentityRotation});
    world.set_linear_velocity(b, {0.0145, 0, 0});
    world.set_angular_velocity(b, {0, 0, 0});
    ASSERT_EQ(world.step(kDt).passing, 1u);
    ASSERT_EQ(world.contact_count(), 1u);
    EXPECT_EQ(impulse(), 0.0f);
}

// Pairs are numbered anew when some fall asleep, in the same step.
TEST(Passing, WhatPassesWhileOthersFallAsleepIsWhoIsLookedAtAgain) {
    Table table({.sleep = {.enabled = true, .time = 0.5}});
    World& world = table.world;
    for (int i = 0; i < 300; ++i) table.add({.position = {2.0 * (i % 20), 0.5, 20.0 + 2.0 * (i / 20)}}, Box{{0.5f, 0.5f, 0.5f}});
    const BodyId crate = table.add({.position = {0, 0.5, 0}, .can_sleep = false}, Box{{0.5f, 0.5f, 0.5f}});
    for (int i = 0; i < 60; ++i) {
        table.add({.type = BodyType::Kinematic, .position = {-0.93 - 0.15 * i, 1.053, 0.1}, .linear_velocity = {6, 0, 0}}, Box{{0.06f, 0.05f, 0.4f}});
    }
    std::size_t both = 0;
    for (int i = 0; i < 60; ++i) {
        const StepReport report = world.step(kDt);
        both += report.fell_asleep > 100 && report.passing > 0 ? 1 : 0;
    }
    EXPECT_GT(both, 0u);
    EXPECT_LT(glm::length(world.pose(crate).position - dvec3{0, 0.5, 0}), 1e-3);
}

TEST(Passing, WhyNamesIt) {
    CartAboveCrate scene({}, 3e-3);
    bool named = false;
    for (int i = 0; i < 60; ++i) {
        if (scene.table.world.step(kDt).passing == 0) continue;
        const ContactExplanation why = scene.table.world.explain(scene.crate, scene.cart);
        ASSERT_EQ(why.rung, Rung::Margin);
        EXPECT_TRUE(why.pairs[why.deciding].found->passes);
        EXPECT_NE(why.sentence.find("they pass by each other"), std::string::npos) << why.sentence;
        EXPECT_TRUE(why.disagreements.empty());
        named = true;
    }
    EXPECT_TRUE(named);
}

}  // namespace
}  // namespace carom
