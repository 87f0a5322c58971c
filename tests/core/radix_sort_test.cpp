#include <carom/core/radix_sort.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace carom {
namespace {

std::uint64_t bits64(Random& random) {
    return (static_cast<std::uint64_t>(random.unit() * 0x1p32) << 32) | static_cast<std::uint64_t>(random.unit() * 0x1p32);
}

TEST(RadixSort, IsAStableSort) {
    Random random(0x5a);
    RadixScratch scratch;
    // Masks make ties, constant bytes in every place, and odd and even numbers of passes.
    for (const std::uint64_t mask : {~std::uint64_t{0}, std::uint64_t{0xff}, std::uint64_t{0x3}, std::uint64_t{0},
                                     std::uint64_t{0x00ff00ff00000000}, std::uint64_t{0xff00000000000000},
                                     std::uint64_t{0x000000ff00ff00ff}}) {
        for (const std::size_t n : {0u, 1u, 2u, 3u, 255u, 1000u, 20000u, 17u}) {
            std::vector<std::uint64_t> keys(n);
            for (auto& key : keys) key = bits64(random) & mask;
            std::vector<std::uint32_t> payload(n);
            std::iota(payload.begin(), payload.end(), 0u);
            std::vector<std::uint32_t> want = payload;
            std::stable_sort(want.begin(), want.end(), [&](auto a, auto b) { return keys[a] < keys[b]; });
            const std::vector<std::uint64_t> before = keys;
            radix_sort(keys, payload, scratch);
            ASSERT_EQ(payload, want) << "mask " << mask << ", " << n << " keys";
            for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(keys[i], before[want[i]]);
        }
    }
}

TEST(RadixSort, KeepsItsScratch) {
    Random random(0x5b);
    RadixScratch scratch;
    std::vector<std::uint64_t> keys(500);
    std::vector<std::uint32_t> payload(500);
    for (auto& key : keys) key = bits64(random);
    radix_sort(keys, payload, scratch);
    const auto* memory = scratch.keys.data();
    for (auto& key : keys) key = bits64(random);
    radix_sort(std::span(keys).first(400), std::span(payload).first(400), scratch);
    EXPECT_EQ(scratch.keys.data(), memory);
    EXPECT_TRUE(std::is_sorted(keys.begin(), keys.begin() + 400));
}

TEST(RadixSort, SizesThatDifferAreMisuseAndChangeNothing) {
    std::vector<std::uint64_t> keys{3, 2, 1};
    std::vector<std::uint32_t> payload{0, 1};
    RadixScratch scratch;
    EXPECT_THROW(radix_sort(keys, payload, scratch), MisuseError);
    EXPECT_EQ(keys, (std::vector<std::uint64_t>{3, 2, 1}));
}

TEST(OrderedKey, SortsAsFloatsDo) {
    const float infinity = std::numeric_limits<float>::infinity();
    std::vector<float> ascending{-infinity, -0x1.fffffep127f, -1.0f, -0x1p-126f, -0x1p-149f, -0.0f, 0.0f, 0x1p-149f, 0x1p-126f,
                                 0.5f, 1.0f, 0x1.fffffep127f, infinity};
    for (std::size_t i = 1; i < ascending.size(); ++i) EXPECT_LT(ordered_key(ascending[i - 1]), ordered_key(ascending[i]));
    Random random(0x0de);
    for (int i = 0; i < 10000; ++i) {
        const auto a = static_cast<float>(random.range(-1.0, 1.0)), b = static_cast<float>(random.range(-1.0, 1.0));
        EXPECT_EQ(a < b, ordered_key(a) < ordered_key(b));
    }
}

}  // namespace
}  // namespace carom
