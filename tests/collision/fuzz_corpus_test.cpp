// The fuzzers' own checks over their seed corpus, so that what once broke a query is looked at in every run of the tests.
#include <fuzz/clipping_check.hpp>
#include <fuzz/ray_primitives_check.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace carom {
namespace {

template <class Check>
void replay(const std::string& name, Check check) {
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(CAROM_TEST_DATA "/fuzz/corpus/" + name)) {
        std::ifstream file(entry.path(), std::ios::binary);
        const std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
        const std::vector<std::uint8_t> bytes(text.begin(), text.end());
        EXPECT_EQ(check(bytes), "") << entry.path();
        ++files;
    }
    EXPECT_GT(files, 5);
}

TEST(FuzzCorpus, RayPrimitives) { replay("ray_primitives", test::ray_primitives_fault); }
TEST(FuzzCorpus, Clipping) { replay("clipping", test::clipping_fault); }

TEST(FuzzCorpus, ShortInputsAreScenesToo) {
    for (int first = 0; first < 256; ++first) {
        const std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(first), 2};
        for (std::size_t n = 0; n <= bytes.size(); ++n) {
            EXPECT_EQ(test::ray_primitives_fault(std::span(bytes).first(n)), "");
            EXPECT_EQ(test::clipping_fault(std::span(bytes).first(n)), "");
        }
    }
}

}  // namespace
}  // namespace carom
