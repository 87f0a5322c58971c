// No two contacts of a colour share a body that moves, and every contact is there once.
#include <carom/dynamics/detail/coloring.hpp>

#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <set>

namespace carom::dynamics {
namespace {

std::vector<ContactRows> random_rows(std::uint64_t seed, int count, std::int32_t movable, std::int32_t rows) {
    Random random(seed);
    std::vector<ContactRows> out;
    while (out.size() < static_cast<std::size_t>(count)) {
        const auto a = static_cast<std::int32_t>(random.range(0, rows));
        const auto b = static_cast<std::int32_t>(random.range(0, rows));
        if (a != b && (a < movable || b < movable)) out.push_back({a, b});
    }
    return out;
}

void expect_valid(const Coloring& coloring, std::span<const ContactRows> rows, std::int32_t movable) {
    std::set<std::uint32_t> seen(coloring.order().begin(), coloring.order().end());
    EXPECT_EQ(seen.size(), rows.size());
    bool fixed_seen = false;
    for (std::size_t c = 0; c + 1 < coloring.starts().size(); ++c) {
        std::set<std::int32_t> bodies;
        bool any_fixed = false;
        bool any_shared = false;
        for (std::uint32_t i = coloring.starts()[c]; i < coloring.starts()[c + 1]; ++i) {
            const ContactRows& r = rows[coloring.order()[i]];
            for (const std::int32_t row : {r.a, r.b}) {
                if (row < movable) {
                    EXPECT_TRUE(bodies.insert(row).second) << "row twice in colour " << c;
                }
            }
            (r.a < movable && r.b < movable ? any_shared : any_fixed) = true;
        }
        EXPECT_FALSE(any_fixed && any_shared);
        EXPECT_FALSE(fixed_seen && any_shared) << "contacts with fixed bodies come last";
        fixed_seen |= any_fixed;
    }
}

TEST(Coloring, ColorsShareNoMovableBody) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const std::int32_t movable = 60;
        const auto rows = random_rows(seed, 200, movable, 70);
        Coloring coloring;
        coloring.color(rows, movable);
        EXPECT_EQ(coloring.overflow_count(), 0u);
        expect_valid(coloring, rows, movable);
    }
}

TEST(Coloring, WhatFitsNoColorOverflowsAndIsNotLost) {
    std::vector<ContactRows> rows;
    for (std::int32_t i = 1; i <= 40; ++i) rows.push_back({0, i});    // a star of 40 needs 40 colours
    for (std::int32_t i = 1; i <= 40; ++i) rows.push_back({i, 41});   // and does not spoil the contacts with the ground
    Coloring coloring;
    coloring.color(rows, 41);
    EXPECT_EQ(coloring.overflow_count(), 40u - kMaxSharedColors);
    expect_valid(coloring, rows, 41);
}

TEST(Coloring, NothingIsNothing) {
    Coloring coloring;
    coloring.color({}, 0);
    EXPECT_EQ(coloring.order().size(), 0u);
    EXPECT_EQ(coloring.overflow_count(), 0u);
}

}  // namespace
}  // namespace carom::dynamics
