// The peers are given the same bodies as Carom, and say where they are in Carom's own frames.
#include <carom/bench/row.hpp>
#include <carom/scenes/scene.hpp>
#include <carom/studies/oracle/penetration.hpp>
#include <carom/studies/peers/engines.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <stdexcept>

namespace carom::bench {
namespace {

using accuracy::Engine;
using accuracy::MovingBody;
using accuracy::SceneBodies;
using accuracy::moving_bodies;
using accuracy::scene_bodies;
using peers::make_bullet;
using peers::make_ode;

using Make = std::unique_ptr<Engine> (*)(const SceneBodies&);

class Peers : public testing::TestWithParam<Make> {};
INSTANTIATE_TEST_SUITE_P(All, Peers, testing::Values(make_bullet, make_ode),
                         [](const auto& made) { return made.index == 0 ? "bullet" : "ode"; });

TEST_P(Peers, StartWhereCaromStarts) {
    const auto run = scenes::make_scene("pile_mixed", {.bodies = 200});
    ASSERT_TRUE(run);
    const auto engine = GetParam()(scene_bodies(run->world));
    const std::vector<BodyId> ids = moving_bodies(run->world);
    ASSERT_EQ(ids.size(), 200u);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const Pose ours = run->world.pose(ids[i]), theirs = engine->pose(i);
        // Bullet's state is float: half an ulp of ten metres, and of 1 in each component of a quaternion and a matrix between.
        EXPECT_LT(glm::length(ours.position - theirs.position), 4e-6) << i;
        EXPECT_GT(std::abs(glm::dot(ours.orientation, theirs.orientation)), 1.0 - 1e-6) << i;
    }
}

// Lets the engine run a scene, and puts its bodies into the world that it was made from.
scenes::SceneRun settled(Make make, const char* scene, int bodies) {
    auto run = scenes::make_scene(scene, {.bodies = bodies}).value();
    const auto engine = make(scene_bodies(run.world));
    for (int i = 0; i < 300; ++i) engine->step(run.dt);
    const std::vector<BodyId> ids = moving_bodies(run.world);
    for (std::size_t i = 0; i < ids.size(); ++i) run.world.set_pose(ids[i], engine->pose(i));
    return run;
}

// A capsule along the wrong axis or a hull off its centre of mass would come to rest deep inside its neighbours. Both peers leave
// some millimetres (Bullet's margins, ODE's soft constraints); half the radius of the thinnest capsule is 100 mm.
TEST_P(Peers, RestOnWhatTheOracleSees) {
    const scenes::SceneRun run = settled(GetParam(), "pile_mixed", 64);
    const oracle::Penetration found = oracle::geometric_penetration(run.world);
    EXPECT_LT(found.polytopes.maximum, 0.05);
    EXPECT_LT(found.round.maximum, 0.05);
    EXPECT_EQ(scenes::count_escaped(run.world, run.domain), 0);
}

TEST_P(Peers, RestOnMeshes) {
    const scenes::SceneRun run = settled(GetParam(), "mesh_bowl", 20);
    EXPECT_LT(oracle::geometric_penetration(run.world).terrain.maximum, 0.05);
    EXPECT_EQ(scenes::count_escaped(run.world, run.domain), 0);
}

TEST_P(Peers, KeepBodiesAwakeAndUnslowedInTheAir) {
    World world({.gravity = {0.0, -9.81, 0.0}});
    const BodyId ball = world.create_body({.linear_velocity = {1.0, 0.0, 0.0}});
    world.add_shape(ball, Sphere{0.5f});
    const auto engine = GetParam()(scene_bodies(world));
    for (int i = 0; i < 120; ++i) engine->step(1.0 / 60.0);
    EXPECT_NEAR(engine->velocity(0).x, 1.0, 1e-5);
    EXPECT_NEAR(engine->velocity(0).y, -9.81 * 2.0, 1e-4);  // 120 sums in float
}

TEST(SceneBodies, GivesHullsAboutTheirCentreOfMass) {
    const auto run = scenes::make_scene("mesh_bowl", {.bodies = 20});
    ASSERT_TRUE(run);
    const SceneBodies bodies = scene_bodies(run->world);
    ASSERT_EQ(bodies.fixed.size(), 1u);
    const std::vector<BodyId> ids = moving_bodies(run->world);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const MovingBody& body = bodies.moving[i];
        EXPECT_LT(glm::length(body.pose.position - run->world.center_of_mass(ids[i])), 1e-12);
        EXPECT_LT(glm::length((body.pose * body.shape_in_mass).position - run->world.pose(ids[i]).position), 1e-12);
        EXPECT_GT(body.moments.x, 0.0);
    }
}

TEST(SceneBodies, RefusesWhatIsNotCompared) {
    World kinematic;
    kinematic.add_shape(kinematic.create_body({.type = BodyType::Kinematic}), Sphere{});
    EXPECT_THROW(static_cast<void>(scene_bodies(kinematic)), std::invalid_argument);
    World two;
    const BodyId body = two.create_body();
    two.add_shape(body, Sphere{});
    two.add_shape(body, Sphere{});
    EXPECT_THROW(static_cast<void>(scene_bodies(two)), std::invalid_argument);
}

TEST_P(Peers, RefusePlanes) {
    World world;
    world.add_shape(world.create_body({.type = BodyType::Static}), Plane{});
    EXPECT_THROW(static_cast<void>(GetParam()(scene_bodies(world))), std::invalid_argument);
}

TEST(Row, SaysHowManyTimesFasterCaromIs) {
    const Row row{.bench = "b", .peer = "p", .peer_version = "1", .carom_ms = 2.0, .peer_ms = 5.0,
                  .carom_quality = {{"max_penetration", 0.25}}, .peer_quality = {}};
    const auto json = to_json(std::span(&row, 1));
    EXPECT_EQ(json["rows"][0]["speedup"], 2.5);
    EXPECT_EQ(json["rows"][0]["carom_quality"]["max_penetration"], 0.25);
    EXPECT_EQ(json["rows"][0]["threads"], 1);
}

}  // namespace
}  // namespace carom::bench
