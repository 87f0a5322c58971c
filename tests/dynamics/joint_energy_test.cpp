// Where joints once made energy: a rope that snaps taut, and a spring that is pulled through its own middle.
#include <carom/dynamics/world.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

constexpr double kDt = 1.0 / 60.0;

TEST(JointEnergy, ARopeThatSnapsTautUnderAHeavyEndGainsNone) {
    for (const double weight : {30.0, 300.0, 1e4}) {
        World world;
        // Two links of a metre and a kilogram, folded, and a weight that falls.
        const double lean = 1.2;
        BodyId last;
        dvec3 at{0.0};
        for (int i = 0; i < 3; ++i) {
            const double turn = i == 2 ? 0.0 : i == 0 ? lean : -lean;
            const dvec3 down{std::sin(turn), -std::cos(turn), 0.0};
            const double half = i == 2 ? 0.0 : 0.5;
            const BodyId body = world.create_body({.position = at + half * down,
                                                   .orientation = {std::cos(0.5 * turn), 0, 0, std::sin(0.5 * turn)},
                                                   .linear_velocity = {0, i == 2 ? -6.3 : 0.0, 0}});
            world.set_mass_properties(body, {i == 2 ? weight : 1.0, dvec3{0.0}, dmat3{i == 2 ? weight : 0.1}});
            world.create_joint(BallJointDef{.body_a = last, .body_b = body, .anchor_a = i == 0 ? dvec3{0.0} : dvec3{0, -0.5, 0}, .anchor_b = {0, half, 0}});
            last = body;
            at += 2.0 * half * down;
        }
        const double before = world.energy().total();
        double most = before;
        std::size_t given_up = 0;
        for (int i = 0; i < 300; ++i) {
            given_up += world.step(kDt).joints.given_up;
            most = std::max(most, world.energy().total());
        }
        EXPECT_LT(most - before, 1e-3 * weight * 9.81) << weight;
        if (weight >= 300.0) {
            EXPECT_GT(given_up, 0u) << weight;
        }
    }
}

TEST(JointEnergy, ASpringThatIsPulledThroughItsMiddleGainsNone) {
    for (const double stiffness : {2304.0, 20736.0, 186624.0}) {
        World world({.gravity = dvec3{0.0}});
        const BodyId body = world.create_body({.position = {1, 0, 0}});
        world.create_joint(SpringDef{.body_b = body, .rest_length = 0.4727, .stiffness = stiffness});
        const double before = world.energy().total();
        double most = 0.0;
        for (int i = 0; i < 6000; ++i) {
            world.step(kDt);
            most = std::max(most, world.energy().total());
        }
        EXPECT_LT(most, 1.001 * before) << stiffness;
    }
}

}  // namespace
}  // namespace carom
