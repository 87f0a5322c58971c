// Scenes in motion: they step, stay where they belong, and do the same twice.
#include "support.hpp"

#include <carom/studies/oracle/ledger.hpp>
#include <carom/studies/oracle/penetration.hpp>

namespace carom::test {
namespace {

using scenes::SceneInfo;
using scenes::SceneOptions;
using scenes::SceneRun;

/// A small version of each scene.
SceneOptions small(const std::string& name) {
    SceneOptions options;
    if (name == "pyramid") options.set["base"] = "6";
    if (name.starts_with("pile_") || name == "mesh_bowl" || name == "teapots") options.bodies = 40;
    if (name == "teapot_meshes") options.bodies = 10;
    if (name == "tall_stack") options.bodies = 5;
    if (name == "fountain") options.bodies = 10;
    if (name == "dominoes") options.bodies = 20;
    return options;
}

class EveryScene : public testing::TestWithParam<std::string> {};

TEST_P(EveryScene, StepsTheSameTwiceAndLosesNothing) {
    std::uint64_t hashes[2] = {};
    for (std::uint64_t& hash : hashes) {
        SceneRun run = scene(GetParam(), small(GetParam()));
        const std::uint64_t before = run.world.state_hash();
        for (int i = 0; i < 90; ++i) {
            run.before_step(i);
            const StepReport report = run.world.step(run.dt);
            ASSERT_TRUE(report.quarantined.empty());
        }
        EXPECT_NE(run.world.state_hash(), before);
        EXPECT_EQ(scenes::count_escaped(run.world, run.domain), 0);
        hash = run.world.state_hash();
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene, testing::ValuesIn([] {
                             std::vector<std::string> names;
                             for (const SceneInfo& entry : scenes::catalogue()) names.push_back(entry.name);
                             return names;
                         }()),
                         [](const auto& test) { return test.param; });

TEST(Dominoes, AllFall) {
    SceneRun run = scene("dominoes", {.bodies = 15});
    step(run, 240);
    for (const BodyId body : dynamic_bodies(run.world)) {
        // A domino that stands is 0.5 m up; one that leans on the next, less.
        EXPECT_LT(run.world.center_of_mass(body).y, 0.4);
    }
}

TEST(Pyramid, StandsStill) {
    SceneRun run = scene("pyramid", {.set = {{"base", "8"}}});
    std::vector<dvec3> start;
    for (const BodyId body : dynamic_bodies(run.world)) start.push_back(run.world.pose(body).position);
    step(run, 120);
    const std::vector<BodyId> bodies = dynamic_bodies(run.world);
    for (std::size_t i = 0; i < bodies.size(); ++i) expect_near(run.world.pose(bodies[i]).position, start[i], 0.05);
    EXPECT_LT(oracle::geometric_penetration(run.world).polytopes.maximum, 0.02);
}

TEST(PileMixed, SettlesWithoutGainingEnergy) {
    SceneRun run = scene("pile_mixed", {.bodies = 100});
    oracle::EnergyLedger ledger(run.world);
    for (int i = 0; i < 240; ++i) {
        run.world.step(run.dt);
        ledger.stepped(run.world);
    }
    EXPECT_LE(ledger.drift(), 1e-3);
    EXPECT_LT(ledger.change(), 0.0);
    const oracle::Penetration penetration = oracle::geometric_penetration(run.world);
    EXPECT_LT(penetration.polytopes.maximum, 0.05);
    EXPECT_LT(penetration.round.maximum, 0.05);
    EXPECT_GT(penetration.polytopes.pairs + penetration.round.pairs, 50u);
}

TEST(SingleBodySpin, KeepsItsMomentum) {
    SceneRun run = scene("single_body_spin");
    oracle::MomentumLedger ledger(run.world);
    for (int i = 0; i < 600; ++i) {
        run.world.step(run.dt);
        ledger.stepped(run.world);
    }
    EXPECT_EQ(ledger.drift()->linear, 0.0);
    EXPECT_LT(ledger.drift()->angular, 1e-9);
}

}  // namespace
}  // namespace carom::test
