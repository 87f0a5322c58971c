// The certificate of a step, and sequential impulses as a method of contact.
#include <carom/dynamics/plan.hpp>
#include <carom/dynamics/world.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace carom {
namespace {

BodyId add_box(World& world, const dvec3& at, double density = 1000.0) {
    const BodyId body = world.create_body({.position = at});
    world.add_shape(body, Box{vec3{0.5f}}, {.density = density});
    return body;
}

void add_floor(World& world) { world.add_shape(world.create_body({.type = BodyType::Static}), Plane{{0, 1, 0}, 0}); }

StepReport settle(World& world, int steps) {
    StepReport report;
    for (int i = 0; i < steps; ++i) report = world.step(1.0 / 60.0);
    return report;
}

TEST(ContactResidual, IsThereOnlyWhereAskedForAndChangesNoBit) {
    World plain, asked({.report_residual = true});
    for (World* world : {&plain, &asked}) {
        add_floor(*world);
        for (int i = 0; i < 3; ++i) add_box(*world, {0.1 * i, 0.6 + 1.1 * i, 0.0});
    }
    for (int i = 0; i < 60; ++i) {
        EXPECT_FALSE(plain.step(1.0 / 60.0).residual);
        ASSERT_TRUE(asked.step(1.0 / 60.0).residual);
        ASSERT_EQ(plain.state_hash(), asked.state_hash()) << i;
    }
    EXPECT_FALSE(asked.step(0.0).residual);
}

TEST(ContactResidual, IsSmallAtRestByEveryMethod) {
    for (const ContactMethod method : {ContactMethod::Soft, ContactMethod::Direct, ContactMethod::Impulses}) {
        World world({.contact_method = method, .report_residual = true});
        add_floor(world);
        for (int i = 0; i < 4; ++i) add_box(world, {0.0, 0.5 + i, 0.0});
        const ContactResidual rest = settle(world, 300).residual.value();
        EXPECT_LT(rest.balance, 2e-3) << to_string(method);
        EXPECT_LT(rest.speed, 1e-3) << to_string(method);
        EXPECT_LT(rest.cone, method == ContactMethod::Impulses ? 1e-3 : 1e-5) << to_string(method) << ": impulses are floats; a last pass takes friction before the normal";
    }
}

// A box is pushed along the floor by a force that friction does not hold: contact and force together explain its motion, and a force that is not told does not.
TEST(ContactResidual, KnowsTheForcesOfTheStep) {
    World world({.report_residual = true});
    add_floor(world);
    const BodyId box = add_box(world, {0.0, 0.5, 0.0});
    settle(world, 60);
    world.apply_force(box, {20'000.0, 0.0, 0.0}, world.center_of_mass(box));
    const double pushed = world.step(1.0 / 60.0).residual.value().balance;
    EXPECT_LT(pushed, 0.2) << "the corners' forces change within this one step, but the push is no surprise: of 333 N s, 98 are friction";
    EXPECT_GT(glm::length(world.linear_velocity(box)), 0.1);
}

TEST(ContactResidual, SeesAnImpact) {
    World world({.report_residual = true});
    add_floor(world);
    const BodyId box = add_box(world, {0.0, 1.5, 0.0});
    double worst = 0.0;
    for (int i = 0; i < 60; ++i) worst = std::max(worst, world.step(1.0 / 60.0).residual.value().balance);
    EXPECT_GT(worst, 0.1) << "the last substep's force is not that of the step";
    EXPECT_NEAR(world.center_of_mass(box).y, 0.5, 1e-3);
}

TEST(Impulses, HoldAStackAndSayInThePlanWhatRuns) {
    World world({.substeps = 32, .contact_method = ContactMethod::Impulses});
    add_floor(world);
    for (int i = 0; i < 4; ++i) add_box(world, {0.0, 0.5 + i, 0.0});
    settle(world, 300);
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(world.center_of_mass(world.bodies()[static_cast<std::size_t>(i + 1)]).y, 0.5 + i, 0.02);
    double lowest = 0.0;
    for (std::size_t i = 0; i < world.contact_count(); ++i) {
        const ContactView view = world.contact(i);
        double sum = 0.0;
        for (const float f : view.normal_impulse) sum += static_cast<double>(f);
        lowest = std::max(lowest, sum * 32.0 * 60.0);
    }
    EXPECT_NEAR(lowest, 4.0 * 9810.0, 0.01 * 4.0 * 9810.0);
    for (const PlanEntry& row : world.plan().entries) {
        if (row.stage == Stage::Direct) {
            EXPECT_TRUE(row.run);
            EXPECT_NE(row.reason.find("Impulses"), std::string::npos);
        }
    }
}

// μ holds a box on a slope below its angle and lets it go above; both sides of the circle's 45°.
TEST(Impulses, FrictionIsCoulombsInEveryDirection) {
    for (const double turn : {0.0, 0.7853981633974483}) {
        const dvec3 along{std::cos(turn), 0.0, std::sin(turn)};
        for (const double tangent : {0.55, 0.65}) {
            World world({.gravity = 9.81 * (tangent * along - dvec3{0, 1, 0}), .substeps = 16, .contact_method = ContactMethod::Impulses});
            add_floor(world);
            const BodyId box = add_box(world, {0.0, 0.5, 0.0});
            settle(world, 60);
            const double way = glm::dot(world.center_of_mass(box), along), free = 0.5 * 9.81 * (tangent - 0.6);
            if (tangent < 0.6) {
                EXPECT_LT(std::abs(way), 0.005) << turn;
            } else {
                EXPECT_NEAR(way, free, 0.1 * free) << turn;
            }
        }
    }
}

TEST(Impulses, WorkWithoutGravityAndLeaveBouncesAndLocksToTheSoftSolver) {
    World world({.gravity = dvec3{0.0}, .contact_method = ContactMethod::Impulses});
    const BodyId left = add_box(world, {0.0, 0.0, 0.0}), right = add_box(world, {1.2, 0.0, 0.0});
    world.set_linear_velocity(left, {1.0, 0.0, 0.0});
    settle(world, 60);
    EXPECT_NEAR(world.linear_velocity(left).x, 0.5, 1e-6);
    EXPECT_NEAR(world.linear_velocity(right).x, 0.5, 1e-6);

    World bouncy({.contact_method = ContactMethod::Impulses});
    add_floor(bouncy);
    const BodyId ball = bouncy.create_body({.position = {0.0, 1.5, 0.0}});
    bouncy.add_shape(ball, Sphere{0.5f}, {.restitution = 1.0f});
    const BodyId locked = bouncy.create_body({.position = {5.0, 0.5, 0.0}, .locked = LockedAxes::TurnX | LockedAxes::TurnZ});
    bouncy.add_shape(locked, Box{vec3{0.5f}});
    double highest = 0.0;
    for (int i = 0; i < 200; ++i) {
        bouncy.step(1.0 / 60.0);
        if (i > 60) highest = std::max(highest, bouncy.center_of_mass(ball).y);
    }
    EXPECT_NEAR(highest, 1.5, 1e-2);
    EXPECT_NEAR(bouncy.center_of_mass(locked).y, 0.5, 1e-2);
    EXPECT_FALSE(validate(WorldDef{.contact_method = static_cast<ContactMethod>(200)}).ok());
}

}  // namespace
}  // namespace carom
