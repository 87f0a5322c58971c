// Which of many pairs of boxes come near, and how they lie: against the same in double, one pair at a time, and the same bits at every width.
#include "box_crowd.hpp"
#include "oracle.hpp"

#include <carom/core/check.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/detail/box_lanes.hpp>
#include <carom/narrowphase/detail/finite_poses.hpp>

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <memory>

namespace carom {
namespace {

using namespace test;
using detail::BoxesNear;
using detail::BoxPairBlock;

constexpr double kSize = kSizeOfCrowd;

// One pair in double, as the block should have it.
struct Placed {
    dmat3 axes, rotation;
    dvec3 offset;
    double separation;  // the greatest of all axes
};
Placed place(const ShapePair& pair) {
    const dmat3 a = glm::mat3_cast(pair.pose_a.orientation), b = glm::mat3_cast(pair.pose_b.orientation);
    const dvec3 between = pair.pose_b.position - pair.pose_a.position;
    const Separation truth = greatest_separation(solid_of(std::get<Box>(*pair.a), pair.pose_a, pair.pose_a.position),
                                                 solid_of(std::get<Box>(*pair.b), pair.pose_b, pair.pose_a.position));
    return {a, glm::transpose(a) * b, between * a, static_cast<double>(truth.value)};
}

void expect_placed(const BoxPairBlock& block, std::size_t k, const ShapePair& pair) {
    const Placed truth = place(pair);
    const double length = std::sqrt(glm::dot(truth.offset, truth.offset));
    EXPECT_EQ(block.margin[k], pair.margin);
    EXPECT_NEAR(static_cast<double>(block.separation[k]), truth.separation, 2e-6 * kSize);
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(block.half_a[i][k], std::get<Box>(*pair.a).half_extents[i]);
        EXPECT_EQ(block.half_b[i][k], std::get<Box>(*pair.b).half_extents[i]);
        EXPECT_NEAR(static_cast<double>(block.offset[i][k]), truth.offset[i], 3e-7 * length);
        for (int j = 0; j < 3; ++j) {
            EXPECT_EQ(block.axis_a[i][j][k], static_cast<float>(truth.axes[i][j]));
            EXPECT_NEAR(static_cast<double>(block.rotation[i][j][k]), truth.rotation[j][i], 2e-7);
        }
    }
}

// Where a pair is listed.
struct Entry {
    const BoxPairBlock* block = nullptr;
    std::size_t k = 0;
};
// By place.
std::vector<Entry> entries_of(const BoxesNear& near) {
    std::vector<Entry> entries(near.faces.count + near.edges.count);
    for (const BoxPairBlock* block : {&near.faces, &near.edges}) {
        for (std::size_t k = 0; k < block->count; ++k) entries.at(static_cast<std::size_t>(block->place[k])) = {block, k};
    }
    return entries;
}

TEST(BoxNear, PairsAreListedInTheirOrderAsTheyLie) {
    const BoxCrowd crowd(BoxPairBlock::kPairs - 5);
    const auto near = std::make_unique<BoxesNear>();
    find_near_boxes(crowd.input(), crowd.chosen, *near);
    ASSERT_TRUE(near->faces.any_unusual);
    EXPECT_FALSE(near->edges.any_unusual);
    EXPECT_TRUE(near->all_finite);
    const std::vector<Entry> entries = entries_of(*near);
    ASSERT_EQ(entries.size(), static_cast<std::size_t>(near->listed));
    std::size_t next = 0, apart = 0, unusual = 0;
    for (const std::uint32_t i : crowd.chosen) {
        const ShapePair pair = crowd.input().pair(i);
        const auto [block, k] = next < entries.size() ? entries[next] : Entry{};
        const bool listed = block != nullptr && block->pair[k] == static_cast<std::int32_t>(i);
        if (i % 7 == 3) {
            ASSERT_TRUE(listed && block == &near->faces) << i;
            EXPECT_EQ(block->unusual[k], 1) << i;
            ++unusual;
        } else if (listed) {
            EXPECT_TRUE(block == &near->edges || block->unusual[k] == 0) << i;
            EXPECT_TRUE(block == &near->faces || block->code[k] >= detail::kFirstEdge) << i;
            expect_placed(*block, k, pair);
            EXPECT_LE(static_cast<double>(block->separation[k]), static_cast<double>(pair.margin) + 2e-6) << i;
        } else {
            EXPECT_GT(place(pair).separation, static_cast<double>(pair.margin)) << i;
            ++apart;
        }
        if (listed) ++next;
    }
    EXPECT_EQ(next, entries.size());
    EXPECT_GT(apart, 20u);
    EXPECT_GT(next, 60u);
    EXPECT_GT(unusual, 10u);
    EXPECT_GT(near->edges.count, 5u);
}

void expect_same_block(const BoxPairBlock& block, const BoxPairBlock& expected, int width) {
    ASSERT_EQ(block.count, expected.count) << width;
    const auto same = [&](const auto& ours, const auto& theirs) { return std::memcmp(&ours, &theirs, block.count * sizeof(ours[0])) == 0; };
    for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(same(block.offset[i], expected.offset[i])) << width;
        for (int j = 0; j < 3; ++j) EXPECT_TRUE(same(block.rotation[i][j], expected.rotation[i][j])) << width;
        for (int j = 0; j < 3; ++j) EXPECT_TRUE(same(block.axis_a[i][j], expected.axis_a[i][j])) << width;
    }
    EXPECT_TRUE(same(block.separation, expected.separation) && same(block.code, expected.code)) << width;
    EXPECT_TRUE(same(block.pair, expected.pair) && same(block.place, expected.place)) << width;
    EXPECT_TRUE(!block.any_unusual || same(block.unusual, expected.unusual)) << width;
}

TEST(BoxNear, TheSameBitsAtEveryWidth) {
    const BoxCrowd crowd(BoxPairBlock::kPairs);
    const auto expected = std::make_unique<BoxesNear>(), near = std::make_unique<BoxesNear>();
    for (const std::size_t count : {crowd.chosen.size(), std::size_t{37}, std::size_t{1}, std::size_t{0}}) {
        const auto chosen = std::span(crowd.chosen).last(count);
        *expected = {};
        find_near_boxes(crowd.input(), chosen, *expected);
        for (const int width : available_simd_widths()) {
            set_simd_width(width);
            *near = {};
            find_near_boxes(crowd.input(), chosen, *near);
            set_simd_width(0);
            EXPECT_EQ(near->listed, expected->listed) << width;
            expect_same_block(near->faces, expected->faces, width);
            expect_same_block(near->edges, expected->edges, width);
        }
    }
}

// Eight times what the other may reach: its half diagonal and the margin.
TEST(BoxNear, WhatIsMuchLongerThanTheOtherReachesIsUnusual) {
    BoxCrowd crowd(1);
    const auto near = std::make_unique<BoxesNear>();
    for (const float size : {0.01f, 1.0f, 100.0f}) {
        for (const float margin : {0.0f, 0.5f, 40.0f}) {
            for (const bool swapped : {false, true}) {
                for (const float times : {0.999f, 1.001f}) {
                    const vec3 small = size * vec3{0.3f, 0.4f, 0.0f};
                    const float longest = times * 8.0f * (0.5f * size + size * margin);
                    crowd.shapes[swapped ? 1 : 0] = Box{vec3{0.2f, 1.0f, 0.5f} * longest};
                    crowd.shapes[swapped ? 0 : 1] = Box{small};
                    crowd.poses[1] = crowd.poses[0];
                    crowd.pairs[0] = {0, 1, size * margin};
                    *near = {};
                    find_near_boxes(crowd.input(), crowd.chosen, *near);
                    EXPECT_EQ(near->faces.any_unusual, times > 1.0f) << size << ' ' << margin;
                }
            }
            crowd.shapes[0] = crowd.shapes[1] = Box{vec3{0.5f * size}};
            crowd.pairs[0] = {0, 1, 2.0f * size + size * margin};  // reaches farther than either is long
            *near = {};
            find_near_boxes(crowd.input(), crowd.chosen, *near);
            EXPECT_FALSE(near->faces.any_unusual) << size << ' ' << margin;
        }
    }
}

// Edges that are better by rounding alone do not decide: what rests on a face has the face's normal.
TEST(BoxNear, WhatRestsOnAFaceIsDecidedByIt) {
    BoxCrowd crowd(BoxPairBlock::kPairs);
    Random r(33);
    for (std::size_t i = 0; i < crowd.chosen.size(); ++i) {
        vec3 half[2];
        for (std::size_t side = 0; side < 2; ++side) {
            for (int k = 0; k < 3; ++k) half[side][k] = static_cast<float>(r.range(0.2, kSize));
            crowd.shapes[2 * i + side] = Box{half[side]};
        }
        const Pose below = crowd.poses[2 * i];
        const double height = static_cast<double>(half[0].y) + static_cast<double>(half[1].y) - r.range(0.0, 1e-3);
        crowd.poses[2 * i + 1] = below * Pose{{r.range(-0.1, 0.1), height, r.range(-0.1, 0.1)}, about({0, 1, 0}, r.range(0.0, 6.0))};
    }
    const auto near = std::make_unique<BoxesNear>();
    find_near_boxes(crowd.input(), crowd.chosen, *near);
    EXPECT_EQ(near->edges.count, 0u);
    ASSERT_EQ(near->faces.count, crowd.chosen.size());
    for (std::size_t k = 0; k < near->faces.count; ++k) EXPECT_LT(near->faces.code[k], detail::kFirstEdge) << k;
}

// The kernel for all pairs is the oracle: it looks for points of faces too, and finds none.
TEST(BoxNear, EdgesAloneAreWhatAllPointsGive) {
    const BoxCrowd crowd(BoxPairBlock::kPairs);
    const auto near = std::make_unique<BoxesNear>();
    find_near_boxes(crowd.input(), crowd.chosen, *near);
    ASSERT_GT(near->edges.count, 5u);
    const auto patch = std::make_unique<detail::BoxPatchBundle>();
    std::fill(std::begin(near->edges.unit), std::end(near->edges.unit), 1.0f);
    std::size_t points = 0;
    for (std::size_t bundle = 0; bundle < bundle_count(near->edges.count); ++bundle) {
        std::vector<Manifold> alone(kBundleWidth), expected(kBundleWidth);
        IntBundle to{};
        const auto number = [&] {
            for (std::size_t l = 0; l < kBundleWidth; ++l) {
                const bool is_there = bundle * kBundleWidth + l < near->edges.count && patch->count.lane[l] > 0;
                to.lane[l] = is_there ? static_cast<std::int32_t>(l) : detail::kNoManifold;
                points += is_there ? static_cast<std::size_t>(patch->count.lane[l]) : 0;
            }
        };
        build_box_patch(near->edges, bundle, *patch);
        number();
        write_box_manifolds(near->edges, bundle, *patch, to, expected.data());
        build_edge_patch(near->edges, bundle, *patch);
        number();
        write_edge_manifolds(near->edges, bundle, *patch, to, alone.data());
        EXPECT_EQ(std::memcmp(alone.data(), expected.data(), kBundleWidth * sizeof(Manifold)), 0);
    }
    EXPECT_GT(points, 10u);
}

void expect_not_listed(const BoxCrowd& crowd, BoxesNear& near, std::size_t number) {
    near = {};
    find_near_boxes(crowd.input(), crowd.chosen, near);
    for (const BoxPairBlock* block : {&near.faces, &near.edges}) {
        for (std::size_t k = 0; k < block->count; ++k) {
            const ShapePair pair = crowd.input().pair(static_cast<std::uint32_t>(block->pair[k]));
            EXPECT_TRUE((is_finite(pair.pose_a) && is_finite(pair.pose_b)) || (block->any_unusual && block->unusual[k] == 1)) << number;
        }
    }
    EXPECT_FALSE(near.all_finite) << number;
}

TEST(BoxNear, WhatIsNotFiniteIsNotListedAndIsSeen) {
    const auto near = std::make_unique<BoxesNear>();
    const double wild[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()};
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        for (std::size_t number = 0; number < 7; ++number) {
            for (const double value : wild) {
                BoxCrowd crowd(BoxPairBlock::kPairs);
                for (std::size_t k = 0; k < crowd.poses.size(); k += 1 + k % 5) crowd.number_of(k, number) = value;
                expect_not_listed(crowd, *near, number);
            }
        }
        set_simd_width(0);
    }
}

TEST(FinitePoses, EveryNumberCounts) {
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        std::vector<Pose> poses(41, Pose{{1e308, -1e-310, 0.0}, kIdentityRotation});
        EXPECT_TRUE(detail::poses_are_finite(poses));
        EXPECT_TRUE(detail::poses_are_finite({}));
        for (std::size_t i = 0; i < 7 * poses.size(); ++i) {
            double& number = reinterpret_cast<double*>(poses.data())[i];
            const double before = number;
            for (const double wild : {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
                number = wild;
                EXPECT_FALSE(detail::poses_are_finite(poses)) << i << ", width " << width;
            }
            number = before;
        }
        set_simd_width(0);
    }
}

}  // namespace
}  // namespace carom
