// Bodies that turn by much in a step: no energy from a blow, no momentum lost, and what is round rolls as it should.
#include "shuffled_executor.hpp"
#include "table.hpp"

#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/dynamics/detail/slender.hpp>
#include <carom/dynamics/detail/turning_rows.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace carom {
namespace {

using namespace test;
using dynamics::BodyMass;

BodyMass mass_of(const dvec3& moments) {
    BodyMass mass;
    static_cast<FreeRotation&>(mass) = classify(moments);
    mass.mass = 1.0, mass.inverse_mass = 1.0;
    return mass;
}

TEST(FastTurns, TheLimitIsAChangeOfTheInertia) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    EXPECT_EQ(dynamics::turning_limit(mass_of({1.0, 1.0, 1.0}), kDt), kNever);
    EXPECT_EQ(dynamics::turning_limit(mass_of({1.0, 0.03, 1.0}), kDt), kNever) << "slender bodies have a rule of their own";
    EXPECT_NEAR(dynamics::turning_limit(mass_of({1.0, 2.0, 1.0}), kDt), 0.1 / kDt, 1e-9) << "a disc";
    EXPECT_NEAR(dynamics::turning_limit(mass_of({1.0, 0.1, 1.0}), kDt), 0.1 / 9.0 / kDt, 1e-9);
    EXPECT_NEAR(dynamics::turning_limit(mass_of({1.0, 1.1, 1.0}), kDt), 0.35 / kDt, 1e-9) << "however little it changes";
    EXPECT_NEAR(dynamics::turning_limit(mass_of({1.0, 1.001, 1.0}), kDt), 20.0 / kDt, 1e-6) << "unless it is next to nothing";
    BodyMass locked = mass_of({1.0, 2.0, 1.0});
    locked.locked = LockedAxes::TurnX;
    EXPECT_EQ(dynamics::turning_limit(locked, kDt), kNever);
}

enum class Kind { Capsule, Box, Cylinder, Brick };

/// @param ratio  length over thickness; below 1 a disc or a plate
Shape shape_of(Kind kind, double ratio) {
    const auto along = static_cast<float>(0.5 * std::min(ratio, 1.0)), aside = static_cast<float>(0.5 / std::max(ratio, 1.0));
    if (kind == Kind::Capsule) return Capsule{aside, std::max(along - aside, 1e-3f)};
    if (kind == Kind::Cylinder) return Cylinder{aside, along};
    return Box{{aside, along, kind == Kind::Brick ? 0.8f * aside : aside}};
}

struct Blow {
    double gained = 0.0;  // over the start, share of the energy
    double lost = 0.0;    // of the angular momentum, over the momentum of the two × 1 m + their first angular momenta
    bool met = false;
};

struct Throw {
    double spin = 0.0, dt = kDt;
    int substeps = 8;
    float friction = 0.5f;
    bool continuous = true;
};

/// Two that are thrown at each other, each with a spin, in nothing.
Blow meet(const Shape& shape, const Throw& how, std::uint64_t seed) {
    Random random(seed);
    World world({.gravity = dvec3{0.0}, .substeps = how.substeps, .continuous = {.enabled = how.continuous}});
    const auto draw = [&](double most) { return dvec3{random.range(-most, most), random.range(-most, most), random.range(-most, most)}; };
    double scale = 0.0;
    for (const double side : {-1.0, 1.0}) {
        const dquat turned = rotation_from_vector(draw(3.0));
        const dvec3 spin = draw(how.spin), off = draw(0.3);
        const BodyId body = world.create_body({.position = {0.9 * side, off.y, off.z},
                                               .orientation = turned,
                                               .linear_velocity = {-2.0 * side, 0.0, 0.0},
                                               .angular_velocity = spin});
        world.add_shape(body, shape, {.friction = how.friction});
        const MassProperties mass = world.mass_properties(body);
        scale += mass.mass * 2.0 + glm::length(dmat3{mass.inertia} * rotate_inverse(turned, spin));
    }
    const double first = world.energy().total();
    const dvec3 momentum = world.momentum().angular;
    Blow blow;
    for (double t = 0.0; t < 1.0; t += how.dt) {
        world.step(how.dt);
        blow.gained = std::max(blow.gained, world.energy().total() / first - 1.0);
    }
    blow.met = world.energy().total() < 0.999 * first;
    blow.lost = glm::length(world.momentum().angular - momentum) / scale;
    return blow;
}

struct Worst {
    double gained = 0.0, lost = 0.0;
};

Worst worst_of(const Shape& shape, const Throw& how, std::uint64_t seeds) {
    Worst worst;
    bool met = false;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        const Blow blow = meet(shape, how, seed);
        worst.gained = std::max(worst.gained, blow.gained);
        worst.lost = std::max(worst.lost, blow.lost);
        met |= blow.met;
    }
    EXPECT_TRUE(met);
    return worst;
}

// With the inertia of the step's start: up to 0.11 of the energy gained at 30 rad/s, 1.1 at 100 rad/s; 0.2 of the angular momentum lost.
TEST(FastTurns, ABlowGainsNoEnergyAtAnyRatio) {
    Worst worst;
    for (const Kind kind : {Kind::Capsule, Kind::Box, Kind::Cylinder, Kind::Brick}) {
        for (const double ratio : {0.02, 0.1, 0.2, 0.5, 0.8, 1.0, 1.2, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 10.0, 20.0}) {
            if (kind == Kind::Capsule && ratio < 1.0) continue;
            for (const double spin : {3.0, 10.0, 30.0, 100.0}) {
                const Worst one = worst_of(shape_of(kind, ratio), {.spin = spin}, 12);
                EXPECT_LT(one.gained, 1e-3) << static_cast<int>(kind) << " 1:" << ratio << " at " << spin;
                EXPECT_LT(one.lost, spin < 50.0 ? 0.1 : 0.3) << static_cast<int>(kind) << " 1:" << ratio << " at " << spin;
                worst = {std::max(worst.gained, one.gained), std::max(worst.lost, one.lost)};
            }
        }
    }
    std::printf("figure 1 a blow, energy gained, share                  %.3g; angular momentum lost %.3g\n", worst.gained, worst.lost);
}

TEST(FastTurns, NorWithOtherStepsOrWithoutFriction) {
    for (const double ratio : {0.2, 1.5, 4.0, 6.0}) {
        const Shape shape = shape_of(Kind::Cylinder, ratio);
        for (const Throw& how :
             {Throw{.spin = 30.0, .substeps = 1}, Throw{.spin = 30.0, .substeps = 3}, Throw{.spin = 30.0, .substeps = 32},
              Throw{.spin = 30.0, .dt = 1.0 / 240.0}, Throw{.spin = 30.0, .friction = 0.0f}, Throw{.spin = 30.0, .continuous = false}}) {
            const Worst worst = worst_of(shape, how, 20);
            EXPECT_LT(worst.gained, how.substeps == 1 ? 1e-2 : 1e-3)
                << ratio << " " << how.substeps << " " << how.dt << " " << how.friction << how.continuous;
        }
    }
}

// Fast bodies in a heap, on one thread and on four: the same bits.
TEST(FastTurns, ThreadsMakeNoDifference) {
    const auto run = [](Executor* executor) {
        Table table({.executor = executor});
        Random random(8);
        for (int i = 0; i < 700; ++i) {
            const dvec3 at{random.range(-4, 4), random.range(0.5, 8), random.range(-4, 4)};
            const Kind kind = i % 3 == 0 ? Kind::Capsule : i % 3 == 1 ? Kind::Cylinder : Kind::Brick;
            table.add({.position = at, .angular_velocity = {random.range(-30, 30), random.range(-30, 30), random.range(-30, 30)}},
                      shape_of(kind, kind == Kind::Cylinder ? 0.3 : 3.0));
        }
        table.run(12);
        return table.world.state_hash();
    };
    ShuffledExecutor four(4);
    EXPECT_EQ(run(nullptr), run(&four));
}

struct Roll {
    double speed = 0.0, aside = 0.0, least = 0.0;  // [m/s], and height over the radius
};

/// Rolls down a slope of 10 degrees from rest for 3 s: the slope is level, gravity is tilted, along `yaw`.
Roll roll(const Shape& shape, double radius, double yaw, double dt, bool on_box) {
    const double angle = 10.0 * kPi / 180.0;
    const dquat heading = rotation_about({0, 1, 0}, yaw);
    World world({.gravity = 9.81 * rotate(heading, dvec3{std::sin(angle), -std::cos(angle), 0.0})});
    const BodyId ground = world.create_body({.type = BodyType::Static, .position = {0.0, on_box ? -1.0 : 0.0, 0.0}});
    world.add_shape(ground, on_box ? Shape{Box{{100.0f, 1.0f, 100.0f}}} : Shape{Plane{}}, {.friction = 0.6f});
    const BodyId body = world.create_body({.position = {0.0, radius, 0.0}, .orientation = heading * rotation_about({1, 0, 0}, 0.5 * kPi)});
    world.add_shape(body, shape, {.friction = 0.6f});
    Roll out;
    for (int i = 0, n = static_cast<int>(std::lround(3.0 / dt)); i < n; ++i) {
        world.step(dt);
        out.least = std::min(out.least, world.center_of_mass(body).y / radius - 1.0);
    }
    out.speed = glm::dot(world.linear_velocity(body), rotate(heading, dvec3{1, 0, 0}));
    out.aside = glm::dot(world.linear_velocity(body), rotate(heading, dvec3{0, 0, 1}));
    return out;
}

// a = 2/3 g sin; with points that turn with the rim 3.5 % off at a radius of 0.1 m, 0.2 % at 0.5 m, and 0.6 m/s aside.
TEST(FastTurns, ACylinderRollsDownASlope) {
    double worst = 0.0;
    for (const double dt : {1.0 / 60.0, 1.0 / 240.0}) {
        for (const double radius : {0.1, 0.5, 2.0}) {
            for (const double thickness : {0.02, 0.1, 0.5, 1.0, 3.0}) {
                for (const bool on_box : {false, true}) {
                    const double yaw = on_box ? 0.7 : 0.0, want = 2.0 / 3.0 * 9.81 * std::sin(10.0 * kPi / 180.0) * 3.0;
                    const Roll r =
                        roll(Cylinder{static_cast<float>(radius), static_cast<float>(radius * thickness)}, radius, yaw, dt, on_box);
                    EXPECT_NEAR(r.speed, want, 5e-4 * want) << radius << " " << thickness << " " << dt << on_box;
                    EXPECT_LT(std::abs(r.aside), 0.03) << radius << " " << thickness << " " << dt << on_box;
                    EXPECT_GT(r.least, -1e-3) << radius << " " << thickness << " " << dt << on_box;
                    worst = std::max(worst, std::abs(r.speed / want - 1.0));
                }
            }
        }
    }
    std::printf("figure 3 a cylinder down a slope, speed, relative error %.3g\n", worst);
}

// A capsule's moment about its axis: 2/5 and 1/2 of the parts' m r².
TEST(FastTurns, ACapsuleDoesToo) {
    const float radius = 0.2f, half = 0.4f;
    World world;
    const BodyId body = world.create_body({});
    world.add_shape(body, Capsule{radius, half});
    const MassProperties mass = world.mass_properties(body);
    const double r = static_cast<double>(radius), share = mass.inertia[1][1] / (mass.mass * r * r);
    const double want = 9.81 * std::sin(10.0 * kPi / 180.0) * 3.0 / (1.0 + share);
    const Roll down = roll(Capsule{radius, half}, r, 0.3, kDt, true);
    EXPECT_NEAR(down.speed, want, 5e-4 * want);
    EXPECT_LT(std::abs(down.aside), 0.01);
}

// A push that is left over is energy: 1.6 m/s with one relax pass.
TEST(FastTurns, AHeapOfOverlappingBallsIsPartedAtRest) {
    World world({.gravity = dvec3{0.0}});
    Random random(4);
    double mass = 0.0;
    for (int i = 0; i < 400; ++i) {
        const BodyId ball = world.create_body({.position = {random.range(-5, 5), random.range(0, 10), random.range(-5, 5)}});
        world.add_shape(ball, Sphere{0.5f});
        mass += world.mass_properties(ball).mass;
    }
    EXPECT_GT(world.step(kDt).deep, 200u);
    const double speed = std::sqrt(2.0 * world.energy().kinetic / mass);
    std::printf("figure 2 speed of balls that part [m/s]                %.3g\n", speed);
    EXPECT_LT(speed, 0.05);
    for (int i = 0; i < 30; ++i) world.step(kDt);
    EXPECT_LT(std::sqrt(2.0 * world.energy().kinetic / mass), 0.5);  // 1.65
}

}  // namespace
}  // namespace carom
