// Long lists of moved slots, which threads share: the same pairs and events as on one thread, whatever the order and however often a slot is
// listed; and a fault anywhere in the list is found before anything changes.
#include "broadphase/distributions.hpp"
#include "broadphase/executors.hpp"

#include <carom/broadphase/broadphase.hpp>
#include <carom/core/check.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace carom {
namespace {

constexpr std::uint32_t kCount = 30000;  // several stretches for each of three threads

struct Pairs {
    std::vector<ProxyPair> pairs, begun, ended;
    explicit Pairs(const PairUpdate& update)
        : pairs(update.pairs.begin(), update.pairs.end()),
          begun(update.begun.begin(), update.begun.end()),
          ended(update.ended.begin(), update.ended.end()) {}
    friend bool operator==(const Pairs&, const Pairs&) = default;
};

class Intake : public ::testing::Test {
protected:
    Intake() : boxes(kCount), filters(kCount), all(kCount) {
        std::iota(all.begin(), all.end(), 0u);
        const double side = std::cbrt(4.0 * kCount);
        for (FloatAabb& box : boxes) {
            const dvec3 centre{random.range(0.0, side), random.range(0.0, side), random.range(0.0, side)};
            box = test::box_about(centre, dvec3{0.6});
        }
        one_thread.update({boxes, filters, all, {}}, serial);
        three_threads.update({boxes, filters, all, {}}, scattering);
    }
    // Each ninth slot moves, few enough to be searched for one by one; some change filters.
    std::vector<std::uint32_t> move_some() {
        std::vector<std::uint32_t> moved;
        for (std::uint32_t slot = 0; slot < kCount; ++slot) {
            if (slot % 9 != 0) continue;
            if (slot % 90 == 9) filters[slot].mask ^= 1;
            const auto by = static_cast<float>(random.range(-0.5, 0.5));
            boxes[slot].lower += by;
            boxes[slot].upper += by;
            moved.push_back(slot);
        }
        return moved;
    }
    Random random{17};
    std::vector<FloatAabb> boxes;
    std::vector<ProxyFilter> filters;
    std::vector<std::uint32_t> all;
    SerialExecutor serial;
    test::ScatteringExecutor scattering;
    Broadphase one_thread{{.method = BroadphaseMethod::UniformGrid}}, three_threads{{.method = BroadphaseMethod::UniformGrid}};
};

TEST_F(Intake, ThreadsThatShareTheMovedSlotsLeaveNoTrace) {
    ASSERT_EQ(Pairs(one_thread.result()), Pairs(three_threads.result()));
    ASSERT_FALSE(one_thread.result().pairs.empty());
    for (int frame = 0; frame < 6; ++frame) {
        const auto moved = move_some();
        const Pairs want(one_thread.update({boxes, filters, moved, {}}, serial));
        ASSERT_FALSE(want.begun.empty());
        ASSERT_FALSE(want.ended.empty());
        auto listed = moved;
        if (frame % 3 == 0) listed = all;  // most of them for nothing
        if (frame % 3 == 1) std::reverse(listed.begin(), listed.end());
        if (frame % 3 == 2) listed.insert(listed.begin(), moved.begin(), moved.end());  // each twice, far apart
        ASSERT_EQ(Pairs(three_threads.update({boxes, filters, listed, {}}, scattering)), want) << frame;
    }
}

TEST_F(Intake, SlotsThatAreOnlyListedHaveNoEvents) {
    const PairUpdate& found = three_threads.update({boxes, filters, all, {}}, scattering);
    EXPECT_TRUE(found.begun.empty());
    EXPECT_TRUE(found.ended.empty());
}

TEST_F(Intake, AFaultAnywhereInALongListIsFoundBeforeAnythingChanges) {
    const Pairs before(three_threads.result());
    const FloatAabb good = boxes[7], bad{vec3{1.0f}, vec3{std::numeric_limits<float>::quiet_NaN()}};
    for (FloatAabb& box : boxes) box.upper += 0.1f;
    for (const std::uint32_t place : {0u, kCount / 2, kCount - 1}) {
        const FloatAabb moved = boxes[place];
        boxes[place] = bad;
        EXPECT_THROW(three_threads.update({boxes, filters, all, {}}, scattering), MisuseError);
        boxes[place] = moved;
        auto beyond = all;
        beyond[place] = kCount;
        EXPECT_THROW(three_threads.update({boxes, filters, beyond, {}}, scattering), MisuseError);
        const std::uint32_t removed[] = {place};
        EXPECT_THROW(three_threads.update({boxes, filters, all, removed}, scattering), MisuseError);
    }
    EXPECT_EQ(three_threads.box(7), good);
    EXPECT_EQ(Pairs(three_threads.result()), before);
}

}  // namespace
}  // namespace carom
