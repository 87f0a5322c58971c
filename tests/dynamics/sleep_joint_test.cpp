// Bodies that joints hold sleep and wake together.
#include <carom/dynamics/world.hpp>

#include <gtest/gtest.h>

#include <vector>

namespace carom {
namespace {

constexpr double kDt = 1.0 / 60.0;

/// A chain that hangs at rest from the world: nothing touches it.
struct Chain {
    World world{{.sleep = {.enabled = true}}};
    std::vector<BodyId> links;
    std::vector<JointId> joints;

    explicit Chain(int count) {
        for (int i = 0; i < count; ++i) {
            links.push_back(world.create_body({.position = {0, -0.5 - i, 0}, .angular_damping = 1.0}));
            world.add_shape(links.back(), Box{{0.1f, 0.4f, 0.1f}});
            BallJointDef joint{.body_b = links.back(), .anchor_a = {0, 0, 0}, .anchor_b = {0, 0.5, 0}};
            if (i > 0) joint.body_a = links[static_cast<std::size_t>(i) - 1], joint.anchor_a = {0, -0.5, 0};
            joints.push_back(world.create_joint(joint));
        }
    }
    void step(int count) {
        for (int i = 0; i < count; ++i) world.step(kDt);
    }
    [[nodiscard]] int awake() const {
        int sum = 0;
        for (const BodyId link : links) sum += world.is_awake(link) ? 1 : 0;
        return sum;
    }
    void sleep_all() {
        step(300);
        ASSERT_EQ(awake(), 0);
    }
};

TEST(SleepJoints, AHangingChainSleepsAsItIsAndWakesAsItWas) {
    Chain chain(4);
    chain.sleep_all();
    const std::uint64_t asleep = chain.world.state_hash();
    const Pose tip = chain.world.pose(chain.links.back());
    chain.step(100);
    EXPECT_EQ(chain.world.state_hash(), asleep);
    chain.world.wake(chain.links.front());
    EXPECT_EQ(chain.awake(), 4);
    chain.step(1);
    EXPECT_LT(glm::length(chain.world.linear_velocity(chain.links.back())), 1e-6);
    chain.step(60);
    EXPECT_LT(glm::length(chain.world.pose(chain.links.back()).position - tip.position), 1e-6);
}

TEST(SleepJoints, AJointThatGoesDropsWhatItHeld) {
    Chain chain(3);
    chain.sleep_all();
    chain.world.destroy_joint(chain.joints[1]);
    EXPECT_EQ(chain.awake(), 3);
    const double before = chain.world.pose(chain.links[2]).position.y;
    chain.step(60);
    EXPECT_NEAR(chain.world.pose(chain.links[2]).position.y, before - 0.5 * 9.81, 0.01);
    EXPECT_NEAR(chain.world.pose(chain.links[0]).position.y, -0.5, 1e-3);
}

TEST(SleepJoints, AJointThatComesOrChangesWakesBoth) {
    Chain chain(2);
    chain.sleep_all();
    const JointId spring = chain.world.create_joint(SpringDef{.body_b = chain.links[1], .anchor_a = {3, -1, 0}, .rest_length = 1.0, .stiffness = 100.0});
    EXPECT_EQ(chain.awake(), 2);
    chain.step(60);
    EXPECT_GT(chain.world.pose(chain.links[1]).position.x, 0.01);
    chain.world.set_damping(chain.links[0], 20.0, 20.0);
    chain.world.set_damping(chain.links[1], 20.0, 20.0);
    chain.step(1200);
    ASSERT_EQ(chain.awake(), 0);
    chain.world.set_joint(spring, SpringDef{.body_b = chain.links[1], .anchor_a = {3, -1, 0}, .rest_length = 1.0, .stiffness = 10.0});
    EXPECT_EQ(chain.awake(), 2);
}

TEST(SleepJoints, AnAnchorThatMovesWakesWhatHangsOnIt) {
    World world({.sleep = {.enabled = true}});
    const BodyId anchor = world.create_body({.type = BodyType::Kinematic});
    const BodyId weight = world.create_body({.position = {0, -1, 0}});
    world.add_shape(weight, Sphere{0.2f});
    world.create_joint(BallJointDef{.body_a = anchor, .body_b = weight, .anchor_b = {0, 1, 0}});
    for (int i = 0; i < 300; ++i) world.step(kDt);
    ASSERT_FALSE(world.is_awake(weight));
    world.set_linear_velocity(anchor, {1, 0, 0});
    for (int i = 0; i < 60; ++i) world.step(kDt);
    EXPECT_TRUE(world.is_awake(weight));
    EXPECT_NEAR(glm::length(world.pose(weight).position - world.pose(anchor).position), 1.0, 1e-6);
}

TEST(SleepJoints, ASwingIsNoRest) {
    Chain chain(1);
    chain.world.set_damping(chain.links[0], 0.0, 0.0);
    chain.world.set_angular_velocity(chain.links[0], {0, 0, 0.3});
    chain.step(600);
    EXPECT_EQ(chain.awake(), 1);
}

// A jointed pair that lies on the ground is touched in its sleep: the joint works from the step in which it wakes.
TEST(SleepJoints, ATouchWakesTheJointsToo) {
    World world({.sleep = {.enabled = true}});
    world.add_shape(world.create_body({.type = BodyType::Static}), Plane{});
    std::vector<BodyId> boxes;
    for (const double x : {0.0, 1.2}) {
        boxes.push_back(world.create_body({.position = {x, 0.5, 0}}));
        world.add_shape(boxes.back(), Box{{0.5f, 0.5f, 0.5f}});
    }
    const JointId joint = world.create_joint(BallJointDef{.body_a = boxes[0], .body_b = boxes[1], .anchor_a = {0.6, 0, 0}, .anchor_b = {-0.6, 0, 0}});
    for (int i = 0; i < 600; ++i) world.step(kDt);
    ASSERT_FALSE(world.is_awake(boxes[0]));
    const BodyId ball = world.create_body({.position = {-3, 0.5, 0}, .linear_velocity = {10, 0, 0}});
    world.add_shape(ball, Sphere{0.4f}, {.density = 5000});
    double gap = 0.0;
    for (int i = 0; i < 60; ++i) {
        world.step(kDt);
        gap = std::max(gap, world.joint_state(joint).stretch);
    }
    EXPECT_GT(world.pose(boxes[1]).position.x, 1.3);
    EXPECT_LT(gap, 1e-6);
}

}  // namespace
}  // namespace carom
