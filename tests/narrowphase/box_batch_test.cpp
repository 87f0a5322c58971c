// Batches of boxes, to a vector and to a function: the bits of single calls, and what is wrong changes nothing.
#include "box_crowd.hpp"

#include <carom/core/check.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/simd_width.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <stdexcept>

namespace carom {
namespace {

using namespace test;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

bool same(std::span<const Manifold> a, std::span<const Manifold> b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

// Says that it has three threads, and so takes the way of those.
class ThreeThreads final : public Executor {
public:
    [[nodiscard]] int thread_count() const noexcept override { return 3; }
    void parallel_for(std::size_t count, std::size_t, Body body) override {
        if (count > 0) body(0, count);
    }
};

std::vector<Manifold> collided(const BoxCrowd& crowd) {
    SerialExecutor executor;
    CollideScratch scratch;
    std::vector<Manifold> out;
    collide({crowd.placed, crowd.poses}, crowd.pairs, executor, scratch, out);
    return out;
}

// What `take` is given, each pair once and in order.
std::vector<Manifold> taken(const BoxCrowd& crowd, std::size_t count, Executor& executor, CollideScratch& scratch) {
    std::vector<Manifold> all;
    std::size_t next = 0;
    collide({crowd.placed, crowd.poses}, std::span(crowd.pairs).first(count), executor, scratch,
            [&](std::size_t pair, std::span<const Manifold> found) {
                EXPECT_EQ(pair, next++);
                all.insert(all.end(), found.begin(), found.end());
            });
    EXPECT_EQ(next, count);
    return all;
}

// What fills no bundle waits for the pairs after it, and few pairs are found before their poses are looked at: whatever is chosen, the
// manifolds are those of one pair at a time.
TEST(BoxBatch, ManyAreThoseOfOneToTheBit) {
    BoxCrowd crowd(2500);
    for (std::size_t i = 300; i < 700; ++i) {  // where none is unusual
        for (std::size_t k = 2 * i; k < 2 * i + 2; ++k) crowd.shapes[k] = Box{{0.5f, 0.4f, 0.3f}};
    }
    SerialExecutor executor;
    CollideScratch scratch;
    std::vector<Manifold> out;
    for (const std::size_t count : {2500u, 1025u, 1024u, 690u, 129u, 128u, 16u, 1u, 0u}) {
        const std::vector<Manifold> expected = crowd.singles(count);
        for (const int width : available_simd_widths()) {
            set_simd_width(width);
            collide({crowd.placed, crowd.poses}, std::span(crowd.pairs).first(count), executor, scratch, out);
            EXPECT_TRUE(same(out, expected)) << count << ", width " << width;
            EXPECT_TRUE(same(taken(crowd, count, executor, scratch), expected)) << count << ", width " << width;
            set_simd_width(0);
        }
    }
}

// Of unusual pairs each has a cut and a unit of its own, which those that wait for more do not take with them.
TEST(BoxBatch, AFifthUnusualAmongManyAreThoseOfOne) {
    BoxCrowd crowd(700);
    Random r(34);
    for (std::size_t i = 0; i < 700; ++i) {
        const float by = i % 10 == 1 ? 60.0f : i % 10 == 6 ? 0x1p-24f : 1.0f;
        const vec3 half = by * vec3{0.5f, 0.4f, 0.3f}, other = by > 1.0f ? vec3{0.5f} : by * vec3{0.5f};
        crowd.shapes[2 * i] = Box{half}, crowd.shapes[2 * i + 1] = Box{other};
        crowd.pairs[i] = {static_cast<std::uint32_t>(2 * i), static_cast<std::uint32_t>(2 * i + 1)};
        const double near = static_cast<double>(half.x + 0.9f * other.x), aside = 0.9 * static_cast<double>(half.y);
        crowd.poses[2 * i].position = {0.0, 0.0, 0.0};
        const double away = i % 3 == 2 ? 3.0 : 1.0;  // some are apart, so that some of those near wait
        crowd.poses[2 * i + 1] = crowd.poses[2 * i] * Pose{{away * near, aside, 0.0}, about(random_direction(r), 0.05)};
    }
    const std::vector<Manifold> expected = crowd.singles(700);
    ASSERT_GT(expected.size(), 300u);
    EXPECT_TRUE(same(collided(crowd), expected));
}

// Quaternions of any length are no misuse, though the kernel cannot prove by the way that they are finite.
TEST(BoxBatch, OrientationsThatAreHugeAreNotRefused) {
    BoxCrowd crowd(40);
    for (std::size_t k = 10; k < 16; ++k) crowd.poses[k].orientation = crowd.poses[k].orientation * 1e20;
    const std::vector<Manifold> expected = crowd.singles(40);
    ASSERT_GT(expected.size(), 10u);
    EXPECT_TRUE(same(collided(crowd), expected));
    SerialExecutor executor;
    CollideScratch scratch;
    EXPECT_TRUE(same(taken(crowd, 40, executor, scratch), expected));
}

int g_reported = 0;
ErrorCode g_code = ErrorCode::InvalidArgument;
class ReportsAreCounted {
public:
    ReportsAreCounted() : before_(set_error_handler([](const Error& error) { ++g_reported, g_code = error.code; })) {}
    ~ReportsAreCounted() { set_error_handler(before_); }
    ReportsAreCounted(const ReportsAreCounted&) = delete;
    ReportsAreCounted& operator=(const ReportsAreCounted&) = delete;

private:
    ErrorHandler before_;
};

// A batch that is refused by either call, and changes nothing.
struct Refused {
    BoxCrowd& crowd;
    Executor& executor;
    CollideScratch scratch{};
    std::vector<Manifold> out{}, before{};

    Refused(BoxCrowd& good, Executor& threads) : crowd(good), executor(threads) {
        collide({crowd.placed, crowd.poses}, crowd.pairs, executor, scratch, out);
        before = out;
    }
    void expect(ErrorCode code, const char* what) {
        ReportsAreCounted counted;
        g_reported = 0;
        collide({crowd.placed, crowd.poses}, crowd.pairs, executor, scratch, out);
        EXPECT_TRUE(g_reported == 1 && g_code == code) << what;
        EXPECT_TRUE(same(out, before)) << what;
        g_reported = 0;
        collide({crowd.placed, crowd.poses}, crowd.pairs, executor, scratch,
                [&](std::size_t, std::span<const Manifold>) { FAIL() << what; });
        EXPECT_TRUE(g_reported == 1 && g_code == code) << what;
    }
};

// Few boxes on one thread, many, and several threads: all ways that there are.
void on_all_ways(const std::function<void(BoxCrowd&, Executor&)>& visit) {
    SerialExecutor one;
    ThreeThreads three;
    for (const std::size_t count : {200u, 1300u}) {
        BoxCrowd crowd(count);
        visit(crowd, one);
        visit(crowd, three);
    }
}

// Of few boxes poses are looked at last: what is not finite changes nothing, whichever number it is.
TEST(BoxBatch, WhatIsNotFiniteChangesNothing) {
    on_all_ways([](BoxCrowd& crowd, Executor& executor) {
        Refused refused(crowd, executor);
        ASSERT_GT(refused.before.size(), 100u);
        for (std::size_t number = 0; number < 7; ++number) {
            for (const std::size_t shape : {std::size_t{6}, std::size_t{7}, std::size_t{20}, std::size_t{399}}) {
                double& changed = crowd.number_of(shape, number);
                const double good = changed;
                for (const double wild : {kNaN, kInfinity, -kInfinity}) {
                    changed = wild;
                    refused.expect(ErrorCode::NotFinite, "a pose");
                }
                changed = good;
            }
        }
    });
}

// Of one pose alone, of a pair that float takes as it is, whichever number it is.
TEST(BoxBatch, OneNumberThatIsNotFiniteIsRefusedAtEveryWidth) {
    BoxCrowd crowd(40);
    SerialExecutor executor;
    Refused refused(crowd, executor);
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        for (std::size_t number = 0; number < 7; ++number) {
            for (const double wild : {kNaN, -kInfinity}) {
                for (const std::size_t shape : {std::size_t{0}, std::size_t{41}, std::size_t{79}}) {
                    double& changed = crowd.number_of(shape, number);
                    const double good = changed;
                    changed = wild;
                    refused.expect(ErrorCode::NotFinite, "a pose");
                    changed = good;
                }
            }
        }
        set_simd_width(0);
    }
}

// Numbers beyond the last shape are never followed, whatever else is wrong.
TEST(BoxBatch, PairsThatAreUnfitChangeNothing) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    on_all_ways([&](BoxCrowd& crowd, Executor& executor) {
        Refused refused(crowd, executor);
        const auto with = [&](const char* what, ErrorCode code, const std::function<void(NumberedPair&)>& spoil) {
            for (const std::size_t i : {std::size_t{0}, std::size_t{77}, crowd.pairs.size() - 1}) {
                const NumberedPair good = crowd.pairs[i];
                spoil(crowd.pairs[i]);
                refused.expect(code, what);
                crowd.pairs[i] = good;
            }
        };
        const auto invalid = ErrorCode::InvalidArgument;
        for (const float wild : {nan, infinity, -infinity}) {
            with("margin", ErrorCode::NotFinite, [&](NumberedPair& pair) { pair.margin = wild; });
            with("slack", ErrorCode::NotFinite, [&](NumberedPair& pair) { pair.slack = wild; });
        }
        with("margin", invalid, [](NumberedPair& pair) { pair.margin = -1e-45f; });
        with("slack", invalid, [](NumberedPair& pair) { pair.slack = -1e-45f; });
        with("last", invalid, [](NumberedPair& pair) { pair.last = 0; });
        with("beyond", invalid, [&](NumberedPair& pair) { pair.b = static_cast<std::uint32_t>(crowd.placed.size()); });
        const Pose good = crowd.poses[0];
        crowd.poses[0].position.x = kNaN;
        with("beyond", invalid, [](NumberedPair& pair) { pair.a = 4'000'000'000u; });
        crowd.poses[0] = good;
        const Shape* const shape = std::exchange(crowd.placed[50], nullptr);
        refused.expect(invalid, "null");
        crowd.placed[50] = shape;
        crowd.poses.emplace_back();
        refused.expect(invalid, "sizes");
        crowd.poses.pop_back();
    });
}

// What no pair names may lie anywhere, however many pairs and threads there are; huge numbers that are finite are no misuse.
TEST(BoxBatch, OnlyPosesThatPairsNameAreLookedAt) {
    SerialExecutor one;
    ThreeThreads three;
    for (const std::size_t count : {200u, 1300u}) {
        for (Executor* executor : {static_cast<Executor*>(&one), static_cast<Executor*>(&three)}) {
            BoxCrowd crowd(count);
            CollideScratch scratch;
            std::vector<Manifold> out;
            const std::vector<Manifold> expected = crowd.singles(count);
            const auto expect_the_same = [&] {
                collide({crowd.placed, crowd.poses}, crowd.pairs, *executor, scratch, out);
                EXPECT_TRUE(same(out, expected));
                EXPECT_TRUE(same(taken(crowd, crowd.pairs.size(), *executor, scratch), expected));
            };
            const Shape box = Box{{0.5f, 0.5f, 0.5f}};
            crowd.placed.push_back(&box);
            crowd.poses.push_back({dvec3(kNaN), kIdentityRotation});
            expect_the_same();
            crowd.poses.back() = {dvec3(1e300), kIdentityRotation};
            crowd.pairs.push_back({0, static_cast<std::uint32_t>(crowd.placed.size() - 1), 0.0f});
            expect_the_same();
        }
    }
}

// Neither call is remembered, and both forget the batch before: no pair may name its `last` after them.
TEST(BoxBatch, WhatIsNotRememberedCannotBeNamed) {
    on_all_ways([](BoxCrowd& crowd, Executor& executor) {
        const std::vector<NumberedPair> good = crowd.pairs;
        std::vector<NumberedPair> again = good;
        for (std::uint32_t i = 0; i < again.size(); ++i) again[i].last = i;
        const auto refuses_after = [&](const std::function<void(CollideScratch&)>& call) {
            CollideScratch scratch;
            std::vector<Manifold> first, second;
            collide({crowd.placed, crowd.poses}, good, {}, executor, scratch, first);
            collide({crowd.placed, crowd.poses}, again, first, executor, scratch, second);
            EXPECT_TRUE(same(second, first));
            call(scratch);
            ReportsAreCounted counted;
            g_reported = 0;
            collide({crowd.placed, crowd.poses}, again, second, executor, scratch, first);
            return g_reported == 1 && g_code == ErrorCode::InvalidArgument;
        };
        std::vector<Manifold> out;
        EXPECT_FALSE(refuses_after([](CollideScratch&) {}));
        EXPECT_TRUE(refuses_after([&](CollideScratch& s) { collide({crowd.placed, crowd.poses}, good, executor, s, out); }));
        EXPECT_TRUE(refuses_after([&](CollideScratch& s) { taken(crowd, good.size(), executor, s); }));
        const auto throwing = [](std::size_t, std::span<const Manifold>) { throw std::runtime_error("enough"); };
        EXPECT_TRUE(refuses_after([&](CollideScratch& s) {
            EXPECT_THROW(collide({crowd.placed, crowd.poses}, good, executor, s, throwing), std::runtime_error);
        }));
    });
}

TEST(BoxBatch, WhatTakeThrowsLeavesTheScratchFit) {
    on_all_ways([](BoxCrowd& crowd, Executor& executor) {
        const std::vector<Manifold> expected = crowd.singles(crowd.pairs.size());
        CollideScratch scratch;
        std::size_t calls = 0;
        const auto throwing = [&](std::size_t pair, std::span<const Manifold>) {
            ++calls;
            if (pair == 41) throw std::runtime_error("enough");
        };
        EXPECT_THROW(collide({crowd.placed, crowd.poses}, crowd.pairs, executor, scratch, throwing), std::runtime_error);
        EXPECT_EQ(calls, 42u);
        EXPECT_TRUE(same(taken(crowd, crowd.pairs.size(), executor, scratch), expected));
    });
}

}  // namespace
}  // namespace carom
