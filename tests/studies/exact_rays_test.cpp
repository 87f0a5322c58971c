// The exact oracle for rays, against hand-made cases and against the casts it judges.
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/random.hpp>
#include <carom/scenes/bumpy.hpp>
#include <carom/studies/accuracy/ray_problem.hpp>
#include <carom/studies/oracle/exact_rays.hpp>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::accuracy {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

const std::vector<vec3> kCorners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
const Triangles kOne{{0, 1, 2}};

std::optional<double> down(double x, double y, const dvec3& offset = dvec3{0.0}, double z = 2.0) {
    return oracle::exact_distance(kCorners, kOne, offset, {.origin = {x, y, z}, .direction = {0, 0, -3}});
}

TEST(ExactRays, EdgesBelongToTheTriangleAndOneUlpOutsideDoesNot) {
    constexpr double kTiny = 0x1p-1074;
    EXPECT_EQ(down(0.25, 0.25), 2.0);
    EXPECT_EQ(down(0.0, 0.0), 2.0);
    EXPECT_EQ(down(0.5, 0.5), 2.0);
    EXPECT_EQ(down(0.25, 0.0), 2.0);
    EXPECT_EQ(down(0.25, -kTiny), std::nullopt);
    EXPECT_EQ(down(0.25, kTiny), 2.0);
    EXPECT_EQ(down(0.5, std::nextafter(0.5, 1.0)), std::nullopt);
    EXPECT_EQ(down(0.5, std::nextafter(0.5, 0.0)), 2.0);
    EXPECT_EQ(down(-kTiny, 0.5), std::nullopt);
}

TEST(ExactRays, StartAtOrBehindTheTriangle) {
    EXPECT_EQ(down(0.25, 0.25, dvec3{0.0}, 0.0), 0.0);
    EXPECT_EQ(down(0.25, 0.25, dvec3{0.0}, -0x1p-1074), std::nullopt);
    const Ray along{.origin = {-1, 0.25, 0}, .direction = {1, 0, 0}};
    EXPECT_EQ(oracle::exact_distance(kCorners, kOne, dvec3{0.0}, along), std::nullopt) << "in its plane";
}

TEST(ExactRays, TheOffsetIsNotRoundedIntoTheVertices) {
    // 1e17 + 0.25 is no double; the difference of origin and offset is what counts.
    EXPECT_EQ(down(1e17, 0.25, {1e17, 0, 0}), 2.0);
    EXPECT_EQ(down(std::nextafter(1e17, 2e17), 0.25, {1e17, 0, 0}), std::nullopt);
}

TEST(ExactRays, TheNearestOfManyAndLongDirections) {
    const MeshData data = scenes::bumpy(4);
    for (const double length : {1e-200, 1.0, 1e200}) {
        const Ray ray{.origin = {5, 0.01, 0.02}, .direction = length * dvec3{-1, 0, 0}};
        const std::optional<double> hit = oracle::exact_distance(data.vertices, data.triangles, dvec3{0.0}, ray);
        ASSERT_TRUE(hit);
        EXPECT_NEAR(*hit, 4.0, 0.2) << "the near side, " << length;
    }
}

TEST(ExactRays, AgreeWithTheWatertightCastOfAClosedBall) {
    const MeshData data = weld(scenes::bumpy(6));
    const Shape mesh = *TriangleMesh::build(data.vertices, data.triangles);
    Random random(4711);
    int hits = 0;
    for (int i = 0; i < 300; ++i) {
        const auto draw = [&] {
            const double x = random.range(-2, 2), y = random.range(-2, 2);
            return dvec3{x, y, random.range(-2, 2)};
        };
        Ray ray{.origin = draw()};
        ray.direction = draw() - ray.origin;
        const std::optional<double> exact = oracle::exact_distance(data.vertices, data.triangles, dvec3{0.0}, ray);
        const std::optional<RayHit> cast = cast_ray(mesh, ray);
        ASSERT_EQ(exact.has_value(), cast.has_value()) << i;
        if (!exact) continue;
        ++hits;
        // What cast_ray documents, for rays that graze at 1e-3 and more.
        EXPECT_NEAR(*exact, cast->distance, 1e-12 * std::max(1.0, *exact)) << i;
    }
    EXPECT_GT(hits, 100);
}

RayProblem two_rays() {
    RayProblem problem{"two", "", {}};
    problem.parts.push_back({nullptr, dvec3{0.0}, {Ray{}, Ray{}}, {2.0, std::nullopt}});
    return problem;
}

TEST(Judge, AWrongVerdictCountsOneAndADistanceItsRelativeError) {
    const RayProblem problem = two_rays();
    EXPECT_EQ(judge(problem, {{2.0, std::nullopt}}, 1.0).error, 0.0);
    EXPECT_EQ(judge(problem, {{2.5, std::nullopt}}, 1.0).error, 0.125);
    EXPECT_EQ(judge(problem, {{std::nullopt, std::nullopt}}, 1.0).error, 0.5);
    EXPECT_EQ(judge(problem, {{std::nullopt, 3.0}}, 1.0).error, 1.0);
    EXPECT_EQ(judge(problem, {{1e9, std::nullopt}}, 1.0).error, 0.5) << "never worse than a wrong verdict";
    const Sample failed = judge(problem, {{std::numeric_limits<double>::quiet_NaN(), -1.0}}, 1.0);
    EXPECT_EQ(failed.failures, 2u);
}

TEST(RayProblems, AreTheSameEachTimeAndNameTheGroupFirst) {
    const auto problems = ray_problems(true), again = ray_problems(true);
    ASSERT_EQ(problems.size(), 6u);
    EXPECT_EQ(problems[0]->name, "rays");
    std::size_t sum = 0;
    for (std::size_t i = 1; i < problems.size(); ++i) {
        sum += problems[i]->ray_count();
        for (std::size_t p = 0; p < problems[i]->parts.size(); ++p) {
            const RayCases& part = problems[i]->parts[p];
            EXPECT_EQ(part.exact, again[i]->parts[p].exact);
            const auto hits = static_cast<double>(std::ranges::count_if(part.exact, [](const auto& e) { return e.has_value(); }));
            EXPECT_GT(hits, 0.1 * static_cast<double>(part.exact.size())) << problems[i]->name;
        }
    }
    EXPECT_EQ(problems[0]->ray_count(), sum);
}

}  // namespace
}  // namespace carom::accuracy
