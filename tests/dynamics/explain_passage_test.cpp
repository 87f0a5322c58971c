// World::explain_sweep and passage(): what let one body pass through another, and in which step; each remedy is tried.
#include "shot.hpp"

#include <carom/collision/triangle_mesh.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace carom {
namespace {

using namespace test;

void expect_passage(const Shot& shot, SweepReason cause, const std::string& remedy) {
    ASSERT_EQ(shot.passages.size(), 1u) << to_string(cause);
    const Passage& p = shot.passages.front();
    EXPECT_EQ(p.cause, cause) << to_string(p.cause);
    EXPECT_EQ(p.step, 3u);
    EXPECT_TRUE(p.through);
    EXPECT_TRUE(says(p.remedy, remedy)) << p.remedy;
    // Never later than it was, and not much earlier: within the tolerance of the search.
    const double per_step = 100.0 * kDt, start = 4.3 - 2.0 * per_step;
    const double touched = (start - kHalf - kRadius) / per_step, middle = (start - kHalf - 0.01 * kRadius) / per_step;
    EXPECT_LE(p.touched, touched + 1e-9);
    EXPECT_GT(p.touched, touched - 1e-4);
    EXPECT_LE(p.t, middle + 1e-9);
    EXPECT_GT(p.t, middle - 1e-4);
}

TEST(ExplainPassage, NamesTheStepAndTheSwitchThatIsOff) {
    Shot shot(kDiscrete);
    shot.fly();
    expect_passage(shot, SweepReason::Off, "enabled = true");
    Shot again(kDiscrete);
    again.fly(3);
    EXPECT_EQ(again.last.a.reason, Following::Off);
    EXPECT_TRUE(says(again.last.sentence, "A passed through B in step 3, at t = ")) << again.last.sentence;
    EXPECT_TRUE(says(again.last.sentence, "because continuous collision is off")) << again.last.sentence;
    EXPECT_TRUE(says(again.last.sentence, "what would have caught it: ContinuousSettings::enabled")) << again.last.sentence;
    EXPECT_TRUE(says(again.world.explain_sweep(again.wall, again.ball).sentence, "B passed through A")) << "who moved";
}

TEST(ExplainPassage, NamesABodyThatMayNotBeFollowed) {
    expect_passage(Shot(kWatched, {.continuity = Continuity::Never}).fly(), SweepReason::Never, "Continuity::Automatic for A");
    EXPECT_TRUE(Shot(kWatched, {.continuity = Continuity::Automatic}).fly().passages.empty());
}

TEST(ExplainPassage, NamesAFilter) {
    expect_passage(Shot(kWatched, {}, kWall, {.mask = 2}).fly(), SweepReason::Filter, "ShapeDef::mask");
    expect_passage(Shot(kDiscrete, {}, kWall, {.mask = 2}).fly(), SweepReason::Filter, "ShapeDef::mask");
}

TEST(ExplainPassage, NamesAJointThatLeavesContactsOut) {
    for (const bool collide : {false, true}) {
        Shot shot(kWatched);
        shot.world.create_joint(SpringDef{.body_a = shot.wall, .body_b = shot.ball, .collide_connected = collide});
        shot.fly();
        if (collide) {
            EXPECT_TRUE(shot.passages.empty());
        } else {
            expect_passage(shot, SweepReason::Joined, "collide_connected = true");
        }
    }
}

TEST(ExplainPassage, NamesTwoThatHaveNoMass) {
    Shot shot(kWatched, {.type = BodyType::Kinematic});
    shot.world.add_shape(shot.world.create_body({.position = {0.0, 90.0, 0.0}}), Sphere{});  // or else no contacts are looked for at all
    expect_passage(shot.fly(), SweepReason::NeitherDynamic, "BodyType::Dynamic");
}

Shape sheet(bool one_sided, bool faces_up) {
    const std::vector<vec3> corners{{-5, -5, 0}, {5, -5, 0}, {5, 5, 0}, {-5, 5, 0}};
    const std::vector<TriangleMesh::Triangle> up{{0, 1, 2}, {0, 2, 3}}, down{{0, 2, 1}, {0, 3, 2}};
    return *TriangleMesh::build(corners, faces_up ? up : down, {.one_sided = one_sided});
}

TEST(ExplainPassage, NamesAOneSidedMeshThatIsMetFromBehind) {
    Shot shot(kWatched, {}, sheet(true, true));
    shot.fly();
    ASSERT_EQ(shot.passages.size(), 1u);
    EXPECT_EQ(shot.passages[0].cause, SweepReason::BackFace);
    EXPECT_EQ(shot.passages[0].step, 3u);
    EXPECT_TRUE(shot.passages[0].through);
    EXPECT_TRUE(says(shot.passages[0].remedy, "one_sided = false"));
    EXPECT_TRUE(Shot(kWatched, {}, sheet(true, false)).fly().passages.empty()) << "from the front";
    EXPECT_TRUE(Shot(kWatched, {}, sheet(false, true)).fly().passages.empty()) << "the remedy";
}

// A plane and a box whose face lies in it turn by a radian onto a ball: it is struck, and nothing has passed.
TEST(ExplainPassage, APlaneThatTurnsIsWatchedAsABoxIs) {
    for (const bool plane : {true, false}) {
        World world(kWatched);
        const BodyId floor = world.create_body({.type = BodyType::Kinematic, .angular_velocity = {0.0, 0.0, 1.0 / kDt}});
        world.add_shape(floor, plane ? Shape{Plane{{0.0f, 1.0f, 0.0f}, 0.0f}} : Shape{Box{{20.0f, 1.0f, 20.0f}}},
                        {.local = {plane ? dvec3{0.0} : dvec3{0.0, -1.0, 0.0}}});
        const BodyId ball = world.create_body({.position = {5.0, 2.0, 0.0}});
        world.add_shape(ball, Sphere{0.05f});
        world.step(kDt);
        const SweepExplanation why = world.explain_sweep(ball, floor);
        EXPECT_FALSE(why.passage.has_value()) << plane;
        EXPECT_TRUE(why.disagreements.empty());
        EXPECT_EQ(why.reason, SweepReason::Watched) << plane;
        ASSERT_FALSE(why.impacts.empty()) << plane;
        const double angle = std::atan2(2.0, 5.0) - std::asin(0.05 / std::sqrt(29.0));  // at which the two touch
        EXPECT_LE(why.impacts.front().t, angle);
        EXPECT_GT(why.impacts.front().t, angle - 1e-4);
    }
}

// Two plates close on a ball until its middle is in one of them; nothing moves far in any step.
TEST(ExplainPassage, NamesContactsThatGaveWay) {
    World world(kWatched);
    const BodyId floor = world.create_body({.type = BodyType::Static});
    const BodyId press =
        world.create_body({.type = BodyType::Kinematic, .position = {0.0, 0.0, 0.12}, .linear_velocity = {0.0, 0.0, -0.6}});
    const BodyId ball = world.create_body({.position = {0.0, 0.0, 0.056}});
    world.add_shape(floor, kWall);
    world.add_shape(press, kWall);
    world.add_shape(ball, Sphere{0.05f});
    std::vector<Passage> passages;
    for (int i = 0; i < 16; ++i) {
        world.step(kDt);
        for (const BodyId plate : {floor, press}) {
            const SweepExplanation why = world.explain_sweep(ball, plate);
            EXPECT_TRUE(why.disagreements.empty());
            if (why.passage) passages.push_back(*why.passage);
        }
    }
    ASSERT_FALSE(passages.empty());
    EXPECT_EQ(passages[0].cause, SweepReason::Pressed) << to_string(passages[0].cause);
    EXPECT_FALSE(passages[0].through);
}

}  // namespace
}  // namespace carom
