// Verdicts of boxes in batches of every length, alone and among other shapes.
#include "near_pairs.hpp"

#include <carom/narrowphase/overlap.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace carom {
namespace {

// Lanes that wait for others, last bundles that are not full, and boxes before and after other shapes.
TEST(Overlap, BoxesHaveTheirVerdictsWhateverIsAskedBesideThem) {
    Random random(0xb0c5);
    std::vector<Shape> shapes;
    std::vector<Pose> poses;
    for (int i = 0; i < 600; ++i) {
        const auto size = [&] { return static_cast<float>(random.range(0.2, 1.0)); };
        shapes.push_back(Box{{size(), size(), size()}});
        const Pose at{random.range(0.0, 1.4) * test::random_direction(random), test::random_rotation(random)};
        poses.push_back(i % 6 == 1 ? Pose{at.position, poses.back().orientation} : at);  // some have parallel edges
    }
    shapes.emplace_back(Sphere{0.7f}), poses.emplace_back();
    std::vector<const Shape*> placed;
    for (const Shape& shape : shapes) placed.push_back(&shape);
    std::vector<NumberedPair> pairs;
    std::vector<Overlap> truth;
    for (std::uint32_t i = 0; i < 600; i += 2) {
        pairs.push_back({i, i + 1, 0.0f});
        truth.push_back(overlaps(shapes[i], poses[i], shapes[i + 1], poses[i + 1]));
    }
    EXPECT_GT(std::ranges::count(truth, Overlap::Apart), 60);
    EXPECT_GT(std::ranges::count(truth, Overlap::Overlapping), 60);

    SerialExecutor executor;
    std::vector<Overlap> verdicts;
    for (std::size_t count = 0; count <= pairs.size(); ++count) {
        overlaps({placed, poses}, std::span(pairs).first(count), executor, verdicts);
        EXPECT_TRUE(std::equal(verdicts.begin(), verdicts.end(), truth.begin(), truth.begin() + static_cast<std::ptrdiff_t>(count))) << count;
    }
    const Overlap ball = overlaps(shapes[0], poses[0], shapes[600], poses[600]);
    for (const std::size_t at : {0u, 1u, 15u, 16u, 40u, 255u, 256u, 300u}) {
        std::vector<NumberedPair> mixed = pairs;
        std::vector<Overlap> expected = truth;
        mixed.insert(mixed.begin() + static_cast<std::ptrdiff_t>(at), {0, 600, 0.0f});
        expected.insert(expected.begin() + static_cast<std::ptrdiff_t>(at), ball);
        overlaps({placed, poses}, mixed, executor, verdicts);
        EXPECT_EQ(verdicts, expected) << at;
    }
}

}  // namespace
}  // namespace carom
