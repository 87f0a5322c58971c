// The fuzzer's check over its corpus and over pseudo-random bytes.
#include <fuzz/overlap_check.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

namespace carom {
namespace {

std::vector<std::uint8_t> read(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST(OverlapFuzz, TheCorpusHoldsNoFault) {
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(CAROM_TEST_DATA "/fuzz/corpus/overlap")) {
        EXPECT_EQ(test::overlap_fault(read(entry.path())), "") << entry.path();
        ++files;
    }
    EXPECT_GE(files, 49);
}

TEST(OverlapFuzz, RandomBytesShowNoFault) {
    Random random(0xf022);
    for (int i = 0; i < 250; ++i) {
        const auto bytes = test::random_bytes(random, 100);
        ASSERT_EQ(test::overlap_fault(bytes), "") << i << " " << int(bytes[0]) << " " << int(bytes[1]);
    }
}

}  // namespace
}  // namespace carom
