// Once warm, an update asks the system for no memory; and what it holds is what docs/broadphase.md states.
#include "broadphase/distributions.hpp"

#include <carom/broadphase/broadphase.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>
#include <support/count_allocations.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

namespace carom {
namespace {

TEST(Allocation, StopsOnceWarm) {
    SerialExecutor executor;
    for (const BroadphaseMethod method : kBroadphaseMethods) {
        for (const std::size_t share : {1u, 20u}) {  // one in so many moves
            Broadphase broadphase({.method = method});
            auto boxes = test::random_boxes(test::Distribution::Stacked, 1000, 3);
            const std::vector<ProxyFilter> filters(boxes.size());
            std::vector<std::uint32_t> moved(boxes.size());
            for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = static_cast<std::uint32_t>(i);
            broadphase.update({boxes, filters, moved, {}}, executor);
            std::erase_if(moved, [&](std::uint32_t i) { return i % share != 0; });
            int frames = 0;
            const auto jiggle = [&] {  // there and back
                const vec3 by(frames++ % 2 == 0 ? 0.02f : -0.02f);
                for (const std::uint32_t i : moved) {
                    boxes[i].lower += by;
                    boxes[i].upper += by;
                }
                return broadphase.update({boxes, filters, moved, {}}, executor).pairs.size();
            };
            for (int frame = 0; frame < 40; ++frame) jiggle();
            const long before = test::allocations();
            std::size_t pairs = 0;
            for (int frame = 0; frame < 20; ++frame) pairs += jiggle();
            EXPECT_EQ(test::allocations(), before) << to_string(method) << ", one in " << share;
            EXPECT_GT(pairs, 0u);
        }
    }
}

// Boxes in a crowd, of which most part: the lists of pairs were long once, and are given back.
TEST(Allocation, GivesBackWhatACrowdTook) {
    SerialExecutor executor;
    for (const BroadphaseMethod method : kBroadphaseMethods) {
        constexpr std::size_t kCount = 2000;
        Random random(23);
        std::vector<FloatAabb> boxes;
        std::vector<std::uint32_t> moved;
        for (std::uint32_t i = 0; i < kCount; ++i) {
            const vec3 at{dvec3{random.range(0, 9), random.range(0, 9), random.range(0, 9)}};
            boxes.push_back({at, at + vec3{1.0f}});
            moved.push_back(i);
        }
        const std::vector<ProxyFilter> filters(kCount);
        Broadphase broadphase({.method = method});
        const long before = test::bytes_held();
        const std::size_t crowded = broadphase.update({boxes, filters, moved, {}}, executor).pairs.size();
        broadphase.update({boxes, filters, moved, {}}, executor);
        const long most = test::bytes_held() - before;
        for (FloatAabb& box : boxes) box = {3.0f * box.lower, 3.0f * box.lower + vec3{1.0f}};
        Broadphase fresh({.method = method});
        const PairUpdate& want = fresh.update({boxes, filters, moved, {}}, executor);
        const long least = test::bytes_held();
        for (int k = 0; k < 130; ++k) {
            const PairUpdate& found = broadphase.update({boxes, filters, moved, {}}, executor);
            ASSERT_TRUE(std::ranges::equal(found.pairs, want.pairs)) << to_string(method) << ", update " << k;
            ASSERT_EQ(found.ended.empty(), k > 0) << to_string(method) << ", update " << k;
        }
        ASSERT_LT(4 * want.pairs.size(), crowded);
        const long given_back = least - test::bytes_held();
        EXPECT_GT(given_back, static_cast<long>(3 * sizeof(ProxyPair) * crowded)) << to_string(method) << " of " << most;
    }
}

// Who does not ask what began and ended gets the same pairs for fewer lists; and what has come to rest needs no lists for all pairs to be found anew.
TEST(Allocation, ListsThatNobodyAsksForTakeNothing) {
    SerialExecutor executor;
    for (const BroadphaseMethod method : kBroadphaseMethods) {
        constexpr std::size_t kCount = 3000;
        auto boxes = test::random_boxes(test::Distribution::Stacked, kCount, 5);
        const std::vector<ProxyFilter> filters(kCount);
        std::vector<std::uint32_t> moved(kCount);
        for (std::uint32_t i = 0; i < kCount; ++i) moved[i] = i;
        Broadphase full({.method = method}), brief({.method = method, .lists_changes = false});
        const auto update = [&](int step) {
            for (const std::uint32_t i : moved) boxes[i] = {boxes[i].lower + vec3(step % 2 == 0 ? 0.02f : -0.02f), boxes[i].upper + vec3(step % 2 == 0 ? 0.02f : -0.02f)};
            const PairUpdate &all = full.update({boxes, filters, moved, {}}, executor), &found = brief.update({boxes, filters, moved, {}}, executor);
            ASSERT_TRUE(std::ranges::equal(found.pairs, all.pairs)) << to_string(method) << ", update " << step;
            ASSERT_TRUE(found.begun.empty() && found.ended.empty()) << to_string(method);
            ASSERT_EQ(found.number, all.number);
        };
        for (int step = 0; step < 20; ++step) update(step);
        const std::size_t pairs = full.result().pairs.size(), moving = brief.memory();
        EXPECT_GE(full.memory(), moving + 2 * sizeof(ProxyPair) * pairs) << to_string(method);
        moved.resize(3);
        for (int step = 0; step < 5; ++step) update(step);
        const std::size_t before = brief.memory();  // with room for boxes that move in place, and the lists for all pairs still
        for (int step = 5; step < 135; ++step) update(step);
        if (method == BroadphaseMethod::UniformGrid || method == BroadphaseMethod::HierarchicalGrid) {
            EXPECT_LE(brief.memory() + (sizeof(std::uint32_t) + sizeof(ProxyPair)) * pairs, before) << to_string(method);
        }
    }
}

/// For each box.
struct Held {
    double bytes = 0.0;     ///< that operator new gave out and did not take back
    double reported = 0.0;  ///< by Broadphase::memory
    double pairs = 0.0;
};

/// Unit cubes at random places, so close that one overlaps `mates` others on the mean; one in a hundred moves for some updates.
Held hold(BroadphaseMethod method, std::size_t count, double mates) {
    SerialExecutor executor;
    Random random(17);
    const double side = std::cbrt(8.0 * static_cast<double>(count) / mates);
    std::vector<FloatAabb> boxes;
    std::vector<std::uint32_t> moved;
    for (std::uint32_t i = 0; i < count; ++i) {
        const vec3 at{dvec3{random.range(0, side), random.range(0, side), random.range(0, side)}};
        boxes.push_back({at, at + vec3{1.0f}});
        moved.push_back(i);
    }
    const std::vector<ProxyFilter> filters(count);
    const long before = test::bytes_held();
    Broadphase broadphase({.method = method});
    broadphase.update({boxes, filters, moved, {}}, executor);
    std::erase_if(moved, [](std::uint32_t i) { return i % 100 != 0; });
    for (int frame = 0; frame < 8; ++frame) {
        for (const std::uint32_t i : moved) {
            const vec3 by(frame % 2 == 0 ? 0.05f : -0.05f);
            boxes[i] = {boxes[i].lower + by, boxes[i].upper + by};
        }
        broadphase.update({boxes, filters, moved, {}}, executor);
    }
    const auto n = static_cast<double>(count);
    return {static_cast<double>(test::bytes_held() - before) / n, static_cast<double>(broadphase.memory()) / n,
            static_cast<double>(broadphase.result().pairs.size()) / n};
}

/// The row of the method in the table of docs/broadphase.md: bytes for a box, and for a pair.
std::array<double, 2> stated_bytes(BroadphaseMethod method) {
    std::ifstream page(std::string(CAROM_TEST_DATA) + "/../docs/broadphase.md");
    const std::string row = std::string("| `") + to_string(method) + "` | ";
    for (std::string line; std::getline(page, line);) {
        std::array<double, 2> bytes{};
        if (line.starts_with(row) && std::sscanf(line.c_str() + row.size(), "%lf | %lf |", &bytes[0], &bytes[1]) == 2) return bytes;
    }
    return {};
}

TEST(Allocation, HoldsAsManyBytesAsThePageSays) {
    for (const BroadphaseMethod method : kBroadphaseMethods) {
        const auto [box, pair] = stated_bytes(method);
        ASSERT_GT(box * pair, 0.0) << to_string(method) << " has no row in the table";
        for (const std::size_t count : {3000u, 12000u}) {
            for (const double mates : {0.01, 6.0, 40.0}) {
                const Held held = hold(method, count, mates);
                const double stated = box + pair * held.pairs;
                EXPECT_LE(held.bytes, stated) << to_string(method) << ", " << count << " boxes, " << held.pairs << " pairs each";
                EXPECT_GE(held.bytes, stated / 1.5) << to_string(method) << ", " << count << " boxes, " << held.pairs << " pairs each";
                EXPECT_NEAR(held.reported, held.bytes, 0.05 * held.bytes) << to_string(method) << ", " << count << " boxes";
            }
        }
    }
}

}  // namespace
}  // namespace carom
