// Every method gives the oracle's list: on every distribution, over moving frames, at every SIMD width and thread count.
#include "broadphase/distributions.hpp"

#include <carom/broadphase/broadphase.hpp>
#include <carom/core/check.hpp>
#include <carom/core/simd_width.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <thread>

namespace carom {
namespace {

using test::Distribution;

/// Cuts loops into ranges of odd sizes on three threads, so that pieces are made in no fixed order.
class ScatteringExecutor final : public Executor {
public:
    [[nodiscard]] int thread_count() const noexcept override { return 3; }
    void parallel_for(std::size_t count, std::size_t grain, Body body) override {
        std::vector<std::thread> threads;
        for (std::size_t t = 0; t < 3; ++t) {
            threads.emplace_back([=] {
                for (std::size_t begin = t * grain; begin < count; begin += 3 * grain) body(begin, std::min(begin + grain, count));
            });
        }
        for (std::thread& thread : threads) thread.join();
    }
};

std::vector<ProxyPair> copy(std::span<const ProxyPair> pairs) { return {pairs.begin(), pairs.end()}; }

class Methods : public ::testing::TestWithParam<BroadphaseMethod> {};

TEST_P(Methods, GiveTheOraclesListOverMovingFrames) {
    SerialExecutor executor;
    for (const Distribution kind : test::kDistributions) {
        for (const bool filtered : {false, true}) {
            const std::size_t n = kind == Distribution::Coincident ? 150 : 343;
            auto boxes = test::random_boxes(kind, n, 0xb0 + static_cast<std::uint64_t>(kind));
            const auto filters = filtered ? test::random_filters(n, 17) : std::vector<ProxyFilter>(n);
            const auto broadphase = make_broadphase(GetParam());
            Random random(0x3a3);
            for (int frame = 0; frame < 12; ++frame) {
                const auto pairs = copy(broadphase->update(boxes, filters, executor));
                ASSERT_EQ(pairs, test::all_pairs(boxes, filters)) << "distribution " << int(kind) << ", frame " << frame;
                test::move(boxes, random);
            }
        }
    }
}

TEST_P(Methods, GiveTheOraclesListForEveryCount) {
    SerialExecutor executor;
    const auto broadphase = make_broadphase(GetParam());  // one object, sizes going up and down
    for (const std::size_t n : {0u, 1u, 2u, 3u, 15u, 16u, 17u, 31u, 33u, 64u, 130u, 600u, 5u, 0u, 200u}) {
        const auto boxes = test::random_boxes(Distribution::Uniform, n, n);
        const std::vector<ProxyFilter> filters(n);
        ASSERT_EQ(copy(broadphase->update(boxes, filters, executor)), test::all_pairs(boxes, filters)) << n;
    }
}

TEST_P(Methods, AreTheSameAtEveryWidthAndOnManyThreads) {
    SerialExecutor serial;
    ScatteringExecutor scattering;
    for (const Distribution kind : test::kDistributions) {
        const std::size_t n = kind == Distribution::Coincident ? 200 : 1200;
        const auto boxes = test::random_boxes(kind, n, 0xd0 + static_cast<std::uint64_t>(kind));
        const auto filters = test::random_filters(n, 18);
        const auto want = copy(make_broadphase(GetParam())->update(boxes, filters, serial));
        for (const int width : available_simd_widths()) {
            set_simd_width(width);
            EXPECT_EQ(copy(make_broadphase(GetParam())->update(boxes, filters, serial)), want) << "width " << width;
            EXPECT_EQ(copy(make_broadphase(GetParam())->update(boxes, filters, scattering)), want) << "width " << width;
        }
        set_simd_width(0);
    }
}

TEST_P(Methods, ReportsWhichTheyAre) { EXPECT_EQ(make_broadphase(GetParam())->method(), GetParam()); }

TEST_P(Methods, RefuseBadInputAndKeepTheListBefore) {
    SerialExecutor executor;
    const auto boxes = test::random_boxes(Distribution::Uniform, 200, 1);
    const std::vector<ProxyFilter> filters(200);
    const auto broadphase = make_broadphase(GetParam());
    const auto want = copy(broadphase->update(boxes, filters, executor));
    ASSERT_FALSE(want.empty());

    const ErrorHandler before = set_error_handler([](const Error&) {});
    EXPECT_EQ(copy(broadphase->update(boxes, std::span(filters).first(199), executor)), want);
    const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity()};
    for (int k = 0; k < 3; ++k) {
        for (const float x : bad) {
            auto broken = boxes;
            broken[77].lower[k] = x;
            EXPECT_EQ(copy(broadphase->update(broken, filters, executor)), want);
            broken = boxes;
            broken[199].upper[k] = x;
            EXPECT_EQ(copy(broadphase->update(broken, filters, executor)), want);
            broken[199].lower[k] = x;
            EXPECT_EQ(copy(broadphase->update(broken, filters, executor)), want);
        }
        auto inverted = boxes;
        std::swap(inverted[3].lower[k], inverted[3].upper[k]);
        EXPECT_EQ(copy(broadphase->update(inverted, filters, executor)), want);
    }
    set_error_handler(before);
    auto inverted = boxes;
    std::swap(inverted[0].lower, inverted[0].upper);
    EXPECT_THROW(broadphase->update(inverted, filters, executor), MisuseError);
    EXPECT_THROW(broadphase->update({}, filters, executor), MisuseError);
    EXPECT_EQ(copy(broadphase->update(boxes, filters, executor)), want);
}

TEST_P(Methods, TakeTheWholeRangeOfFloat) {
    SerialExecutor executor;
    constexpr float kMax = std::numeric_limits<float>::max();
    std::vector<FloatAabb> boxes{{vec3{-kMax}, vec3{kMax}}, {vec3{kMax}, vec3{kMax}}, {vec3{-kMax}, vec3{-kMax}},
                                 {vec3{0.0f}, vec3{0.0f}},  {vec3{-0x1p-149f}, vec3{-0.0f}}};
    for (int i = 0; i < 200; ++i) boxes.push_back({vec3{static_cast<float>(i) * 1e36f}, vec3{static_cast<float>(i + 1) * 1e36f}});
    const std::vector<ProxyFilter> filters(boxes.size());
    EXPECT_EQ(copy(make_broadphase(GetParam())->update(boxes, filters, executor)), test::all_pairs(boxes, filters));
}

INSTANTIATE_TEST_SUITE_P(All, Methods, ::testing::Values(BroadphaseMethod::BruteForce, BroadphaseMethod::SweepAndPrune),
                         [](const auto& tested) { return std::string(to_string(tested.param)); });

TEST(MakeBroadphase, RefusesWhatIsNotAMethod) {
    EXPECT_THROW(static_cast<void>(make_broadphase(static_cast<BroadphaseMethod>(99))), MisuseError);
    EXPECT_STREQ(to_string(static_cast<BroadphaseMethod>(99)), "unknown");
}

}  // namespace
}  // namespace carom
