// Which of many pairs of boxes come near, and how they lie: against the same in double, one pair at a time, and the same bits at every width.
#include "oracle.hpp"

#include <carom/core/check.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/detail/box_lanes.hpp>
#include <carom/narrowphase/detail/pair_lanes.hpp>

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <memory>

namespace carom {
namespace {

using namespace test;
using detail::BoxPairBlock;

constexpr double kSize = 1.0;  // no half extent is longer

// Pairs of boxes far from the origin, of which every seventh is of sizes that float does not take as they are.
struct NearCrowd {
    std::vector<Shape> shapes;
    std::vector<const Shape*> placed;
    std::vector<Pose> poses;
    std::vector<NumberedPair> pairs;
    std::vector<std::uint32_t> chosen;

    explicit NearCrowd(std::size_t count) {
        Random r(31);
        for (std::size_t i = 0; i < count; ++i) {
            const dvec3 here = random_direction(r) * std::pow(10.0, r.range(-3.0, 5.0));
            for (int side = 0; side < 2; ++side) {
                vec3 half{0.0f};
                for (int k = 0; k < 3; ++k) half[k] = static_cast<float>(r.range(0.2, kSize));
                if (i % 7 == 3 && side == 0) half *= 100.0f;
                shapes.emplace_back(Box{half});
                poses.push_back({here + random_direction(r) * r.range(0.0, 1.7), random_rotation(r)});
            }
            pairs.push_back({static_cast<std::uint32_t>(2 * i + i % 2), static_cast<std::uint32_t>(2 * i + 1 - i % 2),
                             static_cast<float>(r.range(0.0, 0.1)), i % 3 == 0 ? 0.01f : 0.0f});
            chosen.push_back(static_cast<std::uint32_t>(i));
        }
        for (const Shape& shape : shapes) placed.push_back(&shape);
    }
    [[nodiscard]] detail::BatchInput input() const { return {{placed, poses}, pairs}; }
};

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

TEST(BoxNear, PairsAreListedInTheirOrderAsTheyLie) {
    const NearCrowd crowd(BoxPairBlock::kPairs - 5);
    const auto block = std::make_unique<BoxPairBlock>();
    find_near_boxes(crowd.input(), crowd.chosen, *block);
    ASSERT_TRUE(block->any_unusual);
    std::size_t k = 0, apart = 0, unusual = 0;
    for (const std::uint32_t i : crowd.chosen) {
        const ShapePair pair = crowd.input().pair(i);
        const bool listed = k < block->count && block->pair[k] == static_cast<std::int32_t>(i);
        if (i % 7 == 3) {
            ASSERT_TRUE(listed) << i;
            EXPECT_EQ(block->unusual[k], 1) << i;
            ++unusual;
        } else if (listed) {
            EXPECT_EQ(block->unusual[k], 0) << i;
            expect_placed(*block, k, pair);
            EXPECT_LE(static_cast<double>(block->separation[k]), static_cast<double>(pair.margin) + 2e-6) << i;
        } else {
            EXPECT_GT(place(pair).separation, static_cast<double>(pair.margin)) << i;
            ++apart;
        }
        if (listed) ++k;
    }
    EXPECT_EQ(k, block->count);
    EXPECT_GT(apart, 20u);
    EXPECT_GT(k, 60u);
    EXPECT_GT(unusual, 10u);
}

TEST(BoxNear, TheSameBitsAtEveryWidth) {
    const NearCrowd crowd(BoxPairBlock::kPairs);
    const auto expected = std::make_unique<BoxPairBlock>(), block = std::make_unique<BoxPairBlock>();
    for (const std::size_t count : {crowd.chosen.size(), std::size_t{37}, std::size_t{1}, std::size_t{0}}) {
        const auto chosen = std::span(crowd.chosen).last(count);
        *expected = {};
        find_near_boxes(crowd.input(), chosen, *expected);
        for (const int width : available_simd_widths()) {
            set_simd_width(width);
            *block = {};
            find_near_boxes(crowd.input(), chosen, *block);
            set_simd_width(0);
            ASSERT_EQ(block->count, expected->count) << width;
            const auto same = [&](const auto& ours, const auto& theirs) {
                return std::memcmp(&ours, &theirs, block->count * sizeof(ours[0])) == 0;
            };
            for (int i = 0; i < 3; ++i) {
                EXPECT_TRUE(same(block->offset[i], expected->offset[i])) << width;
                for (int j = 0; j < 3; ++j) EXPECT_TRUE(same(block->rotation[i][j], expected->rotation[i][j])) << width;
                for (int j = 0; j < 3; ++j) EXPECT_TRUE(same(block->axis_a[i][j], expected->axis_a[i][j])) << width;
            }
            EXPECT_TRUE(same(block->separation, expected->separation) && same(block->code, expected->code) &&
                        same(block->pair, expected->pair))
                << width;
            EXPECT_TRUE(!block->any_unusual || same(block->unusual, expected->unusual)) << width;
        }
    }
}

// What fills no bundle waits for the pairs after it, and few pairs are found before their poses are looked at: whatever is chosen, the manifolds are
// those of one pair at a time.
TEST(BoxNear, ManyAreThoseOfOneToTheBit) {
    NearCrowd crowd(2500);
    for (std::size_t i = 300; i < 700; ++i) {  // where none is unusual
        for (std::size_t k = 2 * i; k < 2 * i + 2; ++k) crowd.shapes[k] = Box{{0.5f, 0.4f, 0.3f}};
    }
    SerialExecutor executor;
    CollideScratch scratch;
    std::vector<Manifold> all, expected;
    for (const std::size_t count : {2500u, 1025u, 1024u, 690u, 129u, 128u, 16u, 1u, 0u}) {
        expected.clear();
        for (std::uint32_t i = 0; i < count; ++i) collide(crowd.input().pair(i), i, expected);
        for (const int width : available_simd_widths()) {
            set_simd_width(width);
            collide({crowd.placed, crowd.poses}, std::span(crowd.pairs).first(count), executor, scratch, all);
            set_simd_width(0);
            ASSERT_EQ(all.size(), expected.size()) << count << ", width " << width;
            EXPECT_TRUE(all.empty() || std::memcmp(all.data(), expected.data(), all.size() * sizeof(Manifold)) == 0)
                << count << ", width " << width;
        }
    }
    EXPECT_TRUE(expected.empty());
}

int g_refused = 0;
void count_not_finite(const Error& error) { g_refused += error.code == ErrorCode::NotFinite ? 1 : 0; }

void expect_nothing_changes(std::size_t count) {
    const NearCrowd good(count);
    SerialExecutor executor;
    CollideScratch scratch;
    std::vector<Manifold> out;
    collide({good.placed, good.poses}, good.pairs, executor, scratch, out);
    ASSERT_GT(out.size(), 100u);
    const std::vector<Manifold> before = out;
    const ErrorHandler handler = set_error_handler(count_not_finite);
    const double wild[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()};
    for (std::size_t number = 0; number < 7; ++number) {
        for (const double value : wild) {
            for (const std::size_t shape : {std::size_t{6}, std::size_t{7}, std::size_t{20}, std::size_t{399}}) {
                NearCrowd crowd = good;
                crowd.placed.clear();
                for (const Shape& s : crowd.shapes) crowd.placed.push_back(&s);
                reinterpret_cast<double*>(&crowd.poses[shape])[number] = value;
                g_refused = 0;
                collide({crowd.placed, crowd.poses}, crowd.pairs, executor, scratch, out);
                EXPECT_EQ(g_refused, 1);
                ASSERT_EQ(out.size(), before.size());
                ASSERT_EQ(std::memcmp(out.data(), before.data(), out.size() * sizeof(Manifold)), 0);
            }
        }
    }
    set_error_handler(handler);
}

// Of few boxes poses are looked at last: what is not finite changes nothing, whichever number it is.
TEST(BoxNear, WhatIsNotFiniteChangesNothing) {
    for (const std::size_t count : {200u, 1300u}) expect_nothing_changes(count);
}

TEST(BoxNear, WhatIsNotFiniteIsNotListed) {
    const NearCrowd good(BoxPairBlock::kPairs);
    const auto block = std::make_unique<BoxPairBlock>();
    const double wild[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()};
    for (std::size_t number = 0; number < 7; ++number) {
        for (const double value : wild) {
            NearCrowd crowd = good;
            crowd.placed.clear();
            for (const Shape& s : crowd.shapes) crowd.placed.push_back(&s);
            for (std::size_t k = 0; k < crowd.poses.size(); k += 1 + k % 5) reinterpret_cast<double*>(&crowd.poses[k])[number] = value;
            *block = {};
            find_near_boxes(crowd.input(), crowd.chosen, *block);
            for (std::size_t k = 0; k < block->count; ++k) {
                const ShapePair pair = crowd.input().pair(static_cast<std::uint32_t>(block->pair[k]));
                EXPECT_TRUE((is_finite(pair.pose_a) && is_finite(pair.pose_b)) || (block->any_unusual && block->unusual[k] == 1)) << number;
            }
        }
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
