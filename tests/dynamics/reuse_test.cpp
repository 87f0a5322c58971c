// Contacts that are carried along from step to step.
#include "table.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace carom {
namespace {

using namespace test;

World stack_of(double reuse) {
    World world({.contact_reuse = reuse});
    const BodyId ground = world.create_body({.type = BodyType::Static});
    world.add_shape(ground, Plane{{0, 1, 0}, 0.0f});
    for (int i = 0; i < 6; ++i) {
        const BodyId body = world.create_body({.position = {0.02 * i, 0.501 + 1.001 * i, 0}});
        world.add_shape(body, Box{{0.5f, 0.5f, 0.5f}});
    }
    return world;
}

TEST(ContactReuse, AStackRestsWhereItRestsWithoutIt) {
    World with = stack_of(WorldDef{}.contact_reuse), without = stack_of(0.0);
    StepReport last;
    for (int i = 0; i < 300; ++i) {
        last = with.step(kDt);
        EXPECT_EQ(without.step(kDt).reused, 0u);
    }
    EXPECT_GT(last.reused, 0u);
    EXPECT_LE(last.reused, last.pairs);
    for (std::size_t i = 0; i < with.bodies().size(); ++i) {
        const BodyId a = with.bodies()[i], b = without.bodies()[i];
        EXPECT_LT(glm::length(with.pose(a).position - without.pose(b).position), 1e-4) << i;
        EXPECT_LT(glm::length(with.linear_velocity(a)), 1e-4) << i;
    }
}

TEST(ContactReuse, AnotherShapeAtTheSamePlaceHasItsOwnContacts) {
    World world({.gravity = {0, 0, 0}});
    const BodyId ground = world.create_body({.type = BodyType::Static});
    world.add_shape(ground, Plane{{0, 1, 0}, 0.0f});
    BodyId body = world.create_body({.position = {0, 0.499, 0}});
    world.add_shape(body, Box{{0.5f, 0.5f, 0.5f}});
    const auto points = [&] {
        world.step(kDt);
        return world.contact_count() == 1 ? world.contact(0).manifold.count : 0u;
    };
    EXPECT_EQ(points(), 4u);
    world.destroy_body(body);
    body = world.create_body({.position = {0, 0.499, 0}});
    const ShapeId ball = world.add_shape(body, Sphere{0.5f});
    EXPECT_EQ(points(), 1u);
    // Nor does a world that had nothing to collide for a while remember anything.
    world.destroy_body(body);
    EXPECT_EQ(points(), 0u);
    EXPECT_FALSE(world.is_alive(ball));
    body = world.create_body({.position = {0, 0.499, 0}});
    world.add_shape(body, Box{{0.5f, 0.5f, 0.5f}});
    EXPECT_EQ(points(), 4u);
    // And what is put elsewhere has no contacts there.
    world.set_pose(body, {{0, 2, 0}, kIdentityRotation});
    EXPECT_EQ(points(), 0u);
    world.set_pose(body, {{0, 0.499, 0}, kIdentityRotation});
    EXPECT_EQ(points(), 4u);
}

}  // namespace
}  // namespace carom
