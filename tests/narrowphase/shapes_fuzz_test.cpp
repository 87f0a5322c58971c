// The fuzzer's check of cylinders, cones and compounds over its corpus and over pseudo-random bytes.
#include <fuzz/shapes_check.hpp>
#include <support/query_cases.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace carom {
namespace {

TEST(ShapesFuzz, TheCorpusHoldsNoFault) {
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(CAROM_TEST_DATA "/fuzz/corpus/shapes")) {
        std::ifstream file(entry.path(), std::ios::binary);
        const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
        EXPECT_EQ(test::shapes_fault(bytes), "") << entry.path();
        ++files;
    }
    EXPECT_GE(files, 12);
}

TEST(ShapesFuzz, RandomBytesShowNoFault) {
    Random random(0x5a9e5);
    for (int i = 0; i < 3000; ++i) {
        const auto bytes = test::random_bytes(random, 160);
        ASSERT_EQ(test::shapes_fault(bytes), "") << i;
    }
}

TEST(ShapesFuzz, ShortInputsAreScenesToo) {
    for (int first = 0; first < 256; ++first) {
        const std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(first), 1, 2, 3};
        for (std::size_t n = 0; n <= bytes.size(); ++n) ASSERT_EQ(test::shapes_fault(std::span(bytes).first(n)), "") << first;
    }
}

}  // namespace
}  // namespace carom
