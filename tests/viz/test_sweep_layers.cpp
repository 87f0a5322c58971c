// The layers of sweeps: there where something was followed, where the step had it.
#include <carom/core/check.hpp>
#include <carom/dynamics/explain_sweep.hpp>
#include <carom/viz/camera.hpp>
#include <carom/viz/make_debug_frame.hpp>
#include <carom/viz/sweep_layers.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace carom {
namespace {

constexpr double kDt = 1.0 / 60.0;

std::set<std::string> names(const DebugFrame& frame) {
    std::set<std::string> found;
    for (const DebugLayer& layer : frame.layers) found.insert(layer.name);
    return found;
}

/// A ball that comes to a wall after half of the step, far from the world's origin.
struct Shot {
    World world{{.gravity = {0, 0, 0}, .record_paths = true}};
    BodyId wall = world.create_body({.type = BodyType::Static, .position = {1e6, 0, 0}});
    BodyId ball = world.create_body({.position = {1e6, 0, -1.06}, .linear_velocity = {0, 0, 120}});
    Shot() {
        world.add_shape(wall, Box{{3, 3, 0.01f}});
        world.add_shape(ball, Sphere{0.05f});
        world.step(kDt);
    }
    [[nodiscard]] DebugFrame frame(const SweepLayerSettings& settings = {}) const {
        DebugFrame frame;
        frame.origin = {1e6, 0, 0};
        append_sweep_layers(frame, world, settings);
        const Status status = validate(frame);
        EXPECT_TRUE(status) << status.error().message;
        return frame;
    }
};

TEST(SweepLayers, AShotHasItsVolumeAndItsImpact) {
    const Shot shot;
    DebugFrame frame = shot.frame();
    EXPECT_EQ(names(frame), (std::set<std::string>{kSweepVolumes, kSweepGhosts})) << "a closed form has no steps";
    const DebugLayer& volumes = *frame.find(kSweepVolumes);
    float nearest = -9.0f, farthest = 9.0f;
    for (const DebugVertex& v : volumes.vertices) nearest = std::max(nearest, v.position.z), farthest = std::min(farthest, v.position.z);
    EXPECT_NEAR(nearest, -0.01f, 1e-4f) << "up to the wall, not to where it would have flown";
    EXPECT_NEAR(farthest, -1.11f, 1e-4f) << "from the start";
    for (const DebugTriangle& t : volumes.triangles) EXPECT_LT(t.color.a, 60);
    // The path: from the start to the wall, where the ball stays.
    ASSERT_FALSE(volumes.lines.empty());
    EXPECT_NEAR(volumes.lines.front().a.z, -1.06f, 1e-6f);
    EXPECT_NEAR(volumes.lines.back().b.z, -0.06f, 1e-4f);
    for (std::size_t i = 1; i < volumes.lines.size(); ++i) EXPECT_EQ(volumes.lines[i].a, volumes.lines[i - 1].b);
    const DebugLayer& ghosts = *frame.find(kSweepGhosts);
    ASSERT_EQ(ghosts.points.size(), 1u);
    EXPECT_NEAR(ghosts.points[0].position.z, -0.01f, 1e-4f);
    ASSERT_EQ(ghosts.texts.size(), 1u);
    EXPECT_EQ(ghosts.texts[0].text, "t = 0.5");
    for (const DebugVertex& v : ghosts.vertices) EXPECT_NEAR(v.position.z, -0.06f, 0.0501f);
    for (const DebugTriangle& t : ghosts.triangles) EXPECT_EQ(t.body, shot.ball) << "the wall stands where it stands";
}

TEST(SweepLayers, TheCameraSeesThem) {
    const Shot shot;
    DebugFrame frame = shot.frame();
    const Camera camera = automatic_camera(frame, 1.6);
    const dvec3 view = glm::normalize(camera.target - camera.position);
    for (const dvec3 end : {dvec3{1e6, 0, -1.06}, dvec3{1e6, 0, -0.06}})
        EXPECT_GT(glm::dot(glm::normalize(end - camera.position), view), std::cos(0.4)) << "half the picture's diagonal";
    DebugLayer& far = frame.layers.emplace_back(DebugLayer{.name = "else"});
    far.points.push_back({{900, 0, 0}, {}, {}});
    EXPECT_EQ(automatic_camera(frame, 1.6).position, camera.position) << "and nothing else";
}

TEST(SweepLayers, CopiesAreAsManyAsTheWayIsLong) {
    const Shot shot;
    const auto copies = [&](int most) {
        return shot.frame({.most_copies = most, .segments = 4}).find(kSweepVolumes)->triangles.size() / 8;
    };
    EXPECT_EQ(copies(256), 41u) << "2 m by half a diameter, the ends among them, and the impact";
    EXPECT_EQ(copies(9), 10u);
}

TEST(SweepLayers, AdvancementHasABoxForEachLook) {
    World world({.gravity = {0, 0, 0}, .record_paths = true});
    const BodyId wall = world.create_body({.type = BodyType::Static});
    const BodyId brick = world.create_body({.position = {0, 0, -1.06}, .linear_velocity = {0, 0, 120}, .angular_velocity = {30, 40, 0}});
    world.add_shape(wall, Box{{3, 3, 0.01f}});
    world.add_shape(brick, Box{{0.05f, 0.05f, 0.05f}});
    world.step(kDt);
    std::size_t looks = 0;
    for (const SweepImpact& impact : world.sweeps().impacts) looks += impact.advances.size();
    ASSERT_GE(looks, 1u);
    DebugFrame frame;
    append_sweep_layers(frame, world);
    ASSERT_NE(frame.find(kSweepSteps), nullptr);
    EXPECT_EQ(frame.find(kSweepSteps)->lines.size(), 12 * looks) << "of the brick: the wall stands";
    EXPECT_TRUE(validate(frame));
}

TEST(SweepLayers, OnlyThoseThatAreAskedFor) {
    Shot shot;
    const BodyId other = shot.world.create_body({.position = {1e6, 2, -1.06}, .linear_velocity = {0, 0, 120}});
    shot.world.add_shape(other, Sphere{0.05f});
    shot.world.set_linear_velocity(shot.ball, {0, 0, -120});
    shot.world.step(kDt);
    DebugFrame both = shot.frame(), one = shot.frame({.bodies = {shot.ball}});
    EXPECT_EQ(names(both), (std::set<std::string>{kSweepVolumes, kSweepGhosts}));
    EXPECT_EQ(names(one), (std::set<std::string>{kSweepVolumes})) << "it met nothing";
    for (const DebugTriangle& t : one.find(kSweepVolumes)->triangles) EXPECT_EQ(t.body, shot.ball);
    EXPECT_GT(both.find(kSweepVolumes)->triangles.size(), one.find(kSweepVolumes)->triangles.size());
}

TEST(SweepLayers, WhereNothingIsFollowedThereAreNone) {
    World world({.record_paths = true});
    world.add_shape(world.create_body({.type = BodyType::Static}), Plane{});
    world.add_shape(world.create_body({.position = {0, 0.5, 0}}), Box{});
    DebugFrame frame;
    append_sweep_layers(frame, world);
    EXPECT_TRUE(frame.layers.empty()) << "before the first step";
    world.step(kDt);
    append_sweep_layers(frame, world);
    EXPECT_TRUE(frame.layers.empty());
}

TEST(SweepLayers, WhatWasNotFollowedIsDrawnWhereItIsAskedFor) {
    World world({.gravity = {0, 0, 0}, .record_paths = true, .continuous = {.enabled = false}});
    const BodyId wall = world.create_body({.type = BodyType::Static}),
                 ball = world.create_body({.position = {0, 0, -1.06}, .linear_velocity = {0, 0, 120}});
    world.add_shape(wall, Box{{3, 3, 0.01f}});
    world.add_shape(ball, Sphere{0.05f});
    world.step(kDt);
    DebugFrame all, asked;
    append_sweep_layers(all, world);
    EXPECT_TRUE(all.layers.empty());
    append_sweep_layers(asked, world, {.bodies = {wall, ball}});
    EXPECT_EQ(names(asked), (std::set<std::string>{kSweepVolumes}));
    float farthest = -9.0f;
    for (const DebugVertex& v : asked.find(kSweepVolumes)->vertices) farthest = std::max(farthest, v.position.z);
    EXPECT_GT(farthest, 0.9f) << "through the wall";
}

TEST(SweepLayers, KinematicPlanesAreNotDrawn) {
    World world({.gravity = {0, 0, 0}, .record_paths = true});
    const BodyId plane = world.create_body({.type = BodyType::Kinematic, .position = {0, 0, -5}, .linear_velocity = {0, 0, 600}});
    world.add_shape(plane, Plane{{0, 0, 1}, 0});
    const BodyId ball = world.create_body({});
    world.add_shape(ball, Sphere{0.05f});
    ASSERT_EQ(world.step(kDt).continuous.impacts, 1u);
    DebugFrame frame;
    append_sweep_layers(frame, world);
    EXPECT_TRUE(validate(frame));
    ASSERT_NE(frame.find(kSweepGhosts), nullptr);
    for (const DebugTriangle& t : frame.find(kSweepVolumes)->triangles) EXPECT_EQ(t.body, ball);
    for (const DebugTriangle& t : frame.find(kSweepGhosts)->triangles) EXPECT_EQ(t.body, ball);
}

TEST(SweepLayers, RefuseBadInput) {
    Shot shot;
    World silent;
    DebugFrame frame;
    EXPECT_THROW(append_sweep_layers(frame, silent), MisuseError);
    EXPECT_THROW(append_sweep_layers(frame, shot.world, {.most_copies = 1}), MisuseError);
    EXPECT_THROW(append_sweep_layers(frame, shot.world, {.most_copies = 257}), MisuseError);
    EXPECT_THROW(append_sweep_layers(frame, shot.world, {.segments = 6}), MisuseError);
    const BodyId gone = shot.ball;
    shot.world.destroy_body(gone);
    EXPECT_THROW(append_sweep_layers(frame, shot.world, {.bodies = {gone}}), MisuseError);
    EXPECT_TRUE(frame.layers.empty());
}

}  // namespace
}  // namespace carom
