// World::explain_sweep: who was followed, who met whom and when.
#include "shot.hpp"

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace carom {
namespace {

using namespace test;

TEST(ExplainSweep, AShotThatIsStoppedWasFollowedAndMet) {
    Shot shot(kWatched);
    shot.fly(2);
    EXPECT_EQ(shot.last.reason, SweepReason::Watched);
    EXPECT_EQ(shot.last.a.reason, Following::Followed);
    EXPECT_NEAR(shot.last.a.motion, 100.0 * kDt, 1e-9);
    EXPECT_NEAR(shot.last.a.limit, kRadius, 1e-9);
    EXPECT_TRUE(shot.last.a.flew);
    EXPECT_EQ(shot.last.b.reason, Following::Static);
    EXPECT_EQ(shot.last.pairs.at(0).impact.status, ImpactStatus::Separated);
    const double gap = 4.3 - 200.0 * kDt - kHalf - kRadius;
    EXPECT_LE(shot.last.pairs[0].clearance, gap);
    EXPECT_GT(shot.last.pairs[0].clearance, 0.98 * gap);
    EXPECT_TRUE(says(shot.last.sentence, "stayed at least")) << shot.last.sentence;
    shot.fly(1);
    EXPECT_TRUE(shot.passages.empty());
    const double t = gap / (100.0 * kDt);
    ASSERT_EQ(shot.last.impacts.size(), 1u);
    const SweepImpact& met = shot.last.impacts[0];
    EXPECT_EQ(met.body_a, shot.ball);
    EXPECT_EQ(met.body_b, shot.wall);
    EXPECT_TRUE(met.blow);
    EXPECT_EQ(met.status, ImpactStatus::Touching);
    EXPECT_EQ(met.watched, 1.0);
    EXPECT_LE(met.t, t + 1e-12);
    EXPECT_GT(met.t, t - 1e-4);
    EXPECT_NEAR(met.normal.z, 1.0, 1e-6);
    EXPECT_NEAR(met.pose_a.position.z, -kHalf - kRadius, met.margin);
    EXPECT_LT(met.margin, 2e-4 * kRadius + 1e-12);
    EXPECT_TRUE(met.advances.empty()) << "a ball against a box has a closed form";
    EXPECT_EQ(shot.last.a.impacts, 1);
    EXPECT_EQ(shot.last.pairs.at(0).impact.status, ImpactStatus::Touching);
    EXPECT_LE(shot.last.pairs[0].impact.t, met.t);
    EXPECT_NEAR(shot.last.pairs[0].impact.t, met.t, 1e-5);
    EXPECT_LT(shot.last.pairs[0].margin, 3e-4 * kRadius);
    EXPECT_TRUE(says(shot.last.sentence, "they met at t = ")) << shot.last.sentence;
    EXPECT_TRUE(says(shot.last.sentence, "touching, and were struck apart")) << shot.last.sentence;
    // From the other side the same, turned round.
    const SweepExplanation back = shot.world.explain_sweep(shot.wall, shot.ball);
    EXPECT_EQ(back.pairs[0].impact.t, shot.last.pairs[0].impact.t);
    EXPECT_EQ(back.pairs[0].impact.normal, -shot.last.pairs[0].impact.normal);
    EXPECT_EQ(back.b.reason, Following::Followed);
}

TEST(ExplainSweep, WhatIsTooDeepIsLeftToContacts) {
    World world(kWatched);
    const BodyId press = world.create_body({.type = BodyType::Kinematic, .linear_velocity = {0.0, 0.0, 100.0}});
    const BodyId ball = world.create_body({.continuity = Continuity::Always});
    world.add_shape(press, kWall);
    world.add_shape(ball, Sphere{0.05f});
    EXPECT_GE(world.step(kDt).continuous.overlapping, 1u);
    const SweepExplanation why = world.explain_sweep(ball, press);
    EXPECT_EQ(why.reason, SweepReason::TooDeep) << to_string(why.reason);
    EXPECT_EQ(why.pairs.at(0).impact.status, ImpactStatus::Overlapping);
    EXPECT_FALSE(why.passage) << "its middle was there before";
    EXPECT_TRUE(says(why.sentence, "too deep in each other")) << why.sentence;
}

TEST(ExplainSweep, WhatFliesTogetherKeepsCompany) {
    World world(kWatched);
    const BodyId a = world.create_body({.linear_velocity = {0.0, 0.0, 100.0}}),
                 b = world.create_body({.position = {0.0, 0.2, 0.0}, .linear_velocity = {0.0, 0.0, 100.0}});
    for (const BodyId body : {a, b}) world.add_shape(body, Sphere{0.05f});
    world.step(kDt);
    const SweepExplanation why = world.explain_sweep(a, b);
    EXPECT_EQ(why.a.reason, Following::Followed);
    EXPECT_EQ(why.reason, SweepReason::Company);
    EXPECT_NEAR(why.pairs.at(0).clearance, 0.1, 0.002);
    world.set_continuity(a, Continuity::Always);
    world.step(kDt);
    EXPECT_EQ(world.explain_sweep(a, b).reason, SweepReason::Watched);
}

TEST(ExplainSweep, WhatRestsIsLeftToContacts) {
    Table table({.record_paths = true}, 0.0f);
    const BodyId crate = table.add({.position = {0.0, 0.5, 0.0}}, Box{}), aside = table.add({.position = {9.0, 0.5, 0.0}}, Box{});
    table.run(3);
    const SweepExplanation why = table.world.explain_sweep(crate, table.ground);
    EXPECT_EQ(why.a.reason, Following::Slow);
    EXPECT_EQ(why.b.reason, Following::Static);
    EXPECT_FALSE(why.a.flew);
    EXPECT_EQ(why.reason, SweepReason::Slow);
    EXPECT_EQ(why.pairs.at(0).impact.status, ImpactStatus::Overlapping);
    EXPECT_FALSE(why.passage);
    EXPECT_TRUE(table.world.sweeps().bodies.empty()) << "nothing was followed";
    EXPECT_NEAR(table.world.explain_sweep(crate, aside).pairs.at(0).clearance, 8.0, 0.2);
}

TEST(ExplainSweep, SaysWhomABodyMetFirst) {
    Shot shot(kWatched);
    const BodyId shield = shot.world.create_body({.type = BodyType::Static, .position = {0.0, 0.0, -0.5}});
    shot.world.add_shape(shield, kWall);
    shot.fly(3);
    ASSERT_EQ(shot.last.impacts.size(), 1u);
    EXPECT_EQ(shot.last.impacts[0].body_b, shield);
    EXPECT_EQ(shot.last.reason, SweepReason::Watched);
    EXPECT_TRUE(says(shot.last.sentence, "stayed at least")) << shot.last.sentence;
    EXPECT_TRUE(says(shot.last.sentence, "A met body 2 at t = ")) << shot.last.sentence;
    EXPECT_TRUE(shot.passages.empty());
}

TEST(ExplainSweep, SaysWhyABodyStopped) {
    World world({.gravity = dvec3{0.0}, .record_paths = true, .continuous = {.most_impacts = 3}});
    BodyId plates[2];
    for (int i = 0; i < 2; ++i) {
        plates[i] = world.create_body({.type = BodyType::Static, .position = {0.0, 0.0, i == 0 ? -0.2 : 0.2}});
        world.add_shape(plates[i], kWall, {.restitution = 1.0f});
    }
    const BodyId ball = world.create_body({.linear_velocity = {0.0, 0.0, 500.0}});
    world.add_shape(ball, Sphere{0.05f}, {.restitution = 1.0f});
    world.step(kDt);
    const SweepExplanation why = world.explain_sweep(ball, plates[0]);
    EXPECT_EQ(why.a.impacts, 3);
    EXPECT_EQ(why.a.stopped, StopCause::Impacts);
    EXPECT_EQ(why.b.stopped, StopCause::None);
    ASSERT_EQ(why.impacts.size(), 3u);
    EXPECT_EQ(why.a.stopped_at, why.impacts[2].t);
    EXPECT_LT(why.a.stopped_at, 1.0);
    const StepSweeps sweeps = world.sweeps();
    ASSERT_EQ(sweeps.bodies.size(), 1u);
    EXPECT_EQ(sweeps.bodies[0].times, (std::vector<double>{0.0, why.impacts[0].t, why.impacts[1].t, why.impacts[2].t, 1.0}));
    const double stands = world.pose_within_step(ball, why.a.stopped_at).position.z;
    EXPECT_EQ(world.pose_within_step(ball, 1.0).position.z, stands);
    EXPECT_EQ(world.pose(ball).position.z, stands);
    EXPECT_NEAR(std::abs(stands), 0.2 - kHalf - kRadius, 1e-5);
}

// Ten whole turns: the short arc between the two poses is no motion at all.
TEST(ExplainSweep, PathsHaveAllTheirTurns) {
    World world(kDiscrete);
    const BodyId rod = world.create_body({.orientation = rotation_about({0.0, 0.0, 1.0}, std::numbers::pi / 2),
                                          .angular_velocity = {0.0, 20.0 * std::numbers::pi / kDt, 0.0}});
    world.add_shape(rod, Capsule{0.0005f, 0.4995f});
    const BodyId ball = world.create_body({.position = {0.0, 0.0, 0.4}});
    world.add_shape(ball, Sphere{0.02f});
    world.step(kDt);
    const SweepExplanation why = world.explain_sweep(rod, ball);
    ASSERT_TRUE(why.passage);
    EXPECT_EQ(why.passage->cause, SweepReason::Off);
    EXPECT_TRUE(why.passage->through);
    EXPECT_LE(why.passage->t, 0.025) << "a quarter of the first turn";
    EXPECT_GT(why.passage->t, 0.02);
    const dvec3 end = rotate(world.pose_within_step(rod, 0.025).orientation, dvec3{0.0, 1.0, 0.0});
    EXPECT_NEAR(std::abs(end.z), 1.0, 1e-6);
}

// A ball on its parabola passes behind a disc that the chord would pierce.
TEST(ExplainSweep, PathsAreTheIntegratorsAndNotChords) {
    World world({.gravity = {0.0, -100.0, 0.0}, .record_paths = true, .continuous = {.enabled = false}});
    const BodyId disc = world.create_body({.type = BodyType::Static});
    world.add_shape(disc, Box{{0.01f, 0.2f, 1.0f}});
    const BodyId ball = world.create_body({.position = {-5.0, 0.0, 0.0}, .linear_velocity = {10.0, 50.0, 0.0}});
    world.add_shape(ball, Sphere{0.05f});
    world.step(1.0);  // from (-5, 0) over (0, 12.5) to (5, 0)
    const SweepExplanation why = world.explain_sweep(ball, disc);
    EXPECT_EQ(why.pairs.at(0).impact.status, ImpactStatus::Separated);
    EXPECT_FALSE(why.passage);
    EXPECT_NEAR(world.pose_within_step(ball, 0.5).position.y, 12.5, 1e-12);
    EXPECT_NEAR(world.pose_within_step(ball, 0.25).position.y, 9.375, 1e-12);
}

TEST(ExplainSweep, AdvancementIsWrittenDownStepByStep) {
    World world(kWatched);
    const BodyId wall = world.create_body({.type = BodyType::Kinematic, .angular_velocity = {0.0, 5.0, 0.0}});
    world.add_shape(wall, kWall);
    const BodyId brick =
        world.create_body({.position = {0.3, 0.0, -1.0}, .linear_velocity = {0.0, 0.0, 100.0}, .angular_velocity = {20.0, 30.0, 0.0}});
    world.add_shape(brick, Box{{0.05f, 0.1f, 0.15f}});
    world.step(kDt);
    const StepSweeps sweeps = world.sweeps();
    EXPECT_EQ(sweeps.step, 1u);
    ASSERT_GE(sweeps.impacts.size(), 1u);
    const SweepImpact& met = sweeps.impacts[0];
    ASSERT_GE(met.advances.size(), 2u);
    for (std::size_t i = 0; i < met.advances.size(); ++i) {
        EXPECT_GE(met.advances[i], i == 0 ? 0.0 : met.advances[i - 1]);
        EXPECT_LE(met.advances[i], met.t);
    }
    EXPECT_LT(met.advances.front(), 0.9 * met.t);
    EXPECT_GT(met.advances.back(), met.t - 0.01);
    ASSERT_EQ(sweeps.bodies.size(), 2u) << "both were followed";
}

/// Balls, boxes and rods in a box, fast enough to meet often.
World crowd(bool records) {
    World world({.gravity = dvec3{0.0}, .record_paths = records});
    for (const double z : {-1.0, 1.0})
        world.add_shape(world.create_body({.type = BodyType::Static, .position = {0.0, 0.0, z}}), kWall, {.restitution = 0.5f});
    Random random(31);
    for (int i = 0; i < 40; ++i) {
        const BodyId body =
            world.create_body({.position = {random.range(-2.0, 2.0), random.range(-2.0, 2.0), random.range(-0.8, 0.8)},
                               .linear_velocity = {random.range(-100.0, 100.0), random.range(-50.0, 50.0), random.range(-100.0, 100.0)},
                               .angular_velocity = {random.range(-200.0, 200.0), random.range(-20.0, 20.0), 0.0}});
        world.add_shape(body,
                        i % 3 == 0   ? Shape{Sphere{0.06f}}
                        : i % 3 == 1 ? Shape{Box{{0.1f, 0.05f, 0.07f}}}
                                     : Shape{Capsule{0.02f, 0.2f}},
                        {.restitution = 0.5f});
    }
    return world;
}

TEST(ExplainSweep, WritingDownChangesNothingAndFindsNoFault) {
    World with = crowd(true), without = crowd(false);
    std::size_t impacts = 0, listed = 0;
    for (int i = 0; i < 6; ++i) {
        impacts += with.step(kDt).continuous.impacts;
        without.step(kDt);
        ASSERT_EQ(with.state_hash(), without.state_hash()) << i;
        for (const SweepImpact& impact : with.sweeps().impacts) listed += impact.blow;
        for (const BodyId body : with.bodies()) {
            const Pose now = with.pose(body), end = with.pose_within_step(body, 1.0);
            EXPECT_LT(glm::length(now.position - end.position), 1e-12);
        }
        for (std::size_t a = 0; a < 2; ++a) {  // nothing passed through the walls
            for (std::size_t b = 2; b < with.bodies().size(); ++b) {
                const SweepExplanation why = with.explain_sweep(with.bodies()[a], with.bodies()[b]);
                EXPECT_FALSE(why.passage) << why.sentence;
                EXPECT_TRUE(why.disagreements.empty());
            }
        }
    }
    EXPECT_GT(impacts, 50u);
    EXPECT_EQ(listed, impacts);
}

TEST(ExplainSweep, WhatTheStepDidNotKnowIsSaid) {
    World world(kWatched);
    const BodyId a = world.create_body({}), b = world.create_body({.position = {3.0, 0.0, 0.0}}), empty = world.create_body({});
    for (const BodyId body : {a, b}) world.add_shape(body, Sphere{});
    EXPECT_EQ(world.explain_sweep(a, b).reason, SweepReason::NoStep);
    EXPECT_EQ(world.explain_sweep(a, b).a.reason, Following::NoStep);
    EXPECT_TRUE(world.sweeps().bodies.empty());
    world.step(kDt);
    EXPECT_EQ(world.explain_sweep(a, b).reason, SweepReason::Still);
    EXPECT_EQ(world.explain_sweep(a, b).a.reason, Following::Still);
    EXPECT_EQ(world.explain_sweep(a, a).reason, SweepReason::SameBody);
    EXPECT_EQ(world.explain_sweep(a, empty).reason, SweepReason::NoShapes);
    EXPECT_EQ(world.explain_sweep(a, empty).b.reason, Following::NoShapes);
    const BodyId late = world.create_body({.position = {7.0, 0.0, 0.0}});
    world.add_shape(late, Sphere{});
    EXPECT_EQ(world.explain_sweep(a, late).reason, SweepReason::OutOfStep);
    EXPECT_EQ(world.explain_sweep(a, late).b.reason, Following::OutOfStep);
    EXPECT_EQ(world.pose_within_step(late, 0.5).position.x, 7.0);
    world.destroy_body(b);
    const BodyId next = world.create_body({.position = {4.0, 0.0, 0.0}});  // in the same slot
    world.add_shape(next, Sphere{});
    EXPECT_EQ(world.explain_sweep(a, next).reason, SweepReason::OutOfStep);
    EXPECT_EQ(world.pose_within_step(next, 0.0).position.x, 4.0);
}

// What is changed after the step does not change what is said of it.
TEST(ExplainSweep, SpeaksOfTheStepAsItWas) {
    World world({.gravity = dvec3{0.0}, .record_paths = true, .continuous = {.enabled = false}});
    const BodyId wall = world.create_body({.type = BodyType::Static});
    world.add_shape(wall, Box{{0.1f, 2.0f, 2.0f}});
    const BodyId ball = world.create_body({.position = {-1.0, 0.0, 0.0}, .linear_velocity = {120.0, 0.0, 0.0}});
    world.add_shape(ball, Sphere{0.1f});
    world.step(kDt);
    const SweepReason reason = world.explain_sweep(ball, wall).reason;
    EXPECT_EQ(reason, SweepReason::Off);
    const Pose end = world.pose_within_step(ball, 1.0);
    EXPECT_EQ(end.position, world.pose(ball).position);
    const JointId spring = world.create_joint(SpringDef{.body_a = ball, .body_b = wall, .stiffness = 1.0});
    EXPECT_EQ(world.explain_sweep(ball, wall).reason, reason) << "the joint came later";
    world.destroy_joint(spring);
    world.add_shape(ball, Sphere{0.1f}, {.local = {{0.0, 1.0, 0.0}, kIdentityRotation}});
    EXPECT_EQ(world.pose_within_step(ball, 1.0).position, end.position) << "its centre of mass is another since";
}

TEST(ExplainSweep, RefusesBadInput) {
    World world(kWatched), silent({.gravity = dvec3{0.0}});
    const BodyId a = world.create_body({}), b = world.create_body({}), c = silent.create_body({}), d = silent.create_body({});
    EXPECT_THROW(static_cast<void>(silent.explain_sweep(c, d)), MisuseError);
    EXPECT_THROW(static_cast<void>(silent.sweeps()), MisuseError);
    EXPECT_THROW(static_cast<void>(silent.passage(c, d)), MisuseError);
    EXPECT_THROW(static_cast<void>(silent.pose_within_step(c, 0.5)), MisuseError);
    EXPECT_THROW(static_cast<void>(world.pose_within_step(a, -0.1)), MisuseError);
    EXPECT_THROW(static_cast<void>(world.pose_within_step(a, 1.1)), MisuseError);
    EXPECT_THROW(static_cast<void>(world.pose_within_step(a, std::numeric_limits<double>::quiet_NaN())), MisuseError);
    world.destroy_body(b);
    EXPECT_THROW(static_cast<void>(world.explain_sweep(a, b)), MisuseError);
    EXPECT_THROW(static_cast<void>(world.explain_sweep(BodyId{}, a)), MisuseError);
    EXPECT_THROW(static_cast<void>(world.passage(a, b)), MisuseError);
    EXPECT_THROW(static_cast<void>(world.pose_within_step(b, 0.5)), MisuseError);
}

}  // namespace
}  // namespace carom
