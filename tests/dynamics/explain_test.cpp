// World::explain: every rung of the ladder, and that it never says otherwise than the step did.
#include "table.hpp"

#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/check.hpp>
#include <carom/core/random.hpp>
#include <carom/dynamics/explain.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

namespace carom {
namespace {

constexpr double kDt = 1.0 / 60.0;
const Shape kCube = Box{{0.5f, 0.5f, 0.5f}};

BodyId put(World& world, const dvec3& at, BodyType type = BodyType::Dynamic, const Shape& shape = kCube, const ShapeDef& def = {}) {
    const BodyId body = world.create_body({.type = type, .position = at});
    world.add_shape(body, shape, def);
    return body;
}

bool says(const ContactExplanation& why, const std::string& words) { return why.sentence.find(words) != std::string::npos; }

TEST(Explain, ACrateOnTheGroundTouchesIt) {
    World world;
    const BodyId ground = put(world, {0, 0, 0}, BodyType::Static, Plane{{0, 1, 0}, 0});
    const BodyId crate = put(world, {0, 0.5, 0});
    for (int i = 0; i < 10; ++i) world.step(kDt);
    const ContactExplanation why = world.explain(crate, ground);
    EXPECT_EQ(why.rung, Rung::Touch);
    EXPECT_EQ(why.step, 10u);
    ASSERT_EQ(why.pairs.size(), 1u);
    const ShapePairExplanation& pair = why.pairs[0];
    EXPECT_TRUE(pair.broadphase->listed);
    EXPECT_EQ(pair.bounds->axis, -1);
    ASSERT_TRUE(pair.contact);
    ASSERT_EQ(pair.contact->manifolds.size(), 1u);
    EXPECT_EQ(pair.contact->manifolds[0].count, 4u);
    EXPECT_EQ(pair.contact->axis->source, AxisSource::FaceOfB);
    EXPECT_GT(pair.contact->margin, 0.0);
    EXPECT_TRUE(says(why, "they touch because they overlap by")) << why.sentence;
    EXPECT_TRUE(says(why, "over face 0 of B")) << why.sentence;
    EXPECT_TRUE(why.disagreements.empty());
    // From the other side the same.
    const ContactExplanation back = world.explain(ground, crate);
    EXPECT_EQ(back.rung, Rung::Touch);
    EXPECT_EQ(back.pairs[0].contact->axis->source, AxisSource::FaceOfA);
    EXPECT_EQ(back.pairs[0].contact->axis->normal, -pair.contact->axis->normal);
}

TEST(Explain, EachRungIsReached) {
    World world({.gravity = {0, 0, 0}, .contact_reuse = 0.0});
    const BodyId a = put(world, {0, 0, 0}), far = put(world, {9, 0, 0}), empty = world.create_body();
    const BodyId ghost = put(world, {0, 0.5, 0}, BodyType::Dynamic, kCube, {.layer = 2, .mask = 2});
    const BodyId wall = put(world, {0, -3, 0}, BodyType::Static), floor = put(world, {0, -4, 0}, BodyType::Static);
    // Balls whose boxes overlap at a corner, where the balls do not; and one that comes towards another, within the margin of the step.
    const Shape ball = Sphere{0.5f};
    const BodyId ball_a = put(world, {0, 50, 0}, BodyType::Dynamic, ball), ball_b = put(world, {0.9, 50.9, 0}, BodyType::Dynamic, ball);
    const BodyId near = put(world, {0, 80, 0}, BodyType::Dynamic, ball), comes = put(world, {1.05, 80, 0}, BodyType::Dynamic, ball);
    world.set_linear_velocity(comes, {-6, 0, 0});
    EXPECT_EQ(world.explain(a, far).rung, Rung::NoStep);
    EXPECT_TRUE(says(world.explain(a, far), "no step has been done yet"));
    world.step(kDt);

    const auto expect = [&](BodyId x, BodyId y, Rung rung, const std::string& words) {
        const ContactExplanation why = world.explain(x, y);
        EXPECT_EQ(why.rung, rung) << to_string(why.rung) << ": " << why.sentence;
        EXPECT_TRUE(says(why, words)) << why.sentence;
        EXPECT_TRUE(says(why, "they do not touch because")) << why.sentence;
        EXPECT_TRUE(why.disagreements.empty());
        EXPECT_EQ(world.explain(y, x).rung, rung);
        return why;
    };
    expect(a, a, Rung::SameBody, "one body");
    expect(a, empty, Rung::NoShapes, "no shapes");
    expect(wall, floor, Rung::Filter, "neither is dynamic");
    expect(a, ghost, Rung::Filter, "layers and masks");
    const ContactExplanation bounds = expect(a, far, Rung::Bounds, "8 m apart along x");
    EXPECT_EQ(bounds.pairs[0].bounds->axis, 0);
    EXPECT_NEAR(bounds.pairs[0].bounds->gap, 8.0, 1e-5);
    EXPECT_FALSE(bounds.pairs[0].broadphase->listed);
    EXPECT_NEAR(bounds.pairs[0].contact->axis->gap, 8.0, 1e-12) << "how far they are apart is said all the same";
    const ContactExplanation corners = expect(ball_a, ball_b, Rung::Distance, "between their closest points, more than the margin");
    EXPECT_TRUE(corners.pairs[0].broadphase->listed);
    EXPECT_NEAR(corners.pairs[0].contact->distance->lower, 0.9 * std::sqrt(2.0) - 1.0, 1e-12);
    expect(near, comes, Rung::Margin, "a gap of 0.05 m; within the margin of 0.1 m");

    // What came after the step, or was moved by hand and does not move by itself, is not what the step saw.
    const BodyId late = put(world, {0, 1, 0});
    expect(a, late, Rung::OutOfStep, "did not know");
    world.set_pose(wall, {{0, -1, 0}});
    expect(a, wall, Rung::OutOfStep, "did not know");
    world.step(kDt);
    EXPECT_EQ(world.explain(a, wall).rung, Rung::Touch);
    // Nor is a plane that came.
    const BodyId plane = put(world, {0, 0, 0}, BodyType::Static, Plane{{0, 1, 0}, -90.0f});
    expect(a, plane, Rung::OutOfStep, "did not know");
    world.step(kDt);
    expect(a, plane, Rung::Bounds, "above what the plane may reach");
}

TEST(Explain, TheDocumentsNameEveryRung) {
    std::ifstream page(std::string(CAROM_TEST_DATA) + "/../docs/cli.md");
    std::string row;
    while (std::getline(page, row) && !row.starts_with("| `rung` |")) {
    }
    ASSERT_FALSE(row.empty());
    for (int r = 0; r <= static_cast<int>(Rung::Touch); ++r) {
        const std::string name = to_string(static_cast<Rung>(r));
        EXPECT_NE(row.find("`" + name + "`"), std::string::npos) << name;
    }
}

TEST(Explain, WhatMeetsExactlyIsNotSaidToOverlapByNothing) {
    World world({.gravity = {0, 0, 0}});
    const BodyId low = put(world, {0, 0, 0}, BodyType::Static), high = put(world, {0, 1, 0});
    world.step(kDt);
    const ContactExplanation why = world.explain(low, high);
    EXPECT_EQ(why.rung, Rung::Touch);
    EXPECT_TRUE(says(why, "they touch because their surfaces meet over face")) << why.sentence;
}

TEST(Explain, AStepThatLooksForNoContactsSaysSo) {
    World world;
    const BodyId a = put(world, {0, 0, 0}, BodyType::Static), b = put(world, {0, 5, 0});
    world.step(kDt);
    const BodyId other = world.create_body();
    world.destroy_body(a);
    world.step(kDt);
    world.add_shape(other, kCube);
    const ContactExplanation why = world.explain(b, other);
    EXPECT_EQ(why.rung, Rung::NoStep);
    EXPECT_TRUE(says(why, "looked for no contacts")) << why.sentence;
}

TEST(Explain, PairsBeyondTheLimitAreNamedAsSuch) {
    World world({.gravity = {0, 0, 0}, .pair_limit = 1});
    std::vector<BodyId> bodies;
    for (int i = 0; i < 4; ++i) bodies.push_back(put(world, {0.1 * i, 0, 0}));
    ASSERT_TRUE(world.step(kDt).pairs_limited);
    const ContactExplanation why = world.explain(bodies[2], bodies[3]);
    EXPECT_EQ(why.rung, Rung::PairLimit);
    EXPECT_TRUE(why.disagreements.empty());
    EXPECT_TRUE(says(why, "limit on pairs"));
}

TEST(Explain, OfSeveralShapesThePairThatGotHighestDecides) {
    World world({.gravity = {0, 0, 0}});
    const BodyId a = put(world, {0, 0, 0});
    world.add_shape(a, kCube, {.local = {{4, 0, 0}}});
    const BodyId b = put(world, {4, 0.95, 0});
    world.step(kDt);
    const ContactExplanation why = world.explain(a, b);
    ASSERT_EQ(why.pairs.size(), 2u);
    EXPECT_EQ(why.rung, Rung::Touch);
    EXPECT_EQ(why.deciding, 1u);
    EXPECT_EQ(why.pairs[0].rung, Rung::Bounds);
}

/// A crowd of all kinds of shapes, some of which touch.
World crowd(BroadphaseMethod method, std::uint64_t seed, std::vector<BodyId>& bodies) {
    World world({.broadphase = method});
    Random r(seed);
    bodies.push_back(put(world, {0, 0, 0}, BodyType::Static, Plane{{0, 1, 0}, 0}));
    const std::vector<vec3> corners{{-9, 0.2f, -9}, {-9, 0.2f, 9}, {9, 0.4f, 9}, {9, 0.2f, -9}};
    const std::vector<TriangleMesh::Triangle> triangles{{0, 1, 2}, {0, 2, 3}};
    bodies.push_back(put(world, {0, 0, 0}, BodyType::Static, *TriangleMesh::build(corners, triangles)));
    const Shape shapes[] = {kCube, Sphere{0.4f}, Capsule{0.2f, 0.4f}, Cylinder{0.3f, 0.4f}, Cone{0.4f, 0.4f}, Box{{2, 0.2f, 0.3f}}};
    for (int i = 0; i < 40; ++i) {
        bodies.push_back(put(world, {r.range(-3, 3), r.range(0.5, 3), r.range(-3, 3)}, i % 9 == 8 ? BodyType::Static : BodyType::Dynamic,
                             shapes[i % 6], {.layer = i % 5 == 4 ? 2u : 1u, .mask = i % 7 == 6 ? 1u : ~0u}));
    }
    return world;
}

TEST(Explain, NeverSaysOtherwiseThanTheStepWhateverFindsThePairs) {
    for (const BroadphaseMethod method : kBroadphaseMethods) {
        std::vector<BodyId> bodies;
        World world = crowd(method, 77, bodies);
        std::size_t touching = 0, contacts = 0;
        for (int step = 0; step < 20; ++step) world.step(kDt);
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            for (std::size_t j = i + 1; j < bodies.size(); ++j) {
                const ContactExplanation why = world.explain(bodies[i], bodies[j]);
                for (const std::string& text : why.disagreements) ADD_FAILURE() << to_string(method) << ": " << text;
                touching += why.rung >= Rung::Margin;
                if (why.rung >= Rung::Bounds && why.pairs[0].bounds->axis >= 0) {
                    EXPECT_FALSE(why.pairs[0].broadphase->place.empty());
                    EXPECT_EQ(why.pairs[0].broadphase->method, method);
                }
            }
        }
        std::vector<std::pair<BodyId, BodyId>> joined;
        for (std::size_t i = 0; i < world.contact_count(); ++i) joined.emplace_back(world.contact(i).body_a, world.contact(i).body_b);
        std::ranges::sort(joined);
        contacts = static_cast<std::size_t>(std::ranges::unique(joined).begin() - joined.begin());
        EXPECT_EQ(touching, contacts) << to_string(method);
        EXPECT_GT(contacts, 20u);
    }
}

TEST(Explain, DeadIdsAreMisuse) {
    World world;
    const BodyId a = put(world, {0, 0, 0}), b = put(world, {0, 1, 0});
    world.destroy_body(b);
    EXPECT_THROW(static_cast<void>(world.explain(a, b)), MisuseError);
    EXPECT_THROW(static_cast<void>(world.explain(BodyId{}, a)), MisuseError);
}

// Where bodies may sleep, pairs that nothing could come of are not listed, though their filters agree: no fault of the engine's.
TEST(Explain, ASlowPlatformInAWallIsNoFaultWhereBodiesMaySleep) {
    for (const bool sleep : {false, true}) {
        World world({.sleep = {.enabled = sleep}});
        const auto add = [&](const BodyDef& def, const vec3& half) {
            const BodyId body = world.create_body(def);
            world.add_shape(body, Box{half});
            return body;
        };
        const BodyId wall = add({.type = BodyType::Static, .position = {0.0, 1.2, 0.0}}, vec3{0.5f});
        const BodyId platform = add({.type = BodyType::Kinematic, .position = {0.0, 0.4, 0.0}, .linear_velocity = {0.1, 0.0, 0.0}}, vec3{0.5f});
        add({.position = {0.0, 0.0, 1.0}}, {0.4f, 0.4f, 0.5f});
        world.step(1.0 / 60.0);
        EXPECT_TRUE(world.explain(platform, wall).disagreements.empty()) << sleep;
    }
}

}  // namespace
}  // namespace carom
