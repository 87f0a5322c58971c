// What the program draws: frames in a folder, and the window.
#include <cli/program.hpp>

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <set>

namespace carom::test {
namespace {

TEST(CliPictures, FramesGoIntoAFolderThatIsMade) {
    if (!CAROM_HAS_VIZ) GTEST_SKIP() << "this build has no viz";
    const TemporaryFolder folder;
    const std::string out = folder.path("deep/frames");
    const Outcome outcome = carom({"run", "tall_stack", "--bodies", "2", "--steps", "130", "--vtk", out, "--json", out + "/r.json"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(out + "/frames.pvd"));
    EXPECT_NE(outcome.out.find(" " + out + "/frames.pvd\n"), std::string::npos) << outcome.out;
    EXPECT_TRUE(std::filesystem::exists(out + "/r.json"));
    std::size_t frames = 0;
    for (const auto& file : std::filesystem::directory_iterator(out + "/frames")) {
        frames += file.path().filename().string().starts_with("shapes") ? 1 : 0;
    }
    // The start, every third step of 130, and the last.
    EXPECT_EQ(frames, 1u + 43u + 1u);
}

TEST(CliPictures, FramesShowTheBroadphaseWhereAskedTo) {
    if (!CAROM_HAS_VIZ) GTEST_SKIP() << "this build has no viz";
    const TemporaryFolder folder;
    const auto layers = [&](const std::string& out, const std::vector<std::string>& more) {
        std::vector<std::string> run{"run", "pile_boxes", "--bodies", "30", "--steps", "3", "--peak-every", "0", "--vtk", out};
        run.insert(run.end(), more.begin(), more.end());
        const Outcome outcome = carom(run);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        std::set<std::string> names;
        for (const auto& file : std::filesystem::directory_iterator(out + "/frames")) {
            const std::string name = file.path().filename().string();
            if (name.starts_with("broadphase-")) names.insert(name.substr(0, name.find_first_of("_.0123456789")));
        }
        return names;
    };
    using Names = std::set<std::string>;
    EXPECT_EQ(layers(folder.path("plain"), {}), Names{});
    EXPECT_EQ(layers(folder.path("brute"), {"--broadphase"}), Names{"broadphase-bounds"});
    EXPECT_EQ(layers(folder.path("tree"), {"--broadphase", "--broadphase-method", "dynamic_tree"}),
              (Names{"broadphase-bounds", "broadphase-tree"}));
    EXPECT_EQ(layers(folder.path("grid"), {"--broadphase", "--broadphase-method", "uniform_grid"}),
              (Names{"broadphase-bounds", "broadphase-cells"}));
    EXPECT_EQ(layers(folder.path("axes"), {"--broadphase", "--broadphase-method", "sorted_axes"}),
              (Names{"broadphase-bounds", "broadphase-axes"}));
}

TEST(CliPictures, TheWindowTakesTheBroadphasesOptionsAndNeedsADisplay) {
    if (!CAROM_HAS_VIZ) GTEST_SKIP() << "this build has no viz";
    const char* const display = std::getenv("DISPLAY");
    const std::string before = display != nullptr ? display : "";
    ::unsetenv("DISPLAY");
    expect_refused({"view", "tall_stack", "--broadphase", "--broadphase-method", "uniform_grid"}, {"DISPLAY"});
    expect_refused({"view", "tall_stack", "--broadphase-method", "magic"}, {"magic", "uniform_grid"});
    if (display != nullptr) ::setenv("DISPLAY", before.c_str(), 1);
}

}  // namespace
}  // namespace carom::test
