// Queries of the static hierarchy at the ends of the range of numbers, and at the edge of what their slack is there for.
#include <carom/collision/bvh_queries.hpp>
#include <carom/collision/overlap_tests.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <support/exact.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace carom {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct WidthGuard {
    ~WidthGuard() { set_simd_width(0); }
};

StaticBvh one_triangle(float size) {
    const std::vector<vec3> v = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}};
    return *StaticBvh::build(v, std::vector<StaticBvh::Triangle>{{0, 1, 2}});
}

template <class Shape>
std::size_t count(const StaticBvh& bvh, const Shape& shape) {
    std::size_t n = 0;
    overlapping_triangles(bvh, shape, [&](std::uint32_t) {
        ++n;
        return true;
    });
    return n;
}

TEST(BvhQueriesLimits, VolumesOfAnySizeMeetWhatTheyHold) {
    const WidthGuard guard;
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        for (const float size : {1.0f, 1e-30f, 1e30f}) {
            const StaticBvh bvh = one_triangle(size);
            for (const double big : {1e9, 1e31, 1e38, 3.5e38, 1e39, 1e45, 1e60, 1e100}) {
                if (big < static_cast<double>(size)) continue;
                EXPECT_EQ(count(bvh, geo::Aabb<double>{dvec3{-big}, dvec3{big}}), 1u) << size << ' ' << big;
                EXPECT_EQ(count(bvh, geo::Sphere<double>{{0, 0, 0}, big}), 1u) << size << ' ' << big;
                EXPECT_EQ(count(bvh, geo::Obb<double>{.half_extents = dvec3{big}}), 1u) << size << ' ' << big;
                EXPECT_EQ(count(bvh, geo::Capsule<double>{{{0, 0, 0}, {0, 1, 0}}, big}), 1u) << size << ' ' << big;
                EXPECT_EQ(count(bvh, geo::Aabb<double>{dvec3{big * 1.5}, dvec3{2.0 * big}}), 0u) << size << ' ' << big;
            }
            EXPECT_EQ(count(bvh, geo::Sphere<double>{{0, 0, 0}, kInfinity}), 0u) << "not finite";
            const auto view = geo::frustum_of(geo::Camera<double>{
                .position = {0, 0, 5.0 * static_cast<double>(size)}, .near_distance = 0.1 * static_cast<double>(size), .far_distance = kInfinity});
            EXPECT_EQ(count(bvh, *view), 1u);
        }
    }
}

TEST(BvhQueriesLimits, ThereIsAClosestPointHoweverFarOff) {
    const std::vector<vec3> v = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
    const StaticBvh bvh = *StaticBvh::build(v, std::vector<StaticBvh::Triangle>{{0, 1, 2}, {3, 4, 5}});
    for (const double away : {1e3, 1e20, 1e100, 1e155, 1e300}) {
        const auto found = closest_point(bvh, {away, 0, 0});
        ASSERT_TRUE(found) << away;
        EXPECT_NEAR(found->distance / away, 1.0, 0.01) << away;
        EXPECT_TRUE(closest_point(bvh, {away, 0, 0}, away));
        EXPECT_FALSE(closest_point(bvh, {away, 0, 0}, 0.9 * away));
    }
    EXPECT_EQ(closest_point(bvh, {1e3, 0, 0})->triangle, 1u);
}

TEST(BvhQueriesLimits, ThereIsAClosestPointHoweverNear) {
    const StaticBvh bvh = one_triangle(1.0f);
    for (const double near : {1e-10, 1e-40, 1e-160, 1e-200, 1e-300}) {
        const auto found = closest_point(bvh, {0.0, 0.0, near}, near);
        ASSERT_TRUE(found) << near;
        EXPECT_NEAR(found->distance / near, 1.0, 1e-6) << near;
    }
}

// Squares of half a least denormal are rounded up to a whole one each; the square of the distance is 1.6 of them.
TEST(BvhQueriesLimits, SquaresThatUnderflowHideNothing) {
    std::vector<vec3> v;
    std::vector<StaticBvh::Triangle> t;
    const float s = 0x1p-74f;
    for (std::uint32_t i = 0; i < 40; ++i) {  // more than a leaf's worth, each a point of its own
        const vec3 at = i == 0 ? vec3{0.51f * s} : vec3{0.51f * s, 0.51f * s, (0.51f + 0.01f * static_cast<float>(i)) * s};
        v.insert(v.end(), {at, at, at});
        t.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    v.insert(v.end(), {{1, 1, 1}, {1, 2, 1}, {2, 1, 1}});
    t.push_back({120, 121, 122});
    const StaticBvh bvh = *StaticBvh::build(v, t);
    const auto found = closest_point(bvh, {0, 0, 0});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->triangle, 0u);
    EXPECT_TRUE(closest_point(bvh, {0, 0, 0}, 0.51 * std::sqrt(3.0) * static_cast<double>(s) * 1.000001));
}

TEST(BvhQueriesLimits, APointOnATriangleIsFoundWithRadiusZero) {
    const StaticBvh bvh = one_triangle(1.0f);
    for (int i = 1; i < 100; ++i) {
        for (int k = 1; i + k < 100; ++k) {
            const dvec3 p{i * 0.01, k * 0.01, 0.0};
            const auto found = closest_point(bvh, p, 0.0);
            ASSERT_TRUE(found) << i << ' ' << k;
            ASSERT_LE(found->distance, 32.0 * 0x1p-52);
        }
    }
    EXPECT_FALSE(closest_point(bvh, {0.25, 0.25, 1e-13}, 0.0));
}

TEST(BvhQueriesLimits, OfTrianglesAsNearTheLowestIsFound) {
    // Forty times the same triangle, the higher numbers nearer to the front of the tree's order by shuffling.
    std::vector<vec3> v;
    std::vector<StaticBvh::Triangle> t;
    Random random(41);
    for (std::uint32_t i = 0; i < 200; ++i) {
        const float x = i % 5 == 3 ? 0.0f : static_cast<float>(random.range(1.0, 9.0));
        v.insert(v.end(), {{x, 0, 0}, {x + 0.5f, 0, 0}, {x, 0.5f, 0}});
        t.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const StaticBvh bvh = *StaticBvh::build(v, t);
    EXPECT_EQ(closest_point(bvh, {-1.0, 0.0, 0.0})->triangle, 3u);
    EXPECT_EQ(closest_point(bvh, {0.1, 0.1, 2.0})->triangle, 3u);
    // A corner that two triangles share, of which the higher number's box is nearer.
    const std::vector<vec3> w = {{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 1, 0.5f}, {1, 1, 0.5f}};
    EXPECT_EQ(closest_point(*StaticBvh::build(w, std::vector<StaticBvh::Triangle>{{0, 1, 2}, {0, 3, 4}}), {0, 0, 0})->triangle, 0u);
}

// A point that floats round by 0.03 lies between two heaps: as floats see it the first is nearer, and the second out of reach.
TEST(BvhQueriesLimits, RoundingThePointToFloatHidesNothing) {
    const WidthGuard guard;
    std::vector<vec3> v;
    std::vector<StaticBvh::Triangle> t;
    for (std::uint32_t i = 0; i < 40; ++i) {
        const float far = 0.0625f * static_cast<float>(i / 2 * (i / 2 + 1));
        const vec3 at = i % 2 == 0 ? vec3{1e6f - 9.9375f - far, 0.4f, 0} : vec3{1e6f + 10.0f + far, 0, 0};
        v.insert(v.end(), {at, at, at});
        t.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const StaticBvh bvh = *StaticBvh::build(v, t);
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        const auto found = closest_point(bvh, {1e6 + 0.03125, 0, 0});
        ASSERT_TRUE(found);
        EXPECT_EQ(found->triangle, 1u);
        EXPECT_EQ(found->distance, 9.96875);
        EXPECT_TRUE(closest_point(bvh, {1e6 + 0.03125, 0, 0}, 9.96875));
    }
}

/// One triangle, about a point far from the origin or near it.
geo::Triangle<double> some_triangle(Random& random, double far, double size) {
    const auto in = [&](double s) { return random.range(-s, s); };
    const dvec3 at{in(far), in(far), in(far)};
    const auto corner = [&] { return dvec3(vec3(at + dvec3{in(size), in(size), in(size)})); };
    return {corner(), corner(), corner()};
}

StaticBvh tree_of(const geo::Triangle<double>& t) {
    const std::vector<vec3> v = {vec3(t.a), vec3(t.b), vec3(t.c)};
    return *StaticBvh::build(v, std::vector<StaticBvh::Triangle>{{0, 1, 2}});
}

// Volumes that touch a triangle from outside, to within what geo::overlaps() still counts: alone in its tree the triangle is met
// where it would be met in any other.
TEST(BvhQueriesLimits, WhatTouchesToRoundingIsMetInEveryTree) {
    const WidthGuard guard;
    Random random(43);
    int met = 0, apart = 0;
    const auto compare = [&](const StaticBvh& bvh, const auto& shape, const geo::Triangle<double>& t, int i) {
        const bool want = geo::overlaps(shape, t);
        ++(want ? met : apart);
        EXPECT_EQ(count(bvh, shape) == 1, want) << i;
    };
    for (int i = 0; i < 4000; ++i) {
        set_simd_width(available_simd_widths()[static_cast<std::size_t>(i) % available_simd_widths().size()]);
        const double far = std::ldexp(1.0, i % 20), size = i % 3 == 0 ? 1.0 : far;
        geo::Triangle<double> t = some_triangle(random, far, size);
        // The corner that is farthest down an axis: from there on outward everything is empty. At 0, mostly, where floats round least.
        const int axis = i % 3;
        if (i % 4 != 0) {
            const double least = std::min({t.a[axis], t.b[axis], t.c[axis]});
            for (dvec3* v : {&t.a, &t.b, &t.c}) (*v)[axis] = static_cast<double>(static_cast<float>((*v)[axis] - least));
        }
        const StaticBvh bvh = tree_of(t);
        const dvec3 corner = t.a[axis] <= std::min(t.b[axis], t.c[axis]) ? t.a : (t.b[axis] <= t.c[axis] ? t.b : t.c);
        const double gap = random.range(-2.0, 70.0) * 0x1p-52 * (size + 1.0);
        const double radius = random.range(0.01, 1.0);
        dvec3 outward{0.0};
        outward[axis] = -1.0;
        const dvec3 center = corner + (radius + gap) * outward;
        compare(bvh, geo::Sphere<double>{center, radius}, t, i);
        dvec3 aside{0.3, 0.2, 0.1};
        aside[axis] = 0.0;
        compare(bvh, geo::Capsule<double>{{center, center + aside}, radius}, t, i);
        // A cube on its corner.
        const double s = std::sqrt(0.5), r = std::sqrt(1.0 / 3.0), q = std::sqrt(1.0 / 6.0);
        dmat3 axes{dvec3{r, r, r}, {s, -s, 0.0}, {q, q, -2.0 * q}};
        if (axis != 0) {
            for (int k = 0; k < 3; ++k) std::swap(axes[k].x, axes[k][axis]);
        }
        dvec3 down{0.0};
        for (int k = 0; k < 3; ++k) down += (axes[k][axis] > 0.0 ? -radius : radius) * axes[k];
        // A turned box so large that its own rounding is what counts.
        const double huge = 1e12 * (far + size);
        const double beside = random.range(-2.0, 140.0) * 0x1p-52 * huge;
        compare(bvh, geo::Obb<double>{.center = corner - (huge + beside) * axes[1], .half_extents = dvec3{huge}, .axes = axes}, t, i);
        // Its highest corner just below the lowest of the triangle.
        compare(bvh, geo::Obb<double>{.center = corner + down + gap * outward, .half_extents = dvec3{radius}, .axes = axes}, t, i);
    }
    EXPECT_GT(met, 1500);
    EXPECT_GT(apart, 3000);
}

// A corner just inside of a turned box' face, far enough out that the face's normal as floats is off by more than that.
TEST(BvhQueriesLimits, ATurnedBoxMeetsCornersJustInside) {
    const WidthGuard guard;
    Random random(44);
    for (int i = 0; i < 2000; ++i) {
        set_simd_width(available_simd_widths()[static_cast<std::size_t>(i) % available_simd_widths().size()]);
        const geo::Triangle<double> t = some_triangle(random, std::ldexp(1.0, i % 24), 1e-6);
        dmat3 axes = glm::mat3_cast(glm::normalize(dquat{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)}));
        const double half = std::ldexp(1.0, i % 24);
        dvec3 center = t.a + half * (i % 2 == 0 ? 1.0 : -1.0) * axes[i % 3];
        center += 1e-12 * (center - t.a);
        center -= 1e-9 * half * (i % 2 == 0 ? 1.0 : -1.0) * axes[i % 3];
        const geo::Obb<double> box{.center = center, .half_extents = dvec3{half}, .axes = axes};
        ASSERT_EQ(count(tree_of(t), box) == 1, geo::overlaps(box, t)) << i;
        ASSERT_TRUE(geo::overlaps(box, t)) << i;
        // Its inner half-space alone.
        geo::Frustum<double> view;
        for (auto& plane : view.planes) plane = {dvec3{0.0}, -1.0};
        view.planes[static_cast<std::size_t>(i) % 6] = {axes[i % 3], glm::dot(axes[i % 3], t.a) - 1e-9 * half};
        ASSERT_EQ(count(tree_of(t), view), 1u) << i;
    }
}

// A triangle with one corner in a half-space by less than rounding, the others out of it.
TEST(BvhQueriesLimits, AFrustumMissesNoCornerByRounding) {
    Random random(45);
    int inside = 0;
    for (int i = 0; i < 3000; ++i) {
        const geo::Triangle<double> at = some_triangle(random, 8.0, 1.0);
        const dvec3 n = glm::normalize(dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)});
        const dvec3 a = at.a;
        const geo::Triangle<double> t{a, dvec3(vec3(at.b - 8.0 * n)), dvec3(vec3(at.c - 8.0 * n))};
        geo::Frustum<double> view;
        for (auto& plane : view.planes) plane = {dvec3{0.0}, -1.0};
        double offset = glm::dot(n, a);
        for (int k = 0; k < i % 5; ++k) offset = std::nextafter(offset, i % 2 == 0 ? kInfinity : -kInfinity);
        view.planes[2] = {n, offset};
        const exact::Rational height = exact::dot(exact::vec(n), exact::vec(a)) - exact::number(offset);
        if (height < 0) continue;
        ++inside;
        ASSERT_EQ(count(tree_of(t), view), 1u) << i;
    }
    EXPECT_GT(inside, 1000);
}

}  // namespace
}  // namespace carom
