// Joints as users meet them: what is refused, what follows from creating and destroying, what can be read, and that the bits are the same.
#include "table.hpp"

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>
#include <carom/dynamics/explain.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace carom {
namespace {

using namespace test;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Pair {
    World world;
    BodyId still, a, b;

    explicit Pair(const WorldDef& def = {}) : world(def) {
        still = world.create_body({.type = BodyType::Static});
        a = world.create_body({.position = {0, 2, 0}});
        b = world.create_body({.position = {1, 2, 0}});
        for (const BodyId body : {a, b}) world.add_shape(body, Sphere{0.4f});
    }
};

/// Expects the call to be refused with the code, and the world to be as it was.
void expect_refused(World& world, ErrorCode code, const std::function<void()>& call) {
    const std::size_t joints = world.joints().size();
    try {
        call();
        ADD_FAILURE() << "accepted";
    } catch (const MisuseError& e) {
        EXPECT_EQ(e.error().code, code) << e.what();
    }
    EXPECT_EQ(world.joints().size(), joints);
}

TEST(Joint, RefusesBadDefinitions) {
    Pair p;
    const BodyId dead = p.world.create_body();
    p.world.destroy_body(dead);
    const BodyId other = p.world.create_body({.type = BodyType::Kinematic});
    const JointId joint = p.world.create_joint(SpringDef{.body_a = p.a, .body_b = p.b, .stiffness = 1.0});
    const auto refuse = [&](ErrorCode code, const JointDef& def) {
        expect_refused(p.world, code, [&] { static_cast<void>(p.world.create_joint(def)); });
        expect_refused(p.world, code, [&] { p.world.set_joint(joint, def); });
        EXPECT_EQ(std::get<SpringDef>(p.world.joint_def(joint)).stiffness, 1.0);
    };
    refuse(ErrorCode::DeadId, BallJointDef{.body_a = p.a, .body_b = dead});
    refuse(ErrorCode::DeadId, SpringDef{.body_a = dead, .body_b = p.b});
    refuse(ErrorCode::InvalidArgument, BallJointDef{.body_a = p.a, .body_b = p.a});
    refuse(ErrorCode::InvalidArgument, BallJointDef{});
    refuse(ErrorCode::WrongType, BallJointDef{.body_a = p.still});
    refuse(ErrorCode::WrongType, BallJointDef{.body_a = p.still, .body_b = other});
    refuse(ErrorCode::NotFinite, BallJointDef{.body_a = p.a, .anchor_a = {0, kNaN, 0}});
    refuse(ErrorCode::NotFinite, BallJointDef{.body_a = p.a, .anchor_b = {INFINITY, 0, 0}});
    refuse(ErrorCode::InvalidArgument, BallJointDef{.body_a = p.a, .anchor_b = {1e31, 0, 0}});
    refuse(ErrorCode::NotFinite, SpringDef{.body_a = p.a, .rest_length = kNaN});
    refuse(ErrorCode::InvalidArgument, SpringDef{.body_a = p.a, .rest_length = -1.0});
    refuse(ErrorCode::InvalidArgument, SpringDef{.body_a = p.a, .stiffness = -1.0});
    refuse(ErrorCode::NotFinite, SpringDef{.body_a = p.a, .stiffness = INFINITY});
    refuse(ErrorCode::InvalidArgument, SpringDef{.body_a = p.a, .stiffness = 1e31});
    refuse(ErrorCode::InvalidArgument, SpringDef{.body_a = p.a, .damping = -1e-9});
    refuse(ErrorCode::NotFinite, SpringDef{.body_a = p.a, .damping = kNaN});
}

TEST(Joint, RefusesDeadIds) {
    Pair p;
    const JointId joint = p.world.create_joint(BallJointDef{.body_a = p.a, .body_b = p.b});
    p.world.destroy_joint(joint);
    EXPECT_FALSE(p.world.is_alive(joint));
    for (const JointId dead : {joint, JointId{}}) {
        expect_refused(p.world, ErrorCode::DeadId, [&] { p.world.destroy_joint(dead); });
        expect_refused(p.world, ErrorCode::DeadId, [&] { static_cast<void>(p.world.joint_def(dead)); });
        expect_refused(p.world, ErrorCode::DeadId, [&] { static_cast<void>(p.world.joint_state(dead)); });
        expect_refused(p.world, ErrorCode::DeadId, [&] { p.world.set_joint(dead, BallJointDef{.body_a = p.a}); });
    }
    EXPECT_THROW(static_cast<void>(spring_damper(-1.0, 0.5, 1.0)), MisuseError);
    EXPECT_THROW(static_cast<void>(spring_damper(1.0, kNaN, 1.0)), MisuseError);
}

TEST(Joint, GoesWithItsBody) {
    Pair p;
    const JointId ab = p.world.create_joint(BallJointDef{.body_a = p.a, .body_b = p.b});
    const JointId a = p.world.create_joint(SpringDef{.body_a = p.a, .stiffness = 1.0});
    const JointId b = p.world.create_joint(SpringDef{.body_b = p.b, .stiffness = 1.0});
    p.world.step(kDt);
    p.world.destroy_body(p.a);
    EXPECT_FALSE(p.world.is_alive(ab));
    EXPECT_FALSE(p.world.is_alive(a));
    ASSERT_EQ(p.world.joints().size(), 1u);
    EXPECT_EQ(p.world.joints()[0], b);
    EXPECT_EQ(p.world.step(kDt).joints.joints, 1u);
}

TEST(Joint, SaysWhereItIsAndWhatItBears) {
    World world;
    const BodyId weight = world.create_body({.position = {0, -2, 0}});
    world.set_mass_properties(weight, {3.0, dvec3{0.0}, dmat3{1.0}});
    const JointId spring = world.create_joint(SpringDef{.body_b = weight, .anchor_b = {0, 0.5, 0}, .rest_length = 1.0, .stiffness = 400.0, .damping = 60.0});
    JointState state = world.joint_state(spring);
    EXPECT_EQ(state.force, dvec3{0.0});
    EXPECT_EQ(state.length, 1.5);
    EXPECT_EQ(state.stretch, 0.5);
    for (int i = 0; i < 600; ++i) world.step(kDt);
    state = world.joint_state(spring);
    EXPECT_NEAR(state.stretch, 3.0 * 9.81 / 400.0, 1e-9);
    EXPECT_NEAR(state.force.y, 3.0 * 9.81, 1e-6);

    SpringDef def = std::get<SpringDef>(world.joint_def(spring));
    def.stiffness = 4000.0;
    world.set_joint(spring, def);
    for (int i = 0; i < 600; ++i) world.step(kDt);
    EXPECT_NEAR(world.joint_state(spring).stretch, 3.0 * 9.81 / 4000.0, 1e-9);
}

TEST(Joint, SpringDamperSwingsAsOftenAsItSays) {
    const SpringDamper s = spring_damper(2.0, 0.25, 3.0);
    EXPECT_DOUBLE_EQ(s.stiffness, 3.0 * 16.0 * kPi * kPi);
    EXPECT_DOUBLE_EQ(s.damping, 2.0 * 0.25 * std::sqrt(s.stiffness * 3.0));
}

TEST(Joint, LeavesContactsOutUnlessItSaysOtherwise) {
    for (const bool collide : {false, true}) {
        World world({.gravity = {0, 0, 0}});
        const BodyId a = world.create_body(), b = world.create_body({.position = {0.7, 0, 0}});
        for (const BodyId body : {a, b}) world.add_shape(body, Sphere{0.4f});
        const JointId joint = world.create_joint(SpringDef{.body_a = a, .body_b = b, .collide_connected = collide});
        EXPECT_EQ(world.step(kDt).manifolds, collide ? 1u : 0u);
        const ContactExplanation why = world.explain(a, b);
        EXPECT_EQ(why.rung, collide ? Rung::Touch : Rung::Joined);
        EXPECT_EQ(why.sentence.find("joint") != std::string::npos, !collide) << why.sentence;
        EXPECT_TRUE(why.disagreements.empty());
        world.destroy_joint(joint);
        EXPECT_EQ(world.step(kDt).manifolds, 1u);
    }
}

TEST(Joint, WithTheWorldAndWithWhatMovesByItself) {
    World world;
    const BodyId wheel = world.create_body({.type = BodyType::Kinematic, .linear_velocity = {1, 0, 0}, .angular_velocity = {0, 2, 0}});
    const BodyId bob = world.create_body({.position = {0.5, -1, 0}});
    world.add_shape(bob, Sphere{0.2f});
    const JointId joint = world.create_joint(BallJointDef{.body_a = wheel, .body_b = bob, .anchor_a = {0.5, 0, 0}, .anchor_b = {0, 1, 0}});
    for (int i = 0; i < 300; ++i) {
        const StepReport report = world.step(kDt);
        EXPECT_EQ(report.joints.joints, 1u);
        EXPECT_LT(report.joints.worst_gap, 1e-9);
    }
    EXPECT_LT(world.joint_state(joint).length, 1e-9);
    EXPECT_NEAR(world.center_of_mass(wheel).x, 5.0, 1e-9);
}

// Momentum is what the joints' common impulses leave of it: all of it.
TEST(Joint, KeepsMomentum) {
    World world({.gravity = {0, 0, 0}});
    std::vector<BodyId> bodies;
    for (int i = 0; i < 6; ++i) {
        const BodyId body = world.create_body({.position = {0.5 * i, 0, 0}, .linear_velocity = {0, i % 2 == 0 ? 1.0 : -2.0, 0.3 * i}, .angular_velocity = {1, 2, 3}});
        world.add_shape(body, Box{{0.2f, 0.1f, 0.15f}}, {.density = 100.0 * (i + 1), .mask = 0});
        if (i > 0 && i % 2 == 1) world.create_joint(BallJointDef{.body_a = bodies.back(), .body_b = body, .anchor_a = {0.25, 0, 0}, .anchor_b = {-0.25, 0, 0}});
        if (i > 0 && i % 2 == 0) world.create_joint(SpringDef{.body_a = bodies.back(), .body_b = body, .anchor_a = {0.2, 0, 0}, .rest_length = 0.2, .stiffness = 1e4, .damping = 3.0});
        bodies.push_back(body);
    }
    world.step(kDt);  // the velocities given are not those that the joints allow
    const Momentum before = world.momentum();
    for (int i = 0; i < 300; ++i) world.step(kDt);
    const Momentum after = world.momentum();
    EXPECT_LT(glm::length(after.linear - before.linear), 1e-10 * glm::length(before.linear));
    EXPECT_LT(glm::length(after.angular - before.angular), 1e-6 * glm::length(before.angular));
}

// A body far out of its place comes to it over some substeps, and not with a blow.
TEST(Joint, ClosesAGapGently) {
    World world({.gravity = {0, 0, 0}});
    const BodyId body = world.create_body();
    world.add_shape(body, Box{{0.5f, 0.5f, 0.5f}});
    world.create_joint(BallJointDef{.body_b = body, .anchor_a = {0.9, 0.3, 0}, .anchor_b = {0.5, 0.5, 0.5}});
    double fastest = 0.0;
    for (int i = 0; i < 60; ++i) {
        world.step(kDt);
        fastest = std::max(fastest, glm::length(world.linear_velocity(body)));
    }
    EXPECT_LT(world.joint_state(world.joints()[0]).length, 1e-9);
    EXPECT_LT(fastest, 3.0);
}

TEST(Joint, OfAQuarantinedBodyWaits) {
    Pair p({.gravity = {0, 0, 0}});
    p.world.create_joint(BallJointDef{.body_a = p.a, .body_b = p.b, .anchor_a = {1, 0, 0}});
    p.world.step(kDt);
    p.world.set_linear_velocity(p.a, {1e20, 0, 0});
    StepReport report = p.world.step(kDt);
    EXPECT_EQ(report.quarantined.size(), 1u);
    EXPECT_EQ(report.joints.joints, 0u);
    p.world.release(p.a);
    EXPECT_EQ(p.world.step(kDt).joints.joints, 1u);
}

TEST(Joint, WorldsWithoutJointsKeepTheirBits) {
    const auto run = [](bool joint, PlanMode mode) {
        Table table({.plan = mode});
        const BodyId box = table.add({.position = {0, 0.6, 0}}, Box{{0.5f, 0.5f, 0.5f}});
        const BodyId far = table.add({.position = {50, 0.6, 0}}, Box{{0.5f, 0.5f, 0.5f}});
        table.run(5);
        if (joint) table.world.destroy_joint(table.world.create_joint(BallJointDef{.body_a = box, .body_b = far}));
        table.run(20);
        return table.world.state_hash();
    };
    EXPECT_EQ(run(false, PlanMode::Automatic), run(true, PlanMode::Automatic));
    EXPECT_EQ(run(false, PlanMode::Automatic), run(false, PlanMode::Everything));
}

}  // namespace
}  // namespace carom
