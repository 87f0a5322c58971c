// Kinematic half-spaces that turn: what is in front of one stays there, and what they only tilt under is left to the contacts.
#include "bullets.hpp"
#include "table.hpp"

#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace carom {
namespace {

using namespace test;

struct Field {
    World world;
    BodyId floor;
    std::vector<BodyId> bodies;

    /// @param spin  of the plane [rad/s].
    Field(std::uint64_t seed, bool followed, double spin) : world({.gravity = dvec3{0.0}, .continuous = {.enabled = followed}}) {
        Random random(seed);
        floor = world.create_body({.type = BodyType::Kinematic,
                                   .position = random.range(0.0, 2.0) * random_direction(random),
                                   .linear_velocity = random.range(0.0, 20.0) * random_direction(random),
                                   .angular_velocity = spin * random_direction(random)});
        world.add_shape(floor, Plane{{0.0f, 1.0f, 0.0f}, -3.0f}, {.layer = 2});
        const double down = world.pose(floor).position.y - 3.0;
        for (int i = 0; i < 48; ++i) {
            const dvec3 at{random.range(-8.0, 8.0), down + random.range(0.6, 3.0), random.range(-8.0, 8.0)};
            bodies.push_back(world.create_body({.position = at,
                                                .orientation = random_rotation(random),
                                                .linear_velocity = random.range(0.0, 30.0) * random_direction(random),
                                                .angular_velocity = random.range(0.0, 60.0) * random_direction(random)}));
            world.add_shape(bodies.back(), bullet(i % kBullets), {.mask = 2});
        }
    }
    [[nodiscard]] int behind() const {
        const Pose pose = world.pose(floor);
        int count = 0;
        for (const BodyId body : bodies) count += inverse_transform_point(pose, world.center_of_mass(body)).y < -3.0;
        return count;
    }
};

TEST(TurningPlanes, NothingComesThroughThem) {
    int struck = 0, carried = 0, through = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const double spin = seed % 4 == 0 ? 90.0 : 30.0;  // 1.5 and 0.5 rad a step
        Field field(seed, true, spin), discrete(seed, false, spin);
        for (int step = 0; step < 2; ++step) {
            const StepReport report = field.world.step(kDt);
            struck += static_cast<int>(report.continuous.impacts);
            carried += static_cast<int>(report.continuous.carried);  // after most_impacts pushes
            EXPECT_EQ(field.behind(), 0) << seed << " step " << step;
        }
        discrete.world.step(kDt);
        through += discrete.behind();
    }
    std::printf("turning planes: %d blows, %d carried, %d behind without\n", struck, carried, through);
    EXPECT_GT(struck, 500);
    EXPECT_GT(carried, 20) << "or else nothing of that is tested";
    EXPECT_GT(through, 300);
}

// A floor that tilts by 0.2 rad/s under what lies on it: contacts hold that, and the bits are those of a world without the stage.
TEST(TurningPlanes, WhatLiesOnASlowOneIsLeftToContacts) {
    std::vector<World> worlds;
    for (const bool followed : {true, false}) {
        World& world = worlds.emplace_back(WorldDef{.continuous = {.enabled = followed}});
        const BodyId floor = world.create_body({.type = BodyType::Kinematic, .angular_velocity = {0.05, 0.0, 0.2}});
        world.add_shape(floor, Plane{{0.0f, 1.0f, 0.0f}, 0.0f});
        for (int i = 0; i < 16; ++i) {
            const Shape shape = i % 2 == 0 ? Shape{Box{{0.2f, 0.15f, 0.25f}}} : Shape{Cylinder{0.2f, 0.15f}};
            world.add_shape(world.create_body({.position = {1.0 * (i % 4) - 1.5, 0.15, 1.0 * (i / 4) - 1.5}}), shape);
        }
        for (int step = 0; step < 60; ++step) {
            const StepReport report = world.step(kDt);
            EXPECT_EQ(report.continuous.pairs, 0u) << step;
        }
    }
    EXPECT_EQ(worlds[0].state_hash(), worlds[1].state_hash());
}

}  // namespace
}  // namespace carom
