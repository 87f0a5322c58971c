#include <carom/core/arena.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace carom {
namespace {

TEST(Arena, SpansAreAlignedAndApart) {
    Arena arena;
    Random random(0xa4e);
    struct Piece {
        std::span<std::uint32_t> span;
        std::uint32_t mark;
    };
    std::vector<Piece> pieces;
    for (std::uint32_t i = 0; i < 200; ++i) {
        const auto span = arena.allocate<std::uint32_t>(static_cast<std::size_t>(random.range(1.0, 500.0)));
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(span.data()) % Arena::kAlignment, 0u);
        for (std::uint32_t& x : span) x = i;
        pieces.push_back({span, i});
    }
    for (const Piece& piece : pieces) {
        for (const std::uint32_t x : piece.span) ASSERT_EQ(x, piece.mark);
    }
}

TEST(Arena, HoldsOneBlockOnceWarm) {
    Arena arena;
    const auto step = [&] {
        arena.reset();
        void* first = arena.allocate<double>(100).data();
        for (int i = 0; i < 50; ++i) static_cast<void>(arena.allocate<double>(1000));
        return first;
    };
    step();
    void* const warm = step();
    const std::size_t held = arena.capacity();
    for (int i = 0; i < 10; ++i) {
        EXPECT_EQ(step(), warm);  // the same block from its start: nothing was asked of the system
        EXPECT_EQ(arena.capacity(), held);
    }
}

TEST(Arena, NothingIsEmptyAndTooMuchIsMisuse) {
    Arena arena;
    EXPECT_TRUE(arena.allocate<int>(0).empty());
    EXPECT_EQ(arena.capacity(), 0u);
    EXPECT_THROW(static_cast<void>(arena.allocate<double>(std::numeric_limits<std::size_t>::max() / 4)), MisuseError);
    EXPECT_EQ(arena.allocate<int>(3).size(), 3u);
}

}  // namespace
}  // namespace carom
