// A scene file that is written, read, and removed again.
#pragma once

#include "support.hpp"

#include <filesystem>
#include <fstream>

namespace carom::test {

using scenes::read_scene;
using scenes::SceneRun;

class ReadScene : public testing::Test {
protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() /
                  ("carom_read_scene_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    [[nodiscard]] std::string path() const { return (folder_ / "scene.json").string(); }

    Result<SceneRun> read(const std::string& text) {
        std::ofstream(path(), std::ios::binary) << text;
        return read_scene(path());
    }

    /// Reads a scene with one body, of the members `body`.
    Result<SceneRun> read_body(const std::string& body) { return read("{\"bodies\": [\n{" + body + "}\n]}"); }
    /// Reads a scene with one dynamic body of one shape, of the members `shape`.
    Result<SceneRun> read_shape(const std::string& shape, const std::string& type = "dynamic") {
        return read_body("\"type\": \"" + type + "\", \"shapes\": [\n{" + shape + "}]");
    }

    void expect_error(const Result<SceneRun>& result, ErrorCode code, const std::string& place) {
        ASSERT_FALSE(result.has_value()) << place;
        EXPECT_EQ(result.error().code, code) << result.error().where << ": " << result.error().message;
        EXPECT_EQ(result.error().where, path() + place) << result.error().message;
        EXPECT_FALSE(result.error().message.empty());
    }

    std::filesystem::path folder_;
};

}  // namespace carom::test
