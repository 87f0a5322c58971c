// carom accuracy and carom cast: exit codes and messages for bad input, and every key of their reports.
#include <cli/program.hpp>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace carom::test {
namespace {

using Json = nlohmann::json;

constexpr int kOk = 0, kFailed = 1, kBadInput = 2;

Json report(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--json", "-"});
    const Outcome outcome = carom(arguments);
    EXPECT_EQ(outcome.code, kOk) << outcome.err;
    Json json = Json::parse(outcome.out, nullptr, false);
    EXPECT_TRUE(json.is_object()) << "stdout holds more than JSON: " << outcome.out;
    return json;
}

std::string contents(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

TEST(Accuracy, ListsItsStudies) {
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"accuracy"}, {"accuracy", "--list"}}) {
        const Outcome outcome = carom(arguments);
        EXPECT_EQ(outcome.code, kOk);
        EXPECT_NE(outcome.out.find("rays"), std::string::npos);
    }
}

TEST(Accuracy, BadInputIsNamed) {
    const TemporaryFolder folder;
    const std::string file = folder.write("file", "keep me");
    expect_refused({"accuracy", "speed"}, {"speed", "rays"});
    expect_refused({"accuracy", "rays", "stray"}, {"stray"});
    expect_refused({"accuracy", "rays", "--fast"}, {"--fast"});
    expect_refused({"accuracy", "rays", "--quick", "--json", file + "/report.json"}, {file + "/report.json", "written"});
    expect_refused({"accuracy", "rays", "--quick", "--out", file + "/folder"}, {file + "/folder"});
    expect_refused({"accuracy", "rays", "--quick", "--out", file}, {file});
    // An unknown study makes no folder.
    expect_refused({"accuracy", "speed", "--out", folder.path("new")}, {"speed"});
    EXPECT_FALSE(std::filesystem::exists(folder.path("new")));
    EXPECT_EQ(contents(file), "keep me");
}

TEST(Accuracy, AReportHasEveryKey) {
    const Json json = report({"accuracy", "rays", "--quick"});
    EXPECT_EQ(json.at("quick"), true);
    EXPECT_GE(json.at("repeats"), 1);
    EXPECT_TRUE(json.at("machine").at("cpu").is_string());
    EXPECT_GE(json.at("build").at("simd_width"), 1);
    ASSERT_FALSE(json.at("studies").empty());
    EXPECT_EQ(json.at("studies").at(0).at("name"), "rays") << "the first study has the group's name";
    for (const Json& study : json.at("studies")) {
        for (const char* key : {"name", "stage", "error", "unit", "oracle"}) {
            EXPECT_NE(study.at(key), "") << key;
        }
        ASSERT_FALSE(study.at("points").empty());
        for (const Json& point : study.at("points")) {
            EXPECT_TRUE(CAROM_HAS_PEERS || point.at("who") == "carom") << point.at("who");
            EXPECT_TRUE(point.at("settings").is_object());
            EXPECT_GT(point.at("time_s"), 0.0);
            EXPECT_GE(point.at("time_iqr_s"), 0.0);
            EXPECT_EQ(point.at("error").is_null(), point.at("failures") > 0);
        }
        EXPECT_FALSE(study.at("front").empty());
        for (const Json& index : study.at("front")) {
            EXPECT_LT(index.get<std::size_t>(), study.at("points").size());
        }
        for (const char* reach : {"1e-2", "1e-3", "1e-4"}) {
            EXPECT_TRUE(study.at("time_to").contains(reach));
        }
        EXPECT_EQ(study.at("points").size() > 0 && study.at("time_to").size() == 3, true);
    }
    // What is exact in double is exact to rounding wherever mesh and ray stand.
    EXPECT_LT(json.at("studies").at(0).at("points").at(0).at("error"), 1e-15);
}

TEST(Accuracy, AFolderHoldsReportTableAndPicture) {
    const TemporaryFolder folder;
    const std::string out = folder.path("deep/studies");
    const Outcome outcome = carom({"accuracy", "rays", "--quick", "--out", out});
    EXPECT_EQ(outcome.code, kOk) << outcome.err;
    EXPECT_NE(outcome.out.find("to reach 1e-2"), std::string::npos);
    const Json json = Json::parse(contents(out + "/accuracy.json"), nullptr, false);
    ASSERT_TRUE(json.is_object());
    for (const Json& study : json.at("studies")) {
        const std::string stem = out + "/" + study.at("name").get<std::string>();
        const std::string csv = contents(stem + ".csv");
        EXPECT_EQ(std::ranges::count(csv, '\n'), static_cast<std::ptrdiff_t>(study.at("points").size() + 1));
        EXPECT_TRUE(std::filesystem::exists(stem + ".gp"));
        const bool said = outcome.err.find("gnuplot is not on the PATH") != std::string::npos;
        EXPECT_NE(std::filesystem::exists(stem + ".svg"), said);
    }
}

TEST(Accuracy, WithoutGnuplotOneLineSaysSo) {
    const TemporaryFolder folder;
    const std::string path = std::getenv("PATH") != nullptr ? std::getenv("PATH") : "";
    ASSERT_EQ(setenv("PATH", folder.path("").c_str(), 1), 0);
    const Outcome outcome = carom({"accuracy", "rays", "--quick", "--out", folder.path("out")});
    ASSERT_EQ(setenv("PATH", path.c_str(), 1), 0);
    EXPECT_EQ(outcome.code, kOk);
    EXPECT_NE(outcome.err.find("gnuplot is not on the PATH"), std::string::npos);
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1);
    EXPECT_TRUE(std::filesystem::exists(folder.path("out/accuracy.json")));
    EXPECT_TRUE(std::filesystem::exists(folder.path("out/rays.csv")));
    EXPECT_FALSE(std::filesystem::exists(folder.path("out/rays.svg")));
}

TEST(Accuracy, AFullDiskIsAFailure) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
    EXPECT_EQ(carom({"accuracy", "rays", "--quick", "--json", "/dev/full"}).code, kFailed);
}

TEST(Cast, BadInputIsNamed) {
    const TemporaryFolder folder;
    const std::string file = folder.write("file", "keep me");
    expect_refused({"cast"}, {"TARGET"});
    expect_refused({"cast", "kettle"}, {"kettle", "teapot", "bumpy", "pile_boxes"});
    expect_refused({"cast", "teapot", "--rays", "0"}, {"--rays", "0"});
    expect_refused({"cast", "teapot", "--rays", "-5"}, {"--rays", "-5"});
    expect_refused({"cast", "teapot", "--rays", "1e6"}, {"--rays", "1e6"});
    expect_refused({"cast", "teapot", "--seed", "-1"}, {"--seed"});
    expect_refused({"cast", "teapot", "--threads", "0"}, {"--threads"});
    expect_refused({"cast", "teapot", "--aim", "moon"}, {"--aim", "moon", "chords, edges"});
    expect_refused({"cast", "teapot", "--bodies", "5"}, {"--bodies", "scenes"});
    expect_refused({"cast", "pile_boxes", "--bodies", "-5"}, {"--bodies", "-5"});
    expect_refused({"cast", "single_body_spin", "--bodies", "5"}, {"bodies"});
    expect_refused({"cast", folder.write("one.json", R"({"bodies": []})"), "--bodies", "5"}, {"bodies"});
    expect_refused({"cast", "tall_stack", "--aim", "edges"}, {"--aim", "mesh"});
    expect_refused({"cast", "teapot", "--shape", "moon"}, {"--shape", "moon", "ray, ball, capsule, box, hull"});
    expect_refused({"cast", "teapot", "--radius", "0.1"}, {"--shape"});
    for (const char* radius : {"0", "-1", "nan", "inf", "1e9"}) {
        expect_refused({"cast", "teapot", "--shape", "ball", "--radius", radius}, {"--radius", "1e-6"});
    }
    expect_refused({"cast", "teapot", "--view", "id"}, {"--picture"});
    expect_refused({"cast", "teapot", "--size", "10x10"}, {"--picture"});
    expect_refused({"cast", "teapot", "--picture", folder.path("p.png"), "--view", "heat"}, {"--view", "heat"});
    for (const char* size : {"10", "x", "10x", "0x10", "10x-3", "10x10x10", "1e2x10", "99999999999x5"}) {
        expect_refused({"cast", "teapot", "--picture", folder.path("p.png"), "--size", size}, {"--size", size});
    }
    expect_refused({"cast", "teapot", "--picture", folder.path("p.png"), "--size", "8193x10"}, {"8192"});
    expect_refused({"cast", "teapot", "--picture", file + "/p.png"}, {file + "/p.png", "written"});
    expect_refused({"cast", "teapot", "--picture", "-"}, {"--picture"});
    expect_refused({"cast", "teapot", "--json", file + "/r.json"}, {file + "/r.json", "written"});
    expect_refused({"cast", folder.path("missing.json")}, {"missing.json"});
    expect_refused({"cast", folder.write("empty.json", R"({"bodies": []})")}, {"shape"});
    EXPECT_FALSE(std::filesystem::exists(folder.path("p.png")));
    EXPECT_EQ(contents(file), "keep me");
}

TEST(Cast, AReportOfAMeshHasEveryKey) {
    const Json json = report({"cast", "bumpy", "--rays", "20000", "--seed", "5"});
    EXPECT_EQ(json.at("target"), "bumpy");
    EXPECT_EQ(json.at("kind"), "mesh");
    EXPECT_EQ(json.at("triangles"), 69312);
    EXPECT_EQ(json.at("closed"), true);
    EXPECT_TRUE(json.at("bodies").is_null());
    EXPECT_EQ(json.at("rays"), 20000);
    EXPECT_EQ(json.at("aim"), "chords");
    EXPECT_EQ(json.at("seed"), 5);
    EXPECT_EQ(json.at("threads"), 1);
    EXPECT_TRUE(json.at("machine").at("cpu").is_string());
    EXPECT_GE(json.at("build").at("simd_width"), 1);
    EXPECT_GT(json.at("build_s"), 0.0);
    EXPECT_GT(json.at("time_s"), 0.0);
    EXPECT_NEAR(json.at("rays_per_s").get<double>() * json.at("time_s").get<double>(), 20000.0, 1e-6);
    EXPECT_GT(json.at("hits"), 2000);
    EXPECT_LT(json.at("hits"), 18000);
    EXPECT_EQ(json.at("leaks"), 0);
    EXPECT_EQ(json.at("answer_hash").get<std::string>().size(), 16u);
}

TEST(Cast, NoRayAimedAtAnEdgeOfAClosedMeshLeaks) {
    const Json json = report({"cast", "bumpy", "--rays", "50000", "--aim", "edges"});
    EXPECT_EQ(json.at("aim"), "edges");
    EXPECT_EQ(json.at("leaks"), 0);
    EXPECT_GT(json.at("hits"), 49000) << "nearly all meet what they are aimed at; the rest pass by at the outline";
}

TEST(Cast, ShapesAreCastAndNoneComesLate) {
    for (const char* target : {"tall_stack", "teapot"}) {
        for (const char* shape : {"ball", "capsule", "box", "hull"}) {
            const std::vector<std::string> arguments{"cast", target, "--shape", shape, "--rays", "300"};
            const Json json = report(arguments);
            EXPECT_EQ(json.at("shape"), shape);
            EXPECT_GT(json.at("radius"), 0.0);
            EXPECT_EQ(json.at("late"), 0) << shape;
            EXPECT_TRUE(json.at("leaks").is_null());
            EXPECT_GT(json.at("hits"), 30);
            EXPECT_EQ(report(arguments).at("answer_hash"), json.at("answer_hash"));
        }
    }
    const Json large = report({"cast", "tall_stack", "--shape", "ball", "--radius", "0.5", "--rays", "300"});
    EXPECT_EQ(large.at("radius"), 0.5);
    const Json rays = report({"cast", "tall_stack", "--rays", "300"});
    EXPECT_EQ(rays.at("shape"), "ray");
    EXPECT_TRUE(rays.at("late").is_null());
    EXPECT_GE(large.at("hits"), rays.at("hits"));
}

// The file's vertices are three a triangle, so that "closed" says that they were welded.
TEST(Cast, MeshFilesAreCastAt) {
    const TemporaryFolder folder;
    std::string soup = "OFF\n12 4 0\n", faces;
    const std::array<const char*, 4> corners{"0 0 0", "1 0 0", "0 1 0", "0 0 1"};
    const std::array<std::array<std::size_t, 3>, 4> triangles{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        for (const std::size_t corner : triangles[i]) soup += std::string(corners[corner]) + "\n";
        faces += "3 " + std::to_string(3 * i) + " " + std::to_string(3 * i + 1) + " " + std::to_string(3 * i + 2) + "\n";
    }
    const Json json = report({"cast", folder.write("tetrahedron.off", soup + faces), "--rays", "5000", "--aim", "edges"});
    EXPECT_EQ(json.at("kind"), "mesh");
    EXPECT_EQ(json.at("triangles"), 4);
    EXPECT_EQ(json.at("closed"), true);
    EXPECT_EQ(json.at("leaks"), 0);
    EXPECT_GT(json.at("hits"), 3000) << "many of the edges lie on the outline, where a ray may pass";
}

TEST(Cast, MeshFilesThatAreNoneAreNamed) {
    const TemporaryFolder folder;
    const auto refused = [&](const char* name, const char* text, const char* why) {
        expect_refused({"cast", folder.write(name, text)}, {name, why});
    };
    expect_refused({"cast", folder.path("missing.stl")}, {"missing.stl", "no such file"});
    expect_refused({"cast", folder.path("mesh.3ds")}, {"mesh.3ds"});
    refused("empty.ply", "", "ply");
    refused("lines.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n", "no triangles");
    refused("truncated.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0", "line 6");
    refused("huge.off", "OFF\n4000000000 1 0\n0 0 0\n", "than the file holds");
    refused("nan.obj", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n", "not finite");
    refused("range.obj", "v 0 0 0\nf 1 2 3\n", "line 2");
    refused("needle.obj", "v 0 0 0\nv 0 0 0\nv 0 1 0\nf 1 2 3\n", "different corners");
}

TEST(Cast, OpenMeshesAndScenesHaveNoLeaks) {
    const Json pot = report({"cast", "teapot", "--rays", "1000"});
    EXPECT_EQ(pot.at("closed"), false);
    EXPECT_TRUE(pot.at("leaks").is_null());
    const Json scene = report({"cast", "tall_stack", "--rays", "1000"});
    EXPECT_EQ(scene.at("kind"), "scene");
    EXPECT_TRUE(scene.at("triangles").is_null() && scene.at("closed").is_null() && scene.at("leaks").is_null());
    EXPECT_TRUE(scene.at("build_s").is_null());
    EXPECT_EQ(scene.at("bodies"), 31);
    EXPECT_GT(scene.at("hits"), 0);
}

TEST(Cast, ScenesAreCastAtInTheSizeAskedFor) {
    EXPECT_EQ(report({"cast", "tall_stack", "--rays", "100", "--bodies", "4"}).at("bodies"), 5) << "the ground is a body";
}

TEST(Cast, OneIsNotMany) {
    const TemporaryFolder folder;
    const std::string one = folder.write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_NE(carom({"cast", one, "--rays", "100"}).out.find(": 1 triangle, open"), std::string::npos);
    EXPECT_NE(carom({"cast", "teapot", "--rays", "100"}).out.find(" triangles, open"), std::string::npos);
}

TEST(Cast, AnswersDependOnTheSeedAndNotOnThreads) {
    for (const char* target : {"teapot", "tall_stack"}) {
        const std::vector<std::string> run{"cast", target, "--rays", "3000"};
        const std::string hash = report(run).at("answer_hash");
        std::vector<std::string> other = run;
        other.insert(other.end(), {"--seed", "2"});
        EXPECT_NE(report(other).at("answer_hash"), hash);
        std::vector<std::string> threads = run;
        threads.insert(threads.end(), {"--threads", "2"});
        if (CAROM_HAS_TBB) {
            EXPECT_EQ(report(threads).at("answer_hash"), hash);
        } else {
            expect_refused(threads, {"--threads", "CAROM_TBB"});
        }
    }
}

TEST(Cast, APictureNeedsNoDisplay) {
    const TemporaryFolder folder;
    for (const char* view : {"depth", "normal", "id"}) {
        for (const char* target : {"teapot", "tall_stack"}) {
            const std::string path = folder.path(std::string(target) + view + ".png");
            const Outcome outcome = carom({"cast", target, "--rays", "1", "--picture", path, "--view", view, "--size", "64x40"});
            EXPECT_EQ(outcome.code, kOk) << outcome.err;
            EXPECT_NE(outcome.out.find("answer hash"), std::string::npos);
            const std::string png = contents(path);
            EXPECT_EQ(png.substr(0, 4), "\x89PNG") << path;
            EXPECT_GT(png.size(), 100u);
        }
    }
}

}  // namespace
}  // namespace carom::test
