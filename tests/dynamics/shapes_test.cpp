// Cylinders, cones and compounds in the world: they fall, rest, roll and keep still.
#include "support/grid_mesh.hpp"
#include "table.hpp"

#include <carom/collision/compound.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace carom {
namespace {

using namespace test;

dquat about(const dvec3& axis, double angle) {
    const SinCos half = sin_cos(0.5 * angle);
    const dvec3 n = glm::normalize(axis);
    return {half.cos, half.sin * n.x, half.sin * n.y, half.sin * n.z};
}

CompoundPtr dumbbell() {
    return *Compound::build({{Sphere{0.3f}, {{-0.6, 0, 0}}}, {Sphere{0.3f}, {{0.6, 0, 0}}},
                             {Cylinder{0.1f, 0.6f}, {dvec3{0.0}, about({0, 0, 1}, 0.5 * kPi)}}});
}

// A plane, a box and a flat mesh of many triangles, whose surface is at y = 0.
enum class Ground { Plane, Box, Mesh };

Shape ground_of(Ground ground) {
    if (ground == Ground::Plane) return Plane{{0, 1, 0}, 0};
    if (ground == Ground::Box) return Box{{10, 1, 10}};
    return grid_mesh(31, [](float i, float j) { return vec3{0.37f * (i - 15.2f), 0.0f, 0.41f * (j - 15.3f)}; });
}

struct Resting {
    Shape shape;
    Pose pose;           // dropped from here
    double height = 0;   // of the origin at rest
    const char* name = "";
};

std::vector<Resting> resting_shapes() {
    const dquat lying = about({0, 0, 1}, 0.5 * kPi);
    return {{Cylinder{0.4f, 0.7f}, {{0.1, 0.9, 0.2}, about({0, 1, 0}, 0.3)}, 0.7, "standing cylinder"},
            {Cylinder{0.4f, 0.7f}, {{0.1, 0.6, 0.2}, lying}, 0.4, "lying cylinder"},
            {Cylinder{0.6f, 0.02f}, {{0.1, 0.1, 0.2}}, 0.02, "coin"},
            {Cone{0.5f, 0.6f}, {{0.1, 0.8, 0.2}}, 0.6, "cone on its base"},
            {dumbbell(), {{0.1, 0.5, 0.2}, about({0, 1, 0}, 0.7)}, 0.3, "dumbbell"}};
}

TEST(ShapesInTheWorld, RestWhereTheirShapeSays) {
    for (const Ground ground : {Ground::Plane, Ground::Box, Ground::Mesh}) {
        for (const Resting& r : resting_shapes()) {
            SCOPED_TRACE(testing::Message() << r.name << " on " << to_string(type_of(ground_of(ground))));
            World world;
            const BodyId floor = world.create_body({.type = BodyType::Static, .position = {0, ground == Ground::Box ? -1.0 : 0.0, 0}});
            world.add_shape(floor, ground_of(ground));
            const BodyId body = world.create_body({.position = r.pose.position, .orientation = r.pose.orientation});
            world.add_shape(body, r.shape);
            for (int i = 0; i < 120; ++i) world.step(kDt);
            const Pose settled = world.pose(body);
            double penetration = 0.0;
            for (int i = 0; i < 240; ++i) penetration = std::max(penetration, world.step(kDt).max_penetration);
            const Pose after = world.pose(body);
            EXPECT_NEAR(after.position.y, r.height, 1e-3);
            EXPECT_LT(penetration, 1e-3);
            EXPECT_LT(glm::length(after.position - settled.position), 1e-5) << "drift in 4 s";
            EXPECT_GT(std::abs(glm::dot(after.orientation, settled.orientation)), 1.0 - 1e-9) << "turn in 4 s";
            EXPECT_LT(glm::length(world.linear_velocity(body)) + glm::length(world.angular_velocity(body)), 1e-4);
            EXPECT_NEAR(after.position.x, 0.1, 2e-3);
            EXPECT_NEAR(after.position.z, 0.2, 2e-3);
        }
    }
}

// Rolling without slipping neither slows down nor leaves its line: on a plane, and over the edges of a mesh. The solver carries contact
// points with the body within a step, which lifts them, so a rolling body sinks by 0.3 mm and turns its heading by a few milliradians.
TEST(ShapesInTheWorld, ALyingCylinderRollsOn) {
    for (const Ground ground : {Ground::Plane, Ground::Box, Ground::Mesh}) {
        SCOPED_TRACE(to_string(type_of(ground_of(ground))));
        World world;
        const BodyId floor = world.create_body({.type = BodyType::Static, .position = {0, ground == Ground::Box ? -1.0 : 0.0, 0}});
        world.add_shape(floor, ground_of(ground));
        const double radius = static_cast<double>(0.4f), speed = 1.0;
        const BodyId body = world.create_body({.position = {-3, radius, 0.1},
                                               .orientation = about({1, 0, 0}, 0.5 * kPi),
                                               .linear_velocity = {speed, 0, 0},
                                               .angular_velocity = {0, 0, -speed / radius}});
        world.add_shape(body, Cylinder{0.4f, 0.5f});
        for (int i = 0; i < 300; ++i) world.step(kDt);
        const dvec3 p = world.pose(body).position, v = world.linear_velocity(body);
        EXPECT_NEAR(p.x, -3 + 5.0 * speed, 0.01);
        EXPECT_NEAR(p.y, radius, 1e-3);
        EXPECT_NEAR(p.z, 0.1, 0.02);
        EXPECT_NEAR(v.x, speed, 2e-3);
        EXPECT_NEAR(v.z, 0.0, 5e-3);
        EXPECT_NEAR(world.angular_velocity(body).z, -v.x / radius, 1e-2);
    }
}

TEST(ShapesInTheWorld, APileOfCylindersStands) {
    for (const auto& [count, drift] : {std::pair{3, 1e-4}, std::pair{5, 0.02}}) {
        Table table;
        std::vector<BodyId> column;
        for (int i = 0; i < count; ++i) column.push_back(table.add({.position = {0, 0.3 + 0.6 * i, 0}}, Cylinder{0.4f, 0.3f}));
        table.run(300);
        for (int i = 0; i < count; ++i) {
            const dvec3 p = table.world.pose(column[static_cast<std::size_t>(i)]).position;
            EXPECT_NEAR(p.y, 0.3 + 0.6 * i, 0.002);
            EXPECT_LT(std::hypot(p.x, p.z), drift);
        }
    }
}

// Each part meets the ground with its own material: the bouncing half of a dumbbell comes up again, the other stays down.
TEST(ShapesInTheWorld, PartsBringTheirOwnMaterial) {
    const CompoundPtr uneven = *Compound::build({{Sphere{0.2f}, {{-2.0, 0, 0}}, {.restitution = 0.9f}}, {Sphere{0.2f}, {{2.0, 0, 0}}}});
    Table table;
    const BodyId body = table.add({.position = {0, 1.2, 0}}, uneven);
    double left = 0.0, right = 0.0;
    for (int i = 0; i < 60; ++i) {
        table.run(1);
        const Pose pose = table.world.pose(body);
        if (i < 32) continue;  // both have landed: 1 m takes 0.45 s
        left = std::max(left, transform_point(pose, {-2.0, 0, 0}).y);
        right = std::max(right, transform_point(pose, {2.0, 0, 0}).y);
    }
    EXPECT_GT(left, right + 0.3);
    // Slippery and rough runners under the same sledge: it turns to the rough side.
    const auto sledge = [](float friction) {
        return *Compound::build({{Box{{0.5f, 0.1f, 0.1f}}, {{0, 0, -0.5}}, {.friction = friction}}, {Box{{0.5f, 0.1f, 0.1f}}, {{0, 0, 0.5}}}});
    };
    const auto yaw_after = [&](float friction) {
        Table ice({}, 0.5f);
        const BodyId sled = ice.add({.position = {0, 0.1, 0}, .linear_velocity = {3, 0, 0}}, sledge(friction), {.friction = 0.5f});
        ice.run(10);
        return ice.world.angular_velocity(sled).y;
    };
    EXPECT_NEAR(yaw_after(0.5f), 0.0, 1e-2);
    EXPECT_LT(yaw_after(0.0f), -0.2);  // the rough runner at +z holds back
    EXPECT_GT(yaw_after(2.0f), 0.2);
}

TEST(ShapesInTheWorld, MassOfACompoundIsThatOfItsParts) {
    World world;
    const BodyId body = world.create_body();
    const CompoundPtr heavy = *Compound::build({{Sphere{0.5f}, {{-1, 0, 0}}, {.density = 3000.0}}, {Sphere{0.5f}, {{1, 0, 0}}}});
    world.add_shape(body, heavy, {.density = 1000.0});
    const double ball = 4.0 / 3.0 * kPi * 0.125;
    EXPECT_NEAR(world.mass_properties(body).mass, 4000.0 * ball, 1e-6);
    EXPECT_NEAR(world.center_of_mass(body).x, -0.5, 1e-12);
    const std::optional<WorldRayHit> hit = world.cast_ray({{1, 5, 0}, {0, -1, 0}});
    ASSERT_TRUE(hit.has_value());
    EXPECT_EQ(hit->hit.part, 1u);
    EXPECT_NEAR(hit->hit.distance, 4.5, 1e-6);
}

}  // namespace
}  // namespace carom
