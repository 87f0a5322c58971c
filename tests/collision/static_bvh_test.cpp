// The wide hierarchy: what its layout promises, and that threads and lanes do not change it.
#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/collision/static_bvh.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/scenes/bumpy.hpp>

#include "mesh_rays_cases.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <thread>
#include <vector>

namespace carom {
namespace {

/// Cuts every loop into many ranges and runs them backwards on two threads.
class TwoThreads final : public Executor {
public:
    [[nodiscard]] int thread_count() const noexcept override { return 2; }
    void parallel_for(std::size_t count, std::size_t grain, Body body) override {
        const std::size_t half = count / 2;
        const auto run = [&](std::size_t begin, std::size_t end) {
            for (std::size_t at = end; at > begin;) {
                const std::size_t from = at - begin > grain ? at - grain : begin;
                body(from, at);
                at = from;
            }
        };
        std::thread other([&] { run(0, half); });
        run(half, count);
        other.join();
    }
};

bool same_tree(const WideBvh& a, const WideBvh& b) {
    return a.lines.size() == b.lines.size() && std::memcmp(a.lines.data(), b.lines.data(), a.lines.size() * sizeof(a.lines[0])) == 0;
}

/// Checks what is below `ref`, whose box in its parent is [lower, upper].
void check_below(const MeshData& mesh, const WideBvh& tree, WideRef ref, const vec3& lower, const vec3& upper, int depth,
                 std::vector<int>& seen) {
    ASSERT_LE(depth, WideBvh::kMaxDepth);
    vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
    if (is_leaf(ref)) {
        const WideLeaf& leaf = tree.leaf(ref);
        ASSERT_GE(leaf.triangle_count, 1u);
        ASSERT_LE(leaf.triangle_count, 16u);
        std::set<std::array<float, 3>> positions;
        for (std::uint32_t v = 0; v < 16; ++v) {
            const std::uint32_t from = v < leaf.vertex_count ? v : 0;
            const vec3 p{leaf.vertex[0][v], leaf.vertex[1][v], leaf.vertex[2][v]};
            ASSERT_EQ(p, (vec3{leaf.vertex[0][from], leaf.vertex[1][from], leaf.vertex[2][from]}));
            const bool is_new = positions.insert({p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}).second;
            ASSERT_EQ(is_new, v < leaf.vertex_count) << "welded";
        }
        for (std::uint32_t k = 0; k < 16; ++k) {
            if (k >= leaf.triangle_count) {
                ASSERT_EQ(leaf.triangle[k], kNoTriangle);
                for (int c = 0; c < 3; ++c) ASSERT_EQ(leaf.corner[c][k], 0);
                continue;
            }
            ASSERT_TRUE(k == 0 || leaf.triangle[k - 1] < leaf.triangle[k]);
            ++seen[leaf.triangle[k]];
            for (std::size_t c = 0; c < 3; ++c) {
                const std::uint8_t v = leaf.corner[c][k];
                ASSERT_LT(v, leaf.vertex_count);
                const vec3 p{leaf.vertex[0][v], leaf.vertex[1][v], leaf.vertex[2][v]};
                ASSERT_EQ(p, tree.scale * mesh.vertices[mesh.triangles[leaf.triangle[k]][c]]);
                low = glm::min(low, p);
                high = glm::max(high, p);
            }
        }
    } else {
        const WideNode& node = tree.node(ref);
        const int children = child_count(node);
        ASSERT_GE(children, 1);
        for (int i = 0; i < 16; ++i) {
            const vec3 a{node.bound[0][0][i], node.bound[0][1][i], node.bound[0][2][i]};
            const vec3 b{node.bound[1][0][i], node.bound[1][1][i], node.bound[1][2][i]};
            if (i >= children) {
                ASSERT_EQ(a, vec3{std::numeric_limits<float>::infinity()});
                ASSERT_EQ(b, vec3{-std::numeric_limits<float>::infinity()});
                ASSERT_EQ(node.child[i], 0);
                continue;
            }
            ASSERT_GT(is_leaf(node.child[i]) ? ~node.child[i] : node.child[i], ref);
            check_below(mesh, tree, node.child[i], a, b, depth + 1, seen);
            low = glm::min(low, a);
            high = glm::max(high, b);
        }
    }
    ASSERT_EQ(low, lower) << "the box is exact";
    ASSERT_EQ(high, upper);
}

void check(const MeshData& mesh, const StaticBvh& bvh) {
    const WideBvh& tree = bvh.wide();
    std::vector<int> seen(mesh.triangles.size(), 0);
    ASSERT_FALSE(is_leaf(WideBvh::root()));
    check_below(mesh, tree, WideBvh::root(), tree.lower, tree.upper, 0, seen);
    EXPECT_TRUE(std::ranges::all_of(seen, [](int n) { return n == 1; })) << "each triangle is in one leaf";
    EXPECT_EQ(bvh.triangle_count(), mesh.triangles.size());
}

TEST(StaticBvh, KeepsWhatItsLayoutPromises) {
    for (const test::RayCase& c : test::ray_cases()) {
        SCOPED_TRACE(c.name);
        check(c.mesh, StaticBvh::build(c.mesh.vertices, c.mesh.triangles).value());
    }
    const MeshData bumpy = scenes::bumpy(20);
    check(bumpy, StaticBvh::build(bumpy.vertices, bumpy.triangles).value());
}

TEST(StaticBvh, IsTheSameOnEveryThreadCountAndWidth) {
    const MeshData mesh = scenes::bumpy(40);
    const StaticBvh first = StaticBvh::build(mesh.vertices, mesh.triangles).value();
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        TwoThreads threads;
        SerialExecutor serial;
        EXPECT_TRUE(same_tree(first.wide(), StaticBvh::build(mesh.vertices, mesh.triangles, serial).value().wide())) << width;
        EXPECT_TRUE(same_tree(first.wide(), StaticBvh::build(mesh.vertices, mesh.triangles, threads).value().wide())) << width;
    }
    set_simd_width(0);
}

TEST(StaticBvh, SoupCostsWhatAnIndexedMeshDoes) {
    const MeshData mesh = scenes::bumpy(20);
    const MeshData soup = test::unweld(mesh);
    const StaticBvh a = StaticBvh::build(mesh.vertices, mesh.triangles).value();
    const StaticBvh b = StaticBvh::build(soup.vertices, soup.triangles).value();
    EXPECT_TRUE(same_tree(a.wide(), b.wide()));
    EXPECT_LE(a.bytes(), 44 * mesh.triangles.size());
    EXPECT_EQ(a.bounds(), b.bounds());
    EXPECT_GT(a.sah_cost(), 1.0);
    EXPECT_LT(a.sah_cost(), 15.0);
}

TEST(StaticBvh, CoincidentTrianglesAndSizesThatHalveKeepTheDepthBound) {
    MeshData twins{{{1, 2, 3}, {2, 2, 3}, {1, 3, 3}}, {}};
    twins.triangles.assign(5000, {0, 1, 2});
    check(twins, StaticBvh::build(twins.vertices, twins.triangles).value());

    MeshData halves;
    for (int k = -70; k < 55; ++k) {
        for (int axis = 0; axis < 3; ++axis) {
            const auto first = static_cast<std::uint32_t>(halves.vertices.size());
            vec3 at{0.0f};
            at[axis] = std::ldexp(1.0f, k);
            halves.vertices.insert(halves.vertices.end(), {at, 1.25f * at, 1.5f * at});
            halves.triangles.push_back({first, first + 1, first + 2});
        }
    }
    check(halves, StaticBvh::build(halves.vertices, halves.triangles).value());
}

TEST(StaticBvh, RefusesBadInputByName) {
    const std::vector<vec3> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    using Triangles = std::vector<StaticBvh::Triangle>;
    const auto code = [](const std::vector<vec3>& v, const Triangles& t) { return StaticBvh::build(v, t).error().code; };
    EXPECT_EQ(code(vertices, {}), ErrorCode::Empty);
    EXPECT_EQ(code({}, {{0, 1, 2}}), ErrorCode::InvalidArgument);
    EXPECT_EQ(code(vertices, {{0, 1, 2}, {0, 1, 3}}), ErrorCode::InvalidArgument);
    EXPECT_EQ(code({{0, 0, 0}, {1, std::numeric_limits<float>::quiet_NaN(), 0}, {0, 1, 0}}, {{0, 1, 2}}), ErrorCode::NotFinite);
}

}  // namespace
}  // namespace carom
