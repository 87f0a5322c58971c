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
    EXPECT_EQ(with_room(1'000), 1'062u);
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

TEST(Room, AListWhoseLengthSwaysByATwentiethIsAllocatedOnce) {
    std::vector<int> list(10'000);
    list.resize(1'000);
    trim_kept(list);
    const int* const at = list.data();
    for (int k = 0; k < 100; ++k) {
        list.resize(k % 2 == 0 ? 1'050 : 950);
        if (k % 3 == 0) trim_kept(list);
        if (k % 3 == 1) trim_scratch(list);
        if (k % 3 == 2) resize_scratch(list, list.size());
        ASSERT_EQ(list.data(), at) << k;
    }
}

TEST(Room, AFewAreNotWorthIt) {
    std::vector<int> list;
    list.reserve(32);
    trim_kept(list);
    EXPECT_EQ(list.capacity(), 32u);
}

TEST(Room, AListThatGrowsHasASixteenthToSpare) {
    std::vector<int> list;
    resize_with_room(list, 800);
    EXPECT_EQ(list.size(), 800u);
    EXPECT_EQ(list.capacity(), 850u);
    for (int i = 0; i < 101; ++i) append_with_room(list) = i;
    EXPECT_EQ(list.back(), 100);
    EXPECT_EQ(list[799], 0);
    EXPECT_EQ(list.capacity(), with_room(851));
    resize_with_room(list, 10);
    EXPECT_EQ(list.capacity(), with_room(851)) << "trimmed by others";
}

TEST(Room, AScratchListThatIsFilledAnewFits) {
    std::vector<int> list;
    resize_scratch(list, 10'000);
    EXPECT_EQ(list.capacity(), with_room(10'000));
    resize_scratch(list, 1'000);
    EXPECT_EQ(list.size(), 1'000u);
    EXPECT_EQ(list.capacity(), with_room(1'000));
    resize_scratch(list, 0);
    EXPECT_EQ(list.capacity(), 0u);
    EXPECT_EQ(held_by(list, std::vector<double>(3)), 24u);
}

}  // namespace
}  // namespace carom::dynamics
