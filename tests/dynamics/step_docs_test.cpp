// docs/step.md has a heading for each stage, in the order they run, and no other.
#include <carom/dynamics/stage.hpp>

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

namespace carom {
namespace {

TEST(StepDocs, HeadingsAreTheStages) {
    std::ifstream page(std::string(CAROM_TEST_DATA) + "/../docs/step.md");
    ASSERT_TRUE(page.good());
    std::vector<std::string> headings;
    for (std::string line; std::getline(page, line);) {
        if (line.starts_with("## ")) headings.push_back(line.substr(3));
    }
    ASSERT_EQ(headings.size(), static_cast<std::size_t>(kStageCount));
    for (const Stage stage : all_stages()) EXPECT_EQ(headings[static_cast<std::size_t>(stage)], to_string(stage));
}

}  // namespace
}  // namespace carom
