// Shapes that move and do not turn: where features lie along each other, and where the way is long.
#include <carom/narrowphase/time_of_impact.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

RigidMotion at(const dvec3& position, const dvec3& motion = dvec3{0.0}) { return {.start = {position, kIdentityRotation}, .translation = motion}; }

/// How far apart two shapes are when they are said to touch, beyond the separation that was asked for [m].
double gap_of(const Shape& a, const RigidMotion& ma, const Shape& b, const RigidMotion& mb, const Impact& impact, double separation) {
    return distance(a, pose_at(ma, impact.t), b, pose_at(mb, impact.t)).lower - separation;
}

// The corners that the search comes with may lie on a line, from which GJK does not go on: the planes it has seen are none that part the two then.
TEST(SlideCores, FeaturesAlongEachOtherTouchWhereTheyDo) {
    const Shape long_capsule = Capsule{0.4375f, 0.875f}, short_capsule = Capsule{0.4375f, 0.125f};
    const Impact past = time_of_impact(long_capsule, at({}), short_capsule, at({0.0, 0.375, 1.375}, {-0.75, -0.25, -0.75}));
    EXPECT_EQ(past.status, ImpactStatus::Separated) << past.t;

    const Shape box = Box{{0.25f, 0.625f, 0.75f}}, capsule = Capsule{0.375f, 0.75f};
    const Impact met = time_of_impact(box, at({}), capsule, at({0.75, 0.625, -1.125}, {-1.0, -0.75, 0.0}));
    EXPECT_EQ(met.status, ImpactStatus::Touching);
    EXPECT_NEAR(met.t, 0.5, 1e-4);  // it grazes: 1e-9 of a gap are 3e-5 of the way

    const Shape a = Box{{0.875f, 0.25f, 1.0f}}, b = Box{{1.0f, 1.0f, 0.375f}};
    const Impact apart = time_of_impact(a, at({}), b, at({1.0, 2.0, 1.875}, {-1.25, -2.375, 0.0}), {.separation = 0.5});
    EXPECT_EQ(apart.status, ImpactStatus::Touching);
    EXPECT_NEAR(apart.t, 0.31577, 1e-5);
    EXPECT_LT(gap_of(a, at({}), b, at({1.0, 2.0, 1.875}, {-1.25, -2.375, 0.0}), apart, 0.5), 1e-8);
}

TEST(SlideCores, OnAGridNothingTouchesFromAfar) {
    Random random(0x51de);
    const auto eighths = [&](int most) { return 0.125 * static_cast<double>(static_cast<int>(random.range(-most, most + 1))); };
    const auto size = [&] { return static_cast<float>(0.125 * (1.0 + std::floor(random.range(0.0, 8.0)))); };
    int touching = 0;
    double farthest = 0.0;
    for (int i = 0; i < 60'000; ++i) {
        const auto shape = [&](bool box) { return box ? Shape{Box{{size(), size(), size()}}} : Shape{Capsule{size(), size()}}; };
        const Shape a = shape(i % 2 == 0), b = shape(i % 3 == 0);
        RigidMotion ma = at({}), mb = at({eighths(24), eighths(24), eighths(24)}, {eighths(32), eighths(32), eighths(32)});
        if (i % 5 == 0) ma.start.orientation = mb.start.orientation = test::random_rotation(random);
        const double separation = i % 4 == 0 ? 0.5 : 0.0;
        const Impact impact = time_of_impact(a, ma, b, mb, {.separation = separation});
        if (impact.status != ImpactStatus::Touching) continue;
        ++touching;
        farthest = std::max(farthest, gap_of(a, ma, b, mb, impact, separation));
        ASSERT_NEAR(glm::length(impact.normal), 1.0, 1e-9) << i;
    }
    EXPECT_GT(touching, 5'000);
    EXPECT_LT(farthest, 1e-8);
}

// A hundred thousand sizes and more: rounding is a share of the way, and the shapes touch before the search sees a direction between them.
TEST(SlideCores, AfterALongWayThereIsANormal) {
    Random random(0x10a6);
    for (int i = 0; i < 2'000; ++i) {
        const Shape a = Box{vec3(0.1f + 0.5f * vec3(glm::abs(test::random_direction(random))))}, b = Box{{0.3f, 0.4f, 0.5f}};
        const RigidMotion ma{.start = {dvec3{0.0}, test::random_rotation(random)}};
        RigidMotion mb{.start = {3.0 * test::random_direction(random), test::random_rotation(random)}};
        mb.translation = -std::pow(10.0, random.range(4.0, 8.0)) * distance(a, ma.start, b, mb.start).normal;
        const Impact impact = time_of_impact(a, ma, b, mb);
        ASSERT_EQ(impact.status, ImpactStatus::Touching) << i;
        ASSERT_NEAR(glm::length(impact.normal), 1.0, 1e-9) << i;
    }
}

// What a search begins with costs time and changes no bound.
TEST(SlideCores, CornersOnALineAreNoHindranceToADistance) {
    const Shape a = Box{{0.5f, 1.0f, 0.25f}}, b = Box{{1.0f, 0.75f, 0.75f}};
    const Pose pose_b{dvec3{2.875, -1.25, 2.125} + 0.32134235891507651 * dvec3{-3.5, 1.5, -2.625}, kIdentityRotation};
    DistanceCache line;
    line.a = {5, 5, 7};
    line.b = {2, 0, 0};
    line.count = 3;
    const DistanceResult result = distance(a, {dvec3{0.0}, kIdentityRotation}, b, pose_b, {}, &line);
    EXPECT_EQ(result.status, DistanceStatus::Converged);
    EXPECT_NEAR(result.lower, 0.37667, 1e-5);
    EXPECT_LT(result.upper - result.lower, 1e-12);
}

}  // namespace
}  // namespace carom
