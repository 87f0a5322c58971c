// Rays against meshes: the hierarchy against brute force, and watertightness at edges and vertices.
#include <carom/collision/detail/ray_candidates.hpp>
#include <carom/collision/detail/ray_triangle.hpp>
#include <carom/collision/ray_cast.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>

#include "support_mesh.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <optional>

namespace carom {
namespace {

using test::random_point;

TriangleMeshPtr build(const MeshData& data) { return TriangleMesh::build(data.vertices, data.triangles).value(); }

struct First {
    double distance;
    std::uint32_t triangle;
};

/// The oracle: the triangle's test for every triangle.
std::optional<First> brute_force(const TriangleMesh& mesh, const Ray& ray) {
    const RayFrame frame(ray.origin, ray.direction / std::sqrt(glm::dot(ray.direction, ray.direction)));
    std::optional<First> first;
    for (std::uint32_t t = 0; t < mesh.triangles().size(); ++t) {
        const auto [a, b, c] = mesh.corners(t);
        const std::optional<TriangleCrossing> crossing = intersect(frame, a, b, c);
        if (crossing && crossing->distance >= 0.0 && (!first || crossing->distance < first->distance)) {
            first = First{crossing->distance, t};
        }
    }
    return first;
}

/// Whether the ray, moved aside by (e, e²) for an infinitesimal e > 0, crosses the triangle: each edge then has one side, so that a
/// crossing at an edge or a vertex counts for as many triangles as it passes through.
bool crosses_when_moved_aside(const RayFrame& frame, const std::array<vec3, 3>& corners) {
    int left = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const dvec3 p = frame.project(corners[k]);
        const dvec3 q = frame.project(corners[(k + 1) % 3]);
        double side = difference_of_products(p.x, q.y, p.y, q.x);
        side = side != 0.0 ? side : p.y - q.y;
        side = side != 0.0 ? side : q.x - p.x;
        if (side == 0.0) {
            return false;  // the corners coincide
        }
        left += side > 0.0 ? 1 : 0;
    }
    const std::optional<TriangleCrossing> crossing = intersect(frame, corners[0], corners[1], corners[2]);
    return (left == 0 || left == 3) && crossing && crossing->distance >= 0.0;
}

int crossings(const TriangleMesh& mesh, const Ray& ray) {
    const RayFrame frame(ray.origin, ray.direction / std::sqrt(glm::dot(ray.direction, ray.direction)));
    int count = 0;
    for (std::uint32_t t = 0; t < mesh.triangles().size(); ++t) {
        count += crosses_when_moved_aside(frame, mesh.corners(t)) ? 1 : 0;
    }
    return count;
}

/// A point on an edge or, in one case of three, at a corner of a random triangle, in double.
dvec3 seam_point(const TriangleMesh& mesh, Random& random) {
    const auto t = static_cast<std::uint32_t>(random.unit() * static_cast<double>(mesh.triangles().size()));
    const std::array<vec3, 3> corners = mesh.corners(t);
    const auto k = static_cast<std::size_t>(random.unit() * 3.0);
    const dvec3 a(corners[k]);
    const dvec3 b(corners[(k + 1) % 3]);
    const double s = random.unit();
    return s < 1.0 / 3.0 ? a : a + (b - a) * random.unit();
}

MeshData moved(MeshData data, const vec3& by, float scale) {
    for (vec3& v : data.vertices) {
        v = scale * v + by;
    }
    return data;
}

TEST(RayMesh, TheHierarchyFindsWhatBruteForceFinds) {
    Random random(301);
    const TriangleMeshPtr mesh = build(test::terrain(40, 0.25));
    int hits = 0;
    for (int i = 0; i < 3000; ++i) {
        Ray ray{random_point(random, 5.0)};  // near enough that the cast does not move its origin
        ray.direction = i % 5 == 0 ? dvec3{0.0, i % 2 == 0 ? -1.0 : 1.0, -0.0} : random_point(random, 1.0);
        const std::optional<RayHit> hit = cast_ray(mesh, ray);
        const std::optional<First> first = brute_force(*mesh, ray);
        ASSERT_EQ(hit.has_value(), first.has_value());
        if (hit) {
            ++hits;
            EXPECT_EQ(hit->distance, first->distance);
            EXPECT_EQ(hit->triangle, first->triangle);
            EXPECT_NEAR(glm::length(ray.origin + hit->distance * glm::normalize(ray.direction) - hit->point), 0.0, 1e-13);
            EXPECT_LT(glm::dot(hit->normal, ray.direction), 0.0);
            EXPECT_NEAR(glm::length(hit->normal), 1.0, 1e-14);
        }
    }
    EXPECT_GT(hits, 800);
}

TEST(RayMesh, ARayLooksAtFewTriangles) {
    Random random(309);
    const TriangleMeshPtr mesh = build(test::terrain(64, 0.25));
    constexpr int kRays = 500;
    int looked_at = 0;
    for (int i = 0; i < kRays; ++i) {
        const dvec3 origin{random.range(-4.0, 4.0), 5.0, random.range(-4.0, 4.0)};
        const dvec3 direction = glm::normalize(dvec3{random.range(-1.0, 1.0), -2.0, random.range(-1.0, 1.0)});
        const RayFrame frame(origin, direction);
        double nearest = std::numeric_limits<double>::infinity();
        WideRay wide;
        ASSERT_TRUE(prepare(mesh->bvh().wide(), geo::Ray<double>{origin, direction}, wide));
        visit_ray_candidates(mesh->bvh().wide(), wide, [&](const WideLeaf& leaf, unsigned triangles) {
            for (; triangles != 0; triangles &= triangles - 1) {
                ++looked_at;
                const auto [a, b, c] = mesh->corners(leaf.triangle[std::countr_zero(triangles)]);
                if (const auto crossing = intersect(frame, a, b, c); crossing && crossing->distance < nearest) {
                    nearest = crossing->distance;
                }
            }
            return wide.own_t(nearest);
        });
        EXPECT_TRUE(std::isfinite(nearest));
    }
    EXPECT_LT(looked_at, 2 * kRays) << "of 8192 triangles";
}

TEST(RayMesh, SoupOfNeedlesAndSpecksToo) {
    Random random(302);
    MeshData data;
    for (int i = 0; i < 600; ++i) {
        const auto first = static_cast<std::uint32_t>(data.vertices.size());
        const dvec3 at = random_point(random, 2.0);
        const dvec3 size = i % 3 == 0 ? dvec3{3.0, 1e-6, 1e-6} : i % 3 == 1 ? dvec3{1e-4} : dvec3{1.0};
        for (int k = 0; k < 3; ++k) {
            data.vertices.push_back(vec3(at + size * random_point(random, 1.0)));
        }
        data.triangles.push_back({first, first + 1, first + 2});
    }
    const TriangleMeshPtr mesh = build(data);
    for (int i = 0; i < 3000; ++i) {
        Ray ray{random_point(random, 2.5)};
        ray.direction = seam_point(*mesh, random) - ray.origin;
        const std::optional<RayHit> hit = cast_ray(mesh, ray);
        const std::optional<First> first = brute_force(*mesh, ray);
        ASSERT_EQ(hit.has_value(), first.has_value());
        if (hit) {
            EXPECT_EQ(hit->distance, first->distance);
            EXPECT_EQ(hit->triangle, first->triangle);
        }
    }
}

TEST(RayMesh, NoRayLeavesAClosedMesh) {
    Random random(303);
    const MeshData ball = test::sphere_mesh(31, 17, 1.0);
    for (const TriangleMeshPtr& mesh : {build(ball), build(test::unweld(ball)), build(moved(ball, {1000, -300, 50}, 0.25f)),
                                        build(moved(ball, {3e-12f, 4e-12f, 5e-12f}, 1e-12f))}) {
        ASSERT_TRUE(mesh->is_closed());
        const dvec3 center = 0.5 * (mesh->local_bounds().lower + mesh->local_bounds().upper);
        const double half = 0.5 * (mesh->local_bounds().upper - mesh->local_bounds().lower).x;
        int leaks = 0;
        for (int i = 0; i < 25000; ++i) {
            const dvec3 origin = i % 4 == 0 ? center : center + random_point(random, 0.5 * half);
            leaks += cast_ray(mesh, {origin, seam_point(*mesh, random) - origin}) ? 0 : 1;
        }
        EXPECT_EQ(leaks, 0);
    }
}

TEST(RayMesh, RaysFromFarHitTheSeamsTheyAimAt) {
    Random random(304);
    const TriangleMeshPtr mesh = build(test::sphere_mesh(31, 17, 1.0));
    for (const double distance : {3.0, 100.0, 1e6}) {
        for (int i = 0; i < 10000; ++i) {
            Ray ray{glm::normalize(random_point(random, 1.0)) * distance};
            // Shrunk, so that what is aimed at is inside the outline by more than the rounding of the origin.
            ray.direction = 0.9 * seam_point(*mesh, random) - ray.origin;
            EXPECT_TRUE(cast_ray(mesh, ray)) << distance;
        }
    }
}

TEST(RayMesh, AClosedMeshIsCrossedAnEvenNumberOfTimes) {
    Random random(305);
    const TriangleMeshPtr mesh = build(test::sphere_mesh(8, 6, 1.0));
    int crossed = 0;
    for (int i = 0; i < 100000; ++i) {
        Ray ray{glm::normalize(random_point(random, 1.0)) * 3.0};
        ray.direction = seam_point(*mesh, random) - ray.origin;
        if (i % 2 == 0) {  // exactly through a vertex, along an axis
            const auto v = static_cast<std::size_t>(random.unit() * static_cast<double>(mesh->vertices().size()));
            ray.direction = {0.0, 0.0, -1.0};
            ray.origin = dvec3(mesh->vertices()[v]);
            ray.origin.z = 3.0;
        }
        const int count = crossings(*mesh, ray);
        ASSERT_EQ(count % 2, 0);
        crossed += count;
    }
    EXPECT_GT(crossed, 100000);
}

TEST(RayMesh, BothSidesEdgesAndCornersAreHit) {
    const TriangleMeshPtr mesh = build({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
    const auto cast = [&](double x, double y, double z, double dz) { return cast_ray(mesh, {{x, y, z}, {0, 0, dz}}); };
    ASSERT_TRUE(cast(0.25, 0.25, 2, -1));
    EXPECT_EQ(cast(0.25, 0.25, 2, -1)->normal, (dvec3{0, 0, 1}));
    EXPECT_EQ(cast(0.25, 0.25, -2, 1)->normal, (dvec3{0, 0, -1}));
    EXPECT_EQ(cast(0.25, 0.25, 0, 1)->distance, 0.0) << "an origin on the surface";
    EXPECT_TRUE(cast(0.5, 0.5, 2, -1));
    EXPECT_TRUE(cast(0, 0, 2, -1));
    EXPECT_TRUE(cast(1, 0, 2, -1));
    EXPECT_FALSE(cast(std::nextafter(1.0, 2.0), 0, 2, -1));
    EXPECT_FALSE(cast(0.5, std::nextafter(0.5, 1.0), 2, -1));
    EXPECT_FALSE(cast(0.25, -5e-324, 2, -1));
    EXPECT_FALSE(cast(0.25, 0.25, 2, 1)) << "behind";
    EXPECT_FALSE(cast_ray(mesh, {{-1, 0.25, 0}, {1, 0, 0}})) << "in its plane";
}

TEST(RayMesh, TiesGoToTheLowestTriangle) {
    MeshData data{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}};
    data.triangles.assign(100, {0, 1, 2});
    EXPECT_EQ(cast_ray(build(data), {{0.25, 0.25, 1}, {0, 0, -1}})->triangle, 0u);
}

TEST(RayMesh, DegenerateTrianglesGiveNoNan) {
    Random random(306);
    const TriangleMeshPtr mesh =
        build({{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {0.1f, 0.7f, 0.3f}, {0.2f, 1.4f, 0.6f}}, {{0, 1, 2}, {1, 1, 1}, {0, 3, 4}, {3, 3, 4}}});
    for (int i = 0; i < 5000; ++i) {
        Ray ray{random_point(random, 3.0)};
        ray.direction = seam_point(*mesh, random) - ray.origin;
        if (const std::optional<RayHit> hit = cast_ray(mesh, ray)) {
            EXPECT_TRUE(is_finite(hit->point) && is_finite(hit->normal) && is_finite(hit->distance));
            EXPECT_NEAR(glm::length(hit->normal), 1.0, 1e-12);
        }
    }
}

TEST(RayMesh, ScalingTheSceneByAPowerOfTwoScalesTheAnswer) {
    Random random(307);
    const MeshData data = test::terrain(20, 0.25);
    const TriangleMeshPtr mesh = build(data);
    for (const float scale : {0x1p-60f, 0x1p-10f, 0x1p20f, 0x1p90f}) {
        const TriangleMeshPtr scaled = build(moved(data, vec3{0.0f}, scale));
        for (int i = 0; i < 500; ++i) {
            const Ray ray{random_point(random, 5.0), random_point(random, 1.0)};
            const auto k = static_cast<double>(scale);
            const std::optional<RayHit> a = cast_ray(mesh, ray);
            const std::optional<RayHit> b = cast_ray(scaled, {k * ray.origin, k * ray.direction});
            ASSERT_EQ(a.has_value(), b.has_value());
            if (a) {
                EXPECT_EQ(k * a->distance, b->distance);
                EXPECT_EQ(k * a->point, b->point);
                EXPECT_EQ(a->normal, b->normal);
                EXPECT_EQ(a->triangle, b->triangle);
            }
        }
    }
}

TEST(RayMesh, FarOriginsKeepTheirAccuracy) {
    Random random(308);
    const TriangleMeshPtr mesh = build({{{-1, 0, -1}, {1, 0, -1}, {0, 0, 2}}, {{0, 1, 2}}});
    for (const double far : {1e3, 1e6, 1e9, 1e12}) {
        for (int i = 0; i < 200; ++i) {
            Ray ray{{random.range(-1.0, 1.0) * far, far, random.range(-1.0, 1.0) * far}};
            ray.direction = -ray.origin;
            const std::optional<RayHit> hit = cast_ray(mesh, ray);
            ASSERT_TRUE(hit);
            const double expected = glm::length(ray.origin);
            EXPECT_NEAR(hit->distance / expected, 1.0, 1e-15);
            EXPECT_NEAR(glm::length(hit->point), 0.0, 1e-15 * expected);
        }
    }
}

}  // namespace
}  // namespace carom
