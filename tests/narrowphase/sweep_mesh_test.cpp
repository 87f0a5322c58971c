// Sweeps against meshes: bit by bit the first of those against each triangle.
#include <carom/collision/closest_points.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/sweep.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace carom {
namespace {

dvec3 any(Random& random) { return {random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)}; }

TEST(SweepMesh, MeshesGiveTheFirstOfTheirTriangles) {
    Random random(0x3e54);
    std::vector<vec3> vertices;
    std::vector<TriangleMesh::Triangle> triangles;
    for (std::uint32_t i = 0; i < 300; ++i) {
        const vec3 p = vec3(2.0 * any(random));
        for (int k = 0; k < 3; ++k) vertices.push_back(p + vec3(0.3 * any(random)));
        triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const TriangleMeshPtr mesh = *TriangleMesh::build(vertices, triangles);
    int touching = 0, separated = 0;
    const auto judge_mesh = [&](const auto& a, const dvec3& motion) {
        double first = 2.0;
        std::uint32_t number = geo::MeshImpact::kNone;
        for (std::uint32_t i = 0; i < 300; ++i) {
            const auto c = mesh->corners(i);
            const Impact one = geo::sweep(a, motion, geo::Triangle<double>{dvec3(c[0]), dvec3(c[1]), dvec3(c[2])});
            if (may_touch(one.status) && one.t < first) first = one.t, number = i;
        }
        const geo::MeshImpact found = geo::sweep(a, motion, *mesh);
        ASSERT_EQ(may_touch(found.status), first <= 1.0);
        ASSERT_EQ(found.triangle, number);
        ASSERT_EQ(found.t, std::min(first, 1.0));
        ++(may_touch(found.status) ? touching : separated);
    };
    for (int i = 0; i < 400; ++i) {
        const dvec3 from = 3.0 * test::random_direction(random), motion = 4.0 * any(random);
        judge_mesh(geo::Sphere<double>{from, i % 10 == 0 ? 0.0 : random.range(0.0, 0.2)}, motion);
        judge_mesh(geo::Capsule<double>{{from, from + 0.5 * any(random)}, random.range(0.0, 0.1)}, motion);
        if (HasFatalFailure()) FAIL() << i;
    }
    EXPECT_GT(touching, 100);
    EXPECT_GT(separated, 100);
    EXPECT_EQ(geo::sweep(geo::Sphere<double>{dvec3{std::numeric_limits<double>::infinity()}, 1.0}, dvec3{1.0}, *mesh).status,
              ImpactStatus::Invalid);
    EXPECT_EQ(geo::sweep(geo::Capsule<double>{{dvec3{0.0}, dvec3{1.0}}, -1.0}, dvec3{1.0}, *mesh).status, ImpactStatus::Invalid);
    EXPECT_EQ(geo::sweep(geo::Sphere<double>{dvec3{0.0}, 1.0}, dvec3{std::numeric_limits<double>::infinity()}, *mesh).status,
              ImpactStatus::Invalid);
}

/// On a grid of quarters of the size, or anywhere.
dvec3 some(Random& random, double size) {
    dvec3 p = size * any(random);
    const bool coarse = random.unit() < 0.3;
    for (int k = 0; k < 3; ++k) {
        if (coarse) p[k] = 0.25 * size * std::round(4.0 * p[k] / size);
    }
    return p;
}

struct Soup {
    double size = 1.0;
    dvec3 off{0.0};
    std::vector<vec3> vertices;
    TriangleMeshPtr mesh;
    std::vector<geo::Triangle<double>> triangles;

    Soup(Random& random, double of_size, double away) : size(of_size), off(away * of_size * any(random)) {
        std::vector<TriangleMesh::Triangle> corners;
        const double side = size * (random.unit() < 0.5 ? 0.1 : 0.6);
        const auto count = static_cast<std::uint32_t>(random.range(1, 120));
        for (std::uint32_t i = 0; i < count; ++i) {
            const dvec3 p = off + some(random, size);
            for (int k = 0; k < 3; ++k) vertices.push_back(vec3(p + some(random, side)));
            if (random.unit() < 0.1) vertices.back() = vertices[vertices.size() - 2];
            corners.push_back({3 * i, 3 * i + 1, 3 * i + 2});
        }
        mesh = *TriangleMesh::build(vertices, corners);
        for (std::uint32_t i = 0; i < count; ++i) {
            const auto c = mesh->corners(i);
            triangles.push_back({dvec3(c[0]), dvec3(c[1]), dvec3(c[2])});
        }
    }
    template <class A>
    [[nodiscard]] geo::MeshImpact one_by_one(const A& a, const dvec3& motion) const {
        geo::MeshImpact first;
        for (std::uint32_t i = 0; i < triangles.size(); ++i) {
            const Impact one = geo::sweep(a, motion, triangles[i]);
            if (!may_touch(one.status) || (may_touch(first.status) && one.t >= first.t)) continue;
            static_cast<Impact&>(first) = one;
            first.triangle = i;
        }
        return first;
    }
};

bool same_bits(const geo::MeshImpact& p, const geo::MeshImpact& q) {
    const auto same = [](double a, double b) { return a == b && std::signbit(a) == std::signbit(b); };
    bool all = p.status == q.status && p.triangle == q.triangle && same(p.t, q.t);
    for (int k = 0; k < 3; ++k) all = all && same(p.point[k], q.point[k]) && same(p.normal[k], q.normal[k]);
    return all;
}

// Leaves are judged in float: of all sizes and places, ties on grids, standing, far and huge balls, and those that just touch one of the triangles.
TEST(SweepMesh, NothingThatIsLeftOutWouldBeFirst) {
    Random random(0x1eaf);
    int touching = 0, separated = 0;
    for (int n = 0; n < 250; ++n) {
        const double away[] = {0.0, 0.0, 10.0, 1e3, 1e5};
        const Soup soup(random, n % 2 == 0 ? 1.0 : std::pow(10.0, random.range(-30.0, 30.0)), away[n % 5]);
        for (int i = 0; i < 24; ++i) {
            const double ways[] = {0.0, 1.0, 4.0, 4.0, 1e3, 1e8, 1e-8, 1e-30}, radii[] = {0.0, 0.01, 0.1, 1.0, 1e-9, 1e6};
            const dvec3 motion = ways[i % 8] * some(random, soup.size);
            geo::Sphere<double> ball{soup.off + 1.5 * some(random, soup.size) - random.unit() * motion, radii[i % 6] * soup.size};
            if (i % 3 == 0) {  // grazing
                const geo::Triangle<double>& other =
                    soup.triangles[static_cast<std::size_t>(random.range(0.0, double(soup.triangles.size())))];
                const geo::Segment<double> path{ball.center, ball.center + motion};
                const double gaps[] = {0.0, 1e-15, -1e-15, 1e-13, -1e-13, 1e-9, -1e-9, 1e-7};
                ball.radius = std::sqrt(geo::closest_points(path, other).distance_sq) * (1.0 + gaps[i / 3]);
            }
            const geo::MeshImpact wanted = soup.one_by_one(ball, motion);
            for (const int width : available_simd_widths()) {
                set_simd_width(width);
                const geo::MeshImpact found = geo::sweep(ball, motion, *soup.mesh);
                set_simd_width(0);
                ASSERT_TRUE(same_bits(found, wanted))
                    << n << " " << i << " width " << width << " of size " << soup.size << ": " << found.triangle << " at " << found.t
                    << ", not " << wanted.triangle << " at " << wanted.t;
            }
            ++(may_touch(wanted.status) ? touching : separated);
            const geo::Capsule<double> rod{{ball.center, ball.center + some(random, soup.size)}, ball.radius};
            ASSERT_TRUE(same_bits(geo::sweep(rod, motion, *soup.mesh), soup.one_by_one(rod, motion))) << n << " " << i;
        }
    }
    EXPECT_GT(touching, 1000);
    EXPECT_GT(separated, 1000);
}

// Of triangles that are met at one time the first.
TEST(SweepMesh, TheLowestOfSeveralIsNamed) {
    std::vector<vec3> vertices;
    std::vector<TriangleMesh::Triangle> triangles;
    for (std::uint32_t i = 0; i < 40; ++i) {  // one on the other, turned
        const vec3 corners[] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
        for (std::uint32_t k = 0; k < 3; ++k) vertices.push_back(corners[(i + k) % 3]);
        triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    for (std::uint32_t first = 0; first < 40; ++first) {
        const std::span<const TriangleMesh::Triangle> rest(triangles.data() + first, triangles.size() - first);
        const TriangleMeshPtr mesh = *TriangleMesh::build(vertices, rest);
        const geo::MeshImpact hit = geo::sweep(geo::Sphere<double>{{0.1, -0.2, 3.0}, 0.5}, {0, 0, -5}, *mesh);
        double least = 2.0;
        std::uint32_t lowest = 0;
        for (std::uint32_t i = 0; i < rest.size(); ++i) {
            const auto c = mesh->corners(i);
            const Impact one = geo::sweep(geo::Sphere<double>{{0.1, -0.2, 3.0}, 0.5}, {0, 0, -5},
                                          geo::Triangle<double>{dvec3(c[0]), dvec3(c[1]), dvec3(c[2])});
            if (one.t < least) least = one.t, lowest = i;
        }
        ASSERT_EQ(hit.triangle, lowest);
        ASSERT_EQ(hit.t, least);
    }
}

}  // namespace
}  // namespace carom
