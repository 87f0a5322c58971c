// One-sided meshes in the world: from the front a floor, from behind nothing, however fast.
#include "table.hpp"

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/check.hpp>
#include <carom/dynamics/explain.hpp>
#include <carom/dynamics/world_cast.hpp>

#include "../support/box_mesh.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace carom {
namespace {

using namespace test;

constexpr double kDt = 1.0 / 60.0;
constexpr WorldDef kSpace{.gravity = dvec3{0.0}};

/// Two triangles in y = 0, wound counter-clockwise from above.
TriangleMeshPtr floor_of(bool one_sided) {
    return *TriangleMesh::build(std::vector<vec3>{{-50, 0, -50}, {-50, 0, 50}, {50, 0, 50}, {50, 0, -50}},
                                std::vector<TriangleMesh::Triangle>{{0, 1, 2}, {0, 2, 3}}, {.one_sided = one_sided});
}

std::array<Shape, 7> solids() {
    std::vector<vec3> corners;
    for (int i = 0; i < 8; ++i) corners.push_back(0.2f * vec3{i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
    return {Sphere{0.2f},     Box{{0.2f, 0.1f, 0.3f}},        Capsule{0.1f, 0.2f}, *ConvexHull::build(corners), Cylinder{0.2f, 0.1f},
            Cone{0.2f, 0.2f}, box_mesh({0.2f, 0.1f, 0.3f}, 2)};
}

TEST(OneSided, AFloorFromAboveAndNothingFromBelow) {
    for (const Shape& shape : solids()) {
        World world;
        world.add_shape(world.create_body({.type = BodyType::Static}), floor_of(true));
        const BodyId over = world.create_body({.position = {0, 0.5, 0}}), under = world.create_body({.position = {5, -0.15, 0}});
        world.add_shape(over, shape);
        world.add_shape(under, shape);
        for (int i = 0; i < 120; ++i) world.step(kDt);
        EXPECT_GT(world.pose(over).position.y, 0.05) << to_string(type_of(shape));
        EXPECT_LT(glm::length(world.linear_velocity(over)), 0.02) << to_string(type_of(shape));
        EXPECT_LT(world.pose(under).position.y, -15.0) << to_string(type_of(shape)) << ": nothing held it from below";
    }
}

/// From 1 mm in a step to forty times the shape's size. What leaves the front behind within the step is not even touched.
TEST(OneSided, WhatComesFromBehindKeepsItsWay) {
    for (const double speed : {0.06, 0.5, 5.0, 50.0, 500.0}) {
        for (const Shape& shape : solids()) {
            World world(kSpace);
            world.add_shape(world.create_body({.type = BodyType::Static}), floor_of(true));
            const double steps = 0.3 / (speed * kDt);
            const BodyId body = world.create_body({.position = {0, -0.45, 0}, .linear_velocity = {0, speed, 0}});
            world.add_shape(body, shape);
            // Until its middle is about to come through.
            while (world.pose(body).position.y + speed * kDt < -1e-3) {
                world.step(kDt);
                ASSERT_EQ(world.linear_velocity(body), (dvec3{0, speed, 0})) << speed << " " << to_string(type_of(shape));
            }
            for (int i = 0; i < static_cast<int>(2.0 * steps) + 40; ++i) {
                world.step(kDt);
                ASSERT_GE(world.linear_velocity(body).y, (1.0 - 1e-5) * speed) << speed << " " << to_string(type_of(shape));
            }
            EXPECT_GT(world.pose(body).position.y, 0.1) << speed << " " << to_string(type_of(shape));
            // What is still in the mesh once its middle is through is pushed out of the front, gently.
            EXPECT_LT(world.linear_velocity(body).y, speed + 0.8) << speed << " " << to_string(type_of(shape));
        }
    }
}

TEST(OneSided, WhatComesFromTheFrontIsStoppedHoweverFast) {
    for (const double speed : {5.0, 50.0, 500.0, 5000.0}) {
        for (const Shape& shape : solids()) {
            World world(kSpace);
            world.add_shape(world.create_body({.type = BodyType::Static}), floor_of(true));
            const BodyId body =
                world.create_body({.position = {0, 0.6, 0}, .linear_velocity = {0.1 * speed, -speed, 0}, .angular_velocity = {3, 0, 4}});
            world.add_shape(body, shape);
            for (int i = 0; i < 20; ++i) world.step(kDt);
            EXPECT_GT(world.pose(body).position.y, 0.0) << speed << " " << to_string(type_of(shape));
        }
    }
}

TEST(OneSided, AKinematicSheetPushesWithItsFrontAlone) {
    World world(kSpace);
    const BodyId sheet = world.create_body({.type = BodyType::Kinematic, .linear_velocity = {0, 2, 0}});
    world.add_shape(sheet, floor_of(true));
    const BodyId ahead = world.create_body({.position = {0, 0.5, 0}}),
                 behind = world.create_body({.position = {3, -0.5, 0}, .linear_velocity = {0, 6, 0}});
    for (const BodyId body : {ahead, behind}) world.add_shape(body, Sphere{0.2f});
    for (int i = 0; i < 60; ++i) world.step(kDt);
    EXPECT_GT(world.pose(ahead).position.y, world.pose(sheet).position.y);
    EXPECT_GT(world.linear_velocity(ahead).y, 1.9);
    EXPECT_NEAR(world.linear_velocity(behind).y, 6.0, 0.1) << "it came through from behind";
    EXPECT_GT(world.pose(behind).position.y, world.pose(sheet).position.y);
}

TEST(OneSided, CastsGoThroughFromBehindAndRaysSeeBothSides) {
    World world(kSpace);
    world.add_shape(world.create_body({.type = BodyType::Static}), floor_of(true));
    const auto is_met = [&](double side) {
        const RigidMotion motion{.start = {{0, 2 * side, 0}, kIdentityRotation}, .translation = {0, -4 * side, 0}};
        return world.cast_shape(ShapeCast{.shape = Sphere{0.2f}, .motion = motion, .filter = {}}).has_value();
    };
    EXPECT_TRUE(is_met(1.0));
    EXPECT_FALSE(is_met(-1.0));
    EXPECT_TRUE(world.cast_ray({.origin = {0.1, 2, 0}, .direction = {0, -1, 0}, .max_distance = 4}));
    EXPECT_TRUE(world.cast_ray({.origin = {0.1, -2, 0}, .direction = {0, 1, 0}, .max_distance = 4}));
}

TEST(OneSided, TheLadderSaysBackFace) {
    World world(kSpace);
    const BodyId ground = world.create_body({.type = BodyType::Static});
    world.add_shape(ground, floor_of(true));
    const BodyId under = world.create_body({.position = {0, -0.1, 0}}), over = world.create_body({.position = {5, 0.19, 0}});
    const BodyId far = world.create_body({.position = {9, -0.9, 0}});
    for (const BodyId body : {under, over}) world.add_shape(body, Sphere{0.2f});
    world.add_shape(far, Sphere{0.2f});
    world.step(kDt);
    const ContactExplanation why = world.explain(under, ground);
    EXPECT_EQ(why.rung, Rung::BackFace);
    EXPECT_EQ(to_string(why.rung), std::string("back face"));
    EXPECT_NE(why.sentence.find(
                  "they do not touch because one is a one-sided mesh and shows the other its back face, though they overlap by 0.1 m"),
              std::string::npos)
        << why.sentence;
    EXPECT_TRUE(why.disagreements.empty());
    EXPECT_EQ(world.explain(over, ground).rung, Rung::Touch);
    EXPECT_EQ(world.explain(far, ground).rung, Rung::Bounds);
}

int g_reports = 0;
ErrorCode g_code{};
void count_report(const Error& error) {
    ++g_reports;
    g_code = error.code;
}

TEST(OneSided, FitsNoDynamicBody) {
    const TriangleMeshPtr crate = box_mesh({0.5f, 0.5f, 0.5f}, 1);
    const Shape one = *TriangleMesh::build(crate->vertices(), crate->triangles(), {.one_sided = true});
    const ErrorHandler before = set_error_handler(count_report);
    World world;
    const BodyId body = world.create_body({});
    g_reports = 0;
    EXPECT_EQ(world.add_shape(body, one), ShapeId{});
    EXPECT_EQ(g_reports, 1);
    EXPECT_EQ(g_code, ErrorCode::WrongType);
    EXPECT_TRUE(world.shapes(body).empty());
    set_error_handler(before);
    EXPECT_NE(world.add_shape(body, crate), ShapeId{});
    EXPECT_NE(world.add_shape(world.create_body({.type = BodyType::Kinematic}), one), ShapeId{});
}

}  // namespace
}  // namespace carom
