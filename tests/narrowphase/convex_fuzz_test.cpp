// The checks of the fuzzers gjk, epa and sat over their corpora and over pseudo-random bytes.
#include <fuzz/convex_check.hpp>
#include <support/query_cases.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace carom {
namespace {

using Check = std::string (*)(std::span<const std::uint8_t>);
struct Target {
    const char* name;
    Check check;
    int inputs;
};
constexpr Target kTargets[] = {{"gjk", test::gjk_fault, 60}, {"epa", test::epa_fault, 50}, {"sat", test::sat_fault, 60}};

TEST(ConvexFuzz, TheCorporaHoldNoFault) {
    for (const Target& target : kTargets) {
        int files = 0;
        for (const auto& entry : std::filesystem::directory_iterator(std::string(CAROM_TEST_DATA "/fuzz/corpus/") + target.name)) {
            std::ifstream file(entry.path(), std::ios::binary);
            const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
            EXPECT_EQ(target.check(bytes), "") << entry.path();
            ++files;
        }
        EXPECT_GE(files, 8) << target.name;
    }
}

TEST(ConvexFuzz, RandomBytesShowNoFault) {
    for (const Target& target : kTargets) {
        Random random(0xc0f022);
        for (int i = 0; i < target.inputs; ++i) {
            const auto bytes = test::random_bytes(random, 200);
            ASSERT_EQ(target.check(bytes), "") << target.name << " " << i;
        }
    }
}

}  // namespace
}  // namespace carom
