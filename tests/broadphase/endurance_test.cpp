// A thousand frames of motion, insertion and removal, at random and as an adversary would have it: every method, and the chooser, give the
// oracle's pairs and events in each of them.
#include "broadphase/crowd.hpp"
#include "broadphase/executors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace carom {
namespace {

using test::Crowd;
using test::Distribution;

constexpr int kFrames = 1000;
constexpr std::size_t kBoxes = 90;

class Endurance : public ::testing::TestWithParam<BroadphaseMethod> {
protected:
    // Most frames on this thread, some on four.
    Executor& executor(int frame) { return frame % 16 == 5 ? static_cast<Executor&>(four_) : serial_; }

    test::ScatteringExecutor four_{4};
    SerialExecutor serial_;
};

TEST_P(Endurance, RandomMotionOverAThousandFrames) {
    for (const Distribution kind : test::kDistributions) {
        const auto seed = 0xe0 + static_cast<std::uint64_t>(kind);
        Crowd crowd(kind, kind == Distribution::Coincident ? kBoxes / 3 : kBoxes, seed, kind == Distribution::Uniform);
        Broadphase broadphase({.method = GetParam()});
        Random random(seed);
        for (int frame = 0; frame < kFrames; ++frame) {
            SCOPED_TRACE(testing::Message() << "distribution " << int(kind) << ", frame " << frame);
            ASSERT_NO_FATAL_FAILURE(crowd.check(broadphase, executor(frame)));
            // Long stretches of few movers, short ones of many.
            const double moving = frame % 100 < 70 ? 0.03 : (frame % 100 < 90 ? 0.2 : 1.0);
            crowd.change(random, moving, frame % 3 == 0 ? 0.02 : 0.0);
        }
    }
}

FloatAabb cube(const vec3& lower, float edge) { return {lower, lower + edge}; }

vec3 random_point(Random& random, double size) {
    const double x = random.range(-size, size), y = random.range(-size, size), z = random.range(-size, size);
    return vec3(dvec3{x, y, z});
}

// What each of these does was chosen to catch a structure in a state that it does not expect.
void be_nasty(Crowd& crowd, Random& random, int frame) {
    crowd.rest();
    const std::uint32_t n = crowd.size();
    const auto some = [&] { return static_cast<std::uint32_t>(random.range(0.0, double(n))); };
    const int phase = frame / 12 % 12;
    switch (phase) {
        case 0:  // teleports: two boxes take each other's place, so that each is where the other one was
            for (int k = 0; k < 4; ++k) {
                const std::uint32_t i = some(), j = some();
                if (i == j || !crowd.is_alive(i) || !crowd.is_alive(j)) continue;
                const FloatAabb box = crowd.box(i);
                crowd.place(i, crowd.box(j));
                crowd.place(j, box);
            }
            break;
        case 1:  // far away and back
            for (int k = 0; k < 5; ++k) crowd.place(some(), cube(random_point(random, frame % 2 == 0 ? 1e7 : 5.0), 1.0f));
            break;
        case 2:  // slots are freed in one frame and used again, elsewhere, in the next
            if (frame % 2 == 0) {
                for (int k = 0; k < 12; ++k) crowd.take_out(some());
            } else {
                for (std::uint32_t i = 0; i < n; ++i) {
                    if (!crowd.is_alive(i)) crowd.place(i, cube(random_point(random, 5.0), 0.7f));
                }
            }
            break;
        case 3:  // all go; then one comes; then all at once
            if (frame % 4 == 0) crowd.all_at_once(false);
            if (frame % 4 == 1) crowd.place(some(), cube(vec3{0.0f}, 2.0f));
            if (frame % 4 == 2) crowd.all_at_once(true);
            break;
        case 4:  // a box grows a millionfold within a few frames
            for (int k = 0; k < 2; ++k) crowd.scale(static_cast<std::uint32_t>(k), 10.0f);
            break;
        case 5:  // and shrinks to next to nothing
            for (int k = 0; k < 2; ++k) crowd.scale(static_cast<std::uint32_t>(k), 0.01f);
            break;
        case 6:  // more and more boxes coincide
            for (int k = 0; k < 6; ++k) crowd.place(some(), cube(vec3{1.0f}, 1.0f));
            break;
        case 7:  // and burst apart
            for (std::uint32_t i = 0; i < n; ++i) {
                if (crowd.is_alive(i) && random.unit() < 0.3) crowd.place(i, cube(random_point(random, 6.0), 0.9f));
            }
            break;
        case 8:  // everything drifts the same way
            for (std::uint32_t i = 0; i < n; ++i) crowd.move_by(i, vec3{0.4f, -0.3f, 0.2f});
            break;
        case 9:  // boxes that touch exactly, then miss by the least there is
            for (int k = 0; k < 6; ++k) {
                const FloatAabb near = crowd.box(some());
                const float x = frame % 2 == 0 ? near.upper.x : std::nextafter(near.upper.x, 1e30f);
                if (near.lower.x <= near.upper.x) crowd.place(some(), cube({x, near.lower.y, near.lower.z}, 0.5f));
            }
            break;
        case 10:  // points and plates, zeros of both signs
            for (int k = 0; k < 6; ++k) {
                const vec3 p = random.unit() < 0.5 ? vec3{-0.0f} : vec3{0.0f};
                crowd.place(some(), {p, p + vec3{frame % 2 == 0 ? 0.0f : 3.0f, 0.0f, 0.0f}});
            }
            break;
        default:  // nothing moves, though some are listed
            for (int k = 0; k < 6; ++k) crowd.move_by(some(), vec3{0.0f});
            break;
    }
}

TEST_P(Endurance, AnAdversaryOverAThousandFrames) {
    for (const Distribution kind : {Distribution::Uniform, Distribution::Mixed, Distribution::Line}) {
        Crowd crowd(kind, kBoxes, 0xadd, false);
        Broadphase broadphase({.method = GetParam()});
        Random random(0xbad);
        for (int frame = 0; frame < kFrames; ++frame) {
            SCOPED_TRACE(testing::Message() << "distribution " << int(kind) << ", frame " << frame);
            ASSERT_NO_FATAL_FAILURE(crowd.check(broadphase, executor(frame)));
            if (frame % 37 == 0) {
                ASSERT_NO_FATAL_FAILURE(crowd.refuse_nan(broadphase, serial_, static_cast<std::uint32_t>(frame % 90), frame % 3));
            }
            be_nasty(crowd, random, frame);
        }
    }
}

// A hundred thousand boxes come at once to a few that are there, and all go at once. The oracle looks at some rows.
TEST_P(Endurance, AHundredThousandAtOnce) {
    constexpr std::uint32_t kFew = 1000, kRows = 100;
    // With every pair of 100,000 tested, brute force would take up the time of all other tests.
    const std::uint32_t all = GetParam() == BroadphaseMethod::BruteForce ? 20000 : 100000;
    const double side = 120.0;
    Random random(0x1e5);
    std::vector<FloatAabb> boxes;
    for (std::uint32_t i = 0; i < all; ++i) boxes.push_back(cube(random_point(random, side / 2), static_cast<float>(random.range(1, 2))));
    const std::vector<ProxyFilter> filters(all);
    std::vector<std::uint32_t> slots(all);
    std::iota(slots.begin(), slots.end(), 0u);
    Broadphase broadphase({.method = GetParam()});
    broadphase.update({boxes, filters, std::span(slots).first(kFew), {}}, serial_);
    const std::size_t pairs_of_few = broadphase.result().pairs.size();
    const PairUpdate& found = broadphase.update({boxes, filters, std::span(slots).subspan(kFew), {}}, four_);
    EXPECT_EQ(found.begun.size(), found.pairs.size() - pairs_of_few);
    EXPECT_TRUE(found.ended.empty());
    EXPECT_EQ(broadphase.live_count(), all);
    EXPECT_TRUE(std::is_sorted(found.pairs.begin(), found.pairs.end()));
    for (std::uint32_t row = 0; row < all; row += all / kRows) {
        std::vector<ProxyPair> want;
        for (std::uint32_t b = row + 1; b < all; ++b) {
            if (overlaps(boxes[row], boxes[b])) want.push_back({row, b});
        }
        const auto first = std::lower_bound(found.pairs.begin(), found.pairs.end(), ProxyPair{row, 0});
        const auto last = std::lower_bound(found.pairs.begin(), found.pairs.end(), ProxyPair{row + 1, 0});
        ASSERT_EQ(std::vector<ProxyPair>(first, last), want) << row;
    }
    const std::size_t all_pairs = found.pairs.size();
    broadphase.update({boxes, filters, {}, slots}, four_);
    EXPECT_EQ(found.ended.size(), all_pairs);
    EXPECT_TRUE(found.pairs.empty());
    EXPECT_EQ(broadphase.live_count(), 0u);
    EXPECT_EQ(broadphase.update({boxes, filters, std::span(slots).first(kFew), {}}, serial_).pairs.size(), pairs_of_few);
}

std::vector<BroadphaseMethod> all_and_the_choice() {
    std::vector<BroadphaseMethod> methods(std::begin(kBroadphaseMethods), std::end(kBroadphaseMethods));
    methods.push_back(BroadphaseMethod::Automatic);
    return methods;
}

INSTANTIATE_TEST_SUITE_P(All, Endurance, ::testing::ValuesIn(all_and_the_choice()),
                         [](const auto& tested) { return std::string(to_string(tested.param)); });

}  // namespace
}  // namespace carom
