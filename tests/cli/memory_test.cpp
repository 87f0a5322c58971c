// What `carom run` says of memory.
#include <cli/program.hpp>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <string>

namespace carom::test {
namespace {

using Json = nlohmann::json;

/// @return memory.world_bytes of a pile of so many boxes.
Json bytes_of(const std::string& bodies, const std::string& steps = "3") {
    const Outcome outcome = carom({"run", "pile_boxes", "--bodies", bodies, "--steps", steps, "--peak-every", "0", "--json", "-"});
    const Json json = Json::parse(outcome.out, nullptr, false);
    EXPECT_TRUE(json.is_object()) << outcome.err;
    return json.at("memory").at("world_bytes");
}

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
    const Json bytes = bytes_of("1000", "450");
    if (bytes.is_null()) GTEST_SKIP() << "the C library does not say";
    const double each = bytes.get<double>() / 1000.0;
    EXPECT_LT(each, 4'100.0);
    EXPECT_GT(each, 2'400.0);
    EXPECT_EQ(bytes, bytes_of("1000", "450")) << "the same run takes the same memory";
}

}  // namespace
}  // namespace carom::test
