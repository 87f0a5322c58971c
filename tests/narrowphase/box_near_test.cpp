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
using detail::BoxesNear;
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
    const NearCrowd crowd(BoxPairBlock::kPairs - 5);
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
    const NearCrowd crowd(BoxPairBlock::kPairs);
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

// The kernel for all pairs is the oracle: it looks for points of faces too, and finds none.
TEST(BoxNear, EdgesAloneAreWhatAllPointsGive) {
    const NearCrowd crowd(BoxPairBlock::kPairs);
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

void expect_not_listed(const NearCrowd& crowd, BoxesNear& near, std::size_t number) {
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
    const NearCrowd good(BoxPairBlock::kPairs);
    const auto near = std::make_unique<BoxesNear>();
    const double wild[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()};
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        for (std::size_t number = 0; number < 7; ++number) {
            for (const double value : wild) {
                NearCrowd crowd = good;
                crowd.placed.clear();
                for (const Shape& s : crowd.shapes) crowd.placed.push_back(&s);
                for (std::size_t k = 0; k < crowd.poses.size(); k += 1 + k % 5) reinterpret_cast<double*>(&crowd.poses[k])[number] = value;
                expect_not_listed(crowd, *near, number);
            }
        }
        set_simd_width(0);
    }
}

// Of one pose alone, of a pair that float takes as it is, whichever number it is.
TEST(BoxNear, OneNumberThatIsNotFiniteIsRefusedAtEveryWidth) {
    NearCrowd crowd(40);
    SerialExecutor executor;
    CollideScratch scratch;
    std::vector<Manifold> out;
    const ErrorHandler handler = set_error_handler(count_not_finite);
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        for (std::size_t number = 0; number < 7; ++number) {
            for (const double wild : {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
                for (const std::size_t shape : {std::size_t{0}, std::size_t{41}, std::size_t{79}}) {
                    double& changed = reinterpret_cast<double*>(&crowd.poses[shape])[number];
                    const double before = changed;
                    changed = wild;
                    g_refused = 0;
                    collide({crowd.placed, crowd.poses}, crowd.pairs, executor, scratch, out);
                    EXPECT_EQ(g_refused, 1) << "number " << number << " of " << shape << ", width " << width;
                    changed = before;
                }
            }
        }
        set_simd_width(0);
    }
    set_error_handler(handler);
}

// Says that it has three threads, and so takes the way of those.
class ThreeThreads final : public Executor {
public:
    [[nodiscard]] int thread_count() const noexcept override { return 3; }
    void parallel_for(std::size_t count, std::size_t, Body body) override {
        if (count > 0) body(0, count);
    }
};

// What no pair names may lie anywhere, however many pairs and threads there are; huge numbers that are finite are no misuse.
TEST(BoxNear, OnlyPosesThatPairsNameAreLookedAt) {
    const ErrorHandler handler = set_error_handler(count_not_finite);
    SerialExecutor one;
    ThreeThreads three;
    for (const std::size_t count : {200u, 1300u}) {
        for (Executor* executor : {static_cast<Executor*>(&one), static_cast<Executor*>(&three)}) {
            NearCrowd crowd(count);
            CollideScratch scratch;
            std::vector<Manifold> expected, out;
            collide({crowd.placed, crowd.poses}, crowd.pairs, *executor, scratch, expected);
            const Shape box = Box{{0.5f, 0.5f, 0.5f}};
            crowd.placed.push_back(&box);
            crowd.poses.push_back({dvec3(std::numeric_limits<double>::quiet_NaN()), kIdentityRotation});
            g_refused = 0;
            collide({crowd.placed, crowd.poses}, crowd.pairs, *executor, scratch, out);
            EXPECT_EQ(g_refused, 0);
            ASSERT_EQ(out.size(), expected.size());
            EXPECT_EQ(std::memcmp(out.data(), expected.data(), out.size() * sizeof(Manifold)), 0);
            crowd.poses.back() = {dvec3(1e300), kIdentityRotation};
            crowd.pairs.push_back({0, static_cast<std::uint32_t>(crowd.placed.size() - 1), 0.0f});
            collide({crowd.placed, crowd.poses}, crowd.pairs, *executor, scratch, out);
            EXPECT_EQ(g_refused, 0);
            EXPECT_EQ(out.size(), expected.size());
        }
    }
    set_error_handler(handler);
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
