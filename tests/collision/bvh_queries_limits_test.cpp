// Queries of the static hierarchy at the ends of the range of numbers, and at the edge of what their slack is there for.
#include <carom/collision/bvh_queries.hpp>
#include <carom/collision/overlap_tests.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>

#include <gtest/gtest.h>

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

// Corners as far as radius, on both sides of a float's last bit; least denormals away from each other.
TEST(BvhQueriesLimits, SquaresThatUnderflowHideNothing) {
    std::vector<vec3> v;
    std::vector<StaticBvh::Triangle> t;
    const float s = 0x1p-74f;
    for (std::uint32_t i = 0; i < 40; ++i) {  // more than a leaf's worth, each a point of its own
        const vec3 at = i == 0 ? vec3{0.7f * s} : vec3{0.7f * s, 0.7f * s, (0.7f + 0.01f * static_cast<float>(i)) * s};
        v.insert(v.end(), {at, at, at});
        t.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    v.insert(v.end(), {{1, 1, 1}, {1, 2, 1}, {2, 1, 1}});
    t.push_back({120, 121, 122});
    const StaticBvh bvh = *StaticBvh::build(v, t);
    const auto found = closest_point(bvh, {0, 0, 0});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->triangle, 0u);
    EXPECT_TRUE(closest_point(bvh, {0, 0, 0}, 0.7 * std::sqrt(3.0) * static_cast<double>(s) * 1.000001));
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

}  // namespace
}  // namespace carom
