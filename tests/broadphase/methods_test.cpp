// Every method gives the oracle's pairs and events: on every distribution, over frames of motion, insertion and removal, at every
// SIMD width and thread count.
#include "broadphase/crowd.hpp"
#include "broadphase/executors.hpp"

#include <carom/broadphase/broadphase.hpp>
#include <carom/core/check.hpp>
#include <carom/core/simd_width.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <limits>

namespace carom {
namespace {

using test::Crowd;
using test::Distribution;

std::vector<ProxyPair> copy(std::span<const ProxyPair> pairs) { return {pairs.begin(), pairs.end()}; }

std::vector<std::uint32_t> all_slots(std::size_t n) {
    std::vector<std::uint32_t> slots(n);
    for (std::size_t i = 0; i < n; ++i) slots[i] = static_cast<std::uint32_t>(i);
    return slots;
}

class Methods : public ::testing::TestWithParam<BroadphaseMethod> {
protected:
    [[nodiscard]] Broadphase make() const { return Broadphase({.method = GetParam()}); }
    SerialExecutor serial;
};

TEST_P(Methods, GiveTheOraclesPairsAndEventsOverChangingFrames) {
    for (const Distribution kind : test::kDistributions) {
        for (const bool filtered : {false, true}) {
            const std::size_t n = kind == Distribution::Coincident ? 90 : 260;
            const auto seed = 0xb0 + static_cast<std::uint64_t>(kind);
            Crowd crowd(kind, n, seed, filtered);
            Broadphase broadphase = make();
            Random random(seed);
            for (int frame = 0; frame < 60; ++frame) {
                SCOPED_TRACE(testing::Message() << "distribution " << int(kind) << ", frame " << frame);
                ASSERT_NO_FATAL_FAILURE(crowd.check(broadphase, serial));
                // Long stretches of few movers, then many; now and then all go and come back.
                const double moving = frame % 20 < 14 ? 0.04 : (frame % 20 < 17 ? 0.2 : 0.9);
                if (frame % 25 == 23 || frame % 25 == 24) {
                    crowd.all_at_once(frame % 25 == 24);
                } else {
                    crowd.change(random, moving, frame % 5 == 0 ? 0.0 : 0.02);
                }
            }
        }
    }
}

TEST_P(Methods, KeepUpWithBoxesThatDriftGrowAndLeave) {
    // All boxes drift the same way out of where the method was set up, one grows over all others, another shrinks to a point.
    Crowd crowd(Distribution::Uniform, 300, 3, false);
    Broadphase broadphase = make();
    Random random(4);
    ASSERT_NO_FATAL_FAILURE(crowd.check(broadphase, serial));
    for (int frame = 0; frame < 80; ++frame) {
        crowd.change(random, 0.1, 0.01);
        for (std::uint32_t i = 0; i < 30; ++i) crowd.move_by(i, vec3{0.7f, 0.3f, -0.2f});
        crowd.scale(31, 1.2f);
        crowd.scale(32, 0.5f);
        SCOPED_TRACE(frame);
        ASSERT_NO_FATAL_FAILURE(crowd.check(broadphase, serial));
    }
}

TEST_P(Methods, GiveTheOraclesListForEveryCount) {
    Broadphase broadphase = make();  // one object, sizes going up and down
    for (const std::size_t n : {0u, 1u, 2u, 3u, 15u, 16u, 17u, 31u, 33u, 64u, 130u, 600u, 5u, 0u, 200u}) {
        const auto boxes = test::random_boxes(Distribution::Uniform, n, n);
        const std::vector<ProxyFilter> filters(n);
        broadphase.clear();
        ASSERT_EQ(copy(broadphase.update({boxes, filters, all_slots(n), {}}, serial).pairs), test::all_pairs(boxes, filters)) << n;
        ASSERT_EQ(broadphase.result().begun.size(), broadphase.result().pairs.size());
        ASSERT_TRUE(broadphase.update({boxes, filters, {}, {}}, serial).begun.empty());
    }
}

TEST_P(Methods, AreTheSameAtEveryWidthAndOnManyThreads) {
    test::ScatteringExecutor scattering;
    for (const Distribution kind : test::kDistributions) {
        const std::size_t n = kind == Distribution::Coincident ? 100 : 500;
        for (const int width : available_simd_widths()) {
            set_simd_width(width);
            SCOPED_TRACE(testing::Message() << "distribution " << int(kind) << ", width " << width);
            Crowd crowd(kind, n, 0xd0, true);
            Broadphase broadphase = make();
            Random random(5);
            for (int frame = 0; frame < 4; ++frame) {
                ASSERT_NO_FATAL_FAILURE(crowd.check(broadphase, frame % 2 == 0 ? static_cast<Executor&>(scattering) : serial));
                crowd.change(random, 0.1, 0.02);
            }
        }
        set_simd_width(0);
    }
}

TEST_P(Methods, ReportWhichTheyAre) { EXPECT_EQ(make().method(), GetParam()); }

TEST_P(Methods, RefuseBadInputAndStayAsTheyWere) {
    const auto boxes = test::random_boxes(Distribution::Uniform, 200, 1);
    const std::vector<ProxyFilter> filters(200);
    const auto all = all_slots(200);
    Broadphase broadphase = make();
    const auto want = copy(broadphase.update({boxes, filters, all, {}}, serial).pairs);
    ASSERT_FALSE(want.empty());

    const ErrorHandler before = set_error_handler([](const Error&) {});
    const auto refuses = [&](const ProxyChanges& changes) {
        const PairUpdate& found = broadphase.update(changes, serial);
        return found.number == 1 && copy(found.pairs) == want && broadphase.live_count() == 200;
    };
    EXPECT_TRUE(refuses({boxes, std::span(filters).first(199), all, {}}));
    const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity()};
    for (int k = 0; k < 3; ++k) {
        for (const float x : bad) {
            auto broken = boxes;
            broken[77].lower[k] = x;
            EXPECT_TRUE(refuses({broken, filters, all, {}}));
            broken = boxes;
            broken[199].upper[k] = x;
            EXPECT_TRUE(refuses({broken, filters, all, {}}));
            broken[199].lower[k] = x;
            EXPECT_TRUE(refuses({broken, filters, all, {}}));
        }
        auto inverted = boxes;
        std::swap(inverted[3].lower[k], inverted[3].upper[k]);
        EXPECT_TRUE(refuses({inverted, filters, all, {}}));
    }
    const std::uint32_t beyond[] = {200}, five[] = {5}, twice[] = {5, 5};
    EXPECT_TRUE(refuses({boxes, filters, beyond, {}}));
    EXPECT_TRUE(refuses({boxes, filters, {}, beyond}));
    EXPECT_TRUE(refuses({boxes, filters, five, five}));
    EXPECT_TRUE(refuses({boxes, filters, {}, twice}));
    set_error_handler(before);
    EXPECT_THROW(broadphase.update({boxes, filters, beyond, {}}, serial), MisuseError);
    EXPECT_EQ(copy(broadphase.update({boxes, filters, all, {}}, serial).pairs), want);
    broadphase.update({boxes, filters, {}, five}, serial);
    EXPECT_THROW(broadphase.update({boxes, filters, {}, five}, serial), MisuseError);  // it is gone already
}

TEST_P(Methods, TakeTheWholeRangeOfFloat) {
    constexpr float kMax = std::numeric_limits<float>::max();
    std::vector<FloatAabb> boxes{{vec3{-kMax}, vec3{kMax}},
                                 {vec3{kMax}, vec3{kMax}},
                                 {vec3{-kMax}, vec3{-kMax}},
                                 {vec3{0.0f}, vec3{0.0f}},
                                 {vec3{-0x1p-149f}, vec3{-0.0f}}};
    for (int i = 0; i < 200; ++i) boxes.push_back({vec3{static_cast<float>(i) * 1e36f}, vec3{static_cast<float>(i + 1) * 1e36f}});
    const std::vector<ProxyFilter> filters(boxes.size());
    Broadphase broadphase = make();
    EXPECT_EQ(copy(broadphase.update({boxes, filters, all_slots(boxes.size()), {}}, serial).pairs), test::all_pairs(boxes, filters));
    const std::uint32_t moved[] = {1, 4, 20};
    boxes[1] = {vec3{-kMax}, vec3{0.0f}};
    boxes[4] = {vec3{0.0f}, vec3{0x1p-149f}};
    boxes[20] = {vec3{kMax}, vec3{kMax}};
    EXPECT_EQ(copy(broadphase.update({boxes, filters, moved, {}}, serial).pairs), test::all_pairs(boxes, filters));
}

TEST_P(Methods, AskTheUsersCallbackAgainForEverySlotThatIsListed) {
    constexpr std::size_t kCount = 400;
    auto boxes = test::random_boxes(Distribution::Clustered, kCount, 9);
    const std::vector<ProxyFilter> filters(kCount);
    std::vector<bool> banned(kCount);
    const auto neither = [](void* context, ProxyPair pair) {
        const auto& out = *static_cast<std::vector<bool>*>(context);
        return !out[pair.a] && !out[pair.b];
    };
    const auto oracle = [&] {
        auto want = test::all_pairs(boxes, filters);
        std::erase_if(want, [&](const ProxyPair& pair) { return banned[pair.a] || banned[pair.b]; });
        return want;
    };
    banned[3] = true;
    Broadphase broadphase({.method = GetParam(), .callback = {neither, &banned}});
    auto before = oracle();
    ASSERT_LT(before.size(), test::all_pairs(boxes, filters).size());
    ASSERT_EQ(copy(broadphase.update({boxes, filters, all_slots(kCount), {}}, serial).pairs), before);
    Random random(12);
    for (int frame = 0; frame < 40; ++frame) {  // few, so that pairs are patched; those with an even number do not move
        std::vector<std::uint32_t> listed;
        for (int k = 0; k < 3; ++k) listed.push_back(static_cast<std::uint32_t>(random.range(0.0, kCount - 0.5)));
        for (const std::uint32_t slot : listed) {
            banned[slot] = !banned[slot];
            if (slot % 2 == 1) boxes[slot].upper.x += 0.01f;
        }
        const PairUpdate& found = broadphase.update({boxes, filters, listed, {}}, serial);
        const auto now = oracle();
        std::vector<ProxyPair> begun, ended;
        std::set_difference(now.begin(), now.end(), before.begin(), before.end(), std::back_inserter(begun));
        std::set_difference(before.begin(), before.end(), now.begin(), now.end(), std::back_inserter(ended));
        ASSERT_EQ(copy(found.pairs), now) << frame;
        ASSERT_EQ(copy(found.begun), begun) << frame;
        ASSERT_EQ(copy(found.ended), ended) << frame;
        before = now;
    }
}

INSTANTIATE_TEST_SUITE_P(All, Methods, ::testing::ValuesIn(kBroadphaseMethods),
                         [](const auto& tested) { return std::string(to_string(tested.param)); });

TEST(BroadphaseSettings, OutOfRangeAreMisuse) {
    EXPECT_THROW(Broadphase({.method = static_cast<BroadphaseMethod>(99)}), MisuseError);
    EXPECT_THROW(Broadphase({.pair_limit = 0}), MisuseError);
    EXPECT_STREQ(to_string(static_cast<BroadphaseMethod>(99)), "unknown");
    EXPECT_FALSE(is_valid(static_cast<BroadphaseMethod>(99)));
}

}  // namespace
}  // namespace carom
