// Where a body goes in a step, as the continuous stage sees it: within its bend of where the integrator has it.
#include "bullets.hpp"

#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/dynamics/detail/body_path.hpp>
#include <carom/dynamics/detail/body_sizes.hpp>
#include <carom/dynamics/detail/path_touch.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace carom {
namespace {

using namespace test;
using dynamics::BodyMass;
using dynamics::BodyPath;
using dynamics::BodyState;

constexpr double kStep = 1.0 / 60.0, kReach = 0.5, kMostBend = 1e-4;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// A body that is symmetric about its y axis, as long as it is thick by the share.
BodyMass rod_mass(double share) {
    BodyMass mass;
    static_cast<FreeRotation&>(mass) = classify({0.1, 0.1 * share, 0.1});
    mass.mass = 1.0, mass.inverse_mass = 1.0;
    return mass;
}

BodyState thrown(Random& random, double spin) {
    return {.pose = {dvec3{0.0}, any_rotation(random)},
            .velocity = {random.range(-50.0, 50.0), random.range(-50.0, 50.0), random.range(-50.0, 50.0)},
            .spin = spin * rotate(any_rotation(random), dvec3{0.0, 1.0, 0.0})};
}

/// @return by how much more than its bend the path has an end of the body's y axis elsewhere than the integrator has it [m], at most.
double farthest_off(BodyPath& path, const dynamics::Flight& flight, const BodyMass& mass, std::uint32_t number) {
    const dynamics::PathPiece piece = path.piece(number);
    double worst = -kInfinite;
    for (int k = 0; k <= 40; ++k) {
        const double t = piece.begin + k / 40.0 * (piece.end - piece.begin);
        BodyState state = flight.start;
        dynamics::integrate_free(state, mass, flight.motion, t * kStep);
        const dvec3 end{0.0, kReach, 0.0};
        const double off = glm::length(transform_point(pose_at(piece, t), end) - transform_point(state.pose, end));
        worst = std::max(worst, off - piece.bend);
    }
    return worst;
}

TEST(BodyPath, TheAxisOfARoundBodyIsOnOneScrew) {
    Random random(5);
    for (int i = 0; i < 2000; ++i) {
        const BodyMass mass = rod_mass(std::pow(10.0, random.range(-6.0, 0.3)));
        ASSERT_EQ(mass.inertia, InertiaClass::Symmetric);
        const dynamics::Flight flight{thrown(random, std::pow(10.0, random.range(-2.0, 5.0))), {.acceleration = {0.0, -9.81, 0.0}}};
        BodyPath path;
        path.fly(flight, mass, 0.0, {kStep, kReach, 1e-3, dvec3{kInfinite, 0.0, kInfinite}});
        EXPECT_FALSE(path.can_split(BodyPath::kWhole)) << i;
        EXPECT_LT(path.piece(BodyPath::kWhole).bend, 1e-3);
        EXPECT_LE(farthest_off(path, flight, mass, BodyPath::kWhole), 1e-15) << i;  // of a way of a metre
    }
}

// Not round, or not nearly enough, or twisted, slowed down, locked: then the bend is that of any body, and pieces are made as fine as it takes.
TEST(BodyPath, WhatIsNotRoundOrNotFreeIsCutIntoPieces) {
    Random random(6);
    const BodyMass rod = rod_mass(1e-3);
    BodyMass locked = rod;
    locked.locked = LockedAxes::TurnX;
    const dvec3 round{kInfinite, 0.0, kInfinite};
    struct Case {
        const char* what;
        BodyMass mass;
        dynamics::FreeMotion motion;
        dvec3 out_of_round;
    };
    const Case cases[]{{"round about another axis", rod, {}, {0.0, kInfinite, 0.0}},
                       {"out of round by more than is let be", rod, {}, {kInfinite, 0.5 * kMostBend, kInfinite}},
                       {"twisted", rod, {.torque = {0.0, 1.0, 0.0}}, round},
                       {"damped", rod, {.angular_damping = 0.1}, round},
                       {"locked", locked, {}, round}};
    for (const Case& c : cases) {
        BodyState start = thrown(random, 300.0);
        start.spin = 300.0 * rotate(start.pose.orientation, glm::normalize(dvec3{1.0, 1.0, 0.0}));
        const dynamics::Flight flight{start, c.motion};
        BodyPath path;
        path.fly(flight, c.mass, 0.0, {kStep, kReach, kMostBend, c.out_of_round});
        EXPECT_TRUE(path.can_split(BodyPath::kWhole)) << c.what;
        EXPECT_LE(farthest_off(path, flight, c.mass, BodyPath::kWhole), 0.0) << c.what;
        std::uint32_t number = BodyPath::kWhole;
        while (path.can_split(number)) number = path.split(number).second;
        EXPECT_LE(farthest_off(path, flight, c.mass, number), 0.0) << c.what;
    }
}

// About one axis of the world any body turns evenly, and one that is as heavy about each turns evenly about two.
TEST(BodyPath, WhatLocksLeaveOneAxisIsOnOneScrew) {
    Random random(7);
    constexpr unsigned char kUpright = LockedAxes::TurnX | LockedAxes::TurnZ;
    for (const bool isotropic : {false, true}) {
        for (int i = 0; i < 200; ++i) {
            BodyMass mass = rod_mass(0.1);
            static_cast<FreeRotation&>(mass) = classify(isotropic ? dvec3{0.1} : dvec3{0.1, 0.02, 0.07});
            mass.locked = isotropic && i % 2 == 0 ? LockedAxes::TurnX : kUpright;
            dynamics::Flight flight{thrown(random, 0.0), {}};
            const double spin = std::pow(10.0, random.range(-1.0, 5.0));
            flight.start.spin = mass.locked == kUpright ? dvec3{0.0, spin, 0.0} : spin * glm::normalize(dvec3{0.0, random.unit(), 1.0});
            BodyPath path;
            path.fly(flight, mass, 0.0, {kStep, kReach, kMostBend});
            EXPECT_FALSE(path.can_split(BodyPath::kWhole)) << spin;
            EXPECT_LE(farthest_off(path, flight, mass, BodyPath::kWhole), 1e-11) << spin;  // turns of up to 1,700 rad
            EXPECT_LT(glm::length(path.end().spin - flight.start.spin), 1e-12 * spin);
        }
    }
}

TEST(BodyPath, ShapesTellHowRoundTheyAre) {
    const Pose centred{}, aside{{1e-3, 0.2, 0.0}, kIdentityRotation}, tilted{dvec3{0.0}, rotation_about({1, 0, 0}, 1e-5)},
        lying{dvec3{0.0}, rotation_about({1, 0, 0}, 0.5 * kPi)};
    EXPECT_EQ(dynamics::out_of_round(Capsule{0.1f, 0.4f}, centred, 0.5), (dvec3{kInfinite, 0.0, kInfinite}));
    EXPECT_EQ(dynamics::out_of_round(Sphere{0.1f}, centred, 0.1), (dvec3{0.0}));
    EXPECT_NEAR(dynamics::out_of_round(Sphere{0.1f}, aside, 0.3).y, 1e-3, 1e-12);
    EXPECT_NEAR(dynamics::out_of_round(Cylinder{0.1f, 0.4f}, aside, 0.7).y, 1e-3, 1e-12);
    // No point of what is tilted by an angle is farther from where it was than that times its distance.
    EXPECT_GE(dynamics::out_of_round(Cone{0.1f, 0.4f}, tilted, 0.5).y, 0.5 * 1e-5);
    EXPECT_LE(dynamics::out_of_round(Cone{0.1f, 0.4f}, tilted, 0.5).y, 1.1 * 1e-5);
    EXPECT_LT(dynamics::out_of_round(Capsule{0.1f, 0.4f}, lying, 0.5).z, 1e-15);
    EXPECT_EQ(dynamics::out_of_round(Capsule{0.1f, 0.4f}, lying, 0.5).y, kInfinite);
    EXPECT_EQ(dynamics::out_of_round(Box{{0.1f, 0.4f, 0.1f}}, centred, 0.5), dvec3{kInfinite});
}

// A rod that turns 30 times beside a ball, nearer and nearer: one look has not enough certificates for that, and where it ends is no contact.
TEST(BodyPath, ASearchGoesOnWhereALookCameToItsCap) {
    const BodyMass mass = rod_mass(1e-3);
    const BodyState start{.pose = {}, .velocity = {0.0, 0.0, 0.3}, .spin = {0.0, 0.0, 2.0 * kPi * 30.0 / kStep}};
    BodyPath path, still;
    path.fly({start, {}}, mass, 0.0, {kStep, kReach, kMostBend, dvec3{kInfinite, 0.0, kInfinite}});
    const Shape rod = Capsule{0.001f, 0.499f}, ball = Sphere{0.1f};
    const double gap = 0.002;  // of which the rod comes 5 mm in the step
    const Pose where{{0.3, 0.0, 0.101 + gap}, kIdentityRotation}, local{};
    still.go({.start = where});
    dynamics::Cores cores;
    dynamics::PathSearch search{.a = {&path, &rod, &local, kReach}, .b = {&still, &ball, &local, 0.1}, .tolerance = 1e-7};
    ASSERT_TRUE(dynamics::touch(search, 0.0, 1.0, cores));
    EXPECT_GT(search.resumed, 0) << "or else nothing is tested";
    EXPECT_EQ(search.impact.status, ImpactStatus::Touching);
    // It comes over the ball's top twice a turn, which is 8e-5 m: the gap closes in one of these.
    EXPECT_NEAR(search.t * 0.3 * kStep, gap, 1e-4);
}

}  // namespace
}  // namespace carom
