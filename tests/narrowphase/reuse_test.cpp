// Contacts that are carried along: how far from those found anew, and what is never carried.
#include "oracle.hpp"

#include <carom/collision/compound.hpp>
#include <carom/core/check.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/simd_width.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace carom {
namespace {

using namespace test;

constexpr float kMargin = 0.05f;

// Pairs of shapes, each pair with two shapes of its own, that meet the batch again and again.
struct Crowd {
    std::vector<Shape> shapes;
    std::vector<Pose> poses;
    std::vector<NumberedPair> pairs;
    std::vector<Manifold> last, found;
    CollideScratch scratch;

    void add(Shape a, Shape b, const Pose& pose_b, float slack) {
        const auto number = static_cast<std::uint32_t>(shapes.size());
        shapes.push_back(std::move(a));
        shapes.push_back(std::move(b));
        poses.push_back({{1, 2, 3}, about({0, 0, 1}, 0.3)});
        poses.push_back(poses.back() * pose_b);
        pairs.push_back({number, number + 1, kMargin, slack});
    }
    [[nodiscard]] std::vector<const Shape*> pointers() const {
        std::vector<const Shape*> all;
        for (const Shape& s : shapes) all.push_back(&s);
        return all;
    }
    CollideCounts collide_again(Executor& executor) {
        std::swap(last, found);
        const CollideCounts counts = collide({pointers(), poses}, pairs, last, executor, scratch, found);
        for (std::size_t k = 0; k < pairs.size(); ++k) pairs[k].last = static_cast<std::uint32_t>(k);
        return counts;
    }
    CollideCounts collide_again() {
        SerialExecutor serial;
        return collide_again(serial);
    }
    // Found anew, as far as margin and slack.
    [[nodiscard]] std::vector<Manifold> fresh(std::size_t pair) const {
        std::vector<Manifold> out;
        const NumberedPair& p = pairs[pair];
        collide({&shapes[p.a], &shapes[p.b], poses[p.a], poses[p.b], p.margin + p.slack}, static_cast<std::uint32_t>(pair), out);
        return out;
    }
    [[nodiscard]] std::vector<Manifold> of(std::size_t pair) const {
        std::vector<Manifold> mine;
        for (const Manifold& m : found) {
            if (m.pair == pair) mine.push_back(m);
        }
        return mine;
    }
};

double deepest(const std::vector<Manifold>& manifolds) {
    double least = std::numeric_limits<double>::infinity();
    for (const Manifold& m : manifolds) {
        for (const ContactPoint& p : m.used()) least = std::min(least, static_cast<double>(p.separation));
    }
    return least;
}

bool same_bits(const std::vector<Manifold>& a, const std::vector<Manifold>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Manifold)) == 0);
}

Crowd random_crowd(Random& r, int count, float slack) {
    constexpr ShapeType kFlat[] = {ShapeType::Box, ShapeType::ConvexHull};
    Crowd crowd;
    for (int i = 0; i < count; ++i) {
        const Shape a = random_shape(kFlat[i % 2], r), b = random_shape(kFlat[i / 2 % 2], r);
        crowd.add(a, b, {random_direction(r) * r.range(0.3, 1.8), random_rotation(r)}, slack);
    }
    return crowd;
}

void move_by(Pose& pose, Random& r, double distance, double angle) {
    pose.position += random_direction(r) * distance;
    pose.orientation = about(random_direction(r), angle) * pose.orientation;
}

TEST(Reuse, DepthsAreOffByTwiceTheMotionAtMostAndBySecondOrderAsARule) {
    Random r(1);
    constexpr double kMotion = 4e-4;
    Crowd crowd = random_crowd(r, 4000, 2e-3f);
    EXPECT_EQ(crowd.collide_again().reused, 0u);
    for (std::size_t k = 1; k < crowd.poses.size(); k += 2) move_by(crowd.poses[k], r, 0.5 * kMotion, 0.25 * kMotion);
    for (std::size_t k = 0; k < crowd.poses.size(); k += 2) move_by(crowd.poses[k], r, 0.5 * kMotion, 0.25 * kMotion);
    EXPECT_EQ(crowd.collide_again().reused, crowd.pairs.size());
    int touching = 0, second_order = 0;
    for (std::size_t k = 0; k < crowd.pairs.size(); ++k) {
        const std::vector<Manifold> carried = crowd.of(k), fresh = crowd.fresh(k);
        if (carried.empty()) {
            // Nothing within the margin was forgotten.
            ASSERT_GT(deepest(fresh), static_cast<double>(kMargin)) << k;
            continue;
        }
        if (fresh.empty()) continue;  // left the margin and the slack
        ++touching;
        // Both shapes moved: 0.5 + 0.5 of kMotion, and turns of 0.25 of it with points up to 1.8 m away.
        const double motion = kMotion * (1.0 + 2.0 * 0.25 * 1.8);
        const double error = std::abs(deepest(carried) - deepest(fresh));
        ASSERT_LT(error, 2.0 * motion + 4e-6) << k;
        second_order += error < 4e-6 ? 1 : 0;  // motion squared, and roundings
    }
    EXPECT_GT(touching, 1000);
    EXPECT_GT(second_order, touching * 9 / 10);
}

TEST(Reuse, ABoxThatSinksIntoAPlaneIsCarriedExactly) {
    Crowd crowd;
    crowd.add(Box{{0.5f, 0.5f, 0.5f}}, Plane{{0, 1, 0}, 0.0f}, {}, 1e-3f);
    crowd.poses = {{{0, 0.499, 0}, kIdentityRotation}, {}};
    crowd.collide_again();
    for (int k = 1; k <= 8; ++k) {
        crowd.poses[0] = {{1e-5 * k, 0.499 - 1e-4 * k, 0}, kIdentityRotation};
        EXPECT_EQ(crowd.collide_again().reused, 1u);
        ASSERT_EQ(crowd.found.size(), 1u);
        ASSERT_EQ(crowd.found[0].count, 4u);
        EXPECT_EQ(crowd.found[0].normal, vec3(0, -1, 0));
        for (const ContactPoint& p : crowd.found[0].used()) EXPECT_NEAR(p.separation, -0.001 - 1e-4 * k, 1e-7);
    }
    crowd.poses[0].position.y -= 3e-4;  // 1.1 mm in all
    EXPECT_EQ(crowd.collide_again().reused, 0u);
}

TEST(Reuse, WhatMovedFartherThanItsSlackIsFoundAnew) {
    Random r(2);
    Crowd crowd = random_crowd(r, 500, 1e-3f);
    crowd.collide_again();
    for (std::size_t k = 1; k < crowd.poses.size(); k += 2) move_by(crowd.poses[k], r, 1.1e-3, 0.0);
    EXPECT_EQ(crowd.collide_again().reused, 0u);
    for (std::size_t k = 0; k < crowd.pairs.size(); ++k) ASSERT_TRUE(same_bits(crowd.of(k), crowd.fresh(k))) << k;
    // Nor what turned so that its farthest point moved as far.
    for (std::size_t k = 1; k < crowd.poses.size(); k += 2) crowd.poses[k].orientation = about(random_direction(r), 0.02) * crowd.poses[k].orientation;
    EXPECT_EQ(crowd.collide_again().reused, 0u);
    // Nor what has no slack, though it rests, nor what comes closer faster by more than the slack.
    for (NumberedPair& p : crowd.pairs) p.slack = 0.0f;
    EXPECT_EQ(crowd.collide_again().reused, 0u);
    for (NumberedPair& p : crowd.pairs) p.slack = 1e-3f;
    EXPECT_EQ(crowd.collide_again().reused, crowd.pairs.size());
    for (NumberedPair& p : crowd.pairs) p.margin = kMargin + 2e-3f;
    EXPECT_EQ(crowd.collide_again().reused, 0u);
}

TEST(Reuse, EveryPairIsLookedAtAnewInTime) {
    Random r(3);
    Crowd crowd = random_crowd(r, 300, 1e-3f);
    crowd.collide_again();
    std::size_t looked = 0, most = 0;
    for (int k = 0; k < 64; ++k) {
        const std::size_t now = crowd.pairs.size() - crowd.collide_again().reused;
        looked += now;
        most = std::max(most, now);
    }
    EXPECT_GE(looked, crowd.pairs.size());
    EXPECT_LT(most, crowd.pairs.size() / 5);  // not all in one step
    // A pair at rest keeps what was found.
    for (std::size_t k = 0; k < crowd.pairs.size(); ++k) {
        const std::vector<Manifold> fresh = crowd.fresh(k), carried = crowd.of(k);
        ASSERT_EQ(fresh.size(), carried.size());
        if (fresh.empty()) continue;
        ASSERT_EQ(deepest(fresh), deepest(carried));
    }
}

TEST(Reuse, CurvedShapesAreCarriedByTheirCoresOrLookedAt) {
    const std::vector<CompoundPart> parts{{Box{{0.2f, 0.2f, 0.2f}}, {}}, {Sphere{0.3f}, {{0.3, 0, 0}, kIdentityRotation}}};
    const std::vector<CompoundPart> flat_parts{{Box{{0.2f, 0.2f, 0.2f}}, {}}, {Box{{0.3f, 0.1f, 0.1f}}, {{0.3, 0, 0}, kIdentityRotation}}};
    const Shape ground = Box{{5, 0.5f, 5}};
    const auto reused = [&](const Shape& shape, double height) {
        Crowd crowd;
        crowd.add(shape, ground, {}, 1e-3f);
        crowd.poses = {{{0, height, 0}, kIdentityRotation}, {{0, -0.5, 0}, kIdentityRotation}};
        crowd.collide_again();
        return crowd.collide_again().reused == 1;
    };
    for (const Shape& carried : {Shape{Box{{0.5f, 0.5f, 0.5f}}}, Shape{Compound::build(flat_parts).value()}, Shape{Sphere{0.5f}}, Shape{Capsule{0.3f, 0.1f}}}) {
        EXPECT_TRUE(reused(carried, 0.3));
    }
    for (const Shape& curved : {Shape{Cylinder{0.5f, 0.5f}}, Shape{Cone{0.5f, 0.5f}}, Shape{Compound::build(parts).value()}}) {
        EXPECT_FALSE(reused(curved, 0.3));
        EXPECT_TRUE(reused(curved, 3.0));  // apart it is
    }
}

TEST(Reuse, WhatRollsKeepsItsContactBelowItsCore) {
    Random r(6);
    for (int i = 0; i < 200; ++i) {
        Crowd crowd;
        const float radius = static_cast<float>(r.range(0.1, 0.5));
        const bool ball = i % 2 == 0;
        crowd.add(ball ? Shape{Sphere{radius}} : Shape{Capsule{radius, 0.3f}}, Box{{5, 0.5f, 5}}, {}, 5e-3f);
        const double height = static_cast<double>(radius) - 1e-3;
        // A capsule lies along z; either rolls along x.
        const dquat lying = ball ? random_rotation(r) : about({1, 0, 0}, 0.5 * kPi);
        crowd.poses = {{{0, height, 0}, lying}, {{0, -0.5, 0}, kIdentityRotation}};
        crowd.collide_again();
        for (int k = 1; k <= 5; ++k) {
            const double way = 8e-5 * k;
            crowd.poses[0] = {{way, height - 1e-5 * k, 0}, about({0, 0, 1}, -way / static_cast<double>(radius)) * lying};
            EXPECT_EQ(crowd.collide_again().reused, 1u);
            ASSERT_EQ(crowd.found.size(), 1u);
            for (const ContactPoint& p : crowd.found[0].used()) {
                EXPECT_NEAR(p.position.x, 0.0, 1e-6);  // about A, which is above it
                EXPECT_NEAR(p.separation, -1e-3 - 1e-5 * k, 1e-6);
            }
        }
    }
    // Two balls: the normal turns with the line between them.
    Crowd crowd;
    crowd.add(Sphere{0.5f}, Sphere{0.25f}, {}, 2e-3f);
    crowd.poses = {{{0, 0, 0}, kIdentityRotation}, {{0, 0.749, 0}, kIdentityRotation}};
    crowd.collide_again();
    crowd.poses[1].position = {1e-3, 0.749, 0};
    EXPECT_EQ(crowd.collide_again().reused, 1u);
    ASSERT_EQ(crowd.found.size(), 1u);
    EXPECT_NEAR(crowd.found[0].normal.x, 1e-3 / 0.749, 1e-6);
    EXPECT_NEAR(crowd.found[0].points[0].separation, std::hypot(1e-3, 0.749) - 0.75, 2e-6);
    // Where the two centres nearly coincide it turns by as much as they like.
    Crowd deep;
    deep.add(Sphere{0.5f}, Sphere{0.5f}, {}, 2e-3f);
    deep.poses = {{{0, 0, 0}, kIdentityRotation}, {{0, 2e-3, 0}, kIdentityRotation}};
    deep.collide_again();
    deep.poses[1].position = {1.5e-3, 2e-3, 0};
    EXPECT_EQ(deep.collide_again().reused, 1u);
    EXPECT_NEAR(deep.found[0].points[0].separation, 2.5e-3 - 1.0, 1e-6);
}

// Says that it has three threads, and runs the last range first.
class Backwards final : public Executor {
public:
    [[nodiscard]] int thread_count() const noexcept override { return 3; }
    void parallel_for(std::size_t count, std::size_t grain, Body body) override {
        for (std::size_t end = count; end > 0;) {
            const std::size_t begin = (end - 1) / grain * grain;
            body(begin, end);
            end = begin;
        }
    }
};

TEST(Reuse, ThreadsAndSimdWidthsChangeNothing) {
    Backwards three;
    Random r(5);
    Crowd one = random_crowd(r, 1500, 1e-3f);
    const auto same_crowd = [] {
        Random again(5);
        return random_crowd(again, 1500, 1e-3f);
    };
    Crowd other = same_crowd();
    std::vector<Crowd> by_width;
    for (std::size_t i = 0; i < available_simd_widths().size(); ++i) by_width.push_back(same_crowd());
    for (int k = 0; k < 4; ++k) {
        const CollideCounts counts = one.collide_again();
        EXPECT_EQ(counts.reused, other.collide_again(three).reused);
        EXPECT_EQ(counts.reused > 0, k > 0);
        ASSERT_TRUE(same_bits(one.found, other.found));
        for (std::size_t i = 0; i < by_width.size(); ++i) {
            set_simd_width(available_simd_widths()[i]);
            by_width[i].poses = one.poses;
            EXPECT_EQ(by_width[i].collide_again().reused, counts.reused);
            ASSERT_TRUE(same_bits(one.found, by_width[i].found)) << simd_width();
        }
        set_simd_width(0);
        for (std::size_t p = 0; p < one.poses.size(); p += 3) one.poses[p].position.x += 4e-4;
        other.poses = one.poses;
    }
}

// On one thread five blocks of pairs, on three a single one; pairs that are carried along lie among those that are not.
TEST(Reuse, BlocksOfPairsChangeNothing) {
    Backwards three;
    SerialExecutor serial;
    const auto crowd = [] {
        Random r(8);
        Crowd all;
        for (int i = 0; i < 5000; ++i) {
            const double gap = r.range(0.97, 1.1);  // some touch, some are near, some are not
            all.add(Box{vec3{0.5f}}, Sphere{0.5f}, {{r.range(-0.3, 0.3), gap, r.range(-0.3, 0.3)}, kIdentityRotation}, 1e-3f);
        }
        return all;
    };
    Crowd one = crowd(), other = crowd();
    for (int k = 0; k < 4; ++k) {
        const CollideCounts counts = one.collide_again(serial);
        EXPECT_EQ(counts.reused, other.collide_again(three).reused);
        EXPECT_EQ(counts.reused > 0 && counts.reused < 5000, k > 0);
        ASSERT_TRUE(same_bits(one.found, other.found)) << k;
        ASSERT_TRUE(std::ranges::is_sorted(one.found, {}, &Manifold::pair));
        if (k == 0) {
            std::vector<Manifold> single;
            for (std::uint32_t i = 0; i < one.pairs.size(); ++i) {
                const NumberedPair& p = one.pairs[i];
                collide({&one.shapes[p.a], &one.shapes[p.b], one.poses[p.a], one.poses[p.b], p.margin + p.slack}, i, single);
            }
            ASSERT_TRUE(same_bits(one.found, single));
        }
        for (std::size_t p = 0; p < one.poses.size(); p += 3) one.poses[p].position.x += p % 2 == 0 ? 4e-4 : 4e-3;
        other.poses = one.poses;
    }
}

int g_reports = 0;
ErrorCode g_code{};
void count_report(const Error& error) {
    ++g_reports;
    g_code = error.code;
}

TEST(Reuse, MisuseIsReportedAndChangesNothing) {
    Crowd crowd;
    crowd.add(Box{{0.5f, 0.5f, 0.5f}}, Box{{0.5f, 0.5f, 0.5f}}, {{0, 0.9, 0}, kIdentityRotation}, 1e-3f);
    crowd.add(Box{{0.5f, 0.5f, 0.5f}}, Box{{0.5f, 0.5f, 0.5f}}, {{0, 0.9, 0}, kIdentityRotation}, 1e-3f);
    crowd.collide_again();
    ASSERT_EQ(crowd.found.size(), 2u);
    SerialExecutor serial;
    const ErrorHandler before = set_error_handler(count_report);
    const auto refused = [&](NumberedPair pair, std::span<const Manifold> last, ErrorCode code) {
        g_reports = 0;
        std::vector<Manifold> out(3);
        collide({crowd.pointers(), crowd.poses}, {&pair, 1}, last, serial, crowd.scratch, out);
        EXPECT_EQ(g_reports, 1);
        EXPECT_EQ(g_code, code);
        EXPECT_EQ(out.size(), 3u);
    };
    const std::span<const Manifold> last(crowd.found);
    refused({0, 1, 0.0f, -1e-9f, 0}, last, ErrorCode::InvalidArgument);
    refused({0, 1, 0.0f, std::numeric_limits<float>::infinity(), 0}, last, ErrorCode::NotFinite);
    refused({0, 1, 0.0f, 1e-3f, 2}, last, ErrorCode::InvalidArgument);             // no such pair
    refused({0, 1, 0.0f, 1e-3f, 1}, last, ErrorCode::InvalidArgument);             // another pair
    refused({0, 1, 0.0f, 1e-3f, 0}, last.first(1), ErrorCode::InvalidArgument);    // not its manifolds
    g_reports = 0;
    collide({crowd.pointers(), crowd.poses}, crowd.pairs, last, serial, crowd.scratch, crowd.found);
    EXPECT_EQ(g_reports, 1);
    EXPECT_EQ(crowd.found.size(), 2u);
    // The call that remembers nothing knows no batch before.
    g_reports = 0;
    std::vector<Manifold> out(3);
    collide({crowd.pointers(), crowd.poses}, crowd.pairs, serial, crowd.scratch, out);
    EXPECT_EQ(g_reports, 1);
    EXPECT_EQ(out.size(), 3u);
    set_error_handler(before);
    // And after all that the batch before is still known.
    EXPECT_EQ(crowd.collide_again().reused, 2u);
}

}  // namespace
}  // namespace carom
