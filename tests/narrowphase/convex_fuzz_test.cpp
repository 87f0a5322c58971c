// The checks of the fuzzers gjk, epa and sat over their corpora and over pseudo-random bytes.
#include <fuzz/convex_check.hpp>
#include <support/query_cases.hpp>

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace carom {
namespace {

using Check = std::string (*)(std::span<const std::uint8_t>);
struct Target {
    const char* name;
    Check check;
    int inputs;
};
constexpr Target kTargets[] = {{"gjk", test::gjk_fault, 60}, {"epa", test::epa_fault, 50}, {"sat", test::sat_fault, 60}};

std::vector<std::vector<std::uint8_t>> corpus_of(const Target& target) {
    std::vector<std::vector<std::uint8_t>> inputs;
    for (const auto& entry : std::filesystem::directory_iterator(std::string(CAROM_TEST_DATA "/fuzz/corpus/") + target.name)) {
        std::ifstream file(entry.path(), std::ios::binary);
        inputs.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
    return inputs;
}

TEST(ConvexFuzz, TheCorporaHoldNoFault) {
    for (const Target& target : kTargets) {
        for (const auto& bytes : corpus_of(target)) EXPECT_EQ(target.check(bytes), "") << target.name;
    }
}

// An input that is refused at once teaches a fuzzer nothing.
TEST(ConvexFuzz, TheCorporaReachTheOracleInEveryStyle) {
    for (const Target& target : kTargets) {
        std::array<int, 3> judged{};
        for (const auto& bytes : corpus_of(target)) {
            std::string fault;
            const bool boxes = std::string(target.name) == "sat";
            if (test::draw_pair(bytes, boxes, fault)) ++judged[static_cast<std::size_t>(test::RawBytes::style_of(bytes))];
        }
        for (const int count : judged) EXPECT_GE(count, 4) << target.name;
    }
}

// A face of four corners or more of a hull is flat to rounding only: by it the box would be 7e-6 m off the hull that it is in.
TEST(ConvexFuzz, TheOracleTakesAHullForItsCornersNotItsFaces) {
    const std::vector<vec3> corners{{1.23921585f, 1.23921585f, 1.23921585f},    {1.24019241f, 1.23921585f, 1.23921585f},
                                    {-1.23921585f, -1.23921585f, -108.980438f}, {-15.0000153f, -6.50882721e-05f, -0.00048828125f},
                                    {-31.1250019f, -85.141983f, -96.9987488f},  {-13.4645109f, -3.05175781e-05f, -3.05175781e-05f}};
    const ConvexHullPtr hull = test::hull_of(corners);
    ASSERT_NE(hull, nullptr);
    ASSERT_EQ(hull->vertices().size(), 6u);
    const exact::Solid solid = exact::solid(Shape(hull), Pose{});
    // Inside of what its corners span, and where distance() finds a tetrahedron round it.
    const Pose pose{{-0.00083356693524935701, 0.079675240957605614, -0.06978426624764715}};
    const exact::Solid box = exact::solid(Shape(Box{vec3(3.05175781e-05f)}), pose);
    EXPECT_EQ(exact::core_distance_sq(solid, box), exact::Rational(0));
    for (const exact::Vec& corner : solid.corners) EXPECT_EQ(exact::core_distance_sq(corner, solid), exact::Rational(0));
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
