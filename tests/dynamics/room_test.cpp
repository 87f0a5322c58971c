// Lists of a step give back what they hold beyond their need, and are left alone while it sways.
#include <carom/dynamics/detail/room.hpp>

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace carom::dynamics {
namespace {

TEST(Room, AKeptListIsTheSameInLessMemory) {
    std::vector<int> list(10'000);
    std::iota(list.begin(), list.end(), 0);
    list.resize(1'000);
    const std::vector<int> before = list;
    trim_kept(list);
    EXPECT_EQ(list, before);
    EXPECT_EQ(list.capacity(), with_room(1'000));
    EXPECT_EQ(with_room(1'000), 1'125u);
}

TEST(Room, AScratchListIsAsLongInLessMemory) {
    std::vector<int> list(10'000);
    list.resize(1'000);
    trim_scratch(list);
    EXPECT_EQ(list.size(), 1'000u);
    EXPECT_EQ(list.capacity(), with_room(1'000));
    list.clear();
    trim_scratch(list);
    EXPECT_EQ(list.capacity(), 0u) << "what is not in use";
}

TEST(Room, AListWhoseLengthSwaysByATenthIsAllocatedOnce) {
    std::vector<int> list(10'000);
    list.resize(1'000);
    trim_kept(list);
    const int* const at = list.data();
    for (int k = 0; k < 100; ++k) {
        list.resize(k % 2 == 0 ? 1'100 : 900);
        if (k % 3 == 0) trim_kept(list);
        if (k % 3 == 1) trim_scratch(list);
        ASSERT_EQ(list.data(), at) << k;
    }
}

TEST(Room, AFewAreNotWorthIt) {
    std::vector<int> list;
    list.reserve(32);
    trim_kept(list);
    EXPECT_EQ(list.capacity(), 32u);
}

TEST(Room, AListThatGrowsHasAnEighthToSpare) {
    std::vector<int> list;
    resize_with_room(list, 800);
    EXPECT_EQ(list.size(), 800u);
    EXPECT_EQ(list.capacity(), 900u);
    for (int i = 0; i < 101; ++i) append_with_room(list) = i;
    EXPECT_EQ(list.back(), 100);
    EXPECT_EQ(list[799], 0);
    EXPECT_EQ(list.capacity(), with_room(901));
    resize_with_room(list, 10);
    EXPECT_EQ(list.capacity(), with_room(901)) << "trimmed by others";
}

}  // namespace
}  // namespace carom::dynamics
