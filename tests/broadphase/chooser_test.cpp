// The chooser: which method for which scene, no flicker near thresholds, and the same pairs whatever it takes.
#include "broadphase/crowd.hpp"

#include <carom/broadphase/chooser.hpp>

#include <gtest/gtest.h>

namespace carom {
namespace {

SceneStatistics measure_all(const std::vector<FloatAabb>& boxes, double moving) {
    return measure(boxes, std::vector<unsigned char>(boxes.size(), 1), moving);
}

std::vector<FloatAabb> spread(std::size_t n, double side, double half) {
    Random random(3);
    std::vector<FloatAabb> boxes;
    for (std::size_t i = 0; i < n; ++i) {
        boxes.push_back(test::box_about({random.range(0, side), random.range(0, side), random.range(0, side)}, dvec3{half}));
    }
    return boxes;
}

TEST(Chooser, CountsWhatIsThere) {
    auto boxes = spread(1000, 30, 0.5);
    boxes[17] = test::box_about({0, 0, 0}, {40, 1, 40});
    const SceneStatistics scene = measure_all(boxes, 0.5);
    EXPECT_EQ(scene.count, 1000u);
    EXPECT_NEAR(scene.median_size, 1.0, 0.2);
    EXPECT_NEAR(scene.p99_size, 1.0, 0.2);
    EXPECT_EQ(scene.largest_size, 80.0);
    EXPECT_EQ(scene.spread_axes, 3);
    EXPECT_GT(scene.fill, 0.9);
    EXPECT_EQ(measure({}, {}, 1.0).count, 0u);
    const std::vector<FloatAabb> points(9, FloatAabb{});
    EXPECT_EQ(measure_all(points, 1.0).line_density, 9.0);
}

TEST(Chooser, TakesNoNoticeOfAFewBoxesFarAway) {
    auto boxes = spread(3000, 30, 0.5);
    const SceneStatistics before = measure_all(boxes, 0.5);
    boxes[5] = test::box_about({1e9, -1e9, 1e9}, {0.5, 0.5, 0.5});
    const SceneStatistics after = measure_all(boxes, 0.5);
    EXPECT_NEAR(after.fill, before.fill, 0.02);
    EXPECT_NEAR(after.line_density, before.line_density, 0.02 * before.line_density);
    EXPECT_NEAR(after.largest_crowd, before.largest_crowd, 0.1 * before.largest_crowd);
    // But where it is large, cells of its size would hold everything.
    boxes[5] = test::box_about({1e9, -1e9, 1e9}, dvec3{1e8});
    EXPECT_EQ(measure_all(boxes, 0.5).largest_crowd, 3000.0);
    EXPECT_EQ(choose_method(measure_all(boxes, 0.5), BroadphaseMethod::UniformGrid).method, BroadphaseMethod::HierarchicalGrid);
}

// Each rule on either side of its threshold, for a scene that has no method yet (brute force) and for one that has the other one.
TEST(Chooser, EveryThresholdIsWhereThePageSays) {
    using enum BroadphaseMethod;
    const SceneStatistics plain{.count = 5000,
                                .median_size = 1.0,
                                .p99_size = 1.5,
                                .largest_size = 1.5,
                                .largest_crowd = 2.0,
                                .line_density = 100.0,
                                .spread_axes = 3,
                                .fill = 1.0,
                                .moving_share = 0.1};
    const auto with = [&](auto change, BroadphaseMethod current) {
        SceneStatistics s = plain;
        change(s);
        return choose_method(s, current).method;
    };
    EXPECT_EQ(with([](SceneStatistics&) {}, UniformGrid), UniformGrid);
    EXPECT_EQ(with([](SceneStatistics& s) { s.count = 500; }, UniformGrid), BruteForce);
    EXPECT_EQ(with([](SceneStatistics& s) { s.count = 501; }, UniformGrid), UniformGrid);
    EXPECT_EQ(with([](SceneStatistics& s) { s.count = 250, s.moving_share = 0.26; }, UniformGrid), BruteForce);
    EXPECT_EQ(with([](SceneStatistics& s) { s.count = 251, s.moving_share = 0.26; }, UniformGrid), UniformGrid);
    EXPECT_EQ(with([](SceneStatistics& s) { s.count = 500, s.moving_share = 0.24; }, UniformGrid), BruteForce);
    EXPECT_EQ(with([](SceneStatistics& s) { s.count = 625; }, BruteForce), BruteForce);
    EXPECT_EQ(with([](SceneStatistics& s) { s.count = 626; }, BruteForce), UniformGrid);
    EXPECT_EQ(with([](SceneStatistics& s) { s.line_density = 39.0; }, UniformGrid), SortedAxes);
    EXPECT_EQ(with([](SceneStatistics& s) { s.line_density = 41.0; }, UniformGrid), UniformGrid);
    EXPECT_EQ(with([](SceneStatistics& s) { s.line_density = 49.0; }, SortedAxes), SortedAxes);
    EXPECT_EQ(with([](SceneStatistics& s) { s.line_density = 39.0, s.moving_share = 0.16; }, UniformGrid), UniformGrid);
    EXPECT_EQ(with([](SceneStatistics& s) { s.fill = 0.49, s.moving_share = 0.26; }, UniformGrid), SweepAndPrune);
    EXPECT_EQ(with([](SceneStatistics& s) { s.fill = 0.51, s.moving_share = 0.26; }, UniformGrid), UniformGrid);
    EXPECT_EQ(with([](SceneStatistics& s) { s.fill = 0.49, s.moving_share = 0.24; }, UniformGrid), UniformGrid);
    EXPECT_EQ(with([](SceneStatistics& s) { s.fill = 0.6, s.moving_share = 0.21; }, SweepAndPrune), SweepAndPrune);
    EXPECT_EQ(with([](SceneStatistics& s) { s.largest_size = 4.1, s.largest_crowd = 151.0; }, UniformGrid), HierarchicalGrid);
    EXPECT_EQ(with([](SceneStatistics& s) { s.largest_size = 4.1, s.largest_crowd = 149.0; }, UniformGrid), UniformGrid);
    EXPECT_EQ(with([](SceneStatistics& s) { s.largest_size = 3.9, s.largest_crowd = 151.0; }, UniformGrid), UniformGrid);
    EXPECT_EQ(with([](SceneStatistics& s) { s.largest_size = 4.1, s.largest_crowd = 121.0; }, HierarchicalGrid), HierarchicalGrid);
}

TEST(Chooser, TakesTheMethodOfTheScene) {
    const auto method = [](const std::vector<FloatAabb>& boxes, double moving) {
        return choose_method(measure_all(boxes, moving), BroadphaseMethod::BruteForce).method;
    };
    EXPECT_EQ(method(spread(100, 10, 0.5), 1.0), BroadphaseMethod::BruteForce);
    EXPECT_EQ(method(spread(5000, 30, 0.5), 0.1), BroadphaseMethod::UniformGrid);
    auto with_ground = spread(5000, 30, 0.5);
    with_ground[0] = test::box_about({0, 0, 0}, {100, 1, 100});
    EXPECT_EQ(method(with_ground, 1.0), BroadphaseMethod::HierarchicalGrid);
    std::vector<FloatAabb> diagonal;
    for (int i = 0; i < 5000; ++i) diagonal.push_back(test::box_about(dvec3{1.5 * i}, dvec3{0.5}));
    EXPECT_EQ(method(diagonal, 0.05), BroadphaseMethod::SortedAxes);
    EXPECT_EQ(method(diagonal, 0.9), BroadphaseMethod::SweepAndPrune);
}

TEST(Chooser, TestsEveryPairOfAFewBoxesInOnePlace) {
    const std::vector<FloatAabb> coincident(400, test::box_about(dvec3{1.0}, dvec3{0.5}));
    EXPECT_EQ(choose_method(measure_all(coincident, 0.3), BroadphaseMethod::UniformGrid).method, BroadphaseMethod::BruteForce);
    EXPECT_EQ(choose_method(measure_all(spread(400, 8, 0.5), 0.3), BroadphaseMethod::UniformGrid).method, BroadphaseMethod::UniformGrid);
    const std::vector<FloatAabb> many(700, coincident[0]);
    EXPECT_NE(choose_method(measure_all(many, 0.3), BroadphaseMethod::UniformGrid).method, BroadphaseMethod::BruteForce);
}

TEST(Chooser, StaysWithWhatItHasNearAThreshold) {
    SceneStatistics scene = measure_all(spread(275, 8, 0.5), 1.0);
    EXPECT_EQ(choose_method(scene, BroadphaseMethod::BruteForce).method, BroadphaseMethod::BruteForce);
    EXPECT_EQ(choose_method(scene, BroadphaseMethod::UniformGrid).method, BroadphaseMethod::UniformGrid);
    scene.count = 5000;
    scene.largest_size = 9.0 * scene.median_size;
    scene.largest_crowd = 130.0;
    EXPECT_EQ(choose_method(scene, BroadphaseMethod::HierarchicalGrid).method, BroadphaseMethod::HierarchicalGrid);
    EXPECT_EQ(choose_method(scene, BroadphaseMethod::UniformGrid).method, BroadphaseMethod::UniformGrid);
}

TEST(Chooser, ChangesMethodsUnderwayWithoutATraceInPairsAndEvents) {
    SerialExecutor executor;
    test::Crowd crowd(test::Distribution::Uniform, 700, 8, true);
    Broadphase broadphase;
    EXPECT_EQ(broadphase.method(), BroadphaseMethod::Automatic) << "there is nothing to choose by yet";
    EXPECT_NE(broadphase.reason(), "");
    Random random(9);
    ASSERT_NO_FATAL_FAILURE(crowd.check(broadphase, executor));
    EXPECT_EQ(broadphase.method(), BroadphaseMethod::UniformGrid);
    bool grid_of_levels = false, brute_force = false;
    for (int frame = 0; frame < 260; ++frame) {
        crowd.change(random, 0.1, 0.0);
        if (frame > 20 && frame < 30) crowd.scale(5, 2.0f);  // one box becomes much larger than the others
        if (frame == 220) crowd.all_at_once(false);
        SCOPED_TRACE(frame);
        ASSERT_NO_FATAL_FAILURE(crowd.check(broadphase, executor));
        if (frame == 160) {
            EXPECT_NE(broadphase.reason().find("700 boxes"), std::string::npos) << broadphase.reason();
        }
        grid_of_levels |= broadphase.method() == BroadphaseMethod::HierarchicalGrid;
        brute_force |= broadphase.method() == BroadphaseMethod::BruteForce;
    }
    EXPECT_TRUE(grid_of_levels);
    EXPECT_TRUE(brute_force);
}

}  // namespace
}  // namespace carom
