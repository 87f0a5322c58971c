// The check of the fuzzer impact over its corpus and over pseudo-random bytes.
#include <fuzz/impact_check.hpp>
#include <support/query_cases.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace carom {
namespace {

TEST(ImpactFuzz, TheCorpusHoldsNoFault) {
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(CAROM_TEST_DATA "/fuzz/corpus/impact")) {
        std::ifstream file(entry.path(), std::ios::binary);
        const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
        EXPECT_EQ(test::impact_fault(bytes), "") << entry.path();
        ++files;
    }
    EXPECT_GE(files, 4);
}

TEST(ImpactFuzz, RandomBytesShowNoFault) {
    Random random(0x13fac7);
    for (int i = 0; i < 1000; ++i) {
        const auto bytes = test::random_bytes(random, 200);
        ASSERT_EQ(test::impact_fault(bytes), "") << i;
    }
}

}  // namespace
}  // namespace carom
