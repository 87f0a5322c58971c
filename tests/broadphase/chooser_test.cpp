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

TEST(Chooser, StaysWithWhatItHasNearAThreshold) {
    SceneStatistics scene = measure_all(spread(220, 10, 0.5), 1.0);
    EXPECT_EQ(choose_method(scene, BroadphaseMethod::BruteForce).method, BroadphaseMethod::BruteForce);
    EXPECT_EQ(choose_method(scene, BroadphaseMethod::UniformGrid).method, BroadphaseMethod::UniformGrid);
    scene.count = 5000;
    scene.largest_size = 3.5 * scene.median_size;
    EXPECT_EQ(choose_method(scene, BroadphaseMethod::HierarchicalGrid).method, BroadphaseMethod::HierarchicalGrid);
    EXPECT_EQ(choose_method(scene, BroadphaseMethod::UniformGrid).method, BroadphaseMethod::UniformGrid);
}

TEST(Chooser, ChangesMethodsUnderwayWithoutATraceInPairsAndEvents) {
    SerialExecutor executor;
    test::Crowd crowd(test::Distribution::Uniform, 420, 8, true);
    Broadphase broadphase;
    EXPECT_EQ(broadphase.method(), BroadphaseMethod::Automatic) << "there is nothing to choose by yet";
    EXPECT_NE(broadphase.reason(), "");
    Random random(9);
    ASSERT_NO_FATAL_FAILURE(crowd.check(broadphase, executor));
    EXPECT_EQ(broadphase.method(), BroadphaseMethod::UniformGrid);
    bool grid_of_levels = false, brute_force = false;
    for (int frame = 0; frame < 160; ++frame) {
        crowd.change(random, 0.1, 0.0);
        if (frame > 20 && frame < 30) crowd.scale(5, 2.0f);  // one box becomes much larger than the others
        if (frame == 110) crowd.all_at_once(false);
        SCOPED_TRACE(frame);
        ASSERT_NO_FATAL_FAILURE(crowd.check(broadphase, executor));
        if (frame == 60) {
            EXPECT_NE(broadphase.reason().find("420 boxes"), std::string::npos) << broadphase.reason();
        }
        grid_of_levels |= broadphase.method() == BroadphaseMethod::HierarchicalGrid;
        brute_force |= broadphase.method() == BroadphaseMethod::BruteForce;
    }
    EXPECT_TRUE(grid_of_levels);
    EXPECT_TRUE(brute_force);
}

}  // namespace
}  // namespace carom
