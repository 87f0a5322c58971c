// Probes on the bodies of a world: whose shapes they feel, and whose not.
#include "table.hpp"

#include <carom/core/check.hpp>
#include <carom/dynamics/probe.hpp>

#include <gtest/gtest.h>

namespace carom {
namespace {

TEST(WorldProbe, AWheelFeelsTheGroundAndNotItsOwnCar) {
    World world;
    SerialExecutor executor;
    const BodyId ground = world.create_body({.type = BodyType::Static});
    const ShapeId plane = world.add_shape(ground, Plane{{0, 1, 0}, 0});
    const BodyId car = world.create_body({.position = {0, 0.3, 0}});
    world.add_shape(car, Box{{1, 0.25f, 2}});
    const BodyId stone = world.create_body({.type = BodyType::Static, .position = {0.8, 0, 1.2}});
    const ShapeId pebble = world.add_shape(stone, Sphere{0.05f}, {.layer = 2});
    const std::vector<WorldProbe> wheels{{car, {.centre = {0.8, 0, 1.2}, .angle = 0.0, .rays = 1, .radius = 0.35}},
                                         {car, {.centre = {-0.8, 0, 1.2}, .angle = 0.0, .rays = 1, .radius = 0.35}},
                                         {car, {.centre = {0.8, 0, 1.2}, .angle = 0.0, .rays = 1, .radius = 0.35}, 1}};
    std::vector<WorldProbeContact> contacts(5);
    probe(world, wheels, executor, contacts);
    ASSERT_EQ(contacts.size(), 3u);
    EXPECT_EQ(contacts[0].shape, pebble);
    EXPECT_EQ(contacts[0].body, stone);
    EXPECT_NEAR(contacts[0].contact.separation, 0.25 - 0.35, 1e-7);
    EXPECT_EQ(contacts[1].shape, plane);
    EXPECT_EQ(contacts[1].contact.probe, 1u);
    EXPECT_NEAR(contacts[1].contact.separation, 0.3 - 0.35, 1e-12);
    EXPECT_EQ(contacts[2].shape, plane) << "the mask leaves the pebble out";
    EXPECT_EQ(contacts[2].contact.probe, 2u);
}

TEST(WorldProbe, MisuseChangesNothing) {
    World world;
    SerialExecutor executor;
    const BodyId body = world.create_body({});
    std::vector<WorldProbeContact> out(2);
    const std::vector<WorldProbe> dead{{BodyId{}, {}}}, bad{{body, {.rays = 0}}};
    EXPECT_THROW(probe(world, dead, executor, out), MisuseError);
    EXPECT_THROW(probe(world, bad, executor, out), MisuseError);
    EXPECT_EQ(out.size(), 2u);
    probe(world, {}, executor, out);
    EXPECT_TRUE(out.empty());
}

}  // namespace
}  // namespace carom
