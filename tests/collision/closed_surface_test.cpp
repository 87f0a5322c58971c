// Positions and closedness against a map of edges.
#include <carom/collision/detail/closed_surface.hpp>
#include <carom/core/random.hpp>

#include "support_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

namespace carom {
namespace {

using Place = std::array<float, 3>;  // -0 equals 0 under its operators

Place place(const vec3& p) { return {p.x, p.y, p.z}; }

SurfaceKind kind_by_map(const MeshData& mesh) {
    std::map<std::pair<Place, Place>, int> runs;
    for (const auto& t : mesh.triangles) {
        const Place p[3]{place(mesh.vertices[t[0]]), place(mesh.vertices[t[1]]), place(mesh.vertices[t[2]])};
        if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
        for (int k = 0; k < 3; ++k) ++runs[{p[k], p[(k + 1) % 3]}];
    }
    bool closed = !runs.empty();
    for (const auto& [edge, count] : runs) {
        if (count != 1) return SurfaceKind::Loose;
        closed = closed && runs.contains({edge.second, edge.first});
    }
    return closed ? SurfaceKind::Closed : SurfaceKind::Oriented;
}

std::size_t pick(Random& random, std::size_t count) { return static_cast<std::size_t>(random.unit() * static_cast<double>(count)); }

// Four corners on a tiny lattice, so that surfaces share corners, edges and whole triangles.
void add_tetrahedron(MeshData& mesh, Random& random) {
    std::array<vec3, 4> corner{vec3{0.0f}, vec3{0.0f}, vec3{0.0f}, vec3{0.0f}};
    for (vec3& p : corner) {
        for (int axis = 0; axis < 3; ++axis) p[axis] = std::array<float, 4>{-0.0f, 0.0f, 1.0f, -1.0f}[pick(random, 4)];
    }
    for (const auto& t : {std::array{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}) {
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const int i : t) mesh.vertices.push_back(corner[static_cast<std::size_t>(i)]);
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
}

TEST(ClosedSurface, AgreesWithAMapOfEdges) {
    Random random(640);
    std::array<int, 3> counts{};
    for (int round = 0; round < 4000; ++round) {
        MeshData mesh;
        const std::size_t solids = 1 + pick(random, 3);
        for (std::size_t i = 0; i < solids; ++i) add_tetrahedron(mesh, random);
        auto& one = mesh.triangles[pick(random, mesh.triangles.size())];
        if (round % 4 == 1) std::swap(one[0], one[1]);
        if (round % 4 == 2) mesh.triangles.pop_back();
        if (round % 4 == 3) one[pick(random, 3)] = static_cast<std::uint32_t>(pick(random, mesh.vertices.size()));
        const SurfaceKind expected = kind_by_map(mesh);
        ASSERT_EQ(surface_kind(mesh.vertices, mesh.triangles), expected) << round;
        ++counts[static_cast<std::size_t>(expected)];
    }
    for (const int count : counts) EXPECT_GT(count, 500);
}

TEST(ClosedSurface, PositionsAreNumberedByPositionAlone) {
    Random random(641);
    std::vector<vec3> vertices;
    for (int i = 0; i < 5000; ++i) {
        vec3 p(test::random_point(random, 2.0));
        for (int axis = 0; axis < 3; ++axis)
            p[axis] = i % 3 == 0 ? p[axis] : std::trunc(p[axis]);  // many alike, many a zero of either sign
        vertices.push_back(p);
    }
    const std::vector<std::uint32_t> numbers = number_positions(vertices);
    std::map<Place, std::uint32_t> number_of;
    std::map<std::uint32_t, Place> place_of;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        ASSERT_LT(numbers[i], vertices.size());
        ASSERT_EQ(number_of.emplace(place(vertices[i]), numbers[i]).first->second, numbers[i]);
        ASSERT_EQ(place_of.emplace(numbers[i], place(vertices[i])).first->second, place(vertices[i]));
    }
    EXPECT_TRUE(number_positions({}).empty());
}

// More edges at one corner than an insertion sort is for.
TEST(ClosedSurface, AFanAroundOneCornerIsClosedByItsBottom) {
    const MeshData ball = test::sphere_mesh(1000, 2, 1.0);
    EXPECT_EQ(surface_kind(ball.vertices, ball.triangles), SurfaceKind::Closed);
    EXPECT_EQ(surface_kind(ball.vertices, std::span(ball.triangles).subspan(1)), SurfaceKind::Oriented);
    EXPECT_EQ(surface_kind({}, {}), SurfaceKind::Oriented);
}

}  // namespace
}  // namespace carom
