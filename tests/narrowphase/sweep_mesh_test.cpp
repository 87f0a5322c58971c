// Sweeps against meshes: bit by bit the first of those against each triangle.
#include <carom/narrowphase/sweep.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <algorithm>
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
    EXPECT_EQ(geo::sweep(geo::Sphere<double>{dvec3{std::numeric_limits<double>::infinity()}, 1.0}, dvec3{1.0}, *mesh).status, ImpactStatus::Invalid);
    EXPECT_EQ(geo::sweep(geo::Capsule<double>{{dvec3{0.0}, dvec3{1.0}}, -1.0}, dvec3{1.0}, *mesh).status, ImpactStatus::Invalid);
    EXPECT_EQ(geo::sweep(geo::Sphere<double>{dvec3{0.0}, 1.0}, dvec3{std::numeric_limits<double>::infinity()}, *mesh).status, ImpactStatus::Invalid);
}

}  // namespace
}  // namespace carom
