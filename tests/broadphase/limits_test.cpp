// Worst cases: more pairs than memory holds, everything in one cell, everything on one axis, sizes over six decades.
#include "broadphase/distributions.hpp"

#include <carom/broadphase/broadphase.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace carom {
namespace {

std::vector<std::uint32_t> all_slots(std::size_t n) {
    std::vector<std::uint32_t> slots(n);
    std::iota(slots.begin(), slots.end(), 0u);
    return slots;
}

TEST(PairLimit, KeepsTheSameFirstPairsWhateverTheMethod) {
    SerialExecutor executor;
    const std::size_t n = 500;
    auto boxes = test::random_boxes(test::Distribution::Clustered, n, 21);
    const auto filters = test::random_filters(n, 22);
    const auto slots = all_slots(n);
    const auto all = test::all_pairs(boxes, filters);
    ASSERT_GT(all.size(), 500u);
    const std::vector<ProxyPair> first(all.begin(), all.begin() + 400);
    for (const BroadphaseMethod method : kBroadphaseMethods) {
        SCOPED_TRACE(to_string(method));
        Broadphase broadphase({.method = method, .pair_limit = 400});
        const PairUpdate& found = broadphase.update({boxes, filters, slots, {}}, executor);
        EXPECT_EQ(found.status, PairStatus::LimitReached);
        EXPECT_TRUE(std::equal(found.pairs.begin(), found.pairs.end(), first.begin(), first.end()));
        EXPECT_EQ(found.complete_below, all[400].a);

        // Fewer boxes, and all is well again; then the limit is reached by a few at a time.
        const auto upper_half = std::span(slots).subspan(100);
        EXPECT_EQ(broadphase.update({boxes, filters, {}, upper_half}, executor).status, PairStatus::Complete);
        EXPECT_EQ(found.ended.size() + found.pairs.size(), 400u);
        PairStatus status = PairStatus::Complete;
        for (std::size_t k = 100; k < n; k += 8) {
            status = broadphase.update({boxes, filters, std::span(slots).subspan(k, 8), {}}, executor).status;
            ASSERT_LE(found.pairs.size(), 400u);
        }
        EXPECT_EQ(status, PairStatus::LimitReached);
        EXPECT_TRUE(std::equal(found.pairs.begin(), found.pairs.end(), first.begin(), first.end()));
    }
}

// Case: a hundred thousand coincident boxes, five thousand million pairs.
TEST(PairLimit, HoldsMemoryInBoundsForCoincidentBoxes) {
    SerialExecutor executor;
    const std::size_t n = 100000, limit = 1000000;
    const std::vector<FloatAabb> boxes(n, {vec3{1.0f}, vec3{2.0f}});
    const std::vector<ProxyFilter> filters(n);
    Broadphase broadphase({.pair_limit = limit});
    const PairUpdate& found = broadphase.update({boxes, filters, all_slots(n), {}}, executor);
    EXPECT_EQ(found.status, PairStatus::LimitReached);
    ASSERT_EQ(found.pairs.size(), limit);
    EXPECT_EQ(found.complete_below, 10u);  // ten rows of nearly a hundred thousand, then the limit
    EXPECT_EQ(found.pairs.back(), (ProxyPair{10, 65}));
    EXPECT_LT(broadphase.memory(), 400u * n + 100u * limit);

    std::size_t rows = 0, pairs = 0;
    broadphase.stream_pairs([&](std::span<const ProxyPair> row) {
        pairs += row.size();
        return ++rows < 20;
    });
    EXPECT_EQ(rows, 20u);
    EXPECT_EQ(pairs, 20u * (n - 1) - 190u);
}

TEST(StreamPairs, GivesEveryPairInOrder) {
    SerialExecutor executor;
    const auto boxes = test::random_boxes(test::Distribution::Mixed, 300, 4);
    const auto filters = test::random_filters(300, 5);
    for (const BroadphaseMethod method : kBroadphaseMethods) {
        Broadphase broadphase({.method = method});
        broadphase.stream_pairs([](std::span<const ProxyPair>) { return ADD_FAILURE(), true; });
        broadphase.update({boxes, filters, all_slots(300), {}}, executor);
        std::vector<ProxyPair> streamed;
        broadphase.stream_pairs([&](std::span<const ProxyPair> row) {
            streamed.insert(streamed.end(), row.begin(), row.end());
            return true;
        });
        EXPECT_EQ(streamed, test::all_pairs(boxes, filters)) << to_string(method);
    }
}

// Cases: everything overlaps on one axis; size ratio a million; one cell for all but one box. None of these is quadratic, which would
// take minutes here.
TEST(WorstCases, AreFoundByTheChosenMethodInLinearMemory) {
    SerialExecutor executor;
    const std::size_t n = 50000;
    const std::vector<ProxyFilter> filters(n);
    const auto slots = all_slots(n);
    for (const int scene : {0, 1, 2}) {
        SCOPED_TRACE(scene);
        Random random(static_cast<std::uint64_t>(scene));
        std::vector<FloatAabb> boxes(n);
        for (std::size_t i = 0; i < n; ++i) {
            const auto row = static_cast<double>(i % 316), column = static_cast<double>(i / 316);
            if (scene == 0) boxes[i] = test::box_about({random.range(-0.1, 0.1), 1.1 * row, 1.1 * column}, dvec3{0.5});
            if (scene == 1) boxes[i] = test::box_about({row, random.range(0, 100), column}, dvec3{i % 10000 == 0 ? 1e3 : 1e-3});
            if (scene == 2) boxes[i] = test::box_about(1e-3 * dvec3{row, 0.0, column}, dvec3{4e-4});
        }
        if (scene == 2) boxes[7] = test::box_about({1e6, 1e6, 1e6}, dvec3{1.0});
        Broadphase broadphase;
        const PairUpdate& found = broadphase.update({boxes, filters, slots, {}}, executor);
        Broadphase other({.method = BroadphaseMethod::DynamicTree});
        const PairUpdate& want = other.update({boxes, filters, slots, {}}, executor);
        EXPECT_EQ(found.status, PairStatus::Complete);
        EXPECT_TRUE(std::equal(found.pairs.begin(), found.pairs.end(), want.pairs.begin(), want.pairs.end()));
        EXPECT_LT(broadphase.memory(), 600u * n + 64u * found.pairs.size());
    }
}

// Case: a million boxes that one far away would have share a cell. They stand in a square of 1000 by 1000, so their pairs can be counted.
TEST(WorstCases, AMillionBoxesInOneCellAreFoundInLinearMemory) {
    SerialExecutor executor;
    constexpr std::size_t kRow = 1000, n = kRow * kRow + 1;
    std::vector<FloatAabb> boxes;
    for (std::size_t i = 0; i + 1 < n; ++i) {
        const dvec3 lower{static_cast<double>(i % kRow), 0.0, static_cast<double>(i / kRow)};
        boxes.push_back({vec3(lower), vec3(lower + 1.25)});  // overlaps the neighbours, at the corners too
    }
    boxes.push_back({vec3{1e9f}, vec3{1.1e9f}});
    const std::vector<ProxyFilter> filters(n);
    Broadphase broadphase;
    const PairUpdate& found = broadphase.update({boxes, filters, all_slots(n), {}}, executor);
    EXPECT_EQ(found.pairs.size(), 2 * kRow * (kRow - 1) + 2 * (kRow - 1) * (kRow - 1));
    EXPECT_LT(broadphase.memory(), 400 * n);
    EXPECT_TRUE(std::all_of(found.pairs.begin(), found.pairs.end(),
                            [&](const ProxyPair& pair) { return pair.a < pair.b && overlaps(boxes[pair.a], boxes[pair.b]); }));
    EXPECT_TRUE(std::is_sorted(found.pairs.begin(), found.pairs.end()));
}

// Case: everything overlaps on one axis. Sorting along that axis alone would find all pairs of boxes, so neither axes nor a
// single sweep may be the choice.
TEST(WorstCases, ASheetOfBoxesIsNotSortedAlongItsThinAxis) {
    std::vector<FloatAabb> sheet;
    Random random(40);
    for (int i = 0; i < 100000; ++i) {
        sheet.push_back(test::box_about({random.range(-0.1, 0.1), 1.1 * (i % 316), 1.1 * (i / 316)}, dvec3{0.5}));
    }
    SerialExecutor executor;
    const std::vector<ProxyFilter> filters(sheet.size());
    Broadphase broadphase;
    const PairUpdate& found = broadphase.update({sheet, filters, all_slots(sheet.size()), {}}, executor);
    EXPECT_EQ(broadphase.method(), BroadphaseMethod::UniformGrid) << broadphase.reason();
    EXPECT_TRUE(found.pairs.empty());
}

// Case: a stack 1e6 and 1e7 m from the origin has the pairs that it has at the origin, as boxes are relative to a double origin.
TEST(FarAway, AStackHasNoMorePairs) {
    SerialExecutor executor;
    const auto pairs_at = [&](const dvec3& origin) {
        std::vector<FloatAabb> boxes;
        for (int i = 0; i < 200; ++i) {
            const dvec3 lower = origin + dvec3{1.01 * (i % 5), 0.999 * (i / 5), 0.0};  // neighbours in a row are 1 cm apart
            boxes.push_back(round_outward({lower, lower + 1.0}, origin));
        }
        const std::vector<ProxyFilter> filters(boxes.size());
        Broadphase broadphase;
        return broadphase.update({boxes, filters, all_slots(boxes.size()), {}}, executor).pairs.size();
    };
    const std::size_t here = pairs_at(dvec3{0.0});
    EXPECT_EQ(here, 5u * 39u);
    for (const double far : {1e6, 1e7}) {
        EXPECT_GE(pairs_at({far, -far, far}), here);
        EXPECT_LE(pairs_at({far, -far, far}), here + here / 10);
    }
}

}  // namespace
}  // namespace carom
