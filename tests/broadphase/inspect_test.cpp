// What a method shows of itself: cells hold every box once, nodes hold their boxes, ends are sorted.
#include "broadphase/crowd.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace carom {
namespace {

class Inspect : public ::testing::TestWithParam<BroadphaseMethod> {};

TEST_P(Inspect, PartsCountEveryBoxOnceAndEndsAreSorted) {
    using enum BroadphaseMethod;
    SerialExecutor executor;
    const BroadphaseMethod method = GetParam();
    for (const test::Distribution kind : {test::Distribution::Uniform, test::Distribution::Clustered, test::Distribution::Mixed}) {
        test::Crowd crowd(kind, 300, 7, false);
        Broadphase broadphase({.method = method});
        broadphase.visit_parts([](const BroadphasePart&) { ADD_FAILURE() << "there is nothing yet"; });
        broadphase.visit_ends([](const BroadphaseEnd&) { ADD_FAILURE() << "there is nothing yet"; });
        Random random(8);
        for (int frame = 0; frame < 5; ++frame) {
            ASSERT_NO_FATAL_FAILURE(crowd.check(broadphase, executor));
            std::size_t boxes = 0, parts = 0;
            int deepest = 0;
            broadphase.visit_parts([&](const BroadphasePart& part) {
                ++parts;
                boxes += part.count;
                deepest = std::max(deepest, part.level);
                EXPECT_TRUE(part.box.lower.x <= part.box.upper.x && part.box.lower.y <= part.box.upper.y);
                if (method != DynamicTree) {
                    EXPECT_GT(part.count, 0u);
                }
            });
            const bool has_parts = method == UniformGrid || method == HierarchicalGrid || method == DynamicTree;
            EXPECT_EQ(boxes, has_parts ? broadphase.live_count() : 0u);
            EXPECT_EQ(parts > 0, has_parts);
            if (method == DynamicTree) {
                EXPECT_EQ(parts, 2 * boxes - 1);
                EXPECT_GE(deepest, 8);
            }
            std::size_t ends = 0, uppers = 0;
            BroadphaseEnd before;
            broadphase.visit_ends([&](const BroadphaseEnd& end) {
                if (ends++ != 0 && end.axis == before.axis) {
                    EXPECT_LE(before.value, end.value);
                }
                uppers += end.is_upper;
                const FloatAabb box = broadphase.box(end.slot);
                EXPECT_EQ(end.value, end.is_upper ? box.upper[end.axis] : box.lower[end.axis]);
                before = end;
            });
            const std::size_t n = broadphase.live_count();
            EXPECT_EQ(ends, method == SortedAxes ? 6 * n : (method == SweepAndPrune ? n : 0u));
            EXPECT_EQ(uppers, method == SortedAxes ? 3 * n : 0u);
            crowd.change(random, 0.1, 0.05);
        }
    }
}

TEST(Inspecting, StraysOfAGridShowThemselves) {
    constexpr std::uint32_t kBoxes = 1000, kGather = 30;
    SerialExecutor executor;
    for (const BroadphaseMethod method : {BroadphaseMethod::UniformGrid, BroadphaseMethod::HierarchicalGrid}) {
        Broadphase broadphase({.method = method});
        std::vector<FloatAabb> boxes;
        std::vector<std::uint32_t> moved;
        for (std::uint32_t i = 0; i < kBoxes; ++i) {
            const vec3 at{2.0f * static_cast<float>(i % 10), 2.0f * static_cast<float>(i / 10 % 10), 2.0f * static_cast<float>(i / 100)};
            boxes.push_back({at, at + vec3{1.0f}});
            moved.push_back(i);
        }
        const std::vector<ProxyFilter> filters(kBoxes);
        broadphase.update({boxes, filters, moved, {}}, executor);
        moved.resize(kGather);
        boxes[0].upper.x += 0.5f;
        broadphase.update({boxes, filters, {moved.data(), 1}, {}}, executor);  // the first that moves few boxes makes room in the cells
        broadphase.visit_parts([](const BroadphasePart& part) { EXPECT_FALSE(part.is_stray); });
        for (const std::uint32_t i : moved) {
            const vec3 at = vec3{9.0f} + 0.01f * static_cast<float>(i);
            boxes[i] = {at, at + vec3{1.0f}};
        }
        broadphase.update({boxes, filters, moved, {}}, executor);
        std::size_t strays = 0, all = 0;
        broadphase.visit_parts([&](const BroadphasePart& part) {
            all += part.count;
            if (!part.is_stray) return;
            ++strays;
            EXPECT_EQ(part.count, 1u);
            EXPECT_EQ(std::count(boxes.begin(), boxes.begin() + kGather, part.box), 1) << "one of those that gathered in a cell";
        });
        EXPECT_GT(strays, 4u);
        EXPECT_EQ(all, kBoxes);
    }
}

INSTANTIATE_TEST_SUITE_P(All, Inspect, ::testing::ValuesIn(kBroadphaseMethods),
                         [](const auto& tested) { return std::string(to_string(tested.param)); });

}  // namespace
}  // namespace carom
