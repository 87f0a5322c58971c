// Pairs of triangles of two meshes against every triangle with every other, and the verdict on two triangles against rationals.
#include <carom/collision/closest_points.hpp>
#include <carom/collision/detail/triangles_meet.hpp>
#include <carom/collision/detail/wide_pairs.hpp>
#include <carom/collision/mesh_pairs.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/scenes/bumpy.hpp>

#include <support/exact_distance.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace carom {
namespace {

using detail::TriangleCorners;

geo::Triangle<double> triangle(const TriangleCorners& t) { return {t[0], t[1], t[2]}; }

bool exactly_meet(const TriangleCorners& a, const TriangleCorners& b) {
    return exact::core_distance_sq(exact::solid(triangle(a)), exact::solid(triangle(b))) == 0;
}

dvec3 lattice_point(Random& random, int size) {
    const auto coordinate = [&] { return std::floor(random.range(0.0, static_cast<double>(size))); };
    const double x = coordinate(), y = coordinate();
    return {x, y, coordinate()};
}

TEST(TrianglesMeet, SmallLatticesHoldEveryWayToTouch) {
    Random random(20'260'901);
    int meeting = 0, flat = 0;
    for (int n = 0; n < 4000; ++n) {
        TriangleCorners a{}, b{};
        const int size = n % 3 == 0 ? 2 : n % 3 == 1 ? 3 : 5;
        for (TriangleCorners* t : {&a, &b}) {
            for (dvec3& p : *t) p = lattice_point(random, size);
        }
        if (n % 4 == 0) {  // in one plane
            for (TriangleCorners* t : {&a, &b}) {
                for (dvec3& p : *t) p.z = p.x - 2.0 * p.y;
            }
        }
        const bool expected = exactly_meet(a, b);
        meeting += expected;
        flat += glm::cross(a[1] - a[0], a[2] - a[0]) == dvec3{0.0};
        ASSERT_EQ(detail::triangles_meet(a, b), expected) << n;
        ASSERT_EQ(detail::triangles_meet(b, a), expected) << n;
        ASSERT_EQ(detail::triangles_meet({a[1], a[0], a[2]}, {b[2], b[0], b[1]}), expected) << n;
    }
    EXPECT_GT(meeting, 600);
    EXPECT_LT(meeting, 3500);
    EXPECT_GT(flat, 200);
}

TEST(TrianglesMeet, IsExactWhereDoublesAreNot) {
    Random random(20'260'902);
    int meeting = 0;
    for (int n = 0; n < 400; ++n) {
        // A corner of b lies on a, to rounding: which side it is on is beyond what doubles tell.
        TriangleCorners a{}, b{};
        for (TriangleCorners* t : {&a, &b}) {
            for (dvec3& p : *t) p = {random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0)};
        }
        const double s = random.range(0.1, 0.4), t = random.range(0.1, 0.4);
        const dvec3 normal = glm::cross(a[1] - a[0], a[2] - a[0]);
        b[0] = a[0] + s * (a[1] - a[0]) + t * (a[2] - a[0]);
        for (dvec3* p : {&b[1], &b[2]}) {
            if (glm::dot(normal, *p - b[0]) < 0.0) *p = b[0] - (*p - b[0]);
        }
        const bool expected = exactly_meet(a, b);
        meeting += expected;
        ASSERT_EQ(detail::triangles_meet(a, b), expected) << n;
        ASSERT_EQ(detail::triangles_meet(b, a), expected) << n;
    }
    EXPECT_GT(meeting, 100);
    EXPECT_LT(meeting, 300);
}

TEST(TrianglesMeet, FindsThoseInOnePlaneAndWithoutAPlane) {
    const TriangleCorners big{dvec3{0, 0, 0}, dvec3{4, 0, 0}, dvec3{0, 4, 0}};
    const auto point = [](double x, double y, double z) { return TriangleCorners{dvec3{x, y, z}, dvec3{x, y, z}, dvec3{x, y, z}}; };
    EXPECT_TRUE(detail::triangles_meet(big, big));
    EXPECT_TRUE(detail::triangles_meet(big, {dvec3{1, 1, 0}, dvec3{2, 1, 0}, dvec3{1, 2, 0}}));                        // inside
    EXPECT_FALSE(detail::triangles_meet(big, {dvec3{3, 3, 0}, dvec3{4, 3, 0}, dvec3{3, 4, 0}}));                       // beside
    EXPECT_TRUE(detail::triangles_meet(big, {dvec3{2, 2, 0}, dvec3{4, 3, 0}, dvec3{3, 4, 0}}));                        // at a corner
    EXPECT_TRUE(detail::triangles_meet(big, point(1, 1, 0)));
    EXPECT_FALSE(detail::triangles_meet(big, point(1, 1, 0x1p-200)));
    EXPECT_TRUE(detail::triangles_meet(point(1, 1, 0), point(1, 1, 0)));
    EXPECT_FALSE(detail::triangles_meet(point(1, 1, 0), point(1, 1, 1)));
    const TriangleCorners along_x{dvec3{0, 1, 0}, dvec3{4, 1, 0}, dvec3{2, 1, 0}}, along_y{dvec3{1, 0, 0}, dvec3{1, 2, 0}, dvec3{1, 4, 0}};
    EXPECT_TRUE(detail::triangles_meet(along_x, along_y));
    const TriangleCorners above{dvec3{1, 0, 1}, dvec3{1, 2, 1}, dvec3{1, 4, 1}};
    EXPECT_FALSE(detail::triangles_meet(along_x, above));
    EXPECT_FALSE(detail::triangles_meet(along_x, {dvec3{5, 1, 0}, dvec3{6, 1, 0}, dvec3{7, 1, 0}}));
    EXPECT_TRUE(detail::triangles_meet(along_x, {dvec3{4, 1, 0}, dvec3{6, 1, 0}, dvec3{7, 1, 0}}));
}

StaticBvh bvh_of(const MeshData& mesh) {
    Result<StaticBvh> bvh = StaticBvh::build(mesh.vertices, mesh.triangles);
    EXPECT_TRUE(bvh);
    return std::move(*bvh);
}

std::vector<TrianglePair> every_pair(const MeshData& a, const MeshData& b, const Pose& b_in_a) {
    const auto corners = [](const MeshData& mesh, std::size_t i, const Pose& pose) {
        TriangleCorners out{};
        for (std::size_t k = 0; k < 3; ++k) out[k] = transform_point(pose, dvec3(mesh.vertices[mesh.triangles[i][k]]));
        return out;
    };
    std::vector<TriangleCorners> of_b;
    for (std::size_t j = 0; j < b.triangles.size(); ++j) of_b.push_back(corners(b, j, b_in_a));
    std::vector<TrianglePair> pairs;
    for (std::size_t i = 0; i < a.triangles.size(); ++i) {
        const TriangleCorners of_a = corners(a, i, {});
        for (std::size_t j = 0; j < of_b.size(); ++j) {
            if (detail::triangles_meet(of_a, of_b[j])) pairs.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
        }
    }
    return pairs;
}

MeshData scaled(MeshData mesh, float factor, const vec3& shift = vec3{0.0f}) {
    for (vec3& v : mesh.vertices) v = factor * (v + shift);
    return mesh;
}

MeshData unit_cube() {
    MeshData cube;
    for (int k = 0; k < 8; ++k) cube.vertices.push_back({(k & 1) != 0 ? 1.0f : 0.0f, (k & 2) != 0 ? 1.0f : 0.0f, (k & 4) != 0 ? 1.0f : 0.0f});
    cube.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return cube;
}

Pose random_pose(Random& random, double reach) {
    const auto in = [&](double r) { return random.range(-r, r); };
    dquat q{1.0, 0.0, 0.0, 0.0};
    q.x = in(1.0), q.y = in(1.0), q.z = in(1.0), q.w = in(1.0);
    Pose pose;
    pose.orientation = glm::normalize(q);
    pose.position.x = in(reach), pose.position.y = in(reach), pose.position.z = in(reach);
    return pose;
}

/// Compares all answers on two meshes with every triangle against every other. @return how many pairs there are.
std::size_t compare(const MeshData& a, const MeshData& b, const Pose& b_in_a, const std::string& what) {
    const StaticBvh first = bvh_of(a), second = bvh_of(b);
    const std::vector<TrianglePair> expected = every_pair(a, b, b_in_a);
    std::vector<TrianglePair> found{{7, 7}};
    overlapping_pairs(first, second, b_in_a, found);
    EXPECT_EQ(found, expected) << what;
    EXPECT_EQ(meshes_overlap(first, second, b_in_a), !expected.empty()) << what;
    const std::optional<TrianglePair> one = find_overlap(first, second, b_in_a);
    EXPECT_EQ(one.has_value(), !expected.empty()) << what;
    EXPECT_TRUE(!one || std::binary_search(expected.begin(), expected.end(), *one)) << what;
    return expected.size();
}

TEST(MeshPairs, AreThoseOfEveryTriangleWithEveryOther) {
    Random random(20'260'903);
    const MeshData ball = scenes::bumpy(6);  // 432 triangles
    std::size_t pairs = 0;
    int apart = 0;
    const std::vector<int> widths = available_simd_widths();
    for (int n = 0; n < 40; ++n) {
        set_simd_width(widths[static_cast<std::size_t>(n) % widths.size()]);
        const std::size_t found = compare(ball, ball, random_pose(random, 1.6), "pose " + std::to_string(n));
        pairs += found;
        apart += found == 0;
    }
    set_simd_width(0);
    EXPECT_GT(pairs, 1000u);
    EXPECT_GT(apart, 0);
    EXPECT_LT(apart, 30);
}

TEST(MeshPairs, SeeCoincidentAndTouchingMeshes) {
    const MeshData ball = scenes::bumpy(5);
    EXPECT_GT(compare(ball, ball, {}, "at one place"), ball.triangles.size());
    // Two cubes of 12 triangles: face on face, edge on edge, corner on corner, and apart by the least there is.
    const MeshData cube = unit_cube();
    EXPECT_GT(compare(cube, cube, {.position = {1.0, 0.0, 0.0}}, "face"), 4u);
    EXPECT_GT(compare(cube, cube, {.position = {1.0, 1.0, 0.25}}, "edge"), 0u);
    EXPECT_GT(compare(cube, cube, {.position = {1.0, 1.0, 1.0}}, "corner"), 0u);
    const double beyond = std::nextafter(1.0, 2.0);
    EXPECT_EQ(compare(cube, cube, {.position = {beyond, 0.0, 0.0}}, "just apart"), 0u);
    EXPECT_EQ(compare(cube, scaled(cube, 0.25f, vec3{1.0f}), {}, "inside"), 0u);
}

TEST(MeshPairs, TouchWhereFloatsRound) {
    // The faces' exact places agree; in float, sums that should be equal are not.
    Random random(20'260'907);
    for (int n = 0; n < 100; ++n) {
        const double axis = random.range(0.0, 3.0);
        const auto in = [&] { return static_cast<float>(random.range(-1.5, 1.5)); };
        vec3 first{0.0f}, second{0.0f};
        for (int k = 0; k < 3; ++k) first[k] = in(), second[k] = in();
        const MeshData a = scaled(unit_cube(), 1.0f, first), b = scaled(unit_cube(), 1.0f, second);
        Pose pose{.position = dvec3(first) - dvec3(second)};
        const int k = static_cast<int>(axis);
        pose.position[k] = static_cast<double>(a.vertices[7][k]) - static_cast<double>(b.vertices[0][k]);
        EXPECT_GT(compare(a, b, pose, "touching " + std::to_string(n)), 4u);
        pose.position[k] = static_cast<double>(a.vertices[0][k]) - static_cast<double>(b.vertices[7][k]);
        EXPECT_GT(compare(a, b, pose, "from the other side " + std::to_string(n)), 4u);
    }
}

TEST(MeshPairs, NearlyTouchWhereFloatsCannotTell) {
    // A corner of b lies on a's triangle, or off it by no more than what floats round, in any pose; other triangles make the leaves wide.
    Random random(20'261'123);
    const auto in = [&](double r) { return dvec3{random.range(-r, r), random.range(-r, r), random.range(-r, r)}; };
    std::size_t meeting = 0;
    const std::vector<int> widths = available_simd_widths();
    constexpr int kPoses = 3000;
    for (int n = 0; n < kPoses; ++n) {
        set_simd_width(widths[static_cast<std::size_t>(n) % widths.size()]);
        const Pose pose = random_pose(random, 2.0);
        const double size = n % 2 == 0 ? 1.0 : 0.01;
        const dvec3 middle = in(1.0);
        dvec3 x[3], y[3];
        for (dvec3& p : x) p = middle + in(size);
        const double s = random.range(0.1, 0.4), t = random.range(0.1, 0.4);
        y[0] = x[0] + s * (x[1] - x[0]) + t * (x[2] - x[0]);
        const dvec3 up = glm::cross(x[1] - x[0], x[2] - x[0]);
        for (dvec3* p : {&y[1], &y[2]}) {
            *p = y[0] + in(size);
            if (glm::dot(up, *p - y[0]) < 0.0) *p = 2.0 * y[0] - *p;
        }
        MeshData a, b;
        for (const dvec3& p : x) a.vertices.push_back(vec3(p));
        for (const dvec3& p : y) b.vertices.push_back(vec3(inverse_transform_point(pose, p)));
        a.triangles = b.triangles = {{0, 1, 2}};
        if (n % 3 == 0) {
            for (MeshData* mesh : {&a, &b}) {
                const vec3 far = mesh->vertices[0] + vec3(20.0 * in(size));
                for (const vec3& p : {far, far + vec3(in(size)), far + vec3(in(size))}) mesh->vertices.push_back(p);
                mesh->triangles.push_back({3, 4, 5});
            }
        }
        meeting += compare(a, b, pose, "nearly " + std::to_string(n)) > 0 ? 1 : 0;
    }
    set_simd_width(0);
    EXPECT_GT(meeting, kPoses / 4);
    EXPECT_LT(meeting, 3 * kPoses / 4);
}

TEST(MeshPairs, HoldWherePosesStretch) {
    Random random(20'261'124);
    const MeshData ball = scenes::bumpy(4);
    const StaticBvh bvh = bvh_of(ball);
    for (const double length : {0.25, 0.9, 1.000'3, 1.001, 1.2, 3.0}) {
        Pose pose = random_pose(random, 0.5);
        pose.orientation *= length;
        WidePlacement placement;
        ASSERT_TRUE(place(bvh.wide(), bvh.wide(), pose, 0.0, placement));
        EXPECT_EQ(placement.too_unlike, length != 1.000'3) << "the bounds on floats are those of turns";
        compare(ball, ball, pose, "length " + std::to_string(length));
    }
}

TEST(MeshPairs, HoldAtAnySizeAndFarFromTheOrigin) {
    Random random(20'260'904);
    const MeshData ball = scenes::bumpy(4);
    for (const float size : {1e-30f, 1e-12f, 1e-3f, 1e5f, 1e12f, 1e30f}) {
        std::size_t pairs = 0;
        for (int n = 0; n < 3; ++n) {
            const MeshData mesh = scaled(ball, size);
            pairs += compare(mesh, mesh, random_pose(random, 0.8 * static_cast<double>(size)), "size " + std::to_string(size));
        }
        EXPECT_GT(pairs, 0u) << size;
    }
    // Both meshes far from the origins of their frames, where float has few bits left for a triangle.
    const MeshData far = scaled(ball, 1.0f, vec3{1e4f, -2e4f, 3e3f});
    std::size_t pairs = 0;
    for (int n = 0; n < 4; ++n) {
        Pose pose = random_pose(random, 0.0);
        pose.position = dvec3{1e4, -2e4, 3e3} - rotate(pose.orientation, dvec3{1e4, -2e4, 3e3}) + dvec3{random.range(-1.0, 1.0), 0.5, 0.0};
        pairs += compare(far, far, pose, "far");
    }
    EXPECT_GT(pairs, 100u);
}

TEST(MeshPairs, HoldForMeshesOfUnlikeSizes) {
    Random random(20'260'905);
    const MeshData ball = scenes::bumpy(4);
    const MeshData floor{{{-1e20f, -1e20f, 0.0f}, {1e20f, -1e20f, 0.0f}, {0.0f, 1e20f, 0.0f}}, {{0, 1, 2}}};
    for (const float size : {1e-20f, 1e-6f, 1.0f}) {
        const MeshData mesh = scaled(ball, size);
        for (int n = 0; n < 3; ++n) {
            const Pose pose = random_pose(random, 0.5 * static_cast<double>(size));
            EXPECT_GT(compare(floor, mesh, pose, "small on large"), 0u) << size;
            // Turned, the floor's corners would be rounded to places far from the small mesh.
            EXPECT_GT(compare(mesh, floor, {.position = pose.position}, "large on small"), 0u) << size;
        }
    }
}

TEST(MeshPairs, AreTheSameBoxByBoxInDouble) {
    Random random(20'260'906);
    const MeshData ball = scenes::bumpy(8);
    const StaticBvh bvh = bvh_of(ball);
    for (int n = 0; n < 20; ++n) {
        WidePlacement placement;
        if (!place(bvh.wide(), bvh.wide(), random_pose(random, 1.2), 0.0, placement)) continue;
        // Lanes may leave out only pairs that the slow way finds apart, and be certain only of pairs that meet.
        std::vector<TrianglePair> lanes, slow;
        std::size_t certain = 0;
        const auto list = [&](std::vector<TrianglePair>& out, bool check) {
            return [&, check](const LeafPair& pair) {
                for (std::size_t n_pair = 0; n_pair < pair.count; ++n_pair) {
                    TriangleCorners x{}, y{};
                    for (std::size_t k = 0; k < 3; ++k) {
                        const std::size_t v = pair.a->corner[k][pair.of_a(n_pair)], w = pair.b->corner[k][pair.of_b(n_pair)];
                        x[k] = dvec3(vec3{pair.a->vertex[0][v], pair.a->vertex[1][v], pair.a->vertex[2][v]});
                        y[k] = placement.place(pair.b->vertex[0][w], pair.b->vertex[1][w], pair.b->vertex[2][w]);
                    }
                    const bool meet = detail::triangles_meet(x, y);
                    EXPECT_TRUE(meet || !pair.is_certain(n_pair)) << n;
                    certain += pair.is_certain(n_pair) ? 1u : 0u;
                    if (!check || meet) out.push_back({pair.triangle_of_a(n_pair), pair.triangle_of_b(n_pair)});
                }
                return true;
            };
        };
        visit_leaf_pairs(bvh.wide(), bvh.wide(), placement, list(lanes, false), {});
        visit_leaf_pairs_in_double(bvh.wide(), bvh.wide(), placement, list(slow, true), {});
        std::sort(lanes.begin(), lanes.end());
        for (const TrianglePair& pair : slow) ASSERT_TRUE(std::binary_search(lanes.begin(), lanes.end(), pair)) << n;
        EXPECT_LE(lanes.size(), slow.size() + slow.size() / 10 + 4) << n;
        EXPECT_GE(certain + certain / 10 + 4, slow.size()) << n;
    }
}

TEST(MeshPairs, WithinAReachAreAllAndFewMore) {
    Random random(20'261'102);
    const MeshData ball = scenes::bumpy(4);
    const StaticBvh bvh = bvh_of(ball);
    const std::vector<int> widths = available_simd_widths();
    std::size_t near = 0, listed = 0;
    for (int n = 0; n < 12; ++n) {
        set_simd_width(widths[static_cast<std::size_t>(n) % widths.size()]);
        const Pose pose = random_pose(random, 1.4);
        const double reach = n % 4 == 0 ? 0.0 : random.range(0.001, 0.3);
        std::vector<TrianglePair> found;
        near_pairs(bvh, bvh, pose, reach, found);
        EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
        listed += found.size();
        for (std::uint32_t i = 0; i < ball.triangles.size(); ++i) {
            for (std::uint32_t j = 0; j < ball.triangles.size(); ++j) {
                const auto corner = [&](std::uint32_t t, std::size_t k) { return dvec3(ball.vertices[ball.triangles[t][k]]); };
                const auto placed = [&](std::size_t k) { return transform_point(pose, corner(j, k)); };
                const geo::Triangle<double> x{corner(i, 0), corner(i, 1), corner(i, 2)}, y{placed(0), placed(1), placed(2)};
                if (geo::closest_points(x, y).distance_sq > reach * reach) continue;
                ++near;
                ASSERT_TRUE(std::binary_search(found.begin(), found.end(), TrianglePair{i, j})) << n;
            }
        }
    }
    set_simd_width(0);
    EXPECT_GT(near, 1500u);
    EXPECT_LT(listed, 3 * near) << "boxes and planes leave out the rest";
}

TEST(MeshPairs, OfBadPosesAreNone) {
    const StaticBvh bvh = bvh_of(scenes::bumpy(3));
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
    std::vector<TrianglePair> pairs{{1, 2}};
    for (const double bad : {kNan, kInfinity, -kInfinity}) {
        Pose pose;
        pose.position.y = bad;
        EXPECT_FALSE(meshes_overlap(bvh, bvh, pose));
        pose = {};
        pose.orientation.z = bad;
        overlapping_pairs(bvh, bvh, pose, pairs);
        EXPECT_TRUE(pairs.empty());
    }
    EXPECT_FALSE(meshes_overlap(bvh, bvh, {.position = {1e300, 0.0, 0.0}}));
    EXPECT_FALSE(meshes_overlap(bvh, bvh, {.position = {2.5, 0.0, 0.0}}));
}

}  // namespace
}  // namespace carom
