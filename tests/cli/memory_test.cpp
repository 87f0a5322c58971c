// What `carom run` says of memory.
#include <cli/program.hpp>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <string>

namespace carom::test {
namespace {

using Json = nlohmann::json;

constexpr double kNarrowphase = 250'000;  // [bytes], its own

/// @return `memory` of a pile of so many boxes.
Json memory_of(const std::string& bodies, const std::string& steps = "3") {
    const Outcome outcome = carom({"run", "pile_boxes", "--bodies", bodies, "--steps", steps, "--peak-every", "0", "--json", "-"});
    const Json json = Json::parse(outcome.out, nullptr, false);
    EXPECT_TRUE(json.is_object()) << outcome.err;
    return json.at("memory");
}
Json bytes_of(const std::string& bodies, const std::string& steps = "3") { return memory_of(bodies, steps).at("world_bytes"); }

// A thousand bodies more take something between half a kilobyte and ten each.
TEST(CliMemory, IsWhatTheBodiesTake) {
    const Json few = bytes_of("1000"), many = bytes_of("2000");
    if (few.is_null()) GTEST_SKIP() << "the C library does not say";
    const double each = (many.get<double>() - few.get<double>()) / 1000.0;
    EXPECT_GT(each, 500.0);
    EXPECT_LT(each, 10'000.0);
}

// docs/performance.md has the figure. What is in the air and hits the ground has twice as many contacts as what lies.
TEST(CliMemory, OfASettledPileIsWhatThePageSays) {
    const Json memory = memory_of("1000", "600"), again = memory_of("1000", "600");
    if (memory.at("world_bytes").is_null()) GTEST_SKIP() << "the C library does not say";
    const double bytes = memory.at("world_bytes").get<double>();
    EXPECT_LT(bytes / 1000.0, 2'700.0);
    EXPECT_GT(bytes / 1000.0, 2'000.0);
    EXPECT_EQ(memory.at("parts"), again.at("parts")) << "the same run takes the same memory";
    // What malloc adds to blocks that are to be aligned hangs on where they come to lie: some 2,000 bytes.
    EXPECT_NEAR(again.at("world_bytes").get<double>(), bytes, 1e-2 * bytes);
}

// What malloc gave out for the world and its scene is what the parts add up to, but for what it adds to each list and what the narrowphase holds.
TEST(CliMemory, ThePartsAreTheWhole) {
    for (const char* steps : {"3", "150"}) {
        const Json memory = memory_of("1000", steps);
        if (memory.at("world_bytes").is_null()) GTEST_SKIP() << "the C library does not say";
        double sum = 0.0;
        for (const Json& part : memory.at("parts")) sum += part.get<double>();
        EXPECT_LT(sum, memory.at("world_bytes").get<double>()) << steps;
        EXPECT_GT(sum, 0.96 * memory.at("world_bytes").get<double>() - kNarrowphase) << steps;
        EXPECT_EQ(memory.at("parts").at("joints"), 0) << steps;
        for (const char* part : {"bodies", "shapes", "broadphase"})
            EXPECT_GT(memory.at("parts").at(part), 100'000) << part << ", " << steps;
        for (const char* part : {"contacts", "solver", "scratch"})
            EXPECT_EQ(memory.at("parts").at(part) > 100'000, steps != std::string("3")) << part;  // in the air at first
    }
}

}  // namespace
}  // namespace carom::test
