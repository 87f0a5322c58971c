// Float rays where floats end: triangles far smaller than the mesh, intervals cut at a hit, trees that are no more.
#include <carom/collision/mesh_rays.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>

#include "mesh_rays_cases.hpp"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace carom {
namespace {

using test::FloatRay;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

StaticBvh build(const MeshData& mesh) { return StaticBvh::build(mesh.vertices, mesh.triangles).value(); }

float within(Random& random, double size) { return static_cast<float>(random.range(-size, size)); }

/// An octahedron of the given size at the origin, and a triangle of size 1 beside it, so that nothing is scaled.
MeshData speck_in_a_large_mesh(float s) {
    return {{{s, 0, 0}, {-s, 0, 0}, {0, s, 0}, {0, -s, 0}, {0, 0, s}, {0, 0, -s}, {1, 1, 1}, {1, 1, 0.5f}, {1, 0.5f, 1}},
            {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}, {6, 7, 8}}};
}

TEST(MeshRaysLimits, ATriangleOfAnySizeIsWatertight) {
    for (const float s : {1e-10f, 1e-18f, 1e-20f, 1e-22f, 1e-23f, 1e-25f, 1e-30f, 1e-38f}) {
        const StaticBvh bvh = build(speck_in_a_large_mesh(s));
        Random random(720);
        std::vector<MeshHit> hits;
        for (int i = 0; i < 3000; ++i) {
            // Every fourth through an edge, every eighth through a corner.
            float x = within(random, 1.0), y = within(random, 1.0 - std::abs(static_cast<double>(x)));
            if (i % 4 == 0) x = 0.0f;
            if (i % 8 == 0) y = 0.0f;
            const FloatRay ray{.origin = {s * x, s * y, -1}, .direction = {0, 0, 1}};
            set_simd_width(available_simd_widths()[static_cast<std::size_t>(i) % available_simd_widths().size()]);
            const MeshHit hit = closest_hit(bvh, ray);
            ASSERT_TRUE(hit) << s << ' ' << i;
            ASSERT_TRUE(any_hit(bvh, ray));
            ASSERT_EQ(hit.t, 1.0f);
            all_hits(bvh, ray, hits);
            ASSERT_EQ(hits.size(), 2u) << s << ' ' << i;
            for (const MeshHit& h : hits) {
                ASSERT_TRUE(h.u >= 0.0f && h.v >= 0.0f && h.u + h.v <= 1.0f + 0x1p-22f);
                // The weights are those of the point, as precise as the mesh is small.
                const MeshData mesh = speck_in_a_large_mesh(1.0f);
                const auto& t = mesh.triangles[h.triangle];
                const vec3 at = (1.0f - h.u - h.v) * mesh.vertices[t[0]] + h.u * mesh.vertices[t[1]] + h.v * mesh.vertices[t[2]];
                const float error = s < 1e-37f ? 1e-4f : 1e-6f;  // denormal coordinates have few bits
                ASSERT_NEAR(at.x, x, error);
                ASSERT_NEAR(at.y, y, error);
            }
        }
    }
    set_simd_width(0);
}

// The triangles of a long thin tent round the ray: images are tiny, depths are not, so that weights that lost bits would show in t.
TEST(MeshRaysLimits, DepthsOfSliversAlongTheRayAreRight) {
    for (const float s : {1e-12f, 1e-21f, 1e-24f, 1e-30f}) {
        const StaticBvh bvh = build({{{s, 0, 0}, {-s, s, 1}, {-s, -s, 3}}, {{0, 1, 2}}});
        const MeshHit hit = closest_hit(bvh, {.origin = {0, 0, -1}, .direction = {0, 0, 1}});
        ASSERT_TRUE(hit) << s;
        EXPECT_NEAR(hit.t, 2.0f, 1e-6f) << s;
        EXPECT_NEAR(hit.u, 0.25f, 1e-6f) << s;
        EXPECT_NEAR(hit.v, 0.25f, 1e-6f) << s;
    }
}

TEST(MeshRaysLimits, ARayInThePlaneOfATriangleMissesItAtEverySize) {
    for (const float s : {1.0f, 1e-10f, 1e-30f}) {
        const StaticBvh bvh = build({{{0, 0, 0}, {s, 0, 0}, {0, 0, s}, {1, 1, 1}, {1, 2, 1}, {2, 1, 1}}, {{0, 1, 2}, {3, 4, 5}}});
        EXPECT_FALSE(closest_hit(bvh, {.origin = {0.25f * s, 0, -1}, .direction = {0, 0, 1}})) << s;
    }
}

/// Rays at a mesh from all distances: near, where floats are cast as they are, and far, where origins are moved.
std::vector<FloatRay> rays_from_everywhere(int count, bool with_small_t) {
    Random random(721);
    std::vector<FloatRay> rays;
    for (int i = 0; i < count; ++i) {
        const double away = std::ldexp(random.range(0.5, 1.0), i % 30);
        const dvec3 from = away * glm::normalize(test::random_point(random, 1.0));
        const vec3 origin(from);
        FloatRay ray{.origin = origin, .direction = vec3(test::random_point(random, 0.6) - dvec3(origin))};
        ray.direction *= std::ldexp(1.0f, with_small_t ? static_cast<int>(random.range(40.0, 90.0)) : static_cast<int>(random.range(-90.0, 60.0)));
        rays.push_back(ray);
    }
    return rays;
}

TEST(MeshRaysLimits, ARayCutAtItsHitHitsThereAgain) {
    for (const float scale : {1.0f, 1e-12f}) {
        const StaticBvh bvh = build(test::transformed(test::needles_and_specks(200), scale, {}));
        int hits = 0;
        std::vector<MeshHit> all, cut;
        for (const bool with_small_t : {false, true}) {
            for (FloatRay ray : rays_from_everywhere(3000, with_small_t)) {
                ray.origin *= scale;
                all_hits(bvh, ray, all);
                const MeshHit first = closest_hit(bvh, ray);
                if (!first) continue;
                ++hits;
                FloatRay again = ray;
                again.t_max = first.t;
                ASSERT_EQ(closest_hit(bvh, again).triangle, first.triangle);
                ASSERT_EQ(closest_hit(bvh, again).t, first.t);
                ASSERT_TRUE(any_hit(bvh, again));
                // Any part of the interval has the part of the list that lies in it.
                const float from = all[all.size() / 3].t, to = all[all.size() * 2 / 3].t;
                for (const FloatRay& part : {FloatRay{ray.origin, ray.direction, 0.0f, to}, FloatRay{ray.origin, ray.direction, from, kInfinity},
                                             FloatRay{ray.origin, ray.direction, from, to}, FloatRay{ray.origin, ray.direction, from, from},
                                             FloatRay{ray.origin, ray.direction, std::nextafter(from, kInfinity), kInfinity}}) {
                    all_hits(bvh, part, cut);
                    std::vector<std::uint32_t> want, got;
                    for (const MeshHit& hit : all) {
                        if (hit.t >= part.t_min && hit.t <= part.t_max) want.push_back(hit.triangle);
                    }
                    for (const MeshHit& hit : cut) got.push_back(hit.triangle);
                    ASSERT_EQ(got, want) << part.t_min << ' ' << part.t_max;
                }
            }
        }
        EXPECT_GT(hits, 1000);
    }
}

// Many triangles through one point, whose boxes are met in another order than that of their numbers.
TEST(MeshRaysLimits, HitsAtOneDistanceComeInTheOrderOfTheirNumbers) {
    Random random(723);
    MeshData mesh;
    for (std::uint32_t k = 0; k < 400; ++k) {
        const float r = static_cast<float>(random.range(0.5, 9.0));
        for (const vec3& v : {vec3{-r, -r, 1}, vec3{2.0f * r, -r, 1}, vec3{-r, 2.0f * r, 1}}) mesh.vertices.push_back(v);
        mesh.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
    }
    const StaticBvh bvh = build(mesh);
    std::vector<MeshHit> hits;
    all_hits(bvh, {.origin = {0.01f, 0.02f, 0}, .direction = {0, 0, 1}}, hits);
    ASSERT_EQ(hits.size(), 400u);
    for (std::uint32_t k = 0; k < 400; ++k) ASSERT_EQ(hits[k].triangle, k);
}

TEST(MeshRaysLimits, ATinyBeginningOfTheIntervalIsKept) {
    const StaticBvh bvh = build({{{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}}, {{0, 1, 2}}});
    for (const float length : {1.0f, 0x1p-60f, 0x1p60f}) {
        EXPECT_TRUE(closest_hit(bvh, {.origin = {0, 0, 0}, .direction = {0, 0, length}, .t_min = 0.0f}));
        EXPECT_FALSE(closest_hit(bvh, {.origin = {0, 0, 0}, .direction = {0, 0, length}, .t_min = 1e-30f}));
        EXPECT_FALSE(closest_hit(bvh, {.origin = {0, 0, 0}, .direction = {0, 0, length}, .t_min = 1e-45f}));
    }
}

// What an allocator gives back is often what it was just given: the memory of a tree that is no more.
TEST(MeshRaysLimits, AnOccluderOfATreeThatIsNoMoreCostsOnlyTime) {
    Random random(722);
    LastOccluder last;
    std::optional<StaticBvh> bvh;
    for (int frame = 0; frame < 300; ++frame) {
        MeshData mesh;
        const auto count = static_cast<std::uint32_t>(60.0 + 900.0 * random.unit());
        for (std::uint32_t i = 0; i < count; ++i) {
            const vec3 at{within(random, 5), within(random, 5), within(random, 5)};
            for (int k = 0; k < 3; ++k) mesh.vertices.push_back(at + vec3{within(random, 0.4), within(random, 0.4), within(random, 0.4)});
            mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
        }
        bvh.reset();
        bvh.emplace(build(mesh));
        for (int k = 0; k < 100; ++k) {
            FloatRay ray{.origin = {within(random, 6), within(random, 6), within(random, 6)},
                         .direction = {within(random, 1), within(random, 1), within(random, 1)}};
            ray.t_max = k < 60 ? 3.0f : kInfinity;
            LastOccluder stale = last;
            ASSERT_EQ(any_hit(*bvh, ray, &stale), any_hit(*bvh, ray)) << frame << ' ' << k;
            if (k >= 60) static_cast<void>(any_hit(*bvh, ray, &last));
        }
    }
}

TEST(MeshRaysLimits, AnOccluderOutlivesARefitAndAMove) {
    MeshData ball = test::sphere_mesh(16, 9, 1.0);
    StaticBvh bvh = build(ball);
    LastOccluder last;
    EXPECT_TRUE(any_hit(bvh, {.origin = {0, 0, -3}, .direction = {0, 0, 1}}, &last));
    const LastOccluder before = last;
    for (vec3& v : ball.vertices) v.x += 5.0f;
    ASSERT_TRUE(bvh.refit(ball.vertices, ball.triangles));
    const StaticBvh elsewhere = std::move(bvh);
    EXPECT_FALSE(any_hit(elsewhere, {.origin = {0, 0, -3}, .direction = {0, 0, 1}}, &last));
    EXPECT_TRUE(any_hit(elsewhere, {.origin = {5, 0, -3}, .direction = {0, 0, 1}}, &last));
    EXPECT_EQ(last.tree, before.tree);
}

}  // namespace
}  // namespace carom
