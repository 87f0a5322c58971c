// carom why: what it says, its keys, and exit codes for bad input.
#include <cli/program.hpp>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace carom::test {
namespace {

using Json = nlohmann::json;

bool has(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

TEST(Why, AScenesBodiesTouchOrDoNot) {
    const Outcome touch = carom({"why", "0", "1", "tall_stack", "--bodies", "3", "--steps", "30"});
    EXPECT_EQ(touch.code, 0) << touch.err;
    for (const char* words : {"tall_stack, step 30: A is body 0", "filter", "bounds", "broadphase", "axis", "distance", "verdict", "manifold",
                              "they touch because they overlap by"}) {
        EXPECT_TRUE(has(touch.out, words)) << words << "\n" << touch.out;
    }
    const Outcome apart = carom({"why", "1", "3", "tall_stack", "--bodies", "3", "--step", "5"});
    EXPECT_EQ(apart.code, 0) << apart.err;
    EXPECT_TRUE(has(apart.out, "step 5")) << apart.out;
    EXPECT_TRUE(has(apart.out, "they do not touch because their bounds are")) << apart.out;
    // Walls of the pit.
    const Outcome walls = carom({"why", "0", "1", "pile_boxes", "--bodies", "5", "--step", "1"});
    EXPECT_TRUE(has(walls.out, "because neither is dynamic")) << walls.out;
    const Outcome before = carom({"why", "0", "1", "tall_stack", "--bodies", "3", "--step", "0"});
    EXPECT_TRUE(has(before.out, "because no step has been done yet")) << before.out;
}

TEST(Why, TheReportHasEveryKey) {
    const Outcome outcome = carom({"why", "0", "1", "tall_stack", "--bodies", "3", "--steps", "30", "--json", "-"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Json json = Json::parse(outcome.out, nullptr, false);
    ASSERT_TRUE(json.is_object()) << "stdout holds more than JSON: " << outcome.out;
    EXPECT_EQ(json.at("scene"), "tall_stack");
    EXPECT_EQ(json.at("step"), 30);
    EXPECT_EQ(json.at("a").at("number"), 0);
    EXPECT_EQ(json.at("a").at("type"), "static");
    EXPECT_EQ(json.at("b").at("type"), "dynamic");
    EXPECT_EQ(json.at("rung"), "touch");
    EXPECT_TRUE(json.at("disagreements").empty());
    const Json& pair = json.at("pairs").at(json.at("deciding").get<std::size_t>());
    EXPECT_EQ(pair.at("shape_a").at("type"), "box");
    EXPECT_EQ(pair.at("filter").at("any_moves"), true);
    EXPECT_LE(pair.at("bounds").at("gap"), 0.0);
    EXPECT_EQ(pair.at("broadphase").at("listed"), true);
    EXPECT_NE(pair.at("broadphase").at("place"), "");
    EXPECT_EQ(pair.at("found").at("points"), 4);
    EXPECT_EQ(pair.at("origin").size(), 3u);
    const Json& contact = pair.at("contact");
    EXPECT_EQ(contact.at("verdict"), "touching");
    EXPECT_EQ(contact.at("back_face"), false);
    EXPECT_EQ(contact.at("axis").at("source"), "face of A");
    EXPECT_LT(contact.at("axis").at("gap"), 0.0);
    EXPECT_EQ(contact.at("distance").at("upper"), 0.0);
    EXPECT_EQ(contact.at("manifolds").at(0).at("points").size(), 4u);
    EXPECT_EQ(contact.at("patch").at("common").size(), 4u);
}

TEST(Why, AOneSidedMeshShowsItsBack) {
    const TemporaryFolder folder;
    const std::string file = folder.write("trapdoor.json", R"({"gravity": [0, 0, 0], "bodies": [
        {"name": "floor", "type": "static", "shapes": [{"type": "triangle_mesh", "one_sided": true,
            "vertices": [[-9, 0, -9], [-9, 0, 9], [9, 0, 9], [9, 0, -9]], "triangles": [[0, 1, 2], [0, 2, 3]]}]},
        {"name": "ball", "position": [0, -0.1, 0], "shapes": [{"type": "sphere", "radius": 0.5}]}]})");
    const Outcome outcome = carom({"why", "ball", "floor", file, "--steps", "1"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(has(outcome.out, "back face, one-sided")) << outcome.out;
    EXPECT_TRUE(has(outcome.out, "shows the other its back face, though they overlap by 0.4 m")) << outcome.out;
    const Outcome json = carom({"why", "ball", "floor", file, "--steps", "1", "--json", "-"});
    const Json report = Json::parse(json.out, nullptr, false);
    ASSERT_TRUE(report.is_object()) << json.out;
    EXPECT_EQ(report.at("rung"), "back face");
    EXPECT_EQ(report.at("pairs").at(0).at("contact").at("back_face"), true);
}

/// A ball at 100 m/s that comes to a thin wall in the third step, and a file of it.
std::string shot_file(const TemporaryFolder& folder, const std::string& of_ball = "") {
    return folder.write("shot.json", R"({"gravity": [0, 0, 0], "bodies": [
        {"name": "wall", "type": "static", "shapes": [{"type": "box", "half_extents": [5, 5, 0.005]}]},
        {"name": "shot", "position": [0, 0, -4.3], "linear_velocity": [0, 0, 100])" + of_ball + R"(,
            "shapes": [{"type": "sphere", "radius": 0.05}]}]})");
}

TEST(Why, APassageIsNamedWithItsStepItsCauseAndItsRemedy) {
    const TemporaryFolder folder;
    const std::string file = shot_file(folder);
    const Outcome later = carom({"why", "shot", "wall", file, "--steps", "6", "--no-continuous"});
    EXPECT_EQ(later.code, 0) << later.err;
    EXPECT_TRUE(has(later.out, "\nA passed through B in step 3, at t = 0.57")) << "the simple question, of a later step\n" << later.out;
    EXPECT_TRUE(has(later.out, "because continuous collision is off")) << later.out;
    EXPECT_TRUE(has(later.out, "leave out --no-continuous")) << later.out;
    EXPECT_TRUE(later.out.ends_with("scene file)\n")) << "it is the last word\n" << later.out;
    const Outcome then = carom({"why", "wall", "shot", file, "--steps", "6", "--step", "3", "--no-continuous"});
    EXPECT_TRUE(has(then.out, "way of A    not followed: it is static")) << then.out;
    EXPECT_TRUE(has(then.out, "way of B    not followed: continuous collision is off, though it came up to 1.66667 m, more than 0.05 m")) << then.out;
    EXPECT_TRUE(has(then.out, "sweep       touching at t = 0.54")) << then.out;
    EXPECT_TRUE(has(then.out, "\nB passed through A in step 3")) << then.out;
    const Outcome before = carom({"why", "shot", "wall", file, "--steps", "6", "--step", "2", "--no-continuous"});
    EXPECT_FALSE(has(before.out, "passed through")) << before.out;
    EXPECT_TRUE(has(before.out, "sweep       separated all the way, by at least 0.9")) << before.out;
}

TEST(Why, WhatWasFollowedIsTold) {
    const TemporaryFolder folder;
    const std::string file = shot_file(folder);
    const Outcome outcome = carom({"why", "shot", "wall", file, "--steps", "6", "--step", "3"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(has(outcome.out, "way of A    followed: it came up to 1.66667 m, more than 0.05 m, by itself; 1 impact\n")) << outcome.out;
    EXPECT_TRUE(has(outcome.out, "met         body 1 (shot) and body 0 (wall) at t = 0.54")) << outcome.out;
    EXPECT_TRUE(has(outcome.out, "touching, within 1e-06 m, struck apart")) << outcome.out;
    EXPECT_TRUE(has(outcome.out, "\nthey met at t = 0.54")) << outcome.out;
    EXPECT_FALSE(has(outcome.out, "passed")) << outcome.out;
    const std::string never = shot_file(folder, R"(, "continuity": "never")");
    const Outcome passed = carom({"why", "shot", "wall", never, "--steps", "6"});
    EXPECT_TRUE(has(passed.out, "A passed through B in step 3")) << passed.out;
    EXPECT_TRUE(has(passed.out, "what would have caught it: Continuity::Automatic for A")) << passed.out;
}

TEST(Why, TheReportOfAWayHasEveryKey) {
    const TemporaryFolder folder;
    const std::string file = shot_file(folder);
    const Outcome outcome = carom({"why", "shot", "wall", file, "--steps", "3", "--json", "-"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Json json = Json::parse(outcome.out, nullptr, false);
    ASSERT_TRUE(json.is_object()) << outcome.out;
    EXPECT_TRUE(json.at("passages").empty());
    const Json& sweep = json.at("sweep");
    EXPECT_EQ(sweep.at("reason"), "watched");
    EXPECT_TRUE(has(sweep.at("sentence"), "they met at t = "));
    EXPECT_EQ(sweep.at("a").at("reason"), "followed");
    EXPECT_EQ(sweep.at("a").at("continuity"), "automatic");
    EXPECT_NEAR(sweep.at("a").at("motion").get<double>(), 100.0 / 60.0, 1e-9);
    EXPECT_NEAR(sweep.at("a").at("limit").get<double>(), 0.05, 1e-8);
    EXPECT_EQ(sweep.at("a").at("flew"), true);
    EXPECT_EQ(sweep.at("a").at("impacts"), 1);
    EXPECT_EQ(sweep.at("a").at("stopped"), "none");
    EXPECT_TRUE(sweep.at("a").at("stopped_at").is_null());
    EXPECT_EQ(sweep.at("b").at("reason"), "static");
    const Json& pair = sweep.at("pairs").at(sweep.at("deciding").get<std::size_t>());
    EXPECT_EQ(pair.at("status"), "touching");
    EXPECT_NEAR(pair.at("t").get<double>(), 0.547, 1e-4);
    EXPECT_GT(pair.at("margin").get<double>(), 0.0);
    EXPECT_NEAR(pair.at("normal").at(2).get<double>(), 1.0, 1e-6);
    EXPECT_EQ(pair.at("point").size(), 3u);
    EXPECT_TRUE(pair.at("clearance").is_null());
    EXPECT_EQ(pair.at("reason"), "watched");
    EXPECT_EQ(pair.at("shape_a"), 1);
    EXPECT_EQ(pair.at("shape_b"), 0);
    const Json& impact = sweep.at("impacts").at(0);
    EXPECT_EQ(impact.at("body_a"), 1);
    EXPECT_EQ(impact.at("body_b"), 0);
    EXPECT_EQ(impact.at("status"), "touching");
    EXPECT_EQ(impact.at("blow"), true);
    EXPECT_EQ(impact.at("watched"), 1.0);
    EXPECT_TRUE(impact.at("advances").empty());
    EXPECT_NEAR(impact.at("point").at(2).get<double>(), -0.005, 1e-5);

    const Outcome off = carom({"why", "shot", "wall", file, "--steps", "6", "--no-continuous", "--json", "-"});
    const Json report = Json::parse(off.out, nullptr, false);
    ASSERT_TRUE(report.is_object()) << off.out;
    ASSERT_EQ(report.at("passages").size(), 1u);
    const Json& passage = report.at("passages").at(0);
    EXPECT_EQ(passage.at("step"), 3);
    EXPECT_EQ(passage.at("cause"), "off");
    EXPECT_EQ(passage.at("through"), true);
    EXPECT_LT(passage.at("touched").get<double>(), passage.at("t").get<double>());
    EXPECT_TRUE(has(passage.at("remedy"), "enabled"));
    EXPECT_TRUE(has(passage.at("sentence"), "A passed through B in step 3"));
    EXPECT_EQ(report.at("sweep").at("reason"), "off") << "in the last step";
    EXPECT_TRUE(report.at("sweep").at("pairs").at(0).at("t").is_null());
    EXPECT_GT(report.at("sweep").at("pairs").at(0).at("clearance").get<double>(), 3.9);
}

TEST(Why, BodiesMayBeNamed) {
    const TemporaryFolder folder;
    const std::string file = folder.write("two.json", R"({"bodies": [
        {"name": "ground", "type": "static", "shapes": [{"type": "plane", "normal": [0, 1, 0], "offset": 0}]},
        {"name": "crate", "position": [0, 0.5, 0], "shapes": [{"type": "box", "half_extents": [0.5, 0.5, 0.5]}]},
        {"name": "twin", "position": [9, 0.5, 0], "shapes": [{"type": "sphere", "radius": 0.5}]},
        {"name": "twin", "position": [9, 3, 0], "shapes": [{"type": "sphere", "radius": 0.5}]}]})");
    const Outcome outcome = carom({"why", "crate", "ground", file, "--steps", "3"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(has(outcome.out, "B is body 0 (ground, plane, static)")) << outcome.out;
    EXPECT_TRUE(has(outcome.out, "the list of planes lists them")) << outcome.out;
    EXPECT_TRUE(has(outcome.out, "they touch because")) << outcome.out;
    expect_refused({"why", "crate", "twin", file}, {"B", "more than one", "twin"});
    expect_refused({"why", "crte", "ground", file}, {"A", "crte"});
}

TEST(Why, BadInputIsNamed) {
    const TemporaryFolder folder;
    const std::string file = folder.write("file", "keep me");
    expect_refused({"why"}, {"A"});
    expect_refused({"why", "0", "1"}, {"SCENE"});
    expect_refused({"why", "0", "1", "kettle"}, {"kettle", "tall_stack"});
    const std::vector<std::string> stack{"tall_stack", "--bodies", "3", "--steps", "4"};
    const auto with = [&](std::vector<std::string> words, const std::vector<std::string>& more = {}) {
        words.insert(words.end(), stack.begin(), stack.end());
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    expect_refused(with({"why", "0", "77"}), {"B", "77", "highest is 3"});
    expect_refused(with({"why", "4294967296", "1"}), {"A", "4294967296"});
    expect_refused(with({"why", "2", "2"}), {"one body", "2"});
    expect_refused(with({"why", "0", "1"}, {"--step", "5"}), {"--step", "4 steps"});
    expect_refused(with({"why", "0", "1"}, {"--step", "-1"}), {"--step", "-1"});
    expect_refused(with({"why", "0", "1"}, {"--step", "two"}), {"--step", "two"});
    expect_refused(with({"why", "0", "1"}, {"--json", file + "/report.json"}), {file + "/report.json"});
    if (CAROM_HAS_VIZ) {
        expect_refused(with({"why", "0", "1"}, {"--picture", folder.path("p.png"), "--size", "8x8"}), {"--size"});
        expect_refused(with({"why", "0", "1"}, {"--size", "80x80"}), {"--picture"});
    }
}

TEST(Why, FramesHoldALayerForEachThing) {
    if (!CAROM_HAS_VIZ) GTEST_SKIP() << "a build without viz";
    const TemporaryFolder folder;
    const Outcome outcome = carom({"why", "0", "1", "tall_stack", "--bodies", "3", "--steps", "9", "--vtk", folder.path("out")});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(folder.path("out/frames.pvd")));
    std::string files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path("out"))) files += entry.path().filename().string() + " ";
    for (const char* layer : {"why-axis", "why-simplex", "why-manifold", "why-patch"}) EXPECT_TRUE(has(files, layer)) << layer << ": " << files;
}

/// The words of a command as a document has it after "$ carom"; quotes hold words together.
std::vector<std::string> words_of(const std::string& command) {
    std::vector<std::string> words{""};
    bool quoted = false;
    for (const char c : command) {
        if (c == '"') {
            quoted = !quoted;
        } else if (c == ' ' && !quoted) {
            words.emplace_back();
        } else {
            words.back() += c;
        }
    }
    for (std::string& word : words) {
        if (word.starts_with("scenes/")) word = std::string(CAROM_TEST_DATA) + "/../" + word;
    }
    return words;
}

/// Numbers may change with the engine; what is said about them may not.
std::string without_numbers(const std::string& text) {
    return std::regex_replace(text, std::regex("-?[0-9][0-9.]*(e[-+]?[0-9]+)?"), "#");
}

void collect_keys(const Json& json, std::set<std::string>& keys) {
    if (json.is_object()) {
        for (const auto& [key, value] : json.items()) keys.insert(key);
    }
    for (const Json& value : json) {
        if (value.is_structured()) collect_keys(value, keys);
    }
}

TEST(Why, TheDocumentsNameEveryKey) {
    std::ifstream file(std::string(CAROM_TEST_DATA) + "/../docs/cli.md");
    std::stringstream text;
    text << file.rdbuf();
    const std::string all = text.str();
    const std::size_t from = all.find("The keys of its report; what a pair did not reach is null"), to = all.find("## `carom cast`");
    ASSERT_LT(from, to);
    const std::string table = all.substr(from, to - from);
    const TemporaryFolder folder;
    const std::string file_of_shot = shot_file(folder);
    std::set<std::string> keys;
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"why", "0", "1", "tall_stack", "--bodies", "3", "--steps", "30", "--json", "-"},
          {"why", "shot", "wall", file_of_shot, "--steps", "3", "--json", "-"},
          {"why", "shot", "wall", file_of_shot, "--steps", "6", "--no-continuous", "--json", "-"}}) {
        const Outcome outcome = carom(command);
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        collect_keys(Json::parse(outcome.out, nullptr, false), keys);
    }
    EXPECT_TRUE(keys.contains("simplex_a") && keys.contains("common") && keys.contains("remedy")) << "reports that reach everything";
    for (const std::string& key : keys) {
        EXPECT_TRUE(std::regex_search(table, std::regex("[`.]" + key + "[`\\[.]"))) << key << " is not in docs/cli.md";
    }
}

TEST(Why, TwoMeshesAreApartByTheDistanceOfTheirNearestTriangles) {
    const TemporaryFolder folder;
    const std::string file = folder.write("pots.json", R"({"gravity": [0, 0, 0], "bodies": [
        {"name": "low", "position": [0, 0, 0], "type": "static", "shapes": [{"type": "triangle_mesh", "generate": "teapot", "size": 1}]},
        {"name": "high", "position": [0, 1.5, 0], "shapes": [{"type": "triangle_mesh", "generate": "teapot", "size": 1}]}]})");
    const Outcome outcome = carom({"why", "low", "high", file, "--steps", "1"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    for (const char* words : {"nearest     triangle ", "axis        gap of ", "distance    ", "verdict     apart"}) {
        EXPECT_TRUE(has(outcome.out, words)) << words << "\n" << outcome.out;
    }
}

TEST(Why, SaysWhatTheDocumentsShow) {
    std::ifstream file(std::string(CAROM_TEST_DATA) + "/../docs/cli.md");
    const std::string prompt = "$ carom why";
    int shown = 0;
    for (std::string line; std::getline(file, line);) {
        if (!line.starts_with(prompt)) continue;
        const std::string command = line.substr(8);
        std::string expected, last;
        while (std::getline(file, line) && line != "```") {
            expected += line.substr(0, 12) + "\n";
            last = line;
        }
        const Outcome outcome = carom(words_of(command));
        EXPECT_EQ(outcome.code, 0) << command << "\n" << outcome.err;
        std::istringstream out(outcome.out);
        std::string rungs, sentence;
        for (std::string said; std::getline(out, said);) {
            rungs += said.substr(0, 12) + "\n";
            sentence = said;
        }
        EXPECT_EQ(without_numbers(sentence), without_numbers(last)) << command;
        EXPECT_EQ(rungs, expected) << command;
        ++shown;
    }
    EXPECT_GE(shown, 3);
}

}  // namespace
}  // namespace carom::test
