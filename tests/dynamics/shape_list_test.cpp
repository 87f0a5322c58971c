// The shapes of a body: none, one without memory of its own, and more.
#include <carom/dynamics/detail/shape_list.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>

namespace carom::dynamics {
namespace {

void expect_first(const ShapeList& list, std::uint32_t count) {
    ASSERT_EQ(list.size(), count);
    EXPECT_EQ(list.empty(), count == 0);
    std::uint32_t next = 0;
    for (const ShapeId id : list) {
        EXPECT_EQ(id, (ShapeId{next, next + 1})) << count;
        ++next;
    }
    EXPECT_EQ(next, count);
    EXPECT_EQ(std::span<const ShapeId>(list).size(), count);
}

TEST(ShapeList, KeepsWhatCameInOrder) {
    ShapeList list;
    expect_first(list, 0);
    for (std::uint32_t i = 0; i < 40; ++i) {
        list.push_back({i, i + 1});
        expect_first(list, i + 1);
        EXPECT_EQ(list.memory() == 0, i == 0) << "one takes nothing";
        EXPECT_GE(list.memory(), i == 0 ? 0 : (i + 1) * sizeof(ShapeId));
    }
    EXPECT_EQ(list.memory(), 64 * sizeof(ShapeId));
}

TEST(ShapeList, Moves) {
    for (const std::uint32_t count : {0u, 1u, 2u, 9u}) {
        ShapeList list;
        for (std::uint32_t i = 0; i < count; ++i) list.push_back({i, i + 1});
        ShapeList other(std::move(list));
        expect_first(other, count);
        ShapeList third;
        third.push_back({7, 7}), third.push_back({8, 8}), third.push_back({9, 9});
        third = std::move(other);
        expect_first(third, count);
        third.push_back({count, count + 1});
        expect_first(third, count + 1);
    }
}

}  // namespace
}  // namespace carom::dynamics
