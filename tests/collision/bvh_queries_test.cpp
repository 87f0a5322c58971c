// Queries of the static hierarchy against a look at every triangle.
#include <carom/collision/bvh_queries.hpp>
#include <carom/collision/closest_points.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/mesh_data.hpp>
#include <carom/collision/overlap_tests.hpp>
#include <carom/core/check.hpp>
#include <carom/core/pose.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace carom {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

dvec3 random_in(Random& r, double size) { return {r.range(-size, size), r.range(-size, size), r.range(-size, size)}; }

/// Triangles of all sizes about a cube of half side 1, some degenerate, some coincident; scaled.
MeshData soup(std::uint64_t seed, int triangles, float scale = 1.0f) {
    Random random(seed);
    MeshData mesh;
    for (int i = 0; i < triangles; ++i) {
        const dvec3 at = random_in(random, 1.0);
        const double size = i % 10 == 0 ? 0.5 : 0.05;
        for (int c = 0; c < 3; ++c) mesh.vertices.push_back(scale * vec3(at + random_in(random, size)));
        if (i % 17 == 3) mesh.vertices.back() = mesh.vertices[mesh.vertices.size() - 2];
        if (i % 29 == 5) std::copy(mesh.vertices.begin(), mesh.vertices.begin() + 3, mesh.vertices.end() - 3);
        const auto first = static_cast<std::uint32_t>(3 * i);
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

geo::Triangle<double> triangle(const MeshData& mesh, std::size_t i) {
    const auto& t = mesh.triangles[i];
    return {dvec3(mesh.vertices[t[0]]), dvec3(mesh.vertices[t[1]]), dvec3(mesh.vertices[t[2]])};
}

template <class Shape>
std::vector<std::uint32_t> brute_force(const MeshData& mesh, const Shape& shape) {
    std::vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        if (geo::overlaps(shape, triangle(mesh, i))) found.push_back(i);
    }
    return found;
}

template <class Shape>
std::vector<std::uint32_t> query(const StaticBvh& bvh, const Shape& shape) {
    std::vector<std::uint32_t> found;
    overlapping_triangles(bvh, shape, [&](std::uint32_t triangle) {
        found.push_back(triangle);
        return true;
    });
    std::sort(found.begin(), found.end());
    return found;
}

dmat3 random_axes(Random& random) {
    dquat q{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
    return glm::mat3_cast(glm::normalize(q));
}

TEST(BvhQueries, VolumesMeetWhatALookAtEveryTriangleFinds) {
    for (const float scale : {1.0f, 1e-15f, 3e12f}) {
        const MeshData mesh = soup(1, 700, scale);
        const StaticBvh bvh = *StaticBvh::build(mesh.vertices, mesh.triangles);
        Random random(2);
        std::size_t hits = 0;
        for (const int width : available_simd_widths()) {
            set_simd_width(width);
            for (int i = 0; i < 60; ++i) {
                const double s = static_cast<double>(scale);
                const dvec3 centre = s * random_in(random, 1.6);
                const dvec3 half = s * (0.6 * dvec3{random.range(0, 1), random.range(0, 1), random.range(0, 1)});
                const double radius = s * random.range(0.0, 0.5);
                const geo::Aabb<double> box{centre - half, centre + half};
                const geo::Obb<double> turned{.center = centre, .half_extents = half, .axes = random_axes(random)};
                const geo::Capsule<double> capsule{{centre, centre + s * random_in(random, 1.5)}, 0.3 * radius};
                const geo::Sphere<double> sphere{centre, radius};
                ASSERT_EQ(query(bvh, box), brute_force(mesh, box)) << scale << ' ' << i;
                ASSERT_EQ(query(bvh, turned), brute_force(mesh, turned)) << scale << ' ' << i;
                ASSERT_EQ(query(bvh, capsule), brute_force(mesh, capsule)) << scale << ' ' << i;
                ASSERT_EQ(query(bvh, sphere), brute_force(mesh, sphere)) << scale << ' ' << i;
                hits += query(bvh, turned).size() + query(bvh, capsule).size();
            }
        }
        set_simd_width(0);
        EXPECT_GT(hits, 1000u);
    }
}

// A corner of the mesh exactly on the side of a volume, and its neighbour a last bit away.
TEST(BvhQueries, TouchingCountsToTheLastBit) {
    const MeshData mesh = soup(3, 300);
    const StaticBvh bvh = *StaticBvh::build(mesh.vertices, mesh.triangles);
    for (std::size_t i = 0; i < mesh.vertices.size(); i += 7) {
        const dvec3 v(mesh.vertices[i]);
        for (int axis = 0; axis < 3; ++axis) {
            geo::Aabb<double> box{v, v};
            ASSERT_FALSE(query(bvh, box).empty()) << i;
            ASSERT_EQ(query(bvh, box), brute_force(mesh, box)) << i;
            box.lower[axis] = std::nextafter(v[axis], kInfinity);
            box.upper[axis] = v[axis] + 1.0;
            ASSERT_EQ(query(bvh, box), brute_force(mesh, box)) << i;
        }
        const geo::Sphere<double> point{v, 0.0};
        ASSERT_EQ(query(bvh, point), brute_force(mesh, point)) << i;
    }
}

std::vector<std::uint32_t> query_hull(const StaticBvh& bvh, const ConvexHull& hull, const Pose& pose) {
    std::vector<std::uint32_t> found;
    overlapping_triangles(bvh, hull, pose, [&](std::uint32_t triangle) {
        found.push_back(triangle);
        return true;
    });
    std::sort(found.begin(), found.end());
    return found;
}

// A box as a hull, at a pose, is a turned box; they may differ by the bounds of the two alone, which random triangles do not come near.
TEST(BvhQueries, AHullMeetsWhatTheSameBoxMeets) {
    const MeshData mesh = soup(11, 700);
    const StaticBvh bvh = *StaticBvh::build(mesh.vertices, mesh.triangles);
    Random random(12);
    std::size_t hits = 0;
    for (int i = 0; i < 200; ++i) {
        const vec3 half{0.5f * static_cast<float>(random.range(0.05, 1.0)), 0.3f, 0.4f * static_cast<float>(random.range(0.05, 1.0))};
        std::vector<vec3> corners;
        for (int c = 0; c < 8; ++c) corners.push_back(half * vec3{c & 1 ? 1.0f : -1.0f, c & 2 ? 1.0f : -1.0f, c & 4 ? 1.0f : -1.0f});
        const Pose pose{random_in(random, 1.3), glm::normalize(dquat{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1), 0.3})};
        const geo::Obb<double> box{.center = pose.position, .half_extents = dvec3(half), .axes = glm::mat3_cast(pose.orientation)};
        const auto found = query_hull(bvh, **ConvexHull::build(corners), pose);
        ASSERT_EQ(found, query(bvh, box)) << i;
        hits += found.size();
    }
    EXPECT_GT(hits, 1000u);
    EXPECT_TRUE(query_hull(bvh, **ConvexHull::build(std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), {{kNaN, 0, 0}, kIdentityRotation}).empty());
}

TEST(BvhQueries, AFrustumMeetsWhatItsPlanesDoNotCutAway) {
    const MeshData mesh = soup(13, 700);
    const StaticBvh bvh = *StaticBvh::build(mesh.vertices, mesh.triangles);
    Random random(14);
    std::size_t inside = 0, outside = 0;
    for (int i = 0; i < 120; ++i) {
        const geo::Camera<double> camera{.position = random_in(random, 2.0),
                                         .forward = random_in(random, 1.0),
                                         .fovy = random.range(0.2, 2.0),
                                         .aspect = random.range(0.5, 2.0),
                                         .near_distance = 0.1,
                                         .far_distance = i % 3 == 0 ? kInfinity : random.range(0.5, 4.0)};
        const auto view = geo::frustum_of(camera);
        ASSERT_TRUE(view) << i;
        std::vector<bool> met(mesh.triangles.size());
        overlapping_triangles(bvh, *view, [&](std::uint32_t triangle) {
            EXPECT_FALSE(met[triangle]) << "twice";
            met[triangle] = true;
            return true;
        });
        for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) {
            // Points of the triangle inside, or one plane that has all of it below: certain either way.
            const geo::Triangle<double> t = triangle(mesh, k);
            bool some_inside = false, cut_away = false;
            for (int a = 0; a <= 6; ++a) {
                for (int b = 0; a + b <= 6; ++b) {
                    const dvec3 p = (t.a * double(a) + t.b * double(b) + t.c * double(6 - a - b)) / 6.0;
                    some_inside |= std::all_of(view->planes.begin(), view->planes.end(), [&](const geo::Plane<double>& plane) { return glm::dot(plane.normal, p) > plane.offset + 1e-12; });
                }
            }
            for (const geo::Plane<double>& plane : view->planes) {
                const double highest = std::max({glm::dot(plane.normal, t.a), glm::dot(plane.normal, t.b), glm::dot(plane.normal, t.c)});
                cut_away |= highest < plane.offset - 1e-12;
            }
            ASSERT_TRUE(met[k] || !some_inside) << i << ' ' << k;
            ASSERT_FALSE(met[k] && cut_away) << i << ' ' << k;
            inside += some_inside;
            outside += cut_away;
        }
    }
    EXPECT_GT(inside, 2000u);
    EXPECT_GT(outside, 20000u);
}

TEST(BvhQueries, StopWhenToldTo) {
    const MeshData mesh = soup(4, 300);
    const StaticBvh bvh = *StaticBvh::build(mesh.vertices, mesh.triangles);
    int visits = 0;
    overlapping_triangles(bvh, geo::Sphere<double>{{0, 0, 0}, 5.0}, [&](std::uint32_t) { return ++visits < 10; });
    EXPECT_EQ(visits, 10);
}

TEST(BvhQueries, BadVolumesMeetNothing) {
    const MeshData mesh = soup(5, 100);
    const StaticBvh bvh = *StaticBvh::build(mesh.vertices, mesh.triangles);
    EXPECT_TRUE(query(bvh, geo::Aabb<double>{{1, 1, 1}, {-1, -1, -1}}).empty());
    EXPECT_TRUE(query(bvh, geo::Aabb<double>{{kNaN, -1, -1}, {1, 1, 1}}).empty());
    EXPECT_TRUE(query(bvh, geo::Sphere<double>{{0, 0, 0}, -1.0}).empty());
    EXPECT_TRUE(query(bvh, geo::Sphere<double>{{0, kNaN, 0}, 1.0}).empty());
    EXPECT_TRUE(query(bvh, geo::Sphere<double>{{0, 0, 0}, kNaN}).empty());
    EXPECT_TRUE(query(bvh, geo::Obb<double>{.center = {0, 0, kInfinity}, .half_extents = dvec3{1.0}}).empty());
    EXPECT_TRUE(query(bvh, geo::Obb<double>{.half_extents = {1, -1, 1}}).empty());
    EXPECT_TRUE(query(bvh, geo::Capsule<double>{{{0, 0, 0}, {kNaN, 0, 0}}, 1.0}).empty());
    EXPECT_TRUE(query(bvh, geo::Capsule<double>{{{0, 0, 0}, {1, 0, 0}}, -1.0}).empty());
}

std::optional<ClosestOnMesh> brute_closest(const MeshData& mesh, const dvec3& p, double radius) {
    std::optional<ClosestOnMesh> best;
    double least = kInfinity;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const geo::ClosestPoints<double> c = geo::closest_points(p, triangle(mesh, i));
        if (!(c.distance_sq < least) || std::sqrt(c.distance_sq) > radius) continue;
        least = c.distance_sq;
        best = ClosestOnMesh{c.on_b, std::sqrt(c.distance_sq), i};
    }
    return best;
}

TEST(BvhQueries, TheClosestPointIsTheClosestOfAllTriangles) {
    for (const float scale : {1.0f, 2e-14f, 5e11f}) {
        const MeshData mesh = soup(6, 600, scale);
        const StaticBvh bvh = *StaticBvh::build(mesh.vertices, mesh.triangles);
        const auto s = static_cast<double>(scale);
        Random random(7);
        int near = 0, beyond = 0;
        for (const int width : available_simd_widths()) {
            set_simd_width(width);
            for (int i = 0; i < 150; ++i) {
                const double away = i % 5 == 0 ? 1e6 : (i % 5 == 1 ? 20.0 : 1.2);
                const dvec3 p = i % 11 == 0 ? dvec3(mesh.vertices[static_cast<std::size_t>(i)]) : s * random_in(random, away);
                const double radius = i % 3 == 0 ? s * random.range(0.0, 0.4) : kInfinity;
                const auto want = brute_closest(mesh, p, radius);
                const auto got = closest_point(bvh, p, radius);
                ASSERT_EQ(got.has_value(), want.has_value()) << scale << ' ' << i;
                ++(got ? near : beyond);
                if (!got) continue;
                ASSERT_EQ(got->distance, want->distance) << scale << ' ' << i;
                ASSERT_EQ(got->triangle, want->triangle) << scale << ' ' << i;
                ASSERT_EQ(got->point, want->point) << scale << ' ' << i;
            }
        }
        set_simd_width(0);
        EXPECT_GT(near, 100);
        EXPECT_GT(beyond, 10);
    }
}

TEST(BvhQueries, TheRadiusIsClosed) {
    const std::vector<vec3> v = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const StaticBvh bvh = *StaticBvh::build(v, std::vector<StaticBvh::Triangle>{{0, 1, 2}});
    EXPECT_TRUE(closest_point(bvh, {0.25, 0.25, 0.5}, 0.5));
    EXPECT_FALSE(closest_point(bvh, {0.25, 0.25, 0.5}, 0.5 - 1e-14));
    EXPECT_TRUE(closest_point(bvh, {0.25, 0.25, 0.0}, 0.0));
    EXPECT_FALSE(closest_point(bvh, {kNaN, 0, 0}));
    EXPECT_FALSE(closest_point(bvh, {kInfinity, 0, 0}));
    EXPECT_FALSE(closest_point(bvh, {0, 0, 0}, kNaN));
    EXPECT_FALSE(closest_point(bvh, {0, 0, 0}, -1.0));
}

TEST(BvhQueries, BatchesAreManySingleCalls) {
    const MeshData mesh = soup(8, 200);
    const StaticBvh bvh = *StaticBvh::build(mesh.vertices, mesh.triangles);
    Random random(9);
    std::vector<dvec3> points(500);
    for (dvec3& p : points) p = random_in(random, 2.0);
    std::vector<std::optional<ClosestOnMesh>> found(points.size());
    SerialExecutor executor;
    closest_points(bvh, points, 0.3, found, executor);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto want = closest_point(bvh, points[i], 0.3);
        ASSERT_EQ(found[i].has_value(), want.has_value());
        if (want) {
            ASSERT_EQ(found[i]->point, want->point);
        }
    }
    EXPECT_THROW(closest_points(bvh, points, 0.3, std::span(found).first(3), executor), MisuseError);
}

}  // namespace
}  // namespace carom
