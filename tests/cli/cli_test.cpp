// The program: exit codes and messages for bad input, and the keys of a report.
#include <cli/program.hpp>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace carom::test {
namespace {

using Json = nlohmann::json;

constexpr int kOk = 0, kFailed = 1, kBadInput = 2, kNotFinite = 3, kEscaped = 4;

// Two crates on a floor, in a domain of 20 m, with whatever is changed.
Json crates() {
    const Json crate{{"position", {0, 0.5, 0}}, {"shapes", {{{"type", "box"}, {"half_extents", {0.5, 0.5, 0.5}}}}}};
    Json upper = crate;
    upper["position"] = {0, 1.5, 0};
    Json floor{{"type", "static"}, {"position", {0, -0.5, 0}}, {"shapes", {{{"type", "box"}, {"half_extents", {5, 0.5, 5}}}}}};
    return {{"name", "crates"},
            {"steps", 5},
            {"domain", {{"lower", {-10, -10, -10}}, {"upper", {10, 10, 10}}}},
            {"bodies", Json::array({floor, crate, upper})}};
}

TEST(Cli, UnknownWordsAreNamed) {
    expect_refused({"fly"}, {"fly", "list", "plan", "run"});
    expect_refused({}, {"subcommand"});
    expect_refused({"run"}, {"SCENE"});
    expect_refused({"run", "no_such_scene"}, {"no_such_scene", "pile_boxes"});
    expect_refused({"plan", "no_such_scene"}, {"no_such_scene", "pile_boxes"});
    expect_refused({"run", "tall_stack", "--no-such-option"}, {"--no-such-option"});
    expect_refused({"run", "tall_stack", "another"}, {"another"});
    expect_refused({"list", "another"}, {"another"});
    expect_refused({"--no-such-option"}, {"subcommand"});
}

TEST(Cli, NumbersOutOfRangeAreNamed) {
    const std::string scene = "tall_stack";
    expect_refused({"run", scene, "--steps", "-1"}, {"--steps", "-1"});
    expect_refused({"run", scene, "--steps", "1e3"}, {"--steps", "1e3"});
    expect_refused({"run", scene, "--steps", "99999999999999999999"}, {"--steps"});
    expect_refused({"run", scene, "--steps"}, {"--steps"});
    expect_refused({"run", scene, "--bodies", "-5"}, {"--bodies", "-5"});
    expect_refused({"run", scene, "--bodies", "many"}, {"--bodies", "many"});
    expect_refused({"run", scene, "--substeps", "0"}, {"--substeps", "0"});
    expect_refused({"run", scene, "--substeps", "1025"}, {"--substeps", "1025"});
    expect_refused({"run", scene, "--contact-reuse", "0.2"}, {"--contact-reuse", "0.2"});
    expect_refused({"run", scene, "--contact-reuse", "nan"}, {"--contact-reuse", "nan"});
    expect_refused({"run", scene, "--contact-method", "rigid"}, {"--contact-method", "rigid", "automatic, soft, direct, impulses"});
    expect_refused({"run", scene, "--direct-sag", "0.02"}, {"--direct-sag", "0.02"});
    expect_refused({"run", scene, "--direct-sag", "nan"}, {"--direct-sag", "nan"});
    expect_refused({"run", scene, "--direct-budget", "-1"}, {"--direct-budget", "-1"});
    expect_refused({"run", scene, "--direct-budget", "4294967297"}, {"--direct-budget", "4294967297"});
    expect_refused({"run", scene, "--threads", "0"}, {"--threads"});
    expect_refused({"run", scene, "--seed", "-1"}, {"--seed", "-1"});
    expect_refused({"run", scene, "--seed", "18446744073709551616"}, {"--seed"});
    expect_refused({"run", scene, "--dt", "nan"}, {"--dt", "finite"});
    expect_refused({"run", scene, "--dt", "inf"}, {"--dt", "finite"});
    expect_refused({"run", scene, "--dt", "-0.01"}, {"--dt", "-0.01"});
    expect_refused({"run", scene, "--dt", "0"}, {"--dt", "positive"});
    expect_refused({"run", scene, "--dt", "fast"}, {"--dt", "fast"});
    expect_refused({"run", scene, "--peak-every", "-1"}, {"--peak-every", "-1"});
    expect_refused({"run", scene, "--steps", "1", "--steps", "2"}, {"--steps"});
}

TEST(Cli, ParametersOfScenesAreChecked) {
    expect_refused({"run", "mass_ratio", "--set", "ratio"}, {"--set", "KEY=VALUE"});
    expect_refused({"run", "mass_ratio", "--set", "=3"}, {"--set", "KEY=VALUE"});
    expect_refused({"run", "mass_ratio", "--set", "ration=3"}, {"ration"});
    expect_refused({"run", "mass_ratio", "--set", "ratio=heavy"}, {"ratio", "heavy"});
    expect_refused({"run", "mass_ratio", "--set", "ratio=nan"}, {"ratio", "nan"});
    expect_refused({"run", "mass_ratio", "--set", "ratio=-1"}, {"ratio", "-1"});
    expect_refused({"run", "mass_ratio", "--set", "ratio=1", "--set", "ratio=2"}, {"ratio", "twice"});
    expect_refused({"run", "mass_ratio", "--set", "ratio=1", "stray"}, {"stray"});
}

TEST(Cli, SceneFilesAreChecked) {
    const TemporaryFolder folder;
    expect_refused({"run", folder.path("missing.json")}, {"missing.json"});
    expect_refused({"run", folder.write("broken.json", "{\"bodies\": [\n  {\"type\" \"box\"}]}")}, {"broken.json:2"});
    expect_refused({"run", folder.write("empty.json", "")}, {"empty.json"});
    expect_refused({"plan", folder.write("list.json", "[]")}, {"list.json"});
    Json scene = crates();
    scene["bodies"][1]["shapes"][0]["half_extents"] = "big";
    expect_refused({"run", folder.write("type.json", scene.dump(1))}, {"type.json:", "bodies[1].shapes[0].half_extents"});
    scene = crates();
    scene["steps"] = -3;
    expect_refused({"run", folder.write("steps.json", scene.dump(1))}, {"steps.json:", "steps", "-3"});
    scene = crates();
    scene["bodies"][0]["shapes"][0]["half_extents"] = {5, 0, 5};
    expect_refused({"run", folder.write("flat.json", scene.dump(1))}, {"flat.json:", "bodies[0].shapes[0]"});
    scene = crates();
    scene["colour"] = "red";
    expect_refused({"run", folder.write("key.json", scene.dump(1))}, {"key.json:", "colour"});
    expect_refused({"run", folder.write("good.json", crates().dump(1)), "--bodies", "3"}, {"bodies"});
}

TEST(Cli, PathsAreProvedBeforeTheRun) {
    const TemporaryFolder folder;
    const std::string file = folder.write("file", "keep me");
    // Found after the run it would be code 1, some seconds later.
    const std::string steps = "20000";
    expect_refused({"run", "tall_stack", "--steps", steps, "--json", file + "/report.json"}, {file + "/report.json", "written"});
    expect_refused({"run", "tall_stack", "--steps", steps, "--json", folder.path("")}, {folder.path(""), "written"});
    expect_refused({"run", "tall_stack", "--steps", steps, "--json", folder.path("no/such/folder.json")}, {"folder.json"});
    expect_refused({"run", "tall_stack", "--steps", steps, "--json", ""}, {"written"});
    if (CAROM_HAS_VIZ) {
        expect_refused({"run", "tall_stack", "--steps", steps, "--vtk", file + "/frames"}, {file});
        expect_refused({"run", "tall_stack", "--steps", steps, "--picture", file + "/picture.png"}, {});
    } else {
        expect_refused({"run", "tall_stack", "--vtk", folder.path("frames")}, {"--vtk"});
        expect_refused({"run", "tall_stack", "--picture", folder.path("p.png")}, {"--picture"});
        expect_refused({"view", "tall_stack"}, {"view"});
    }
    // A refused run leaves existing files alone and makes no new ones.
    expect_refused({"run", "tall_stack", "--substeps", "0", "--json", folder.path("new.json")}, {});
    EXPECT_FALSE(std::filesystem::exists(folder.path("new.json")));
    EXPECT_EQ(std::filesystem::file_size(file), 7u);
}

TEST(Cli, ThreadsNeedABuildWithThem) {
    if (CAROM_HAS_TBB) {
        EXPECT_EQ(carom({"run", "tall_stack", "--bodies", "3", "--steps", "2", "--threads", "2"}).code, kOk);
    } else {
        expect_refused({"run", "tall_stack", "--threads", "2"}, {"--threads", "CAROM_TBB"});
    }
}

TEST(Cli, ListShowsScenesAndParameters) {
    const Outcome outcome = carom({"list"});
    EXPECT_EQ(outcome.code, kOk);
    for (const char* scene : {"teapots", "pyramid", "pile_boxes", "pile_mixed", "mesh_bowl", "tall_stack", "mass_ratio", "ratio=",
                              "wall_fast", "single_body_spin", "fountain", "dominoes"}) {
        EXPECT_NE(outcome.out.find(scene), std::string::npos) << scene;
    }
    EXPECT_EQ(outcome.err, "");
}

TEST(Cli, PlanHasALineForEachStage) {
    const Outcome outcome = carom({"plan", "tall_stack", "--substeps", "7"});
    EXPECT_EQ(outcome.code, kOk);
    EXPECT_NE(outcome.out.find("7 substeps"), std::string::npos);
    for (const char* stage : {"Bounds", "Pairs", "Collide", "Islands", "Direct", "Prepare", "Velocities", "WarmStart", "Solve", "Positions", "Relax",
                              "Restitution", "Store", "Quarantine"}) {
        EXPECT_NE(outcome.out.find(std::string("\n") + stage), std::string::npos) << stage;
    }
}

TEST(Cli, PlanAndReportNameTheBroadphaseAndWhy) {
    const std::vector<std::string> plan{"plan", "pile_boxes", "--bodies", "2000"};
    EXPECT_NE(carom(plan).out.find("\nbroadphase   hierarchical_grid: "), std::string::npos) << carom(plan).out;
    std::vector<std::string> asked = plan;
    asked.insert(asked.end(), {"--broadphase-method", "dynamic_tree"});
    EXPECT_NE(carom(asked).out.find("\nbroadphase   dynamic_tree: asked for"), std::string::npos) << carom(asked).out;
    expect_refused({"plan", "pile_boxes", "--broadphase-method", "magic"}, {"--broadphase-method", "magic", "automatic", "sweep_and_prune"});
    expect_refused({"run", "pile_boxes", "--broadphase-method", "0"}, {"--broadphase-method", "\"0\"", "brute_force"});
}

TEST(Cli, HelpAndVersionAreNoErrors) {
    EXPECT_EQ(carom({"--help"}).code, kOk);
    for (const char* command : {"list", "plan", "run", "cast", "accuracy"}) {
        const Outcome help = carom({command, "--help"});
        EXPECT_EQ(help.code, kOk);
        for (const char* noise : {"{", "ENUM", "->"}) EXPECT_EQ(help.out.find(noise), std::string::npos) << help.out;
    }
    EXPECT_NE(carom({"run", "--help"}).out.find("|sorted_axes|"), std::string::npos);
    EXPECT_EQ(carom({"--version"}).code, kOk);
}

Json report(std::vector<std::string> arguments, int code = kOk) {
    arguments.insert(arguments.end(), {"--json", "-"});
    const Outcome outcome = carom(arguments);
    EXPECT_EQ(outcome.code, code) << outcome.err;
    Json json = Json::parse(outcome.out, nullptr, false);
    EXPECT_TRUE(json.is_object()) << "stdout holds more than JSON: " << outcome.out;
    return json;
}

TEST(Cli, AReportHasEveryKey) {
    const Json json = report({"run", "pile_boxes", "--bodies", "30", "--steps", "20", "--seed", "7", "--substeps", "3", "--dt", "0.01"});
    EXPECT_EQ(json.at("scene"), "pile_boxes");
    EXPECT_EQ(json.at("seed"), 7);
    EXPECT_EQ(json.at("bodies"), 30);
    EXPECT_EQ(json.at("steps"), 20);
    EXPECT_EQ(json.at("dt"), 0.01);
    EXPECT_EQ(json.at("substeps"), 3);
    EXPECT_EQ(json.at("threads"), 1);
    EXPECT_TRUE(json.at("machine").at("cpu").is_string());
    EXPECT_GE(json.at("machine").at("cores"), 1);
    for (const char* key : {"version", "compiler", "type"}) {
        EXPECT_TRUE(json.at("build").at(key).is_string()) << key;
    }
    EXPECT_GE(json.at("build").at("simd_width"), 1);
    ASSERT_EQ(json.at("plan").at("stages").size(), 17u);
    for (const Json& stage : json.at("plan").at("stages")) {
        EXPECT_TRUE(stage.at("stage").is_string() && stage.at("run").is_boolean());
        EXPECT_NE(stage.at("reason"), "");
    }
    for (const char* key : {"stiff", "solved", "too_large", "ordered", "moving", "waiting", "fell_back", "iterations", "factorisations", "operations"}) {
        EXPECT_GE(json.at("direct").at(key), 0) << key;
    }
    const Json& time = json.at("time_ms");
    EXPECT_NEAR(time.at("mean_step").get<double>() * 20, time.at("total").get<double>(), 1e-9 * time.at("total").get<double>());
    EXPECT_GE(time.at("p99_step"), time.at("mean_step"));
    const Json& late = time.at("last_third_cpu");
    EXPECT_EQ(late.at("steps"), 7);  // of 20
    EXPECT_GT(late.at("p50"), 0.0);
    EXPECT_LE(late.at("p50"), late.at("p99"));
    EXPECT_LE(late.at("mean"), late.at("max"));
    EXPECT_EQ(late.at("p99"), late.at("max"));  // the nearest rank of 7
    double sum = 0.0;
    for (const auto& [stage, ms] : time.at("by_stage").items()) {
        sum += ms.get<double>();
    }
    EXPECT_EQ(time.at("by_stage").size(), 17u);
    EXPECT_GT(sum, 0.0);
    EXPECT_LE(sum, time.at("total").get<double>() * (1 + 1e-9));
    const Json& error = json.at("error");
    EXPECT_GE(error.at("peak_penetration"), error.at("max_penetration"));
    EXPECT_GE(error.at("max_penetration"), error.at("mean_penetration"));
    EXPECT_LE(error.at("energy_drift"), 1e-3);
    EXPECT_EQ(error.at("escaped"), 0);
    EXPECT_EQ(error.at("non_finite"), 0);
    EXPECT_EQ(error.at("quarantined"), 0);
    EXPECT_TRUE(error.at("tunnelled").is_null());
    EXPECT_TRUE(error.at("momentum_drift").is_null()) << "the ground takes momentum";
    for (const char* kind : {"round", "terrain"}) {
        EXPECT_EQ(error.at(kind).at("max"), 0.0);
    }
    EXPECT_GE(json.at("speed").at("max"), json.at("speed").at("mean"));
    EXPECT_GE(json.at("contacts"), json.at("manifolds"));
    EXPECT_EQ(json.at("state_hash").get<std::string>().size(), 16u);
}

TEST(Cli, WhatDoesNotApplyIsNull) {
    const Json json = report({"run", "single_body_spin", "--steps", "0"});
    EXPECT_TRUE(json.at("time_ms").at("mean_step").is_null());
    EXPECT_TRUE(json.at("time_ms").at("p99_step").is_null());
    EXPECT_TRUE(json.at("time_ms").at("last_third_cpu").is_null());
    const Json spin = report({"run", "single_body_spin", "--steps", "10", "--peak-every", "0"});
    EXPECT_LT(spin.at("error").at("angular_momentum_magnitude_drift"), 1e-6);
    EXPECT_TRUE(spin.at("error").at("momentum_drift").is_number());
    EXPECT_TRUE(spin.at("error").at("peak_penetration").is_null());
    const Json walls = report({"run", "wall_fast", "--steps", "1"});
    EXPECT_TRUE(walls.at("error").at("tunnelled").is_number());
}

TEST(Cli, FastBodiesTunnelOnlyWhereTheyAreNotFollowed) {
    const Json followed = report({"run", "wall_fast"}), discrete = report({"run", "wall_fast", "--no-continuous"});
    EXPECT_EQ(followed.at("error").at("tunnelled"), 0);
    EXPECT_GE(followed.at("continuous").at("impacts"), 200);
    EXPECT_EQ(followed.at("continuous").at("stopped"), 0);
    EXPECT_GT(discrete.at("error").at("tunnelled"), 150);
    EXPECT_EQ(discrete.at("continuous").at("followed"), 0);
}

TEST(Cli, TheSameRunHasTheSameHash) {
    const std::vector<std::string> run{"run", "pile_mixed", "--bodies", "40", "--steps", "30"};
    const std::string hash = report(run).at("state_hash");
    EXPECT_EQ(report(run).at("state_hash"), hash);
    std::vector<std::string> other = run;
    other.insert(other.end(), {"--seed", "4"});
    EXPECT_NE(report(other).at("state_hash"), hash);
    if (CAROM_HAS_TBB) {
        std::vector<std::string> threads = run;
        threads.insert(threads.end(), {"--threads", "2"});
        EXPECT_EQ(report(threads).at("state_hash"), hash);
    }
}

TEST(Cli, TheBroadphaseChangesNoResult) {
    std::vector<std::string> run{"run", "pile_mixed", "--bodies", "60", "--steps", "20", "--peak-every", "0", "--broadphase-method", "automatic"};
    const std::string hash = report(run).at("state_hash");
    EXPECT_EQ(report(run).at("plan").at("broadphase").at("method"), "brute_force");
    EXPECT_NE(report(run).at("plan").at("broadphase").at("reason").get<std::string>().find("few boxes"), std::string::npos);
    for (const char* method : {"sweep_and_prune", "sorted_axes", "uniform_grid", "hierarchical_grid", "dynamic_tree"}) {
        run.back() = method;
        const Json json = report(run);
        EXPECT_EQ(json.at("plan").at("broadphase").at("method"), method);
        EXPECT_EQ(json.at("state_hash"), hash) << method;
    }
}

TEST(Cli, AReportGoesIntoAFileAndTheSummaryToStdout) {
    const TemporaryFolder folder;
    const std::string path = folder.path("report.json");
    const Outcome outcome = carom({"run", "tall_stack", "--bodies", "3", "--steps", "5", "--json", path});
    EXPECT_EQ(outcome.code, kOk);
    EXPECT_EQ(outcome.err, "") << "progress is for terminals only";
    EXPECT_NE(outcome.out.find("state hash"), std::string::npos);
    EXPECT_NE(outcome.out.find("files         " + path + "\n"), std::string::npos) << outcome.out;
    EXPECT_LE(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 40) << "one screen";
    std::FILE* file = std::fopen(path.c_str(), "r");
    ASSERT_NE(file, nullptr);
    const Json json = Json::parse(file, nullptr, false);
    std::fclose(file);
    ASSERT_TRUE(json.is_object());
    EXPECT_NE(outcome.out.find(json.at("state_hash").get<std::string>()), std::string::npos);
}

TEST(Cli, AFullDiskIsAFailureAfterTheRun) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
    const Outcome outcome = carom({"run", "tall_stack", "--bodies", "2", "--steps", "1", "--json", "/dev/full"});
    EXPECT_EQ(outcome.code, kFailed);
    EXPECT_NE(outcome.err.find("/dev/full"), std::string::npos);
}

TEST(Cli, SceneFilesRun) {
    const TemporaryFolder folder;
    const Json json = report({"run", folder.write("crates.json", crates().dump())});
    EXPECT_EQ(json.at("scene"), "crates");
    EXPECT_EQ(json.at("bodies"), 2);
    EXPECT_EQ(json.at("steps"), 5);
}

TEST(Cli, AnEscapeHasItsExitCode) {
    const TemporaryFolder folder;
    Json scene = crates();
    scene["bodies"][2]["linear_velocity"] = {0, 500, 0};
    const Json json = report({"run", folder.write("escape.json", scene.dump())}, kEscaped);
    EXPECT_EQ(json.at("error").at("escaped"), 1);
    scene.erase("domain");
    EXPECT_TRUE(report({"run", folder.write("free.json", scene.dump())}).at("error").at("escaped").is_null());
}

TEST(Cli, GoingNonFiniteHasItsExitCode) {
    const TemporaryFolder folder;
    Json scene = crates();
    scene["bodies"][2]["linear_velocity"] = {0, 1e200, 0};
    scene["bodies"][2]["angular_velocity"] = {1e200, 0, 1e200};
    const Json json = report({"run", folder.write("burst.json", scene.dump())}, kNotFinite);
    EXPECT_GE(json.at("error").at("quarantined"), 1);
    EXPECT_EQ(json.at("error").at("non_finite"), 0) << "the body is restored to its last valid pose";
}

TEST(Cli, EnergyFromNothingHasItsExitCode) {
    // Two crates deep in each other are pushed apart: the engine removes overlap at a capped speed, but upwards work is energy
    // that nobody brought.
    const TemporaryFolder folder;
    Json scene = crates();
    scene["steps"] = 60;
    scene["bodies"][2]["position"] = {0, 0.6, 0};
    const Json json = report({"run", folder.write("overlap.json", scene.dump())}, kEscaped);
    EXPECT_GT(json.at("error").at("energy_drift"), 1e-3);
    EXPECT_EQ(json.at("error").at("escaped"), 0);
}

}  // namespace
}  // namespace carom::test
