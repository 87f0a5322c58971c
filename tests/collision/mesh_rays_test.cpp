// Float rays against the wide hierarchy: against exact arithmetic, against every SIMD width, and against leaks.
#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/collision/mesh_rays.hpp>
#include <carom/core/check.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>

#include "mesh_rays_cases.hpp"
#include "ray_definition.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace carom {
namespace {

using test::FloatRay;
using test::RayCase;
using test::by_definition;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Brings the widest lanes back whatever a test did.
struct WidthGuard {
    ~WidthGuard() { set_simd_width(0); }
};

bool same_bits(const MeshHit& a, const MeshHit& b) { return std::memcmp(&a, &b, sizeof(MeshHit)) == 0; }

StaticBvh build(const MeshData& mesh) { return StaticBvh::build(mesh.vertices, mesh.triangles).value(); }

TEST(MeshRays, TheClosestHitIsWhatTheDefinitionSaysToTheLastBitAtEveryWidth) {
    const WidthGuard guard;
    int hits = 0, misses = 0;
    for (const RayCase& c : test::ray_cases()) {
        const StaticBvh bvh = build(c.mesh);
        for (FloatRay ray : c.near_rays) {
            const MeshHit expected = by_definition(c.mesh, ray);
            (expected ? hits : misses) += 1;
            for (const int width : available_simd_widths()) {
                set_simd_width(width);
                const MeshHit hit = closest_hit(bvh, ray);
                ASSERT_TRUE(same_bits(hit, expected)) << c.name << ", " << width << " lanes: triangle " << hit.triangle << " at " << hit.t
                                                      << ", expected " << expected.triangle << " at " << expected.t;
                ASSERT_EQ(any_hit(bvh, ray), static_cast<bool>(expected)) << c.name;
            }
        }
    }
    EXPECT_GT(hits, 2000);
    EXPECT_GT(misses, 1000);
}

TEST(MeshRays, EveryQueryHasTheSameBitsAtEveryWidth) {
    const WidthGuard guard;
    for (const RayCase& c : test::ray_cases()) {
        const StaticBvh bvh = build(c.mesh);
        std::vector<FloatRay> rays = c.near_rays;
        rays.insert(rays.end(), c.far_rays.begin(), c.far_rays.end());
        for (const FloatRay& ray : rays) {
            std::vector<MeshHit> first, here;
            set_simd_width(available_simd_widths().back());
            const MeshHit closest = closest_hit(bvh, ray);
            all_hits(bvh, ray, first);
            for (const int width : available_simd_widths()) {
                set_simd_width(width);
                ASSERT_TRUE(same_bits(closest_hit(bvh, ray), closest)) << c.name;
                all_hits(bvh, ray, here);
                ASSERT_EQ(here.size(), first.size());
                for (std::size_t i = 0; i < here.size(); ++i) ASSERT_TRUE(same_bits(here[i], first[i])) << c.name;
            }
            for (const MeshHit& hit : first) {
                ASSERT_GE(hit.t, closest.t);
                ASSERT_GE(hit.u, 0.0f);
                ASSERT_GE(hit.v, 0.0f);
                ASSERT_LE(hit.u + hit.v, 1.0f + 0x1p-22f);
            }
        }
    }
}

/// A bound of how far hit or miss may be wrong: moving the mesh by that must make it right. Here: the point of the ray at t is that near
/// to the point of the triangle.
TEST(MeshRays, TheRayMeetsTheTriangleAtTWithinTheStatedBound) {
    double worst = 0.0;
    for (const RayCase& c : test::ray_cases()) {
        const StaticBvh bvh = build(c.mesh);
        const Aabb box = bvh.bounds();
        for (const std::vector<FloatRay>* rays : {&c.near_rays, &c.far_rays}) {
            for (const FloatRay& ray : *rays) {
                const MeshHit hit = closest_hit(bvh, ray);
                if (!hit || !(std::abs(hit.t) > 1e-35f && is_finite(hit.t))) continue;  // t itself left the range of float
                const auto& t = c.mesh.triangles[hit.triangle];
                const dvec3 a(c.mesh.vertices[t[0]]), b(c.mesh.vertices[t[1]]), d(c.mesh.vertices[t[2]]);
                const auto u = static_cast<double>(hit.u), v = static_cast<double>(hit.v);
                const dvec3 on_triangle = (1.0 - u - v) * a + u * b + v * d;
                const dvec3 o(ray.origin);
                const dvec3 on_ray = o + static_cast<double>(hit.t) * dvec3(ray.direction);
                // D from the place to which a far origin is moved: within three radii of the box. t itself is rounded to float.
                const double size = glm::length(box.upper - box.lower);
                const double coordinate = glm::length(glm::max(glm::abs(box.lower), glm::abs(box.upper)));
                const double travelled = 0x1p-24 * glm::length(on_ray - o);
                const double bound = 16.0 * 0x1p-24 * (std::min(glm::length(on_ray - o) + size, 10.0 * size) + coordinate + 3.0 * size);
                const double error = glm::length(on_ray - on_triangle);
                worst = std::max(worst, error / (bound + travelled));
                ASSERT_LE(error, bound + travelled) << c.name;
            }
        }
    }
    EXPECT_GT(worst, 0.001) << "the bound says nothing";
    RecordProperty("worst", std::to_string(worst));
}

TEST(MeshRays, BadRaysHitNothing) {
    const MeshData ball = test::sphere_mesh(16, 9, 1.0);
    const StaticBvh bvh = build(ball);
    std::vector<MeshHit> hits{{}};
    const auto nothing = [&](const FloatRay& ray) {
        all_hits(bvh, ray, hits);
        return !closest_hit(bvh, ray) && !any_hit(bvh, ray) && hits.empty();
    };
    EXPECT_FALSE(nothing({.direction = {0, 0, 1}}));
    for (const float bad : {kNan, kInfinity, -kInfinity}) {
        for (int k = 0; k < 3; ++k) {
            FloatRay ray{.direction = {1, 1, 1}};
            ray.origin[k] = bad;
            EXPECT_TRUE(nothing(ray));
            ray = {.direction = {1, 1, 1}};
            ray.direction[k] = bad;
            EXPECT_TRUE(nothing(ray));
        }
    }
    EXPECT_TRUE(nothing({.direction = {0.0f, -0.0f, 0.0f}}));
    EXPECT_TRUE(nothing({.direction = {0, 0, 1}, .t_min = kNan}));
    EXPECT_TRUE(nothing({.direction = {0, 0, 1}, .t_max = kNan}));
    EXPECT_TRUE(nothing({.direction = {0, 0, 1}, .t_min = 2.0f, .t_max = 1.0f}));
    EXPECT_TRUE(nothing({.direction = {0, 0, 1}, .t_min = 0.0f, .t_max = -kInfinity}));
    EXPECT_TRUE(nothing({.direction = {0, 0, 1}, .t_min = kInfinity, .t_max = kInfinity}));
}

TEST(MeshRays, IntervalsAreClosedAndMayBeNegativeOrInfinite) {
    const StaticBvh bvh = build({{{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}, {-1, -1, 2}, {3, -1, 2}, {-1, 3, 2}}, {{0, 1, 2}, {3, 4, 5}}});
    const auto cast = [&](float z, float length, float t_min, float t_max) {
        return closest_hit(bvh, {{0, 0, z}, {0, 0, length}, t_min, t_max});
    };
    EXPECT_EQ(cast(-1, 1, 0, kInfinity).t, 1.0f);
    EXPECT_EQ(cast(-1, 1, 1, 1).triangle, 0u);
    EXPECT_EQ(cast(-1, 1, std::nextafter(1.0f, 2.0f), 5).triangle, 1u);
    EXPECT_FALSE(cast(-1, 1, 0, std::nextafter(1.0f, 0.0f)));
    EXPECT_EQ(cast(0, 1, 0, 5).t, 0.0f) << "an origin on the surface";
    EXPECT_NEAR(cast(1, 1, -kInfinity, kInfinity).t, -1.0f, 1e-6f);  // its origin is moved
    EXPECT_NEAR(cast(1, 1, -0.5f, kInfinity).t, 1.0f, 1e-6f);
    EXPECT_NEAR(cast(1, -1, -5, -0.5f).t, -1.0f, 1e-6f);
    EXPECT_EQ(cast(-1, 0x1p-100f, 0, kInfinity).t, 0x1p100f);
    EXPECT_EQ(cast(-1, 0x1p120f, 0, kInfinity).t, 0x1p-120f);
    EXPECT_EQ(cast(-1, 1e-40f, 0, kInfinity).t, kInfinity) << "t is beyond float, but there is a hit";
    EXPECT_EQ(cast(-1, 1e-40f, 0, kInfinity).triangle, 0u);
    EXPECT_EQ(cast(-1e6f, 1, 0, kInfinity).t, 1e6f);
    EXPECT_EQ(cast(-1e6f, 1, 1e6f, 1e6f).t, 1e6f);
    EXPECT_FALSE(cast(-1e6f, 1, 0, 999999.0f));
}

TEST(MeshRays, OfTwinsTheLowestIsHit) {
    MeshData mesh;
    for (std::uint32_t k = 0; k < 100; ++k) {
        for (const vec3& v : {vec3{-1, -1, 1}, vec3{3, -1, 1}, vec3{-1, 3, 1}}) mesh.vertices.push_back(v);
        mesh.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
    }
    const StaticBvh bvh = build(mesh);
    EXPECT_EQ(closest_hit(bvh, {.direction = {0, 0, 1}}).triangle, 0u);
    std::vector<MeshHit> hits;
    all_hits(bvh, {.direction = {0, 0, 1}}, hits);
    ASSERT_EQ(hits.size(), 100u);
    for (std::uint32_t k = 0; k < 100; ++k) EXPECT_EQ(hits[k].triangle, k);
}

TEST(MeshRays, BatchesAndOccludersGiveWhatSingleRaysDo) {
    const MeshData ball = test::sphere_mesh(24, 13, 1.0);
    const StaticBvh bvh = build(ball);
    const StaticBvh other = build(test::sphere_mesh(5, 4, 1.0));
    Random random(702);
    std::vector<FloatRay> rays;
    for (int i = 0; i < 3000; ++i) rays.push_back({vec3(test::random_point(random, 3.0)), vec3(test::random_point(random, 1.0))});
    std::vector<MeshHit> hits(rays.size());
    std::vector<std::uint8_t> occluded(rays.size());
    SerialExecutor serial;
    closest_hits(bvh, rays, hits, serial);
    any_hits(bvh, rays, occluded, serial);
    LastOccluder last;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_TRUE(same_bits(hits[i], closest_hit(bvh, rays[i])));
        ASSERT_EQ(occluded[i] != 0, static_cast<bool>(hits[i]));
        ASSERT_EQ(any_hit(i % 7 == 0 ? other : bvh, rays[i], &last), any_hit(i % 7 == 0 ? other : bvh, rays[i]));
    }
    EXPECT_THROW(closest_hits(bvh, rays, std::span(hits).first(5), serial), MisuseError);
    EXPECT_THROW(any_hits(bvh, rays, std::span(occluded).first(5), serial), MisuseError);
}

}  // namespace
}  // namespace carom
