// Box against box: depth and axis against brute force, resting contacts, names that survive motion.
#include "oracle.hpp"

#include <carom/core/executor.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/distance.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace carom {
namespace {

using namespace test;

vec3 random_half(Random& r) {
    return {static_cast<float>(r.range(0.1, 1.0)), static_cast<float>(r.range(0.1, 1.0)), static_cast<float>(r.range(0.1, 1.0))};
}

// Poses of all sorts: free, almost aligned, faces on faces, deep.
Pose random_pose(Random& random, int kind) {
    Pose pose;
    pose.position = random_direction(random) * random.range(kind == 3 ? 0.0 : 0.3, kind == 3 ? 0.2 : 2.0);
    pose.orientation = random_rotation(random);
    if (kind == 1) pose.orientation = about(random_direction(random), random.range(-1e-6, 1e-6));
    if (kind == 2) pose.orientation = kIdentityRotation;
    return pose;
}

TEST(BoxBox, DepthIsTheLeastOverAllAxes) {
    Random random(20261122);
    const float margin = 0.05f;
    int touching = 0;
    for (int i = 0; i < 20000; ++i) {
        const Box a{random_half(random)}, b{random_half(random)};
        const Pose pa{random_direction(random) * 3.0, random_rotation(random)};
        const Pose local = random_pose(random, i % 4);
        const Pose pb = pa * local;
        const Separation truth = greatest_separation(solid_of(a, pa, pa.position), solid_of(b, pb, pa.position));
        const std::vector<Manifold> m = collide_all(a, pa, b, pb, margin);
        if (truth.value > Real(margin) + 1e-6L) {
            EXPECT_TRUE(m.empty()) << i;
        } else if (truth.value < 0) {
            ASSERT_EQ(m.size(), 1u) << i;
            ++touching;
            EXPECT_NEAR(static_cast<double>(truth.value), static_cast<double>(least_separation(m[0])), 2e-6) << i << " kind " << i % 4;
            const double length = std::sqrt(glm::dot(dvec3(m[0].normal), dvec3(m[0].normal)));
            EXPECT_NEAR(length, 1.0, 1e-6);
        }
    }
    EXPECT_GT(touching, 4000);
}

TEST(BoxBox, RestingFaceHasItsFourCorners) {
    const Shape ground = Box{{5.0f, 0.5f, 5.0f}};
    const Shape crate = Box{{0.5f, 0.25f, 0.375f}};
    const Pose pa{{0.0, -0.5, 0.0}, kIdentityRotation};
    const Pose pb{{1.0, 0.249, 2.0}, about({0, 1, 0}, 0.3)};
    const std::vector<Manifold> m = collide_all(ground, pa, crate, pb, 0.01f);
    ASSERT_EQ(m.size(), 1u);
    ASSERT_EQ(m[0].count, 4u);
    EXPECT_NEAR(m[0].normal.y, 1.0f, 1e-7f);
    std::set<std::uint64_t> names;
    for (const ContactPoint& p : m[0].used()) {
        EXPECT_NEAR(p.separation, -0.001f, 1e-7f);
        const dvec3 local = inverse_transform_point(pb, pa.position + dvec3(p.position));
        EXPECT_NEAR(std::abs(local.x), 0.5, 1e-6);
        EXPECT_NEAR(std::abs(local.z), 0.375, 1e-6);
        EXPECT_NEAR(p.position.y, 0.5f - 0.0005f, 1e-6f);
        names.insert(p.feature);
    }
    EXPECT_EQ(names.size(), 4u);
}

// A crate on the middle of a very large box: what counts is the crate's size.
TEST(BoxBox, AHugeBoxIsAsPreciseAsASmallOne) {
    Random random(41);
    for (const double half : {5.0, 50.0, 1e3, 1e5}) {
        const Shape ground = Box{{static_cast<float>(half), static_cast<float>(half), static_cast<float>(half)}};
        const Shape crate = Box{{0.5f, 0.25f, 0.375f}};
        for (int i = 0; i < 200; ++i) {
            const double depth = random.range(-0.01, 0.2);
            const Pose local{{random.range(-0.7, 0.7) * half, half + 0.25 - depth, random.range(-0.7, 0.7) * half},
                             about({0, 1, 0}, random.range(0.0, 6.0))};
            const Pose turn{{0.0, 0.0, 0.0}, random_rotation(random)};
            const Pose pa = turn, pb = turn * local;
            for (const bool swapped : {false, true}) {
                const std::vector<Manifold> m = swapped ? collide_all(crate, pb, ground, pa, 0.02f) : collide_all(ground, pa, crate, pb, 0.02f);
                ASSERT_EQ(m.size(), 1u) << half << ' ' << i;
                ASSERT_EQ(m[0].count, 4u) << half << ' ' << i;
                // The pose itself is good to an ulp of its distance from the origin.
                for (const ContactPoint& p : m[0].used()) EXPECT_NEAR(static_cast<double>(p.separation), -depth, 1e-6 + 1e-15 * half) << half;
                const dvec3 up = rotate(turn.orientation, dvec3{0, 1, 0}) * (swapped ? -1.0 : 1.0);
                EXPECT_GT(glm::dot(dvec3(m[0].normal), up), 1.0 - 1e-6);
            }
        }
    }
}

TEST(BoxBox, DeepInsideAHugeBoxTheNearestSideDecides) {
    const Shape rock = Box{{100.0f, 80.0f, 120.0f}};
    const Shape crate = Box{{0.5f, 0.5f, 0.5f}};
    for (const double below : {0.2, 1.0, 2.0, 3.0, 3.5, 4.0, 5.0, 30.0, 79.0}) {
        const Pose pose{{3.0, 80.0 - below, -2.0}, kIdentityRotation};
        const std::vector<Manifold> m = collide_all(rock, {}, crate, pose, 0.0f);
        ASSERT_EQ(m.size(), 1u) << below;
        EXPECT_NEAR(m[0].normal.y, 1.0f, 1e-6f) << below;
        EXPECT_NEAR(static_cast<double>(least_separation(m[0])), -(below + 0.5), 1e-6 * 120.0) << below;
    }
}

// Powers of two only move exponents: the same manifold at every size of which floats can hold the boxes.
TEST(BoxBox, ScalingScalesTheAnswer) {
    Random random(42);
    for (int i = 0; i < 300; ++i) {
        const float by = i % 8 < 4 ? 1.0f : 0.25f;  // small ones are never much longer than what the other and the margin reach
        const Box a{by * random_half(random)}, b{by * random_half(random)};
        Pose local = random_pose(random, i % 4);
        local.position *= static_cast<double>(by);
        const std::vector<Manifold> one = collide_all(a, {}, b, local, 0.0625f);
        for (const int exponent : {-100, -40, -21, 19, 60, 96}) {
            const float s = std::ldexp(1.0f, exponent);
            const Pose pose{local.position * static_cast<double>(s), local.orientation};
            const std::vector<Manifold> scaled = collide_all(Box{a.half_extents * s}, {}, Box{b.half_extents * s}, pose, 0.0625f * s);
            ASSERT_EQ(scaled.size(), one.size()) << i << ' ' << exponent;
            if (one.empty()) continue;
            ASSERT_EQ(scaled[0].count, one[0].count) << i << ' ' << exponent;
            for (std::size_t k = 0; k < one[0].count; ++k) {
                EXPECT_NEAR(scaled[0].points[k].separation / s, one[0].points[k].separation, 1e-6f) << i << ' ' << exponent;
            }
        }
    }
}

// Edges that are parallel but for an angle from 1e-24 to 1e-1 about every axis: axes whose length is all rounding must not decide, nor
// those whose squares are below what floats hold.
TEST(BoxBox, NearlyParallelEdgesKeepTheirDepth) {
    Random random(44);
    for (int i = 0; i < 6000; ++i) {
        const Box a{random_half(random)}, b{random_half(random)};
        const bool exact = i % 2 == 1;  // along the axes of the world nothing is added to the angle
        const Pose pa{random_direction(random) * 3.0, exact ? kIdentityRotation : random_rotation(random)};
        const double angle = std::pow(10.0, random.range(exact ? -24.0 : -9.0, -1.0));
        const Pose local{random_direction(random) * random.range(0.3, 1.5), about(random_direction(random), angle)};
        const Pose pb = pa * local;
        const Separation truth = greatest_separation(solid_of(a, pa, pa.position), solid_of(b, pb, pa.position));
        if (!(truth.value < 0)) continue;
        const std::vector<Manifold> m = collide_all(a, pa, b, pb, 0.05f);
        ASSERT_EQ(m.size(), 1u) << i;
        EXPECT_NEAR(static_cast<double>(truth.value), static_cast<double>(least_separation(m[0])), 2e-6) << i << " angle " << angle;
    }
}

// Edges that are apart and cross only beyond their ends: the true distance decides, and points lie on the boxes.
TEST(BoxBox, EdgesThatCrossBeyondTheirEndsHaveNoPointThere) {
    const Box a{{0.385473f, 0.329135f, 0.140924f}}, b{{0.860114f, 0.195689f, 0.592591f}};
    const Pose pb{{-1.06758, 0.52858, -0.740131}, glm::normalize(dquat{1, 1.70277318e-05, -1.18102833e-06, 8.2449733e-06})};
    for (const float margin : {0.0105f, 0.02f, 0.1f}) {
        for (const Manifold& m : collide_all(a, {}, b, pb, margin)) {
            for (const ContactPoint& p : m.used()) {
                for (int k = 0; k < 3; ++k) EXPECT_LE(std::abs(p.position[k]), a.half_extents[k] + margin) << margin;
            }
        }
    }
}

// Whether a face, two edges or corners are nearest: also where the nearest corner lies beside the face along whose normal the two are farthest
// apart, and other corners over it.
TEST(BoxBox, WhatIsApartIsAsFarAsItSays) {
    Random random(47);
    int apart = 0, few = 0;
    for (int i = 0; i < 60000; ++i) {
        const bool cubes = i % 2 == 0;
        const Box a{cubes ? vec3{0.5f} : random_half(random)}, b{cubes ? vec3{0.5f} : random_half(random)};
        const Pose pa{random_direction(random) * 3.0, random_rotation(random)};
        const double turn = i % 4 < 2 ? 3.0 : std::pow(10.0, random.range(-7.0, 0.0));
        const Pose pb = pa * Pose{random_direction(random) * random.range(0.5, 2.0), about(random_direction(random), turn)};
        const double distance = carom::distance(a, pa, b, pb).upper;
        if (!(distance > 0.0)) continue;
        const std::vector<Manifold> m = collide_all(a, pa, b, pb, 0.1f);
        if (m.empty()) {
            EXPECT_GT(distance, 0.1 - 4e-6) << i;
            continue;
        }
        ++apart;
        few += m[0].count < 3 ? 1 : 0;
        EXPECT_NEAR(static_cast<double>(least_separation(m[0])), distance, 4e-6) << i;
    }
    EXPECT_GT(apart, 3000);
    EXPECT_GT(few, 1000);
}

// Squares of separations leave the range of floats: what is within the margin is found, in batches too.
TEST(BoxBox, WhatIsVeryFarIsFoundWithinItsMargin) {
    const dquat qa = glm::normalize(dquat(0.9, 0.3, 0.2, 0.1)), qb = glm::normalize(dquat(0.5, -0.4, 0.6, 0.2));
    for (const float half : {1.0f, 1e-12f, 1e-20f, 1e-25f}) {
        for (const double far : {1e3, 1e15, 1e18, 1e19, 3e19, 1e25, 9e29, 2e30, 1e35, 2e38}) {
            const dvec3 way = far > 1e38 ? dvec3{far, far, 0.0} : far * dvec3{0.6, 0.64, 0.48};
            const double length = std::sqrt(glm::dot(way, way));
            const auto margin = static_cast<float>(std::min(2.0 * length, 3.4e38));
            const std::vector<Manifold> m = collide_all(Box{vec3{half}}, {{}, qa}, Box{vec3{0.9f, 0.8f, 0.7f} * half}, {way, qb}, margin);
            ASSERT_EQ(m.size(), 1u) << half << ' ' << far;
            EXPECT_GT(least_separation(m[0]), 0.99 * (length - 2.0 * static_cast<double>(half)) - 2.0) << half << ' ' << far;
            EXPECT_LT(least_separation(m[0]), 1.01 * length) << half << ' ' << far;
        }
    }
}

// Differences of positions are exact wherever the pair is: what doubles hold of the poses decides, and nothing else.
TEST(BoxBox, DistanceFromTheOriginDoesNotMatter) {
    Random random(45);
    for (int i = 0; i < 2000; ++i) {
        const Box a{random_half(random)}, b{random_half(random)};
        const double far = std::ldexp(1.0, static_cast<int>(random.range(0.0, 40.0)));  // steps of doubles there: up to 1.2e-4
        const Pose pa{random_direction(random) * far, random_rotation(random)};
        Pose pb{pa.position + random_direction(random) * random.range(0.3, 1.5), random_rotation(random)};
        const Pose near_a{dvec3{0.0}, pa.orientation}, near_b{pb.position - pa.position, pb.orientation};
        const std::vector<Manifold> there = collide_all(a, pa, b, pb, 0.05f), here = collide_all(a, near_a, b, near_b, 0.05f);
        ASSERT_EQ(there.size(), here.size()) << i;
        if (here.empty()) continue;
        // Of points that carry a patch equally well, the last digit may choose others.
        EXPECT_NEAR(least_separation(there[0]), least_separation(here[0]), 5e-7f) << i << " at " << far;
        EXPECT_LT(glm::length(there[0].normal - here[0].normal), 1e-5f) << i << " at " << far;
    }
}

// How far a point in a box's own axes is from the corner or edge that a name says, across it.
double off_corner(const Box& box, std::uint64_t corner, const dvec3& p) {
    dvec3 at;
    for (int k = 0; k < 3; ++k) at[k] = ((corner >> k) & 1u) != 0 ? box.half_extents[k] : -box.half_extents[k];
    return glm::length(p - at);
}
double off_edge(const Box& box, std::uint64_t edge, const dvec3& p) {
    const int axis = static_cast<int>(edge / 4), j = (axis + 1) % 3, k = (axis + 2) % 3;
    const double at_j = (edge & 1u) != 0 ? box.half_extents[j] : -box.half_extents[j];
    const double at_k = (edge & 2u) != 0 ? box.half_extents[k] : -box.half_extents[k];
    return std::hypot(p[j] - at_j, p[k] - at_k);
}

TEST(BoxBox, PointsBearTheNamesOfTheCornersAndEdgesTheyLieOnEachOnce) {
    Random random(46);
    std::array<int, 3> kinds{};
    int near_corners = 0, twins = 0;
    for (int i = 0; i < 12000; ++i) {
        const Box a{random_half(random)}, b{random_half(random)};
        const Pose pa{random_direction(random) * 3.0, random_rotation(random)}, pb = pa * random_pose(random, i % 4);
        const float least = std::min({a.half_extents.x, a.half_extents.y, a.half_extents.z, b.half_extents.x, b.half_extents.y, b.half_extents.z});
        for (const Manifold& m : collide_all(a, pa, b, pb, 0.01f)) {
            const dvec3 n(m.normal);
            for (std::size_t k = 0; k < m.count; ++k) {
                const ContactPoint& point = m.points[k];
                for (std::size_t other = 0; other < k; ++other) twins += point.feature == m.points[other].feature;
                const dvec3 half_gap = 0.5 * static_cast<double>(point.separation) * n;
                const dvec3 on_a = rotate_inverse(pa.orientation, dvec3(point.position) - half_gap);
                const dvec3 on_b = rotate_inverse(pb.orientation, dvec3(point.position) + half_gap - (pb.position - pa.position));
                const std::uint64_t kind = point.feature >> 62, first = (point.feature >> 31) & 0x7fffffffu, second = point.feature & 0x7fffffffu;
                ++kinds[kind];
                // A point counts as a corner within a hundredth or so of the faces' sides, seen along the normal; and that is a slope away.
                const double across_a = kind == 1 ? off_corner(a, first, on_a) : kind == 0 ? off_edge(a, first, on_a) : 0.0;
                const double across_b = kind == 2 ? off_corner(b, second, on_b) : kind == 0 ? off_edge(b, second, on_b) : 0.0;
                near_corners += kind != 0 && std::max(across_a, across_b) < 1e-5;
                EXPECT_LT(std::max(across_a, across_b), kind == 0 ? 2e-5 : 0.2 * static_cast<double>(least) + 0.1) << i << " kind " << kind << ' ' << k;
            }
        }
    }
    for (const int count : kinds) EXPECT_GT(count, 500);
    EXPECT_GT(near_corners, 2000);
    EXPECT_LT(1000 * twins, kinds[0] + kinds[1] + kinds[2]) << "points that share a name";
}

// To the bit.
bool same(const Manifold& x, const Manifold& y) {
    bool equal = x.pair == y.pair && x.count == y.count && x.normal == y.normal;
    for (std::size_t k = 0; equal && k < x.count; ++k) {
        equal = x.points[k].position == y.points[k].position && x.points[k].separation == y.points[k].separation &&
                x.points[k].feature == y.points[k].feature;
    }
    return equal;
}

// Lanes do not see one another: alone, in a crowd, at every width.
TEST(BoxBox, ManyPairsAreManySinglePairs) {
    Random random(43);
    std::vector<Shape> shapes;
    std::vector<ShapePair> pairs;
    for (int i = 0; i < 400; ++i) {
        shapes.emplace_back(Box{random_half(random)});
        shapes.emplace_back(Box{random_half(random) * (i % 7 == 0 ? 40.0f : 1.0f)});
    }
    for (std::size_t i = 0; i < 400; ++i) {
        const Pose at{random_direction(random) * 5.0, random_rotation(random)};
        pairs.push_back({&shapes[2 * i], &shapes[2 * i + 1], at, at * random_pose(random, static_cast<int>(i) % 4), 0.05f});
    }
    std::vector<Manifold> single;
    for (std::uint32_t i = 0; i < pairs.size(); ++i) collide(pairs[i], i, single);
    ASSERT_GT(single.size(), 150u);
    ASSERT_LT(single.size(), 399u);
    SerialExecutor executor;
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        CollideScratch scratch;
        std::vector<Manifold> batch;
        collide(pairs, executor, scratch, batch);
        ASSERT_EQ(batch.size(), single.size()) << width;
        for (std::size_t i = 0; i < batch.size(); ++i) EXPECT_TRUE(same(batch[i], single[i])) << width << ' ' << i;
    }
    set_simd_width(0);
}

// Boxes that are in many pairs are read once for all of them, those of pairs by themselves with their pair.
TEST(BoxBox, ACrowdIsManySinglePairs) {
    Random random(44);
    std::vector<Shape> shapes;
    std::vector<Pose> poses;
    for (int i = 0; i < 60; ++i) {
        shapes.emplace_back(Box{random_half(random)});
        poses.push_back({random_direction(random) * random.range(0.0, 2.0), random_rotation(random)});
    }
    std::vector<const Shape*> placed;
    for (const Shape& shape : shapes) placed.push_back(&shape);
    for (const std::uint32_t reach : {1u, 2u, 30u}) {  // pairs a box
        std::vector<NumberedPair> pairs;
        std::vector<Manifold> single, batch;
        for (std::uint32_t a = 0; a < 60; a += reach == 1 ? 2 : 1) {
            for (std::uint32_t b = a + 1; b < std::min(60u, a + 1 + reach); ++b) {
                collide({placed[a], placed[b], poses[a], poses[b], 0.1f}, static_cast<std::uint32_t>(pairs.size()), single);
                pairs.push_back({a, b, 0.1f});
            }
        }
        SerialExecutor executor;
        CollideScratch scratch;
        collide({placed, poses}, pairs, executor, scratch, batch);
        ASSERT_GT(single.size(), 3u);
        ASSERT_EQ(batch.size(), single.size()) << reach;
        for (std::size_t i = 0; i < batch.size(); ++i) EXPECT_TRUE(same(batch[i], single[i])) << reach << ' ' << i;
    }
}

}  // namespace
}  // namespace carom
