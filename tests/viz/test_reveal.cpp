// What hides the moving bodies from the camera is drawn by its edges; everything else stays as it was.
#include <carom/core/check.hpp>
#include <carom/viz/make_debug_frame.hpp>
#include <carom/viz/reveal.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom {
namespace {

const Camera kFront{.position = {0, 0, 30}, .target = {0, 0, 0}, .up = {0, 1, 0}};

/// Crates in a row along x, seen from z.
struct Row {
    explicit Row(int crates) {
        for (int i = 0; i < crates; ++i) {
            world.add_shape(world.create_body({.position = {2.0 * i - crates + 1.0, 0, 0}}), Box{{0.4f, 0.4f, 0.4f}});
        }
    }
    BodyId add_wall(const dvec3& at, const vec3& half_extents) {
        const BodyId wall = world.create_body({.type = BodyType::Static, .position = at});
        world.add_shape(wall, Box{half_extents});
        return wall;
    }
    World world;
};

auto triangles_of(const DebugFrame& frame, BodyId body) {
    const DebugLayer& layer = *frame.find("static");
    return std::count_if(layer.triangles.begin(), layer.triangles.end(), [&](const DebugTriangle& t) { return t.body == body; });
}

TEST(Reveal, OnlyWhatHidesMoreThanItsShareIsOpened) {
    Row row(16);
    const BodyId near = row.add_wall({0, 0, 10}, {20, 5, 0.5f});
    const BodyId far = row.add_wall({0, 0, -10}, {20, 5, 0.5f});
    const BodyId below = row.add_wall({0, -3, 0}, {20, 0.5f, 20});
    // At a third of the way the crates' middles are 4/3 m apart: this post hides two of sixteen, an eighth.
    const BodyId post = row.add_wall({1.333, 0, 10}, {1.2f, 5, 0.5f});
    for (const dvec3 origin : {dvec3{0.0}, dvec3{100, -50, 20}}) {
        DebugFrame frame = make_debug_frame(row.world, {.origin = origin});
        EXPECT_EQ(reveal(frame, kFront), 1u);
        EXPECT_EQ(triangles_of(frame, near), 0);
        for (const BodyId whole : {far, below, post}) EXPECT_EQ(triangles_of(frame, whole), 12);
        const DebugLayer& layer = *frame.find("static");
        ASSERT_EQ(layer.lines.size(), 12u) << "a box's edges, without the diagonals of its faces";
        for (const DebugLine& line : layer.lines) {
            EXPECT_EQ(line.body, near);
            const float length = glm::length(line.a - line.b);
            EXPECT_TRUE(std::abs(length - 40) < 1e-3f || std::abs(length - 10) < 1e-3f || std::abs(length - 1) < 1e-3f) << length;
        }
        EXPECT_TRUE(validate(frame));
    }
}

TEST(Reveal, MoreThanItsShareMeansMore) {
    Row row(16);
    const BodyId post = row.add_wall({1.333, 0, 10}, {2.2f, 5, 0.5f});  // hides at least three
    DebugFrame frame = make_debug_frame(row.world);
    EXPECT_EQ(reveal(frame, kFront), 1u);
    EXPECT_EQ(triangles_of(frame, post), 0);
}

TEST(Reveal, ASheetThatFacesAwayHidesNothing) {
    Row row(4);
    const BodyId ground = row.world.create_body({.type = BodyType::Static, .position = {0, 0, 10}});
    row.world.add_shape(ground, Plane{{0, 0, -1}, 0.0f});
    DebugFrame frame = make_debug_frame(row.world);
    const auto patch = triangles_of(frame, ground);
    ASSERT_GT(patch, 0);
    EXPECT_EQ(reveal(frame, kFront), 0u);
    EXPECT_EQ(triangles_of(frame, ground), patch);
    frame.find("static")->hide_backs = false;
    EXPECT_EQ(reveal(frame, kFront), 1u) << "backs that are drawn do hide";
}

TEST(Reveal, ManyBodiesAreStoodForByASample) {
    Row row(300);
    const BodyId near = row.add_wall({0, 0, 10}, {400, 5, 0.5f});
    DebugFrame frame = make_debug_frame(row.world);
    EXPECT_EQ(reveal(frame, kFront), 1u);
    EXPECT_EQ(triangles_of(frame, near), 0);
}

TEST(Reveal, NothingMovingOpensNothingAndMisuseIsReported) {
    Row row(0);
    row.add_wall({0, 0, 10}, {20, 5, 0.5f});
    DebugFrame frame = make_debug_frame(row.world);
    EXPECT_EQ(reveal(frame, kFront), 0u);
    DebugFrame empty;
    EXPECT_EQ(reveal(empty, kFront), 0u);
    Camera bad = kFront;
    bad.position.x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(reveal(frame, bad), MisuseError);
}

}  // namespace
}  // namespace carom
