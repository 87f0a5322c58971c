// The check of the fuzzer sweep over its corpus and over pseudo-random bytes.
#include <fuzz/sweep_check.hpp>
#include <support/query_cases.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace carom {
namespace {

TEST(SweepFuzz, TheCorpusHoldsNoFault) {
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(CAROM_TEST_DATA "/fuzz/corpus/sweep")) {
        std::ifstream file(entry.path(), std::ios::binary);
        const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
        EXPECT_EQ(test::sweep_fault(bytes), "") << entry.path();
        ++files;
    }
    EXPECT_GE(files, 6);
}

TEST(SweepFuzz, RandomBytesShowNoFault) {
    Random random(0x5eeb);
    for (int i = 0; i < 6000; ++i) {
        const auto bytes = test::random_bytes(random, 320);
        ASSERT_EQ(test::sweep_fault(bytes), "") << i;
    }
}

}  // namespace
}  // namespace carom
