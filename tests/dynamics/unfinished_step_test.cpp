// A step that something thrown has ended: memory that ran out, or an executor that threw.
#include "odd_executors.hpp"
#include "table.hpp"

#include <carom/dynamics/explain.hpp>

#include <gtest/gtest.h>
#include <support/allocations.hpp>

#include <cmath>
#include <new>
#include <stdexcept>

namespace carom {
namespace {

using namespace test;

/// Forty bodies of three shapes, that fall into a heap; a joint, what bounces and what falls asleep.
World heap(Executor* executor = nullptr) {
    World world({.executor = executor,
                 .plan = executor == nullptr ? PlanMode::Automatic : PlanMode::Everything,
                 .record_paths = true,
                 .sleep = {.enabled = true, .time = 0.2}});
    world.add_shape(world.create_body({.type = BodyType::Static}), Plane{{0, 1, 0}, 0});
    BodyId last;
    for (int i = 0; i < 40; ++i) {
        const BodyId body = world.create_body({.position = {0.9 * (i % 3) + 0.05 * (i % 7), 0.6 + 1.05 * (i / 6), 0.9 * ((i / 3) % 2)}});
        if (i % 3 == 0)
            world.add_shape(body, Sphere{0.5f}, {.restitution = i == 39 ? 0.5f : 0.0f});
        else
            i % 3 == 1 ? world.add_shape(body, Box{{0.5f, 0.5f, 0.5f}}) : world.add_shape(body, Capsule{0.2f, 0.4f});
        if (i == 1) world.create_joint(BallJointDef{.body_a = last, .body_b = body, .anchor_a = {0.6, 0, 0}, .anchor_b = {-0.6, 0, 0}});
        last = body;
    }
    world.add_shape(world.create_body({.type = BodyType::Static, .position = {30, 0.5, 0}}), Box{{2.0f, 0.5f, 2.0f}});
    const BodyId alone = world.create_body({.position = {30, 1.5, 0}});
    world.add_shape(alone, Box{{0.5f, 0.5f, 0.5f}});  // the first to sleep
    return world;
}

/// All that can be asked of a world between two steps.
void expect_whole(const World& world) {
    for (std::size_t i = 0; i < world.contact_count(); ++i) {
        const ContactView view = world.contact(i);
        ASSERT_TRUE(world.is_alive(view.body_a) && world.is_alive(view.body_b));
        ASSERT_GE(view.manifold.count, 1u);
        ASSERT_LE(view.manifold.count, static_cast<std::uint32_t>(kMaxManifoldPoints));
    }
    const std::span<const BodyId> bodies = world.bodies();
    EXPECT_FALSE(world.explain(bodies[1], bodies[2]).sentence.empty());
    EXPECT_FALSE(world.plan(kDt).entries.empty());
    for (const BodyId body : bodies) {
        ASSERT_TRUE(std::isfinite(glm::length(world.pose(body).position)));
        ASSERT_GT(world.center_of_mass(body).y, -0.01);
    }
}

/// @param alone  rests on something that does not move.
void expect_goes_on(World& world, BodyId alone) {
    expect_whole(world);
    for (int k = 0; k < 12; ++k) world.step(kDt);
    EXPECT_GT(world.contact_count(), 0u);
    EXPECT_NEAR(world.center_of_mass(alone).y, 1.5, 1e-3);
    world.destroy_body(world.bodies()[5]);
    world.step(kDt);
    expect_whole(world);
}

// At each allocation of a step.
TEST(UnfinishedStep, OutOfMemoryLeavesTheWorldWhole) {
    long failures = 0;
    for (const int step : {0, 1, 20, 63}) {
        bool failed = true;
        for (long n = 1; failed; ++n) {
            World world = heap();
            for (int k = 0; k < step; ++k) world.step(kDt);
            fail_allocation(n);
            try {
                world.step(kDt);
                failed = false;  // it has not so many, or did without
            } catch (const std::bad_alloc&) {
                EXPECT_EQ(world.contact_count(), 0u);
                ++failures;
            }
            fail_allocation(-1);
            SCOPED_TRACE(testing::Message() << "step " << step << ", allocation " << n);
            expect_goes_on(world, world.bodies().back());
            if (testing::Test::HasFatalFailure()) return;
        }
    }
    EXPECT_GT(failures, 60);
}

// A graph of contacts that was to be analysed is analysed in the next step.
TEST(UnfinishedStep, OutOfMemoryLeavesDirectIslandsWhole) {
    long failures = 0;
    bool failed = true;
    for (long n = 1; failed; ++n) {
        World world({.contact_method = ContactMethod::Direct});
        world.add_shape(world.create_body({.type = BodyType::Static}), Plane{});
        for (int i = 0; i < 3; ++i) world.add_shape(world.create_body({.position = {0.0, 0.5 + i, 0.0}}), Box{{0.5f, 0.5f, 0.5f}});
        fail_allocation(n);
        try {
            world.step(kDt);
            failed = false;
        } catch (const std::bad_alloc&) {
            ++failures;
        }
        fail_allocation(-1);
        SCOPED_TRACE(testing::Message() << "allocation " << n);
        for (int k = 0; k < 20; ++k) world.step(kDt);
        EXPECT_EQ(world.step(kDt).direct.solved, 1u);
        EXPECT_NEAR(world.center_of_mass(world.bodies().back()).y, 2.5, 1e-3);
    }
    EXPECT_GT(failures, 60);
}

// What sleeps wakes, without the contacts that it had, and falls asleep again.
TEST(UnfinishedStep, WhatSleepsWakes) {
    World world = heap();
    const BodyId alone = world.bodies().back();
    StepReport report;
    for (int k = 0; k < 60; ++k) report = world.step(kDt);
    ASSERT_GT(report.asleep, 0u);
    ASSERT_FALSE(world.is_awake(alone));
    for (int i = 0; i < 100; ++i) world.add_shape(world.create_body({.position = {60.0 + 2.0 * i, 0.5, 0}}), Sphere{0.5f});
    fail_allocation(1);
    EXPECT_THROW(world.step(kDt), std::bad_alloc);
    EXPECT_TRUE(world.is_awake(alone));
    EXPECT_EQ(world.contact_count(), 0u);
    expect_goes_on(world, alone);
    for (int k = 0; k < 40; ++k) report = world.step(kDt);
    EXPECT_FALSE(world.is_awake(alone));
    EXPECT_NEAR(world.center_of_mass(alone).y, 1.5, 1e-3);
}

// By all threads together: in the executor, and in the step that they share.
TEST(UnfinishedStep, AnExecutorThatThrows) {
    for (const int call : {1, 2, 5}) {
        int left = -1;
        OddExecutor executor(2, [&](std::size_t count, const Executor::Body& body) {
            if (left > 0 && --left == 0) throw std::runtime_error("no");
            body(0, count);
        });
        World world = heap(&executor);
        for (int k = 0; k < 30; ++k) world.step(kDt);
        left = call;
        EXPECT_THROW(for (int k = 0; k < 10; ++k) world.step(kDt), std::runtime_error) << call;
        expect_goes_on(world, world.bodies().back());
    }
}

}  // namespace
}  // namespace carom
