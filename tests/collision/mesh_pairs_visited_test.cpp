// The pairs of nodes that a search for pairs of triangles looks at, against the tree's own promise: nothing that meets lies elsewhere.
#include <carom/collision/mesh_pairs.hpp>
#include <carom/collision/static_bvh.hpp>
#include <carom/core/check.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/scenes/bumpy.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

namespace carom {
namespace {

struct Meshes {
    MeshData data = scenes::bumpy(8);
    StaticBvh bvh = StaticBvh::build(data.vertices, data.triangles).value();
    Pose pose{{1.1, 0.7, -0.2}, glm::normalize(dquat{0.9, 0.1, -0.3, 0.2})};

    [[nodiscard]] bool holds(const Aabb& box, std::uint32_t triangle) const {
        return std::ranges::all_of(data.triangles[triangle], [&](std::uint32_t v) {
            const dvec3 p(data.vertices[v]);
            return overlaps(box, Aabb{p, p});
        });
    }
};

using Line = std::tuple<std::int32_t, std::int32_t, bool, bool>;

std::vector<Line> lines_of(const std::vector<NodePair>& pairs) {
    std::vector<Line> lines;
    for (const NodePair& p : pairs) lines.emplace_back(p.a.id, p.b.id, p.a.is_leaf, p.b.is_leaf);
    return lines;
}

TEST(VisitedNodes, HoldAllThatMeetsAndLittleElse) {
    const Meshes m;
    const std::vector<NodePair> visited = visited_nodes(m.bvh, m.bvh, m.pose, 0.0);
    ASSERT_FALSE(visited.empty());
    EXPECT_EQ(visited.front().a.box, m.bvh.bounds());
    EXPECT_EQ(visited.front().b.box, m.bvh.bounds());
    std::set<std::int32_t> leaves;
    for (const NodePair& pair : visited) {
        EXPECT_FALSE(is_empty(pair.a.box) || is_empty(pair.b.box));
        if (pair.a.is_leaf) leaves.insert(pair.a.id);
    }
    EXPECT_GT(leaves.size(), 3u);
    std::vector<TrianglePair> meeting;
    overlapping_pairs(m.bvh, m.bvh, m.pose, meeting);
    ASSERT_GT(meeting.size(), 20u);
    for (const TrianglePair& pair : meeting) {
        EXPECT_TRUE(std::ranges::any_of(visited, [&](const NodePair& v) {
            return v.a.is_leaf && v.b.is_leaf && m.holds(v.a.box, pair.a) && m.holds(v.b.box, pair.b);
        })) << pair.a << " " << pair.b;
    }
    const std::vector<Line> lines = lines_of(visited);
    EXPECT_EQ(std::set<Line>(lines.begin(), lines.end()).size(), lines.size()) << "no pair is looked at twice";
}

TEST(VisitedNodes, GrowWithTheReachAndAreTheSameAtEveryWidth) {
    const Meshes m;
    const std::vector<Line> near = lines_of(visited_nodes(m.bvh, m.bvh, m.pose, 0.0)), far = lines_of(visited_nodes(m.bvh, m.bvh, m.pose, 0.2));
    EXPECT_GT(far.size(), near.size());
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        EXPECT_EQ(lines_of(visited_nodes(m.bvh, m.bvh, m.pose, 0.2)), far) << width;
    }
    set_simd_width(0);
}

TEST(VisitedNodes, AreNoneWhereBoxesAreApart) {
    const Meshes m;
    EXPECT_TRUE(visited_nodes(m.bvh, m.bvh, {.position = {9, 0, 0}}, 0.0).empty());
    EXPECT_TRUE(visited_nodes(m.bvh, m.bvh, {.position = {std::numeric_limits<double>::quiet_NaN(), 0, 0}}, 0.0).empty());
    EXPECT_FALSE(visited_nodes(m.bvh, m.bvh, {.position = {9, 0, 0}}, 10.0).empty());
    for (const double bad : {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_THROW(static_cast<void>(visited_nodes(m.bvh, m.bvh, m.pose, bad)), std::invalid_argument) << bad;
    }
}

TEST(VisitedNodes, OfSizesThatFloatsCannotHoldTogetherAreListedToo) {
    const Meshes m;
    MeshData tiny = m.data;
    for (vec3& v : tiny.vertices) v *= 1e-20f;
    const StaticBvh small = StaticBvh::build(tiny.vertices, tiny.triangles).value();
    const dvec3 corner(m.data.vertices[0]);
    const std::vector<NodePair> visited = visited_nodes(m.bvh, small, {.position = corner}, 0.0);
    ASSERT_FALSE(visited.empty());
    EXPECT_EQ(visited.front().b.box, small.bounds());
    EXPECT_TRUE(std::ranges::any_of(visited, [](const NodePair& v) { return v.a.is_leaf && v.b.is_leaf; }));
}

}  // namespace
}  // namespace carom
