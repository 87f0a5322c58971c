// Stages share the memory of their lists.
#include <carom/dynamics/detail/scratch_pool.hpp>

#include <gtest/gtest.h>

#include <cstdint>

namespace carom::dynamics {
namespace {

TEST(ScratchPool, WhatOneStageGivesBackTheNextTakes) {
    ScratchPool pool;
    std::size_t first = 0;
    for (int step = 0; step < 10; ++step) {
        {
            ScratchList<double> early(pool);
            early.resize(1000);
            early[999] = 1.0;
        }
        ScratchList<float> late(pool);
        late.resize(2000);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(late.data()) % ScratchPool::kAlignment, 0u);
        late.release();
        if (step == 0) first = pool.memory();
        EXPECT_EQ(pool.memory(), first);
    }
    EXPECT_GE(first, 8000u);
    EXPECT_LT(first, 2 * 8000u) << "not the sum";
}

TEST(ScratchPool, ListsThatAreHeldAtOnceAreApart) {
    ScratchPool pool;
    ScratchList<std::uint32_t> a(pool), b(pool);
    a.resize(100), b.resize(100);
    for (std::uint32_t i = 0; i < 100; ++i) a[i] = i, b[i] = 1000 + i;
    for (std::uint32_t i = 0; i < 100; ++i) ASSERT_EQ(a[i], i);
    ScratchList<std::uint32_t> moved(std::move(a));
    EXPECT_EQ(moved.size(), 100u);
    EXPECT_EQ(moved[99], 99u);
    moved.swap(b);
    EXPECT_EQ(b[99], 99u);
    EXPECT_EQ(moved[99], 1099u);
    b.release();
    EXPECT_TRUE(b.empty());
    ScratchList<std::uint32_t> again(pool);
    again.resize(50);  // in the place of b
    again[0] = 7;
    EXPECT_EQ(moved[0], 1000u);
}

TEST(ScratchPool, ListsOfOneBlockFollowEachOther) {
    ScratchPool pool;
    ScratchList<std::byte> block(pool);
    block.resize(bytes_of<std::uint16_t>(33) + bytes_of<double>(5));
    std::byte* next = block.data();
    const std::span<std::uint16_t> first = cut<std::uint16_t>(next, 33);
    const std::span<double> second = cut<double>(next, 5);
    EXPECT_EQ(first.size(), 33u);
    EXPECT_EQ(reinterpret_cast<std::byte*>(second.data()) - block.data(), 128) << "66 bytes, and on to the next 64";
    EXPECT_EQ(next, block.data() + block.size());
    EXPECT_EQ(block.size(), 128u + 64u);
}

TEST(ScratchPool, TakesTheSmallestThatFits) {
    ScratchPool pool;
    ScratchPool::Block large = pool.take(100'000), small = pool.take(10'000);
    pool.give_back(large), pool.give_back(small);
    const std::size_t held = pool.memory();
    const ScratchPool::Block first = pool.take(9'000), second = pool.take(50'000);
    EXPECT_EQ(first.data, small.data);
    EXPECT_EQ(second.data, large.data);
    EXPECT_EQ(pool.memory(), held);
    pool.give_back(first), pool.give_back(second);
    const ScratchPool::Block longer = pool.take(200'000);
    EXPECT_LT(pool.memory(), 200'000u * 9 / 8 + 12'000u) << "in place of the large one";
    pool.give_back(longer);
}

TEST(ScratchPool, ListsGrowAndLoseSome) {
    ScratchPool pool;
    ScratchList<std::uint32_t> list(pool), other(pool);
    other.resize(100'000);  // so that blocks that lists have left are there to be taken
    other.release();
    for (std::uint32_t i = 0; i < 10'000; ++i) list.push_back(i);
    ASSERT_EQ(list.size(), 10'000u);
    for (std::uint32_t i = 0; i < 10'000; ++i) ASSERT_EQ(list[i], i);
    list.reserve(200'000);
    ASSERT_EQ(list.size(), 10'000u);
    for (std::uint32_t i = 0; i < 10'000; ++i) ASSERT_EQ(list[i], i);
    const std::size_t held = pool.memory();
    const std::uint32_t* const at = list.data();
    for (std::uint32_t i = 10'000; i < 200'000; ++i) list.push_back(i);
    EXPECT_EQ(pool.memory(), held);
    EXPECT_EQ(list.data(), at) << "there was room";
    list.erase_if([](std::uint32_t i) { return i % 3 != 1; });
    ASSERT_EQ(list.size(), 66'666u + 1u);
    for (std::uint32_t k = 0; k < list.size(); ++k) ASSERT_EQ(list[k], 3 * k + 1);
}

TEST(ScratchPool, GivesBackWhatIsMuchMoreThanWasAskedForAtOnce) {
    ScratchPool pool;
    ScratchList<std::byte> list(pool);
    list.resize(1'000'000);
    list.release();
    pool.trim();
    EXPECT_GE(pool.memory(), 1'000'000u) << "it was asked for since the last call";
    list.resize(1'000);
    list.release();
    EXPECT_GE(pool.memory(), 1'000'000u) << "a block of it served";
    pool.trim();
    EXPECT_EQ(pool.memory(), 0u) << "what asks for little counts as little, whatever block it has";
    list.resize(1'000);
    list[999] = std::byte{1};
    EXPECT_GE(pool.memory(), 1'000u);
}

}  // namespace
}  // namespace carom::dynamics
