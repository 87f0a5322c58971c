// Shots of every shape at thin walls, at each other and at what lies beside a wall: nothing passes through anything.
//
//   CAROM_SHOTS=1000000 test_dynamics --gtest_filter='Shots.*'     the long run: two hours of a core for the first family
//   CAROM_SHOTS_FROM=400000 CAROM_SHOTS=200000 ...                 a part of it: the shots from the 400,000th on
#include "bullets.hpp"
#include "table.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

namespace carom {
namespace {

using namespace test;

/// Shots that go through, of `count` that fly towards a wall with spins up to 1e4 rad/s, none of which sees another.
int count_tunnelled(int count, int bullet_kind, int wall_kind, std::uint64_t seed, const WorldDef& def = kSpace) {
    World world(def);
    Random random(seed);
    const auto thickness = static_cast<float>(random.unit() < 0.5 ? 0.001 : random.range(0.001, 0.01));
    const BodyId target = world.create_body({.type = BodyType::Static});
    world.add_shape(target, thin_wall(wall_kind, thickness), {.layer = 2});
    const Shape shape = bullet(bullet_kind);
    for (int i = 0; i < count; ++i) {
        const double speed = 50.0 * std::pow(200.0, random.unit()), tilt = random.range(0.0, 0.5);
        const dvec3 sideways{random.range(-1.0, 1.0), random.range(-1.0, 1.0), 0.0};
        const double spin = random.unit() < 0.5 ? 0.0 : std::pow(10.0, random.range(0.0, 4.0));
        BodyDef def_i{
            .position = {random.range(-50.0, 50.0), random.range(-50.0, 50.0), -0.6 - random.unit() * std::min(20.0, 1.5 * speed / 60.0)},
            .orientation = any_rotation(random),
            .linear_velocity = speed * glm::normalize(dvec3{0.0, 0.0, 1.0} + tilt * sideways),
            .angular_velocity = spin * rotate(any_rotation(random), dvec3{0.0, 1.0, 0.0})};
        world.add_shape(world.create_body(def_i), shape, {.mask = 2});
    }
    for (int k = 0; k < 4; ++k) world.step(kDt);
    int tunnelled = 0;
    for (const BodyId body : world.bodies()) tunnelled += body != target && world.center_of_mass(body).z > 0.0;
    return tunnelled;
}

int asked_count(const char* variable, int otherwise) {
    const char* const asked = std::getenv(variable);
    return asked == nullptr ? otherwise : std::stoi(asked);
}

/// Batches of `size` shots that are asked for: [first, last).
struct Batches {
    int first, last;

    explicit Batches(int size)
        : first(asked_count("CAROM_SHOTS_FROM", 0) / size), last(first + asked_count("CAROM_SHOTS", 10'000) / size) {}
};

TEST(Shots, NoneOfAnyShapeGoesThroughAThinWall) {
    constexpr int kBatch = 60;
    const Batches batches(kBatch);
    for (int i = batches.first; i < batches.last; ++i) {
        const int kind = i % kBullets, at = (i / kBullets) % 3;
        EXPECT_EQ(count_tunnelled(kBatch, kind, at, static_cast<std::uint64_t>(77 + i)), 0)
            << to_string(type_of(bullet(kind))) << " at wall " << at << ", batch " << i;
    }
}

BodyDef thrown(Random& random, const dvec3& at, const dvec3& velocity) {
    const double spin = random.unit() < 0.5 ? 0.0 : std::pow(10.0, random.range(0.0, 4.0));
    return {.position = at,
            .orientation = any_rotation(random),
            .linear_velocity = velocity,
            .angular_velocity = spin * rotate(any_rotation(random), dvec3{0.0, 1.0, 0.0})};
}

/// Pairs of `count` that fly at each other, off centre by less than they are thick, and go on as if nothing had been there.
int count_passed(int count, int kind_a, int kind_b, std::uint64_t seed) {
    World world(kSpace);
    Random random(seed);
    std::vector<std::array<BodyId, 2>> pairs;
    std::vector<std::array<dvec3, 2>> velocities;
    for (int i = 0; i < count; ++i) {
        const double speed = 50.0 * std::pow(200.0, random.unit()), off = 0.8 * (core_of(kind_a) + core_of(kind_b));
        const double apart = random.range(0.3, 1.9) * speed / 60.0 + 1.2;
        const dvec3 at{20.0 * i, random.range(-0.7, 0.7) * off, random.range(-0.7, 0.7) * off};
        auto& pair = pairs.emplace_back();
        auto& velocity = velocities.emplace_back(std::array{dvec3{0.0, 0.0, speed}, dvec3{0.0, 0.0, -speed * random.range(-0.2, 1.0)}});
        for (int k = 0; k < 2; ++k) {
            const dvec3 side{0.0, 0.0, k == 0 ? -0.5 * apart : 0.5 * apart};
            pair[static_cast<std::size_t>(k)] =
                world.create_body(thrown(random, (k == 0 ? at : dvec3{at.x, 0.0, 0.0}) + side, velocity[static_cast<std::size_t>(k)]));
            world.add_shape(pair[static_cast<std::size_t>(k)], bullet(k == 0 ? kind_a : kind_b));
        }
    }
    for (int k = 0; k < 6; ++k) world.step(kDt);
    int passed = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto [a, b] = pairs[i];
        const bool untouched = world.linear_velocity(a) == velocities[i][0] && world.linear_velocity(b) == velocities[i][1];
        passed += untouched && world.center_of_mass(a).z > world.center_of_mass(b).z + 1.2;
    }
    return passed;
}

/// Bodies that are behind a wall, of `count` that lay beside it and `count` that were shot at these.
int count_driven_through(int count, int kind_a, int kind_b, int wall_kind, std::uint64_t seed) {
    World world(kSpace);
    Random random(seed);
    const auto thickness = static_cast<float>(random.range(0.001, 0.01));
    const BodyId target = world.create_body({.type = BodyType::Static});
    world.add_shape(target, thin_wall(wall_kind, thickness), {.restitution = random.unit() < 0.5 ? 0.0f : 1.0f});
    for (int i = 0; i < count; ++i) {
        const double speed = 50.0 * std::pow(200.0, random.unit()), x = 20.0 * (i - 0.5 * count);
        const BodyId resting =
            world.create_body({.position = {x, 0.0, -0.6 - std::pow(10.0, random.range(-5.0, -1.0))}, .orientation = any_rotation(random)});
        world.add_shape(resting, bullet(kind_a), {.restitution = 0.5f});
        // Put beside the wall, by its lowest point towards that.
        const double gap = std::pow(10.0, random.range(-5.0, -2.0)), reach = bounds(bullet(kind_a), world.pose(resting)).upper.z;
        Pose pose = world.pose(resting);
        pose.position.z -= reach + 0.5 * static_cast<double>(thickness) + gap;
        world.set_pose(resting, pose);
        const dvec3 middle = world.center_of_mass(resting);
        const double off = 0.5 * (core_of(kind_a) + core_of(kind_b));
        const dvec3 from{middle.x + random.range(-off, off), middle.y + random.range(-off, off),
                         middle.z - 1.2 - random.range(0.0, 1.5) * speed / 60.0};
        world.add_shape(world.create_body(thrown(random, from, {0.0, 0.0, speed})), bullet(kind_b), {.restitution = 0.5f});
    }
    for (int k = 0; k < 6; ++k) world.step(kDt);
    int through = 0;
    for (const BodyId body : world.bodies()) through += body != target && world.center_of_mass(body).z > 0.0;
    return through;
}

TEST(Shots, NoneOfTwoThatFlyAtEachOtherGoesThrough) {
    constexpr int kBatch = 20;
    const Batches batches(8 * kBatch);
    for (int i = batches.first; i < batches.last; ++i) {
        const int a = i % kBullets, b = i / kBullets % kBullets;
        if (core_of(a) == 0.0 || core_of(b) == 0.0) continue;
        EXPECT_EQ(count_passed(kBatch, a, b, static_cast<std::uint64_t>(901 + i)), 0)
            << to_string(type_of(bullet(a))) << " at " << to_string(type_of(bullet(b))) << ", batch " << i;
    }
}

TEST(Shots, NothingIsDrivenThroughTheWallBesideIt) {
    constexpr int kBatch = 20;
    const Batches batches(8 * kBatch);
    for (int i = batches.first; i < batches.last; ++i) {
        const int a = i % kBullets, b = i / kBullets % kBullets, at = i % 3;
        EXPECT_EQ(count_driven_through(kBatch, a, b, at, static_cast<std::uint64_t>(4001 + i)), 0)
            << to_string(type_of(bullet(a))) << " hit by " << to_string(type_of(bullet(b))) << " at wall " << at << ", batch " << i;
    }
}

// Rods that lie beside the wall and are hit there: contacts give them up to 30,000 rad a step, more than can be followed. They are slowed down, and watched.
TEST(Shots, WhatContactsSpinTooFastToBeFollowedIsSlowed) {
    EXPECT_EQ(count_driven_through(20, 2, 0, 2, 4003), 0);
    EXPECT_EQ(count_driven_through(20, 2, 0, 0, 4067), 0);
}

// Rods that a blow leaves beside the wall with 1e5 rad/s: by what their paths may bend in the next step they overlap it, though they do not.
TEST(Shots, WhatSpinsTooFastToBeFollowedDoesNotGoThrough) {
    EXPECT_EQ(count_tunnelled(60, 2, 1, 77 + 1786), 0);
    EXPECT_EQ(count_tunnelled(60, 2, 2, 77 + 1794), 0);
}

/// Bodies behind a half-space, of eight rods that lie beside it and eight bullets that are shot at their ends: at 1/30 s and one substep the rods are jammed.
int count_jammed_through(std::uint64_t seed) {
    World world({.gravity = dvec3{0.0}, .substeps = 1, .contact_method = ContactMethod::Direct});
    Random random(seed);
    const auto thickness = static_cast<float>(random.range(0.001, 0.01));
    const double surface = -0.5 * static_cast<double>(thickness), dt = 2.0 * kDt;
    const BodyId target = world.create_body({.type = BodyType::Static});
    world.add_shape(target, thin_wall(kThinWalls - 1, thickness), {.restitution = random.unit() < 0.5 ? 0.0f : 1.0f});
    const Shape shot = bullet(static_cast<int>(random.unit() * kBullets));
    for (int i = 0; i < 8; ++i) {
        const double speed = 50.0 * std::pow(200.0, random.unit()), gap = std::pow(10.0, random.range(-6.0, -2.0));
        BodyDef rod{.position = {20.0 * i, 0.0, 0.0}, .orientation = any_rotation(random)};
        rod.position.z = surface - gap - bounds(bullet(2), Pose{rod.position, rod.orientation}).upper.z;
        world.add_shape(world.create_body(rod), bullet(2), {.restitution = 0.5f});
        const dvec3 at = rod.position + random.range(-0.45, 0.45) * rotate(rod.orientation, dvec3{0.0, 1.0, 0.0});
        const double spin = random.unit() < 0.5 ? 0.0 : std::pow(10.0, random.range(0.0, 4.0));
        const BodyDef fast{.position = {at.x, at.y, at.z - 1.2 - random.range(0.0, 1.0) * speed * dt},
                           .orientation = any_rotation(random),
                           .linear_velocity = {0.0, 0.0, speed},
                           .angular_velocity = spin * rotate(any_rotation(random), dvec3{0.0, 1.0, 0.0})};
        world.add_shape(world.create_body(fast), shot, {.density = random.unit() < 0.5 ? 1000.0 : 1e4, .restitution = 0.5f});
    }
    for (int k = 0; k < 8; ++k) world.step(dt);
    int through = 0;
    for (const BodyId body : world.bodies()) through += body != target && world.center_of_mass(body).z > surface;
    return through;
}

// Rods between a bullet and a half-space: what moved the two apart moved the rod into it, and what was stopped there at its middle was left to contacts, which threw
// it up to 190 m in a step.
TEST(Shots, NoRodThatIsJammedAtAHalfSpaceComesThroughIt) {
    for (const std::uint64_t seed : {1, 10, 30, 45, 76, 77}) EXPECT_EQ(count_jammed_through(seed), 0) << seed;
}

/// What comes of a needle of 10 micrometres that spins and flies at a wall from 10 micrometres before it: beyond the margin in which contacts are looked for.
ContinuousCounts shoot_a_needle(const Shape& needle) {
    constexpr double kRadius = 5e-6;
    World world(kSpace);
    world.add_shape(world.create_body({.type = BodyType::Static}), Box{{300.0f, 300.0f, 0.005f}});
    const double z = -static_cast<double>(0.005f) - kRadius - 1e-5;
    const BodyId body =
        world.create_body({.position = {0.0, 0.0, z}, .linear_velocity = {0.0, 0.0, 1000.0}, .angular_velocity = {0.0, 1e3, 1.1e5}});
    world.add_shape(body, needle);
    const StepReport report = world.step(kDt);
    EXPECT_LT(world.center_of_mass(body).z, 0.0);
    return report.continuous;
}

// A square one's path is known less well than it is thick. A round one's is exact: nobody sees how it turns about itself.
TEST(Shots, WhatIsNearerThanItsPathIsKnownStops) {
    EXPECT_EQ(shoot_a_needle(Box{{5e-6f, 0.5f, 5e-6f}}).stopped, 1u);
    const ContinuousCounts round = shoot_a_needle(Capsule{5e-6f, 0.5f});
    EXPECT_EQ(round.stopped, 0u);
    EXPECT_GT(round.impacts, 0u);
}

TEST(Shots, MostGoThroughWithoutContinuousCollision) {
    EXPECT_GT(count_tunnelled(60, 0, 0, 5, {.gravity = dvec3{0.0}, .continuous = {.enabled = false}}), 50);
}

}  // namespace
}  // namespace carom
