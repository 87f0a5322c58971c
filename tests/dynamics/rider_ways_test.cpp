// Where kinematic walls leave room, what they carry goes there: along with the faster wall, out of their way, up what rises before them.
#include "bullets.hpp"
#include "table.hpp"

#include <carom/dynamics/detail/least_shift.hpp>
#include <carom/dynamics/explain_sweep.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace carom {
namespace {

using namespace test;

dquat rotation_between(const dvec3& from, const dvec3& to) {
    const dvec3 across = glm::cross(from, to);
    const double sine = glm::length(across);
    return sine == 0.0 ? kIdentityRotation : rotation_from_vector(std::atan2(sine, glm::dot(from, to)) / sine * across);
}

/// A ball that another one hits, which is all that it may be, so that both stand where something kinematic comes upon them.
struct Room {
    World world{{.gravity = dvec3{0.0}, .record_paths = true, .continuous = {.most_impacts = 1}}};
    BodyId ball, shot;
    ContinuousCounts counts;

    BodyId wall(const BodyDef& def, const vec3& half) {
        const BodyId body = world.create_body(def);
        world.add_shape(body, Box{half}, {.friction = 0.0f});
        return body;
    }
    BodyId door(double z, double speed, const dvec3& turning = dvec3{0.0}) {
        return wall(
            {.type = BodyType::Kinematic, .position = {0.0, 0.0, z}, .linear_velocity = {0.0, 0.0, speed}, .angular_velocity = turning},
            {3.0f, 3.0f, 0.01f});
    }
    void step(unsigned char locked = LockedAxes::None, const dvec3& from = {-1.0, 0.0, 0.0}) {
        ball = world.create_body({.locked = locked});
        world.add_shape(ball, Sphere{0.05f}, {.friction = 0.0f});
        shot = world.create_body({.position = 3.0 * from, .linear_velocity = -400.0 * from});
        world.add_shape(shot, Sphere{0.05f}, {.friction = 0.0f});
        counts = world.step(kDt).continuous;
    }
    [[nodiscard]] dvec3 before(BodyId wall, BodyId body) const {
        return inverse_transform_point(world.pose(wall), world.pose(body).position);
    }
};

TEST(RiderWays, WhatAFasterWallOvertakesGoesAlongWithThat) {
    for (const dvec3& turning : {dvec3{0.0}, dvec3{0.0, 0.0, 3.0}, dvec3{2.0, 1.0, 3.0}}) {
        Room room;
        const BodyId slow = room.door(-0.6, 60.0), fast = room.door(-1.3, 120.0, turning);
        room.step();
        EXPECT_EQ(room.counts.carried, 2u);
        EXPECT_EQ(room.counts.crushed, 0u);
        for (const BodyId body : {room.ball, room.shot}) {
            EXPECT_GT(room.before(slow, body).z, 0.1) << "there was room ahead of both";
            EXPECT_NEAR(room.before(fast, body).z, 0.06, turning == dvec3{0.0} ? 1e-4 : 1e-3);
            const auto at_fast = [&](double t) {
                return inverse_transform_point(room.world.pose_within_step(fast, t), room.world.pose_within_step(body, t).position);
            };
            if (turning.x == 0.0) {
                EXPECT_LT(glm::length(at_fast(0.95) - at_fast(1.0)), 1e-12) << "as if fixed to it";
            }
            EXPECT_FALSE(room.world.passage(body, slow));
            EXPECT_FALSE(room.world.passage(body, fast));
        }
    }
}

TEST(RiderWays, WhatTwoWallsCloseInOnIsPushedOutBetweenThem) {
    Room room;
    const dvec3 out_a = glm::normalize(dvec3{0.6, 0.0, 1.0}), out_b = glm::normalize(dvec3{-0.6, 0.0, 1.0});
    const auto add = [&](const dvec3& out) {
        return room.wall({.type = BodyType::Kinematic,
                          .position = -0.3 * out,
                          .orientation = rotation_between(dvec3{0.0, 0.0, 1.0}, out),
                          .linear_velocity = 40.0 * out},
                         {3.0f, 3.0f, 0.01f});
    };
    const BodyId a = add(out_a), b = add(out_b);
    room.step(LockedAxes::None, {0.0, -1.0, 0.0});
    EXPECT_EQ(room.counts.crushed, 0u);
    for (const BodyId body : {room.ball, room.shot}) {
        for (const BodyId wall : {a, b}) {
            EXPECT_NEAR(room.before(wall, body).z, 0.06, 1e-3) << "in the corner, at both";
            EXPECT_FALSE(room.world.passage(body, wall));
        }
    }
}

// Floors rise before the door by more than half of the ball's thickness, where it was crushed before: it slides up.
TEST(RiderWays, WhatADoorPushesAlongARisingFloorSlidesUp) {
    for (const double rise : {0.02, 0.1, 0.4}) {
        Room room;
        const dvec3 up = glm::normalize(dvec3{0.0, 1.0, -rise});
        const BodyId floor =
            room.wall({.type = BodyType::Static, .position = -0.0501 * up, .orientation = rotation_between(dvec3{0.0, 1.0, 0.0}, up)},
                      {9.0f, 0.0001f, 9.0f});
        const BodyId door = room.door(-0.6, 90.0);
        room.step();
        EXPECT_EQ(room.counts.crushed, 0u) << rise;
        EXPECT_EQ(room.counts.carried, 2u) << rise;
        for (const BodyId body : {room.ball, room.shot}) {
            EXPECT_NEAR(room.before(door, body).z, 0.06, 1e-3) << rise;
            EXPECT_NEAR(room.before(floor, body).y, 0.0501, 0.003) << rise;
        }
    }
}

// It has no need to carry anything the way that it moves along itself.
TEST(RiderWays, APaddleThatMovesAlongItselfTakesNothingIntoTheFloor) {
    Room room;
    const BodyId floor = room.wall({.type = BodyType::Static, .position = {0.0, -0.06, 0.0}}, {9.0f, 0.01f, 9.0f});
    const BodyId paddle =
        room.wall({.type = BodyType::Kinematic, .position = {0.0, 2.0, -0.2}, .linear_velocity = {0.0, -50.0, 30.0}}, {3.0f, 3.0f, 0.01f});
    room.step();
    EXPECT_EQ(room.counts.crushed, 0u);
    EXPECT_EQ(room.counts.carried, 2u);
    for (const BodyId body : {room.ball, room.shot}) {
        EXPECT_GT(room.before(floor, body).y, 0.0599);
        EXPECT_NEAR(room.before(paddle, body).z, 0.06, 1e-3);
    }
}

TEST(RiderWays, WhatHasLocksSlidesWhereTheyLetIt) {
    Room room;
    const dvec3 out = glm::normalize(dvec3{0.0, 1.0, 1.0});
    const BodyId door = room.wall({.type = BodyType::Kinematic,
                                   .position = -0.3 * out,
                                   .orientation = rotation_between(dvec3{0.0, 0.0, 1.0}, out),
                                   .linear_velocity = 30.0 * out},
                                  {9.0f, 3.0f, 0.01f});
    room.step(LockedAxes::MoveY);
    EXPECT_EQ(room.counts.crushed, 0u);
    EXPECT_EQ(room.world.pose(room.ball).position.y, 0.0);
    EXPECT_NEAR(room.before(door, room.ball).z, 0.06, 1e-3) << "it went twice as far as if it were free";
    EXPECT_GT(room.world.pose(room.ball).position.z, 0.1);
}

// A rod whose path bends by more than its gap to a ball stands from the start of the step, while a wall of a lesser slot, which had asked for it, comes.
TEST(RiderWays, WhatStandsFromTheStartIsFoundByWallsThatAskedBefore) {
    World world(kSpace);
    const BodyId wall = world.create_body({.type = BodyType::Kinematic, .position = {0.0, 0.0, -0.5}, .linear_velocity = {0.0, 0.0, 60.0}});
    world.add_shape(wall, Box{{9.0f, 9.0f, 0.01f}});
    const BodyId rod = world.create_body({.angular_velocity = 118'000.0 * glm::normalize(dvec3{1.0, 1.0, 0.0})});
    world.add_shape(rod, Box{{0.0005f, 2.0f, 0.0005f}});
    const BodyId ball = world.create_body({.type = BodyType::Static, .position = {0.0508, 0.0, 0.0}});
    world.add_shape(ball, Sphere{0.05f});
    const ContinuousCounts counts = world.step(kDt).continuous;
    EXPECT_EQ(counts.stopped, 1u);
    EXPECT_EQ(counts.carried, 1u);
    EXPECT_GT(world.pose(rod).position.z, world.pose(wall).position.z + 0.01) << "before the wall";
}

// Boxes of three moments, nearly as fast as a step can follow, spin up and down as they fly, and faster still when balls hit them.
TEST(RiderWays, BoxesThatSpinUpAsTheyFlyStayInTheWorld) {
    World world(kSpace);
    Random random(11);
    for (int i = 0; i < 80; ++i) {
        const dvec3 place{3.0 * (i % 20), 3.0 * (i / 20), 0.0};
        const BodyId box =
            world.create_body({.position = place, .angular_velocity = random.range(1500.0, 1999.0) / kDt * random_direction(random)});
        world.add_shape(box, Box{{0.05f, 0.08f, 0.03f}}, {.friction = 0.5f});
        if (i % 2 == 0) continue;
        const BodyId ball = world.create_body({.position = place + dvec3{0.02, 0.03, -10.0}, .linear_velocity = {0.0, 0.0, 30000.0}});
        world.add_shape(ball, Sphere{0.03f}, {.friction = 0.5f});
    }
    std::size_t slowed = 0;
    for (int k = 0; k < 4; ++k) {
        const StepReport report = world.step(kDt);
        EXPECT_TRUE(report.quarantined.empty()) << report.quarantined.size();
        slowed += report.continuous.slowed;
    }
    EXPECT_GT(slowed, 20u);
}

/// Dykstra's projections onto one half-space after the other, which come to the nearest point of all.
dvec3 nearest(const std::vector<dynamics::ShiftBound>& bounds) {
    dvec3 x{0.0};
    std::vector<dvec3> corrections(bounds.size(), dvec3{0.0});
    for (int round = 0; round < 20'000; ++round) {
        for (std::size_t i = 0; i < bounds.size(); ++i) {
            const dvec3 y = x + corrections[i];
            const double missing = bounds[i].least - glm::dot(bounds[i].normal, y);
            x = y + std::max(missing, 0.0) / glm::dot(bounds[i].normal, bounds[i].normal) * bounds[i].normal;
            corrections[i] = y - x;
        }
    }
    return x;
}

TEST(LeastShift, IsThePointOfAllBoundsThatIsNearest) {
    Random random(3);
    int corners = 0, found = 0;
    for (int i = 0; i < 200; ++i) {
        std::vector<dynamics::ShiftBound> bounds;
        for (int k = 0; k < 1 + i % 8; ++k) {
            const dvec3 n = glm::normalize(random_direction(random) + dvec3{0.0, 0.0, 0.8});
            bounds.push_back({random.range(0.5, 2.0) * n, random.range(-1.0, 2.0)});
        }
        const std::optional<dvec3> shift = dynamics::least_shift(bounds, 12.0);
        int on = 0;
        if (!shift) continue;
        for (const dynamics::ShiftBound& b : bounds) {
            EXPECT_GE(glm::dot(b.normal, *shift), b.least - 1e-5) << i;
            on += std::abs(glm::dot(b.normal, *shift) - b.least) < 1e-9 ? 1 : 0;
        }
        corners += on >= 2 ? 1 : 0;
        EXPECT_LT(glm::length(*shift - nearest(bounds)), 1e-4 * (1.0 + glm::length(*shift))) << i;
        ++found;
    }
    EXPECT_GT(corners, 40);
    EXPECT_GT(found, 120);
}

TEST(LeastShift, SaysWhereThereIsNoRoom) {
    using Bounds = std::vector<dynamics::ShiftBound>;
    const dvec3 x{1.0, 0.0, 0.0};
    EXPECT_EQ(dynamics::least_shift(Bounds{}, 1.0), dvec3{0.0});
    EXPECT_EQ(dynamics::least_shift(Bounds{{x, 1.0}, {-x, -2.0}}, 4.0), x);
    EXPECT_FALSE(dynamics::least_shift(Bounds{{x, 1.0}, {-x, -0.5}}, 4.0));
    EXPECT_FALSE(dynamics::least_shift(Bounds{{x, 1.0}}, 0.9)) << "farther than it may be";
    EXPECT_FALSE(dynamics::least_shift(Bounds{{dvec3{0.0}, 1.0}}, 4.0)) << "along an axis that is locked";
    EXPECT_EQ(dynamics::least_shift(Bounds{{dvec3{0.0}, -1.0}, {x, 1.0}}, 4.0), x);
}

}  // namespace
}  // namespace carom
