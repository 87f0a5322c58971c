// Supports and placed polytopes in lanes, against plain loops.
#include "oracle.hpp"

#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/detail/polytope_lanes.hpp>

#include <gtest/gtest.h>

namespace carom {
namespace {

using namespace test;

std::vector<PointBundle> bundled(const std::vector<dvec3>& points) {
    std::vector<PointBundle> bundles(double_bundle_count(points.size()));
    for (std::size_t i = 0; i < bundles.size() * kDoubleBundleWidth; ++i) {
        set_point(bundles[i / kDoubleBundleWidth], i % kDoubleBundleWidth, points[std::min(i, points.size() - 1)]);
    }
    return bundles;
}

TEST(PolytopeLanes, TheLowestPointIsTheFirstOfThoseThatAre) {
    Random r(1);
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        for (std::size_t count = 1; count <= 100; ++count) {
            std::vector<dvec3> points;
            for (std::size_t i = 0; i < count; ++i) points.push_back(dvec3{glm::round(random_direction(r) * 3.0)});  // many are equally low
            const std::vector<PointBundle> bundles = bundled(points);
            for (const dvec3& direction : {random_direction(r), dvec3{0, 1, 0}, dvec3{-1, 0, 1}}) {
                std::size_t lowest_one = 0;
                for (std::size_t i = 1; i < count; ++i) {
                    if (glm::dot(points[i], direction) < glm::dot(points[lowest_one], direction)) lowest_one = i;
                }
                const detail::Extreme found = detail::lowest(bundles, direction);
                ASSERT_EQ(found.number, lowest_one) << count << " points, width " << width;
                ASSERT_EQ(found.value, glm::dot(points[lowest_one], direction));
                const std::size_t part = (bundles.size() + 1) / 2;
                const auto two = detail::lowest_of_two(bundles, direction, std::span(bundles).first(part), -direction);
                ASSERT_EQ(two[0], lowest_one) << count << " points, width " << width;
                ASSERT_EQ(two[1], detail::lowest(std::span(bundles).first(part), -direction).number);
            }
        }
    }
    set_simd_width(0);
}

TEST(PolytopeLanes, BoundsAreThoseOfTheVerticesToTheBit) {
    Random r(3);
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        for (int i = 0; i < 100; ++i) {
            const ConvexHullPtr hull = random_hull(r, 5 + i, 0.3, 1.0);
            detail::Polytope p;
            detail::load_hull(p, *hull);
            const dmat3 axes = glm::mat3_cast(random_rotation(r));
            const dvec3 origin = random_direction(r) * 2.0;
            Aabb bounds;
            for (std::uint32_t v = 0; v < p.vertex_count; ++v) bounds = merge(bounds, {(p.vertex(v) - origin) * axes, (p.vertex(v) - origin) * axes});
            const Aabb found = detail::bounds_of(p, origin, axes);
            ASSERT_EQ(found.lower, bounds.lower) << i << ", width " << width;
            ASSERT_EQ(found.upper, bounds.upper) << i << ", width " << width;
        }
    }
    set_simd_width(0);
}

TEST(PolytopeLanes, PlacedHullsHoldTheirVertices) {
    Random r(2);
    for (int i = 0; i < 50; ++i) {
        const ConvexHullPtr hull = random_hull(r, 8 + 3 * (i % 20), 0.3, 1.0);
        const dmat3 axes = glm::mat3_cast(random_rotation(r));
        const dvec3 origin = random_direction(r) * 2.0;
        detail::Polytope placed;
        detail::load_hull(placed, *hull, axes, origin);
        ASSERT_EQ(placed.vertex_count, hull->vertices().size());
        ASSERT_EQ(placed.face_count(), hull->faces().size());
        for (std::uint32_t v = 0; v < placed.vertex_count; ++v) {
            ASSERT_LT(glm::length(placed.vertex(v) - (axes * dvec3(hull->vertices()[v]) + origin)), 1e-14);
            for (std::uint32_t f = 0; f < placed.face_count(); ++f)
                ASSERT_LT(glm::dot(placed.normal(f), placed.vertex(v)) - placed.offset(f), 1e-14);
        }
        const dvec3 direction = random_direction(r);
        const detail::Extreme face = detail::face_along(placed, direction);
        for (std::uint32_t f = 0; f < placed.face_count(); ++f) ASSERT_LE(glm::dot(placed.normal(f), direction), face.value);
        ASSERT_EQ(face.value, glm::dot(placed.normal(face.number), direction));
    }
}

}  // namespace
}  // namespace carom
