// The distance of two boxes by their nearest features, and searches among placed points: against exact rationals and against the plain search.
#include <fuzz/convex_check.hpp>

#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/detail/box_distance.hpp>

#include <gtest/gtest.h>

#include <array>
#include <optional>

namespace carom {
namespace {

using test::Condition;
using test::NearPair;

std::optional<DistanceResult> by_features(const NearPair& p, double tolerance = 0.0) {
    return detail::box_distance(std::get<Box>(p.a).half_extents, p.pose_a, std::get<Box>(p.b).half_extents, p.pose_b, tolerance);
}

TEST(BoxDistance, BoundsHoldAgainstExactRationals) {
    Random random(0xb0c5);
    int apart = 0, overlapping = 0;
    for (const Condition condition : test::kConditions) {
        for (int i = 0; i < 60; ++i) {
            const NearPair p = test::near_pair(random, ShapeType::Box, ShapeType::Box, condition);
            const std::optional<DistanceResult> r = by_features(p);
            if (!r) continue;
            ASSERT_EQ(test::bounds_fault(p, test::JudgedPair(p), *r), "") << int(condition) << " " << i << " " << to_string(r->status);
            (r->status == DistanceStatus::Overlap ? overlapping : apart) += 1;
        }
    }
    EXPECT_GT(apart, 150);
    EXPECT_GT(overlapping, 100);
}

// Members of their boxes by their own coordinates, `upper` apart, and the normal's support planes `lower` apart, all in long double.
TEST(BoxDistance, WhatItSaysIsSeenAtItsPointsAndPlanes) {
    Random random(0x5ee);
    int seen = 0;
    for (const Condition condition : test::kConditions) {
        for (int i = 0; i < 2000; ++i) {
            const NearPair p = test::near_pair(random, ShapeType::Box, ShapeType::Box, condition);
            const std::optional<DistanceResult> r = by_features(p);
            if (!r || r->status == DistanceStatus::Overlap) continue;
            ++seen;
            const test::Real e = test::query_rounding(p);
            const auto half_a = test::real(dvec3(std::get<Box>(p.a).half_extents)),
                       half_b = test::real(dvec3(std::get<Box>(p.b).half_extents));
            const test::RealVec between = test::real(p.pose_b.position) - test::real(p.pose_a.position), n = test::real(r->normal);
            const glm::mat<3, 3, test::Real> axes_a = glm::mat3_cast(glm::qua<test::Real>(p.pose_a.orientation));
            const glm::mat<3, 3, test::Real> axes_b = glm::mat3_cast(glm::qua<test::Real>(p.pose_b.orientation));
            const test::RealVec on_a = test::real(r->on_a) * axes_a, on_b = (test::real(r->on_b) - between) * axes_b;
            test::Real gap = glm::dot(n, between);
            for (int k = 0; k < 3; ++k) {
                ASSERT_LE(std::abs(on_a[k]), half_a[k] + e) << int(condition) << " " << i;
                ASSERT_LE(std::abs(on_b[k]), half_b[k] + e) << int(condition) << " " << i;
                gap -= half_a[k] * std::abs(glm::dot(n, axes_a[k])) + half_b[k] * std::abs(glm::dot(n, axes_b[k]));
            }
            const test::Real apart = glm::length(test::real(r->on_b) - test::real(r->on_a));
            ASSERT_LE(apart, test::Real(r->upper)) << int(condition) << " " << i;
            ASSERT_GE(gap, test::Real(r->lower)) << int(condition) << " " << i;
            ASSERT_GE(apart, gap - e) << int(condition) << " " << i;
            ASSERT_LE(r->upper - r->lower, 4.0 * double(e)) << int(condition) << " " << i;
            ASSERT_EQ(r->status, DistanceStatus::Converged);
        }
    }
    EXPECT_GT(seen, 5000);
}

TEST(BoxDistance, NearlyAllPairsAreAnsweredInAFewSteps) {
    Random random(0xa115);
    int answered = 0, most = 0, steps = 0;
    constexpr int kPairs = 20000;
    for (int i = 0; i < kPairs; ++i) {
        const NearPair p = test::near_pair(random, ShapeType::Box, ShapeType::Box, Condition::Random);
        const std::optional<DistanceResult> r = by_features(p);
        if (!r) continue;
        ++answered;
        steps += r->iterations;
        most = std::max(most, r->iterations);
    }
    EXPECT_GT(answered, kPairs - kPairs / 1000);
    EXPECT_LT(steps, kPairs + kPairs / 5);
    EXPECT_LE(most, 6);
}

TEST(BoxDistance, KnownFeatures) {
    const Shape unit = Box{{1, 1, 1}};
    const dquat quarter = test::about({0, 0, 1}, 0.25 * kPi);  // an edge along z comes first
    const auto answer = [&](const Pose& b) { return by_features({unit, unit, {}, b, 1.0}).value(); };
    // Face to face, in part over each other; corner to corner; edge over a face; crossed edges.
    EXPECT_NEAR(answer({{3, 0.5, -0.25}, kIdentityRotation}).lower, 1.0, 1e-12);
    EXPECT_NEAR(answer({{3, 3, 3}, kIdentityRotation}).lower, std::sqrt(3.0), 1e-12);
    EXPECT_NEAR(answer({{1 + std::sqrt(2.0) + 0.5, 0.3, 0}, quarter}).lower, 0.5, 1e-12);
    const dquat tipped = test::about({0, 1, 0}, 0.5 * kPi) * quarter;  // its first edge along x
    const DistanceResult crossed =
        by_features({unit, unit, {{0, 0, 0}, quarter}, {{0, 2 * std::sqrt(2.0) + 0.25, 0}, tipped}, 1.0}).value();
    EXPECT_NEAR(crossed.lower, 0.25, 1e-12);
    EXPECT_NEAR(glm::length(crossed.normal - dvec3{0, 1, 0}), 0.0, 1e-12);
    EXPECT_NEAR(glm::length(crossed.on_a - dvec3{0, std::sqrt(2.0), 0}), 0.0, 1e-12);
    // An edge through a face, with all corners of either box outside of the other, and a box wholly inside.
    const Shape wide = Box{{4, 1, 4}};
    EXPECT_EQ(by_features({wide, unit, {}, {{4.2, 1.2, 0}, test::about({1, 0, 1}, 0.6)}, 1.0}).value().status, DistanceStatus::Overlap);
    EXPECT_EQ(by_features({wide, Box{{0.1f, 0.1f, 0.1f}}, {}, {}, 1.0}).value().status, DistanceStatus::Overlap);
}

// Found in the second round, after the first had points that were apart.
TEST(BoxDistance, AnOverlapHasNothingOfTheRoundsBefore) {
    const DistanceResult r = distance(Box{{0.25f, 1.0f, 0.75f}}, {}, Box{{0.5f, 0.75f, 0.75f}}, {{1.25, -0.75, 0.5}, {-0.1, -0.5, -0.7, 0.5}});
    EXPECT_EQ(r.status, DistanceStatus::Overlap);
    EXPECT_EQ(r.lower, 0.0);
    EXPECT_EQ(r.upper, 0.0);
    EXPECT_EQ(r.on_a, dvec3{0.0});
    EXPECT_EQ(r.on_b, dvec3{0.0});
    EXPECT_GT(r.iterations, 1);
}

TEST(BoxDistance, TouchingAndOutOfRangePairsAreLeftToTheSearch) {
    const Shape unit = Box{{1, 1, 1}};
    EXPECT_FALSE(by_features({unit, unit, {}, {{2, 0.5, 0}, kIdentityRotation}, 1.0}).has_value());
    EXPECT_FALSE(by_features({unit, unit, {}, {{1e70, 0, 0}, kIdentityRotation}, 1.0}).has_value());
    const DistanceResult touching = distance(unit, {}, unit, {{2, 0.5, 0}, kIdentityRotation});
    EXPECT_EQ(touching.lower, 0.0);
    EXPECT_LT(touching.upper, 1e-12);
    const DistanceResult far = distance(unit, {}, unit, {{1e70, 0, 0}, kIdentityRotation});
    EXPECT_LE(far.lower, 1e70);
    EXPECT_GE(far.upper, 1e70 * (1.0 - 1e-14));
    EXPECT_EQ(far.status, DistanceStatus::Converged);
}

TEST(BoxDistance, ATolerantAnswerKeepsItsBounds) {
    Random random(0x701);
    for (int i = 0; i < 500; ++i) {
        const NearPair p = test::near_pair(random, ShapeType::Box, ShapeType::Box, Condition::Random);
        const DistanceResult exact = distance(p.a, p.pose_a, p.b, p.pose_b);
        for (const double tolerance : {1e-3, 0.5, 4.0}) {
            const DistanceResult r = distance(p.a, p.pose_a, p.b, p.pose_b, {.tolerance = tolerance});
            EXPECT_LE(r.lower, exact.upper);
            EXPECT_GE(r.upper, exact.lower);
            EXPECT_GE(r.lower, 0.0);
        }
    }
}

// Boxes, hulls, segments and points: the search among placed points and the one that begins with an empty simplex prove bounds of one distance.
TEST(SearchPoints, AgreesWithThePlainSearchAtEveryWidth) {
    Random random(0x5ea);
    constexpr std::array kTypes{ShapeType::Sphere, ShapeType::Box, ShapeType::Capsule, ShapeType::ConvexHull};
    int apart = 0, overlapping = 0;
    for (const Condition condition : test::kConditions) {
        for (std::size_t i = 0; i < 320; ++i) {
            const NearPair p = test::near_pair(random, kTypes[i % 4], kTypes[i / 4 % 4], condition);
            DistanceCache empty;
            const DistanceResult plain = distance(p.a, p.pose_a, p.b, p.pose_b, {}, &empty);
            const DistanceResult placed = distance(p.a, p.pose_a, p.b, p.pose_b);
            ASSERT_LE(std::max(plain.lower, placed.lower), std::min(plain.upper, placed.upper)) << int(condition) << " " << i;
            const double e = test::query_rounding(p);
            ASSERT_NEAR(plain.lower, placed.lower, 8.0 * e) << int(condition) << " " << i;
            if (plain.status == DistanceStatus::Converged || plain.status == DistanceStatus::Overlap) {
                ASSERT_EQ(plain.status, placed.status) << int(condition) << " " << i;
            }
            if (placed.lower > 0.0) {
                ASSERT_NEAR(glm::length(placed.on_b - placed.on_a), placed.upper, 2.0 * e) << int(condition) << " " << i;
                ++apart;
            }
            overlapping += placed.status == DistanceStatus::Overlap ? 1 : 0;
            for (const int width : available_simd_widths()) {
                set_simd_width(width);
                const DistanceResult again = distance(p.a, p.pose_a, p.b, p.pose_b);
                ASSERT_TRUE(again.lower == placed.lower && again.upper == placed.upper && again.on_a == placed.on_a &&
                            again.on_b == placed.on_b && again.normal == placed.normal && again.iterations == placed.iterations)
                    << width;
            }
            set_simd_width(0);
        }
    }
    EXPECT_GT(apart, 800);
    EXPECT_GT(overlapping, 500);
}

TEST(SearchPoints, HullsOfAnyNumberOfPoints) {
    Random random(0x64);
    for (const int count : {4, 8, 9, 16, 17, 33, 63, 64, 65, 72, 90, 200}) {
        for (int i = 0; i < 20; ++i) {
            const Shape a = test::random_hull(random, count, 1.0, 1.0), b = test::random_hull(random, 40, 0.4, 1.0);
            ASSERT_EQ(std::get<ConvexHullPtr>(a)->vertices().size(), static_cast<std::size_t>(count));
            const Pose here{{}, test::random_rotation(random)},
                there{random.range(0.2, 2.5) * test::random_direction(random), test::random_rotation(random)};
            DistanceCache empty;
            const DistanceResult plain = distance(a, here, b, there, {}, &empty), placed = distance(a, here, b, there);
            ASSERT_EQ(plain.status, placed.status) << count;
            ASSERT_NEAR(plain.lower, placed.lower, 1e-13) << count;
            ASSERT_NEAR(plain.upper, placed.upper, 1e-13) << count;
        }
    }
}

TEST(SearchPoints, TheCapOnIterationsHolds) {
    Random random(0xcab);
    int stopped = 0;
    for (int i = 0; i < 400; ++i) {
        const NearPair p = test::near_pair(random, ShapeType::ConvexHull, ShapeType::ConvexHull, Condition::Random);
        const DistanceResult exact = distance(p.a, p.pose_a, p.b, p.pose_b);
        for (const int most : {1, 2, 3}) {
            const DistanceResult r = distance(p.a, p.pose_a, p.b, p.pose_b, {.most_iterations = most});
            EXPECT_LE(r.lower, exact.upper);
            EXPECT_GE(r.upper, exact.lower);
            if (r.status != DistanceStatus::Stopped) continue;
            EXPECT_EQ(r.iterations, most);
            ++stopped;
        }
    }
    EXPECT_GT(stopped, 200);
}

}  // namespace
}  // namespace carom
