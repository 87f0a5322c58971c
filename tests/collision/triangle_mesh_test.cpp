// TriangleMesh and its hierarchy against brute force over the triangles' own boxes.
#include <carom/collision/detail/exact_sign.hpp>
#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/random.hpp>

#include "support_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace carom {
namespace {

using Triangle = TriangleMesh::Triangle;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TriangleMeshPtr build(const MeshData& data) {
    Result<TriangleMeshPtr> mesh = TriangleMesh::build(data.vertices, data.triangles);
    EXPECT_TRUE(mesh) << (mesh ? "" : mesh.error().message);
    return mesh.value();
}

std::vector<std::uint32_t> found(const TriangleMesh& mesh, const Aabb& box) {
    std::vector<std::uint32_t> result;
    mesh.overlap(box, [&](std::uint32_t t) {
        result.push_back(t);
        return true;
    });
    return result;
}

/// The oracle: the closed overlap of each triangle's box in double.
std::vector<std::uint32_t> brute_force(const TriangleMesh& mesh, const Aabb& box) {
    std::vector<std::uint32_t> result;
    for (std::uint32_t t = 0; t < mesh.triangles().size(); ++t) {
        const auto [a, b, c] = mesh.corners(t);
        if (overlaps(box, {dvec3(glm::min(a, glm::min(b, c))), dvec3(glm::max(a, glm::max(b, c)))})) {
            result.push_back(t);
        }
    }
    return result;
}

void expect_same_overlaps(const TriangleMesh& mesh, const Aabb& box) {
    std::vector<std::uint32_t> result = found(mesh, box);
    EXPECT_EQ(result, found(mesh, box)) << "the order must be fixed";
    std::stable_sort(result.begin(), result.end());
    EXPECT_EQ(result, brute_force(mesh, box));
}

MeshData triangle_soup(std::uint64_t seed, int count, double size) {
    Random random(seed);
    MeshData data;
    for (int i = 0; i < count; ++i) {
        const vec3 at(test::random_point(random, 10.0));
        const auto first = static_cast<std::uint32_t>(data.vertices.size());
        for (int k = 0; k < 3; ++k) {
            data.vertices.push_back(at + vec3(test::random_point(random, size)));
        }
        data.triangles.push_back({first, first + 1, first + 2});
    }
    return data;
}

TEST(TriangleMesh, OverlapFindsWhatBruteForceFinds) {
    Random random(101);
    for (const int count : {1, 2, 4, 5, 17, 300, 3000}) {
        const TriangleMeshPtr mesh = build(triangle_soup(static_cast<std::uint64_t>(count), count, 0.5));
        for (int i = 0; i < 200; ++i) {
            const dvec3 center = test::random_point(random, 11.0);
            const dvec3 half = 2.0 * random.unit() * dvec3{random.unit(), random.unit(), random.unit()};
            expect_same_overlaps(*mesh, {center - half, center + half});
        }
    }
}

TEST(TriangleMesh, OverlapIsClosedToTheLastBitOfDouble) {
    const TriangleMeshPtr mesh = build(triangle_soup(7, 64, 0.5));
    for (std::uint32_t t = 0; t < 64; ++t) {
        const auto [a, b, c] = mesh->corners(t);
        const dvec3 upper(glm::max(a, glm::max(b, c)));
        const dvec3 lower(glm::min(a, glm::min(b, c)));
        for (int axis = 0; axis < 3; ++axis) {
            Aabb touching{upper, upper + 1.0};
            touching.lower -= dvec3{0.01};
            touching.lower[axis] = upper[axis];
            expect_same_overlaps(*mesh, touching);
            EXPECT_TRUE(std::ranges::count(found(*mesh, touching), t));
            touching.lower[axis] = std::nextafter(upper[axis], 1e9);
            EXPECT_FALSE(std::ranges::count(found(*mesh, touching), t));

            Aabb below{lower - 1.0, lower + 0.01};
            below.upper[axis] = lower[axis];
            EXPECT_TRUE(std::ranges::count(found(*mesh, below), t));
            below.upper[axis] = std::nextafter(lower[axis], -1e9);
            EXPECT_FALSE(std::ranges::count(found(*mesh, below), t));
        }
    }
}

TEST(TriangleMesh, OverlapOfUnusualBoxes) {
    const TriangleMeshPtr mesh = build(triangle_soup(8, 100, 0.5));
    const double infinity = std::numeric_limits<double>::infinity();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(found(*mesh, {dvec3{-infinity}, dvec3{infinity}}).size(), 100u);
    EXPECT_EQ(found(*mesh, {dvec3{-1e300}, dvec3{1e300}}).size(), 100u);
    EXPECT_TRUE(found(*mesh, Aabb{}).empty());
    EXPECT_TRUE(found(*mesh, {dvec3{1.0}, dvec3{-1.0}}).empty());
    EXPECT_TRUE(found(*mesh, {dvec3{nan}, dvec3{1.0}}).empty());
    EXPECT_TRUE(found(*mesh, {dvec3{1e300}, dvec3{infinity}}).empty());
    EXPECT_TRUE(found(*mesh, {dvec3{-infinity}, dvec3{-1e300}}).empty());
    // A box thinner than a float's ulp that holds no float still overlaps what spans it.
    const TriangleMeshPtr one = build({{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 1, 2}}});
    EXPECT_EQ(found(*one, {{1.0 + 0x1p-40, 0.5, 0.0}, {1.0 + 0x1p-39, 0.5, 0.0}}).size(), 1u);
    EXPECT_TRUE(found(*one, {{0.0, 0.0, 1e-300}, {1.0, 1.0, 1.0}}).empty());
}

TEST(TriangleMesh, OverlapStopsWhenToldTo) {
    const TriangleMeshPtr mesh = build(triangle_soup(9, 50, 0.5));
    int calls = 0;
    mesh->overlap({dvec3{-20.0}, dvec3{20.0}}, [&](std::uint32_t) { return ++calls < 7; });
    EXPECT_EQ(calls, 7);
}

TEST(TriangleMesh, TheSameMeshGivesTheSameOrder) {
    const MeshData data = triangle_soup(10, 500, 0.5);
    const Aabb all{dvec3{-20.0}, dvec3{20.0}};
    EXPECT_EQ(found(*build(data), all), found(*build(data), all));
}

TEST(TriangleMesh, CoincidentTriangles) {
    MeshData data{{{1, 2, 3}, {2, 2, 3}, {1, 3, 3}}, {}};
    data.triangles.assign(5000, {0, 1, 2});
    const TriangleMeshPtr mesh = build(data);
    EXPECT_EQ(found(*mesh, {dvec3{1.0, 2.0, 3.0}, dvec3{1.0, 2.0, 3.0}}).size(), 5000u);
    EXPECT_TRUE(found(*mesh, {dvec3{1.0, 2.0, 3.1}, dvec3{1.0, 2.0, 3.2}}).empty());
}

// Sizes that halve make a tree as deep as surface-area splits can make it; the depth has a bound all the same.
TEST(TriangleMesh, GeometricSizesKeepTheDepthBound) {
    MeshData data;
    for (int k = -140; k < 120; ++k) {
        for (int axis = 0; axis < 3; ++axis) {
            const auto first = static_cast<std::uint32_t>(data.vertices.size());
            vec3 at{0.0f};
            at[axis] = std::ldexp(1.0f, k);
            data.vertices.insert(data.vertices.end(), {at, 1.25f * at, 1.5f * at});
            data.triangles.push_back({first, first + 1, first + 2});
        }
    }
    const TriangleMeshPtr mesh = build(data);
    int deepest = 0;
    mesh->visit_nodes([&](const Aabb&, int depth) { deepest = std::max(deepest, depth); });
    EXPECT_LE(deepest, WideBvh::kMaxDepth);
    EXPECT_EQ(found(*mesh, {dvec3{-1e38}, dvec3{1e38}}).size(), data.triangles.size());
    expect_same_overlaps(*mesh, {dvec3{0.0}, dvec3{1e-20}});
}

TEST(TriangleMesh, NodesNestAndStartAtTheRoot) {
    const TriangleMeshPtr mesh = build(triangle_soup(11, 1000, 0.5));
    std::vector<Aabb> path;
    int nodes = 0;
    mesh->visit_nodes([&](const Aabb& box, int depth) {
        ASSERT_LE(depth, static_cast<int>(path.size()));
        ASSERT_GE(depth, nodes == 0 ? 0 : 1);
        path.resize(static_cast<std::size_t>(depth));
        if (!path.empty()) {
            EXPECT_EQ(merge(path.back(), box), path.back());
        } else {
            EXPECT_EQ(box, mesh->local_bounds());
        }
        path.push_back(box);
        ++nodes;
    });
    EXPECT_GT(nodes, 1000 / 16) << "16 triangles a leaf";
}

TEST(TriangleMesh, RefusesBadInputByName) {
    const std::vector<vec3> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::vector<Triangle> one{{0, 1, 2}};
    const auto code = [](const std::vector<vec3>& v, const std::vector<Triangle>& t) {
        const Result<TriangleMeshPtr> mesh = TriangleMesh::build(v, t);
        EXPECT_FALSE(mesh);
        return mesh ? ErrorCode::Io : mesh.error().code;
    };
    EXPECT_EQ(code(vertices, {}), ErrorCode::Empty);
    EXPECT_EQ(code({}, one), ErrorCode::InvalidArgument);
    EXPECT_EQ(code(vertices, {{0, 1, 2}, {0, 1, 3}}), ErrorCode::InvalidArgument);
    EXPECT_NE(TriangleMesh::build(vertices, std::vector<Triangle>{{0, 1, 2}, {0, 1, 3}}).error().message.find("triangle 1"),
              std::string::npos);
    EXPECT_EQ(code({{0, 0, 0}, {1, kNan, 0}, {0, 1, 0}}, one), ErrorCode::NotFinite);
    EXPECT_EQ(code({{0, 0, 0}, {1, 0, 0}, {0, 1, -kInfinity}}, one), ErrorCode::NotFinite);
}

TEST(TriangleMesh, ClosedMeansEveryEdgeTwiceInOppositeDirections) {
    const MeshData ball = test::sphere_mesh(12, 8, 1.0);
    EXPECT_TRUE(build(ball)->is_closed());
    EXPECT_TRUE(build(test::unweld(ball))->is_closed()) << "vertices are compared by position";

    MeshData hole = ball;
    hole.triangles.pop_back();
    EXPECT_FALSE(build(hole)->is_closed());

    MeshData flipped = ball;
    std::swap(flipped.triangles[5][0], flipped.triangles[5][1]);
    EXPECT_FALSE(build(flipped)->is_closed());

    MeshData inside_out = ball;
    for (Triangle& t : inside_out.triangles) {
        std::swap(t[0], t[1]);
    }
    EXPECT_TRUE(build(inside_out)->is_closed());

    MeshData twice = ball;  // four triangles at every edge
    twice.triangles.insert(twice.triangles.end(), ball.triangles.begin(), ball.triangles.end());
    EXPECT_FALSE(build(twice)->is_closed());

    MeshData cracked = test::unweld(ball);
    cracked.vertices[0].x = std::nextafter(cracked.vertices[0].x, 9.0f);
    EXPECT_FALSE(build(cracked)->is_closed());

    EXPECT_FALSE(build({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}})->is_closed());
    EXPECT_FALSE(build({{{0, 0, 0}, {1, 0, 0}}, {{0, 1, 1}}})->is_closed());
    // Two sides of one triangle bound an empty volume, and close by the rule.
    EXPECT_TRUE(build({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}})->is_closed());
}

TEST(TriangleMesh, ClosedSeesMinusZeroAsZeroAndIgnoresCollapsedTriangles) {
    // A tetrahedron whose edge 0-1 is split by a collapsed triangle, one copy of the origin being (-0, -0, -0).
    const MeshData data{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-0.0f, -0.0f, -0.0f}},
                        {{0, 2, 1}, {4, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 4, 1}}};
    const TriangleMeshPtr mesh = build(data);
    EXPECT_TRUE(mesh->is_closed());
    EXPECT_EQ(mesh->degenerate_count(), 1u);
}

TEST(TriangleMesh, CountsZeroAreaExactly) {
    const auto count = [](const vec3& a, const vec3& b, const vec3& c) {
        return build({{a, b, c}, {{0, 1, 2}}})->degenerate_count();
    };
    EXPECT_EQ(count({1, 2, 3}, {1, 2, 3}, {1, 2, 3}), 1u);
    EXPECT_EQ(count({1, 2, 3}, {4, 5, 6}, {1, 2, 3}), 1u);
    EXPECT_EQ(count({0, 0, 0}, {1, 2, 3}, {3, 6, 9}), 1u);
    EXPECT_EQ(count({0, 0, 0}, {1, 2, 3}, {3, 6, std::nextafter(9.0f, 10.0f)}), 0u);
    // Cancels to zero in rounded arithmetic, but is a triangle.
    EXPECT_EQ(count({1e30f, 0, 0}, {1e30f, 1e-30f, 0}, {-1e30f, 1e-30f, 0}), 0u);
    EXPECT_EQ(count({1e8f, 1e8f, 0}, {0, 0, 0}, {1e-8f, std::nextafter(1e-8f, 1.0f), 0}), 0u);
    EXPECT_EQ(count({1e8f, 1e8f, 0}, {0, 0, 0}, {1e-8f, 1e-8f, 0}), 1u);
}

TEST(TriangleMesh, ExactSumsKeepWhatRoundingLoses) {
    EXPECT_EQ(sign_of_sum<4>({1e300, 1.0, -1e300, -1e-300}), 1);
    EXPECT_EQ(sign_of_sum<4>({1e300, -1e-300, -1e300, 0.0}), -1);
    EXPECT_EQ(sign_of_sum<4>({0.1, 0.2, -0.1, -0.2}), 0);
    const double a = 1.0 + 0x1p-40;
    EXPECT_EQ(a * a, (1.0 + 0x1p-39) * 1.0) << "the products round to the same";
    EXPECT_GT(difference_of_products(a, a, 1.0 + 0x1p-39, 1.0), 0.0);
    EXPECT_LT(difference_of_products(1.0, 1.0 + 0x1p-39, a, a), 0.0);
    EXPECT_EQ(difference_of_products(3.0, 7.0, 21.0, 1.0), 0.0);
}

TEST(TriangleMesh, HoldsAMillionTriangles) {
    const MeshData data = test::terrain(708, 0.5);  // 708 x 708 quads
    const TriangleMeshPtr mesh = build(data);
    ASSERT_GT(mesh->triangles().size(), 1'000'000u);
    EXPECT_FALSE(mesh->is_closed());
    EXPECT_EQ(mesh->degenerate_count(), 0u);
    const dvec3 center = 0.5 * (mesh->local_bounds().lower + mesh->local_bounds().upper);
    expect_same_overlaps(*mesh, {center - dvec3{1.0, 9.0, 1.0}, center + dvec3{1.0, 9.0, 1.0}});
}

}  // namespace
}  // namespace carom
