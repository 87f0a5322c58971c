// Crowds that kinematic walls drive: along floors, along themselves, one after the other, against each other. Few are crushed, and nothing else comes through.
//
//   CAROM_CROWDS=60 test_dynamics --gtest_filter='RiderCrowds.*'     the long run: worlds of each kind
#include "bullets.hpp"
#include "table.hpp"

#include <carom/dynamics/explain_sweep.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace carom {
namespace {

using namespace test;

enum class Drive { AlongAFloor, Overtaking, AlongItself, Closing };

/// A score of bodies, of which a third is shot at the others, with few impacts each.
struct Driven {
    Random random;
    Drive drive;
    World world;
    double dt;
    float friction;
    std::vector<BodyId> walls, bodies;
    BodyId floor;
    dvec3 up{0.0, 0.0, 1.0};  ///< of the floor, if there is one
    bool has_floor;
    std::size_t carried = 0, crushed = 0;

    Driven(std::uint64_t seed, Drive how)
        : random(seed),
          drive(how),
          world(def(random, how)),
          dt(random.unit() < 0.6   ? kDt
             : random.unit() < 0.5 ? 2.0 * kDt
                                   : 0.25 * kDt),
          friction(random.unit() < 0.5 ? 0.6f : 0.0f),
          has_floor(drive == Drive::AlongAFloor || drive == Drive::AlongItself) {
        if (has_floor) add_floor();
        add_walls();
        const int kind_a = any_kind(), kind_b = any_kind();
        for (int i = 0; i < 20; ++i) add_body(i, i % 2 == 0 ? kind_a : kind_b);
    }

    static WorldDef def(Random& random, Drive how) {
        WorldDef of{.record_paths = true, .continuous = {.most_impacts = 1 + static_cast<int>(3.0 * random.unit())}};
        of.gravity = how == Drive::AlongAFloor || how == Drive::AlongItself ? dvec3{0.0, 0.0, -9.81} : dvec3{0.0};
        return of;
    }
    int any_kind() {
        const int kind = static_cast<int>(random.unit() * kBullets);
        return kind == 2 ? 0 : kind;  // rods have tests of their own
    }
    void add_floor() {
        const double tilt = drive == Drive::AlongAFloor ? random.range(-0.05, 0.05) * (random.unit() < 0.5 ? 1.0 : 8.0) : 0.0;
        const dquat turn = rotation_from_vector({0.0, -tilt, 0.0});
        up = rotate(turn, up);
        floor = world.create_body({.type = BodyType::Static, .position = -0.05 * up, .orientation = turn});
        world.add_shape(floor, Box{{20.0f, 20.0f, 0.05f}}, {.friction = friction});
    }
    void add_wall(BodyDef def, const vec3& half) {
        def.type = BodyType::Kinematic;
        walls.push_back(world.create_body(def));
        world.add_shape(walls.back(), Box{half}, {.friction = friction});
    }
    void add_walls() {
        const auto thin = static_cast<float>(random.range(0.001, 0.02));
        const double speed = random.range(5.0, 60.0);
        if (drive == Drive::AlongAFloor) {
            BodyDef def{.position = {-1.2, 0.0, 2.0}, .linear_velocity = {speed, 0.0, 0.0}};
            if (random.unit() < 0.5) def.position.y = -3.0, def.angular_velocity.z = -std::pow(10.0, random.range(-1.0, 1.2));
            add_wall(def, {thin, 6.0f, 3.0f});
        } else if (drive == Drive::Overtaking) {
            add_wall({.position = {0.0, 0.0, -1.5}, .linear_velocity = {0.0, 0.0, speed}}, {4.0f, 4.0f, thin});
            const dvec3 turning = random.unit() < 0.5 ? dvec3{0.0} : std::pow(10.0, random.range(-2.0, 1.0)) * random_direction(random);
            add_wall({.position = {0.5, 0.0, -1.9 - random.unit()},
                      .linear_velocity = {random.range(-10.0, 10.0), random.range(-10.0, 10.0), speed * random.range(1.2, 3.0)},
                      .angular_velocity = turning},
                     {4.0f, 4.0f, thin});
        } else if (drive == Drive::AlongItself) {
            const double way = random.range(0.0, 2.0 * kPi), sink = random.unit() < 0.5 ? 0.3 * random.unit() : 0.0;
            add_wall({.position = {0.0, 0.0, 1.0}, .linear_velocity = speed * dvec3{std::cos(way), std::sin(way), -sink}},
                     {thin, 6.0f, 1.001f});
        } else {
            for (const double side : {1.0, -1.0}) {
                const dquat turn = rotation_from_vector({0.0, side * random.range(0.3, 1.2), 0.0});
                const dvec3 out = rotate(turn, dvec3{-side, 0.0, 0.0});
                add_wall({.position = -out, .orientation = turn, .linear_velocity = random.range(1.0, 20.0) * out}, {thin, 6.0f, 6.0f});
            }
        }
    }
    void add_body(int i, int kind) {
        BodyDef def{.position = {-0.9 + 0.45 * (i % 5), -0.9 + 0.6 * (i / 5), 0.0}, .orientation = any_rotation(random)};
        if (has_floor) {
            const double reach = -bounds(bullet(kind), Pose{{0, 0, 0}, def.orientation}).lower.z;
            if (drive == Drive::AlongItself && std::abs(def.position.x) < 0.2) def.position.x += 0.25;
            def.position += (reach + 0.0201 - glm::dot(up, def.position)) * up;
        } else {
            def.position.z = random.range(-1.2, 1.2) * (drive == Drive::Overtaking ? 0.6 : 0.2);
        }
        if (i % 3 == 1) {
            const dvec3 way{random.range(-1.0, 0.0), random.range(-0.3, 0.3), has_floor ? -0.2 : random.range(-1.0, 1.0)};
            def.linear_velocity = 50.0 * std::pow(40.0, random.unit()) * glm::normalize(way);
            if (random.unit() < 0.5) def.angular_velocity = std::pow(10.0, random.range(0.0, 3.0)) * random_direction(random);
        }
        bodies.push_back(world.create_body(def));
        world.add_shape(bodies.back(), bullet(kind), {.friction = friction});
    }

    void run(int steps) {
        for (int k = 0; k < steps; ++k) {
            const ContinuousCounts counts = world.step(dt).continuous;
            carried += counts.carried, crushed += counts.crushed;
            std::vector<BodyId> partners = walls;
            if (has_floor) partners.push_back(floor);
            for (const BodyId body : bodies) {
                for (const BodyId partner : partners) {
                    const auto passage = world.passage(body, partner);
                    if (passage && passage->cause != SweepReason::Crushed) ADD_FAILURE() << "step " << k << ": " << passage->sentence;
                }
            }
        }
    }
};

TEST(RiderCrowds, FewAreCrushedAndNothingElseComesThrough) {
    const char* const asked = std::getenv("CAROM_CROWDS");
    const int worlds = asked == nullptr ? 16 : std::stoi(asked);
    std::size_t all_carried = 0, all_crushed = 0;
    for (const Drive drive : {Drive::AlongAFloor, Drive::Overtaking, Drive::AlongItself, Drive::Closing}) {
        std::size_t carried = 0, crushed = 0;
        for (int i = 0; i < worlds; ++i) {
            Driven crowd(static_cast<std::uint64_t>(i + 1), drive);
            crowd.run(6);
            carried += crowd.carried, crushed += crowd.crushed;
        }
        std::printf("rider crowds: %d worlds of kind %d, %zu carried, %zu crushed\n", worlds, static_cast<int>(drive), carried, crushed);
        all_carried += carried, all_crushed += crushed;
    }
    EXPECT_GT(all_carried, 50u);
    EXPECT_LE(all_crushed, all_carried / 20);
}

}  // namespace
}  // namespace carom
