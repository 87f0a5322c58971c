// The closest pair of two meshes against every triangle with every other.
#include <carom/collision/closest_points.hpp>
#include <carom/collision/mesh_closest.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/scenes/bumpy.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace carom {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

StaticBvh bvh_of(const MeshData& mesh) { return std::move(*StaticBvh::build(mesh.vertices, mesh.triangles)); }

MeshData scaled(MeshData mesh, float factor) {
    for (vec3& v : mesh.vertices) v *= factor;
    return mesh;
}

Pose random_pose(Random& random, double nearest, double farthest) {
    const auto in = [&] { return random.range(-1.0, 1.0); };
    Pose pose;
    dquat& q = pose.orientation;
    q.x = in(), q.y = in(), q.z = in(), q.w = in();
    q = glm::normalize(q);
    dvec3 way{0.0};
    way.x = in(), way.y = in(), way.z = in();
    pose.position = glm::normalize(way) * random.range(nearest, farthest);
    return pose;
}

std::vector<geo::Triangle<double>> placed(const MeshData& mesh, const Pose& pose) {
    std::vector<geo::Triangle<double>> out;
    for (const auto& t : mesh.triangles) {
        const auto at = [&](std::size_t k) { return transform_point(pose, dvec3(mesh.vertices[t[k]])); };
        out.push_back({at(0), at(1), at(2)});
    }
    return out;
}

struct Brute {
    double distance = kInfinity;
    TrianglePair pair;
};
Brute brute(const MeshData& a, const MeshData& b, const Pose& b_in_a) {
    const auto x = placed(a, {}), y = placed(b, b_in_a);
    Brute best;
    for (std::uint32_t i = 0; i < x.size(); ++i) {
        for (std::uint32_t j = 0; j < y.size(); ++j) {
            const double d = std::sqrt(geo::closest_points(x[i], y[j]).distance_sq);
            if (d < best.distance) best = {d, {i, j}};
        }
    }
    return best;
}

TEST(MeshClosest, IsThatOfEveryTriangleWithEveryOther) {
    Random random(20'261'101);
    const MeshData ball = scenes::bumpy(4), small = scaled(scenes::bumpy(3), 0.3f);
    const StaticBvh first = bvh_of(ball), second = bvh_of(small);
    const std::vector<int> widths = available_simd_widths();
    int apart = 0, meet = 0;
    for (int n = 0; n < 30; ++n) {
        set_simd_width(widths[static_cast<std::size_t>(n) % widths.size()]);
        const Pose pose = random_pose(random, 0.6, n % 3 == 0 ? 30.0 : 2.0);
        const Brute expected = brute(ball, small, pose);
        const std::optional<ClosestOfMeshes> found = closest_pair(first, second, pose);
        ASSERT_TRUE(found) << n;
        EXPECT_EQ(found->distance, expected.distance) << n;
        EXPECT_LE(found->lower, found->distance);
        EXPECT_GE(found->lower, found->distance - 1e-13 * (found->distance + 2.0));
        EXPECT_NEAR(glm::distance(found->on_a, found->on_b), found->distance, 1e-14 * (found->distance + 2.0)) << n;
        if (expected.distance > 0.0) {
            ++apart;
            EXPECT_EQ(found->triangles, expected.pair) << n;
            EXPECT_FALSE(closest_pair(first, second, pose, 0.999 * expected.distance)) << n;
            const std::optional<ClosestOfMeshes> within = closest_pair(first, second, pose, 1.001 * expected.distance);
            ASSERT_TRUE(within) << n;
            EXPECT_EQ(within->triangles, expected.pair) << n;
        } else {
            ++meet;
            EXPECT_TRUE(meshes_overlap(first, second, pose)) << n;
        }
    }
    set_simd_width(0);
    EXPECT_GT(apart, 15);
    EXPECT_GT(meet, 2);
}

// Two cubes face to face: every pair of the two faces' triangles that look at each other is as near, and the first is named.
TEST(MeshClosest, NamesTheFirstOfEqualPairsAndHoldsAtAnySize) {
    MeshData cube;
    for (int k = 0; k < 8; ++k) cube.vertices.push_back({(k & 1) != 0 ? 1.0f : 0.0f, (k & 2) != 0 ? 1.0f : 0.0f, (k & 4) != 0 ? 1.0f : 0.0f});
    cube.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    for (const float size : {1e-30f, 1e-6f, 1.0f, 1e12f, 1e30f}) {
        const MeshData mesh = scaled(cube, size);
        const StaticBvh bvh = bvh_of(mesh);
        for (const double gap : {1.0, 0.25, 0x1p-30}) {
            const Pose pose{.position = {(1.0 + gap) * static_cast<double>(size), 0.125 * static_cast<double>(size), 0.0}};
            const std::optional<ClosestOfMeshes> found = closest_pair(bvh, bvh, pose);
            ASSERT_TRUE(found) << size;
            EXPECT_NEAR(found->distance / static_cast<double>(size), gap, 1e-14) << size;
            EXPECT_EQ(found->triangles, brute(mesh, mesh, pose).pair) << size << " " << gap;
        }
        EXPECT_EQ(closest_pair(bvh, bvh, {})->distance, 0.0) << size;
    }
    const StaticBvh large = bvh_of(scaled(cube, 1e20f)), tiny = bvh_of(scaled(cube, 1e-10f));
    EXPECT_NEAR(closest_pair(large, tiny, {.position = {1e19, 1e19, -3.0}})->distance, 3.0 - 1e-10, 1e-6 * 3.0 + 1e20 * 0x1p-46);
}

TEST(MeshClosest, OfBadInputIsNothing) {
    const StaticBvh bvh = bvh_of(scenes::bumpy(3));
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    for (const double bad : {kNan, kInfinity, -kInfinity}) {
        Pose pose;
        pose.position.y = bad;
        EXPECT_FALSE(closest_pair(bvh, bvh, pose));
        pose = {};
        pose.orientation.z = bad;
        EXPECT_FALSE(closest_pair(bvh, bvh, pose));
    }
    const Pose away{.position = {5.0, 0.0, 0.0}};
    EXPECT_FALSE(closest_pair(bvh, bvh, away, kNan));
    EXPECT_FALSE(closest_pair(bvh, bvh, away, -1.0));
    EXPECT_FALSE(closest_pair(bvh, bvh, away, 1.0));
    EXPECT_TRUE(closest_pair(bvh, bvh, away, 5.0));
    EXPECT_EQ(closest_pair(bvh, bvh, {}, 0.0)->distance, 0.0);
}

}  // namespace
}  // namespace carom
