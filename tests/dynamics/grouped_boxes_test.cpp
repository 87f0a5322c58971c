// Asked by groups or one by one, the same boxes are met, in the same order, while boxes come and change.
#include <carom/dynamics/detail/grouped_boxes.hpp>

#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <vector>

namespace carom::dynamics {
namespace {

Aabb random_box(Random& random) {
    const dvec3 at{random.range(0, 20), random.range(0, 20), random.range(0, 20)};
    return {at, at + dvec3{random.range(0, 2)}};
}

TEST(GroupedBoxes, MeetWhatEachBoxByItselfDoes) {
    Random random(3);
    GroupedBoxes grouped;
    std::vector<Aabb> all;
    std::size_t met = 0;
    for (int round = 0; round < 2000; ++round) {
        const bool adds = all.size() < 100 && round % 3 == 0;
        const std::size_t k = adds || all.empty() ? all.size() : static_cast<std::size_t>(random.range(0, static_cast<double>(all.size())));
        const Aabb box = random_box(random);
        if (k == all.size()) all.push_back(box);
        all[k] = box;
        grouped.set(k, box);
        ASSERT_EQ(grouped.size(), all.size());
        const Aabb asked = random_box(random);
        std::vector<std::size_t> want, found;
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (overlaps(asked, all[i])) want.push_back(i);
        }
        grouped.for_each_meeting(asked, [&](std::size_t i) { found.push_back(i); });
        ASSERT_EQ(found, want) << round;
        met += found.size();
    }
    EXPECT_GT(met, 100u);
    grouped.clear();
    grouped.for_each_meeting({dvec3{-1e9}, dvec3{1e9}}, [](std::size_t) { ADD_FAILURE(); });
}

TEST(GroupedBoxes, VisitsMayAddBoxes) {
    GroupedBoxes grouped;
    const Aabb box{dvec3{0.0}, dvec3{1.0}};
    grouped.set(0, box);
    std::size_t visits = 0;
    grouped.for_each_meeting(box, [&](std::size_t k) {
        EXPECT_EQ(k, visits++);
        if (grouped.size() < 40) grouped.set(grouped.size(), box);
    });
    EXPECT_EQ(visits, 40u);
}

}  // namespace
}  // namespace carom::dynamics
