// No ray slips between triangles: rays aimed at edges and vertices of closed meshes.
//
//   CAROM_LEAK_RAYS=1000000000 test_collision --gtest_filter='MeshLeaks.*'     the long run, some ten minutes
#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/collision/mesh_rays.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/scenes/bumpy.hpp>

#include "mesh_rays_cases.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <vector>

namespace carom {
namespace {

using test::FloatRay;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// How many rays a test casts in all: a million, or what CAROM_LEAK_RAYS says.
std::size_t ray_count() {
    const char* const wanted = std::getenv("CAROM_LEAK_RAYS");
    return wanted == nullptr ? 1'000'000 : static_cast<std::size_t>(std::strtoull(wanted, nullptr, 10));
}

struct Ball {
    const char* name;
    MeshData mesh;
    vec3 center{0.0f};
    double size = 1.0;  ///< every point within 0.4 of it from the centre is inside
};

/// Surfaces that are star-shaped about their centre; the first is as smooth as scans are.
std::vector<Ball> balls() {
    const MeshData bumpy = scenes::bumpy(40);
    const MeshData ball = test::sphere_mesh(31, 17, 1.0);
    return {{"bumpy", bumpy},
            {"bumpy 1,000 away", test::transformed(bumpy, 1.0f, {1000, 0, 0}), {1000, 0, 0}},
            {"bumpy 1,000 away along all axes", test::transformed(bumpy, 1.0f, {577, -577, 577}), {577, -577, 577}},
            {"ball", ball},
            {"tiny ball", test::transformed(ball, 1e-20f, {}), {}, 1e-20},
            {"huge ball", test::transformed(ball, 1e15f, {}), {}, 1e15}};
}

TEST(MeshLeaks, NoRayLeavesAClosedMesh) {
    const std::vector<Ball> all = balls();
    const std::vector<int> widths = available_simd_widths();
    std::uint64_t seed = 720;
    for (const Ball& ball : all) {
        const StaticBvh bvh = StaticBvh::build(ball.mesh.vertices, ball.mesh.triangles).value();
        Random random(seed++);
        std::size_t leaks = 0;
        for (std::size_t i = 0; i < ray_count() / all.size(); ++i) {
            // A tenth at each narrower width, the rest at the widest.
            if (i % 16384 == 0) set_simd_width(i / 16384 % 5 == 0 ? widths[i / 81920 % widths.size()] : 0);
            const vec3 origin = i % 4 == 0 ? ball.center : ball.center + vec3(test::random_point(random, 0.2 * ball.size));
            const vec3 direction = test::seam_point(ball.mesh, random) - origin;
            leaks += closest_hit(bvh, {origin, direction}) ? 0 : 1;
        }
        set_simd_width(0);
        EXPECT_EQ(leaks, 0u) << ball.name;
    }
}

TEST(MeshLeaks, RaysFromOutsideHitTheSeamsTheyAimAt) {
    for (const Ball& ball : balls()) {
        const StaticBvh bvh = StaticBvh::build(ball.mesh.vertices, ball.mesh.triangles).value();
        Random random(730);
        std::size_t misses = 0;
        for (std::size_t i = 0; i < ray_count() / 60; ++i) {
            // From 1,000 sizes away, at what is inside the outline by more than the rounding of the direction moves it.
            const double away = i % 3 == 0 ? 3.0 : i % 3 == 1 ? 30.0 : 1000.0;
            const dvec3 offset = glm::normalize(test::random_point(random, 1.0)) * away * ball.size;
            const vec3 origin(dvec3(ball.center) + offset);
            const dvec3 target = dvec3(ball.center) + 0.9 * (dvec3(test::seam_point(ball.mesh, random)) - dvec3(ball.center));
            misses += closest_hit(bvh, {origin, vec3(target - dvec3(origin))}) ? 0 : 1;
        }
        EXPECT_EQ(misses, 0u) << ball.name;
    }
}

TEST(MeshLeaks, AClosedMeshIsCrossedAnEvenNumberOfTimes) {
    std::vector<MeshHit> hits;
    for (const Ball& ball : balls()) {
        const StaticBvh bvh = StaticBvh::build(ball.mesh.vertices, ball.mesh.triangles).value();
        Random random(740);
        std::size_t odd = 0, crossings = 0;
        for (std::size_t i = 0; i < ray_count() / 60; ++i) {
            const vec3 origin = i % 2 == 0 ? ball.center + vec3(test::random_point(random, 2.0 * ball.size))
                                           : test::any_vertex(ball.mesh, random) + vec3{static_cast<float>(4.0 * ball.size), 0.0f, 0.0f};
            vec3 direction = test::seam_point(ball.mesh, random) - origin;
            if (i % 8 == 1) direction = {-1.0f, 0.0f, -0.0f};
            all_hits(bvh, {origin, direction, -kInfinity, kInfinity}, hits);
            odd += hits.size() % 2;
            crossings += hits.size();
        }
        EXPECT_EQ(odd, 0u) << ball.name;
        EXPECT_GT(crossings, ray_count() / 60) << ball.name;
    }
}

/// Rays that meet corners and edges of a grid exactly, head on: each crosses once, and hits.
TEST(MeshLeaks, ExactCornersAndEdgesAreCrossedOnce) {
    const StaticBvh bvh = StaticBvh::build(test::flat_grid(16).vertices, test::flat_grid(16).triangles).value();
    std::vector<MeshHit> hits;
    for (float x = -7.5f; x <= 7.5f; x += 0.25f) {
        for (float y = -7.5f; y <= 7.5f; y += 0.25f) {
            for (const vec3& slope : {vec3{0.0f, -0.0f, 1.0f}, vec3{0.5f, -0.25f, 1.0f}, vec3{-1.0f, 1.0f, 1.0f}}) {
                all_hits(bvh, {vec3{x, y, 0.0f} - 2.0f * slope, slope}, hits);
                ASSERT_EQ(hits.size(), 1u) << x << " " << y;
                EXPECT_EQ(hits[0].t, 2.0f);
                EXPECT_LE(closest_hit(bvh, {vec3{x, y, 0.0f} - 2.0f * slope, slope}).triangle, hits[0].triangle);
            }
        }
    }
}

}  // namespace
}  // namespace carom
