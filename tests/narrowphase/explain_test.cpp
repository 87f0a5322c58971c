// explain(): known answers, agreement with collide() and with the brute-force axes over every pair of types, bad input.
#include "oracle.hpp"

#include <support/box_mesh.hpp>

#include <carom/collision/closest_points.hpp>
#include <carom/collision/compound.hpp>
#include <carom/collision/mesh_pairs.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/check.hpp>
#include <carom/narrowphase/explain.hpp>

#include <gtest/gtest.h>

#include <limits>

namespace carom {
namespace {

using namespace test;

const Shape kCube = Box{{0.5f, 0.5f, 0.5f}};

PairExplanation explain_at(const Shape& a, const Pose& pa, const Shape& b, const Pose& pb, float margin = 0.05f) {
    return explain({&a, &b, pa, pb, margin});
}

Shape ball_of_triangles(Random& r) {
    const ConvexHullPtr hull = random_hull(r, 30, 0.5, 0.8);
    std::vector<TriangleMesh::Triangle> triangles;
    for (const ConvexHull::Face& face : hull->faces()) {
        const auto& e = hull->edges();
        const std::uint32_t a = face.first_edge;
        for (std::uint32_t b = e[a].next; e[b].next != a; b = e[b].next)
            triangles.push_back({e[a].origin, e[b].origin, e[e[b].next].origin});
    }
    return *TriangleMesh::build(hull->vertices(), triangles);
}

Shape sample(ShapeType type, Random& r) {
    if (type == ShapeType::Plane) return Plane{vec3(random_direction(r)), static_cast<float>(r.range(-0.3, 0.3))};
    if (type == ShapeType::TriangleMesh) return ball_of_triangles(r);
    if (type != ShapeType::Compound) return random_shape(type, r);
    std::vector<CompoundPart> parts;
    for (const ShapeType part : {ShapeType::Box, ShapeType::Sphere, ShapeType::ConvexHull, ShapeType::Cylinder}) {
        parts.push_back({random_shape(part, r), {random_direction(r) * r.range(0.0, 0.8), random_rotation(r)}});
    }
    return *Compound::build(std::move(parts));
}

TEST(Explain, ACubeOverACubeIsApartByTheGapBetweenTheirFaces) {
    const PairExplanation why = explain_at(kCube, {}, kCube, {{0.25, 1.5, 0.0}});
    EXPECT_EQ(why.verdict, PairVerdict::Apart);
    ASSERT_TRUE(why.axis && why.distance);
    EXPECT_EQ(why.axis->source, AxisSource::FaceOfA);
    EXPECT_EQ(why.axis->verdict, PairVerdict::Apart);
    EXPECT_EQ(why.axis->of_a.kind, SupportKind::Face);
    EXPECT_EQ(why.axis->of_a.index, 3u) << "the upper side of y";
    EXPECT_EQ(why.axis->of_b.index, 2u) << "the lower side of y";
    EXPECT_EQ(why.axis->normal, (vec3{0, 1, 0}));
    EXPECT_NEAR(why.axis->gap, 0.5, 1e-14);
    EXPECT_LE(why.distance->lower, 0.5);
    EXPECT_NEAR(why.distance->lower, 0.5, 1e-12);
    EXPECT_NEAR(why.distance->upper, 0.5, 1e-12);
    EXPECT_FALSE(why.distance->simplex_a.empty());
    EXPECT_TRUE(why.manifolds.empty());
    EXPECT_EQ(why.disagreement, "");
}

// Beside an edge: 0.02 along either face's normal, and 0.0283 in truth.
TEST(Explain, CubesBesideEachOthersEdgesAreAsFarApartAsTheyAre) {
    for (const float margin : {0.019f, 0.024f, 0.028f, 0.0285f, 0.05f}) {
        const PairExplanation why = explain_at(kCube, {}, kCube, {{1.02, 1.02, 0.25}}, margin);
        EXPECT_EQ(why.manifolds.size(), margin > 0.0283f ? 1u : 0u) << margin;
        ASSERT_TRUE(why.axis);
        EXPECT_NEAR(why.axis->gap, 0.02 * std::sqrt(2.0), 1e-9);
        EXPECT_EQ(why.disagreement, "") << margin;
    }
}

TEST(Explain, ACubeInACubeOverlapsAlongTheFaceAndSharesHalfOfIt) {
    const PairExplanation why = explain_at(kCube, {}, kCube, {{0.5, 0.9, 0.0}});
    EXPECT_EQ(why.verdict, PairVerdict::Touching);
    ASSERT_TRUE(why.axis);
    EXPECT_NEAR(why.axis->gap, -0.1, 1e-14);
    ASSERT_EQ(why.manifolds.size(), 1u);
    ASSERT_TRUE(why.patch);
    EXPECT_EQ(why.patch->face_a.size(), 4u);
    EXPECT_EQ(why.patch->face_b.size(), 4u);
    ASSERT_EQ(why.patch->common.size(), 4u);
    dvec3 area{0.0};
    const auto& c = why.patch->common;
    for (std::size_t i = 2; i < c.size(); ++i) area += 0.5 * glm::cross(c[i - 1] - c[0], c[i] - c[0]);
    EXPECT_NEAR(std::sqrt(glm::dot(area, area)), 0.5, 1e-6);
    for (const dvec3& p : c) EXPECT_NEAR(p.y, 0.45, 1e-6) << "midway between the faces";
    EXPECT_EQ(why.disagreement, "");
}

TEST(Explain, FacesThatOnlyMeetAreUndecided) {
    EXPECT_EQ(explain_at(kCube, {}, kCube, {{0.0, 1.0, 0.0}}).verdict, PairVerdict::Undecided);
    EXPECT_EQ(explain_at(kCube, {}, kCube, {{0.0, 1.0 + 1e-13, 0.0}}).verdict, PairVerdict::Apart);
    EXPECT_EQ(explain_at(kCube, {}, kCube, {{0.0, 1.0 - 1e-11, 0.0}}).verdict, PairVerdict::Touching);
    const Shape ball = Sphere{0.5f};
    EXPECT_EQ(explain_at(ball, {}, ball, {{0.0, 1.0, 0.0}}).verdict, PairVerdict::Undecided);
    EXPECT_EQ(explain_at(ball, {}, ball, {{0.0, 0.0, 0.0}}).verdict, PairVerdict::Touching);
}

TEST(Explain, CrossedEdgesAreNamed) {
    // Two cubes, each turned on an edge, one of them a quarter round: edge across edge.
    const dquat on_edge = about({0, 0, 1}, kPi / 4), crossed = about({0, 1, 0}, kPi / 2) * on_edge;
    const double reach = std::sqrt(0.5);
    const PairExplanation why = explain_at(kCube, {{0, 0, 0}, on_edge}, kCube, {{0.0, 2.0 * reach + 0.25, 0.0}, crossed});
    ASSERT_TRUE(why.axis);
    EXPECT_EQ(why.axis->source, AxisSource::Edges);
    EXPECT_EQ(why.axis->of_a.kind, SupportKind::Edge);
    EXPECT_EQ(why.axis->of_b.kind, SupportKind::Edge);
    EXPECT_NEAR(why.axis->gap, 0.25, 1e-12);
    EXPECT_NEAR(why.axis->on_a.y, reach, 1e-12);
    EXPECT_NEAR(why.axis->on_b.y, reach + 0.25, 1e-12);
}

TEST(Explain, APlaneAndATriangleHaveTheirPlaceInIt) {
    const Shape ground = Plane{{0, 1, 0}, 0.25f};
    const PairExplanation over = explain_at(kCube, {{0, 2, 0}}, ground, {});
    ASSERT_TRUE(over.axis);
    EXPECT_EQ(over.axis->source, AxisSource::FaceOfB);
    EXPECT_NEAR(over.axis->gap, 1.25, 1e-14);
    EXPECT_EQ(explain_at(ground, {}, kCube, {{0, 2, 0}}).axis->source, AxisSource::FaceOfA);

    const std::vector<vec3> vertices{{-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}};
    const std::vector<TriangleMesh::Triangle> triangles{{0, 1, 2}, {0, 2, 3}};
    const Shape mesh = *TriangleMesh::build(vertices, triangles);
    const PairExplanation far = explain_at(kCube, {{4, 30, -4}}, mesh, {});
    EXPECT_EQ(far.triangle, 1u);
    EXPECT_NEAR(far.axis->gap, 29.5, 1e-12);
    EXPECT_EQ(explain_at(mesh, {}, kCube, {{-4, 0.4, 4}}).triangle, 0u);
}

TEST(Explain, AgreesWithCollideOfEveryTwoTypes) {
    Random r(501);
    for (int a = 0; a < kShapeTypeCount; ++a) {
        for (int b = 0; b < kShapeTypeCount; ++b) {
            const auto ta = static_cast<ShapeType>(a), tb = static_cast<ShapeType>(b);
            if (!can_collide(ta, tb)) continue;
            int apart = 0, touching = 0;
            for (int i = 0; i < 60; ++i) {
                SCOPED_TRACE(testing::Message() << to_string(ta) << " " << to_string(tb) << " " << i);
                const Shape sa = sample(ta, r), sb = sample(tb, r);
                const Pose pa{random_direction(r), random_rotation(r)};
                const Pose pb{pa.position + random_direction(r) * r.range(0.0, 3.0), random_rotation(r)};
                const PairExplanation why = explain_at(sa, pa, sb, pb);
                ASSERT_TRUE(why.axis && why.distance);
                EXPECT_EQ(why.disagreement, "");
                apart += why.verdict == PairVerdict::Apart;
                touching += why.verdict == PairVerdict::Touching;
                EXPECT_EQ(why.verdict == PairVerdict::Apart, why.axis->gap > why.axis->rounding);
                EXPECT_LE(why.distance->lower, why.distance->upper);
                EXPECT_LE(why.axis->gap, why.distance->upper + why.axis->rounding);
                EXPECT_NEAR(glm::length(dvec3(why.axis->normal)), 1.0, 1e-6);

                const PairExplanation back = explain_at(sb, pb, sa, pa);
                EXPECT_EQ(back.verdict, why.verdict);
                EXPECT_NEAR(back.axis->gap, why.axis->gap, 2e-5);
                EXPECT_EQ(back.part_a, why.part_b);
            }
            EXPECT_GT(apart, 0) << to_string(ta) << " " << to_string(tb);
            EXPECT_GT(touching, 0) << to_string(ta) << " " << to_string(tb);
        }
    }
}

TEST(Explain, GapsAndDistancesAreThoseOfTheBruteForce) {
    Random r(502);
    int overlaps = 0;
    for (int i = 0; i < 400; ++i) {
        const ConvexHullPtr a = random_hull(r, 12, 0.3, 0.7), b = random_hull(r, 12, 0.3, 0.7);
        const Pose pa{random_direction(r), random_rotation(r)};
        const Pose pb{pa.position + random_direction(r) * r.range(0.2, 1.6), random_rotation(r)};
        const PairExplanation why = explain_at(a, pa, b, pb);
        const Solid sa = solid_of(*a, pa, pa.position), sb = solid_of(*b, pb, pa.position);
        const auto exact = static_cast<double>(signed_distance(sa, sb));
        overlaps += exact < 0.0;
        EXPECT_NEAR(why.axis->gap, exact, 2e-6) << i;
        EXPECT_LE(why.distance->lower, std::max(exact, 0.0)) << i;
        EXPECT_GE(why.distance->upper, exact - 1e-12) << i;
        EXPECT_EQ(why.verdict, exact > 0.0 ? PairVerdict::Apart : PairVerdict::Touching) << i;
        // A gap is a proof: no corner of either lies beyond its plane.
        EXPECT_NEAR(static_cast<double>(gap_along(sa, sb, real(dvec3(why.axis->normal)))), why.axis->gap, 1e-6) << i;
    }
    EXPECT_GT(overlaps, 50);
}

TEST(Explain, OfAMeshTheNearestTriangleIsFoundHoweverFarItIs) {
    Random r(503);
    // Shards far apart: near the box of one there may be none.
    std::vector<vec3> vertices;
    std::vector<TriangleMesh::Triangle> triangles;
    for (std::uint32_t t = 0; t < 60; ++t) {
        const vec3 middle = 5.0f * vec3(random_direction(r));
        for (int k = 0; k < 3; ++k) vertices.push_back(middle + 2.0f * vec3(random_direction(r)));
        triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    const TriangleMeshPtr mesh = *TriangleMesh::build(vertices, triangles);
    const Shape ball = Sphere{0.05f}, shards = mesh;
    for (int i = 0; i < 300; ++i) {
        const Pose at{random_direction(r) * r.range(0.0, 30.0)};
        Real best = 1e30L;
        std::uint32_t nearest = 0;
        for (std::uint32_t t = 0; t < triangles.size(); ++t) {
            const auto corners = mesh->corners(t);
            const Real d =
                distance_to_triangle({real(dvec3(corners[0])), real(dvec3(corners[1])), real(dvec3(corners[2]))}, real(at.position));
            if (d >= best) continue;
            best = d;
            nearest = t;
        }
        if (best < 0.1L) continue;
        const PairExplanation why = explain_at(ball, at, shards, {});
        EXPECT_NEAR(why.axis->gap, static_cast<double>(best) - 0.05, 1e-6) << i;
        EXPECT_EQ(why.triangle, nearest) << i;
    }
}

/// A ball with a tetrahedron in its middle, which bounds no convex solid.
Shape seeded_ball(Random& r) {
    const Shape ball = ball_of_triangles(r);
    const TriangleMesh& mesh = *std::get<TriangleMeshPtr>(ball);
    std::vector<vec3> vertices(mesh.vertices().begin(), mesh.vertices().end());
    std::vector<TriangleMesh::Triangle> triangles(mesh.triangles().begin(), mesh.triangles().end());
    const auto n = static_cast<std::uint32_t>(vertices.size());
    for (const vec3& v : {vec3{0, 0, 0}, vec3{1e-3f, 0, 0}, vec3{0, 1e-3f, 0}, vec3{0, 0, 1e-3f}}) vertices.push_back(v);
    for (const auto& t : {std::array{0u, 2u, 1u}, std::array{0u, 1u, 3u}, std::array{0u, 3u, 2u}, std::array{1u, 2u, 3u}}) {
        triangles.push_back({n + t[0], n + t[1], n + t[2]});
    }
    return *TriangleMesh::build(vertices, triangles);
}

TEST(Explain, OfMeshesTheBoundsOfTheDistanceHoldTheLeastOfAllTriangles) {
    Random r(504);
    int apart = 0, near = 0, touching = 0;
    for (int i = 0; i < 200; ++i) {
        SCOPED_TRACE(i);
        const Shape a = seeded_ball(r), b = seeded_ball(r);
        const TriangleMesh &ma = *std::get<TriangleMeshPtr>(a), &mb = *std::get<TriangleMeshPtr>(b);
        ASSERT_EQ(ma.solid(), nullptr);
        const Pose pa{100.0 * random_direction(r), random_rotation(r)};
        const Pose pb{pa.position + random_direction(r) * r.range(0.6, 1.8), random_rotation(r)};
        const PairExplanation why = explain_at(a, pa, b, pb);
        ASSERT_TRUE(why.axis && why.distance);
        EXPECT_EQ(why.disagreement, "");
        EXPECT_NEAR(glm::length(dvec3(why.axis->normal)), 1.0, 1e-6);
        const PairExplanation back = explain_at(b, pb, a, pa);
        EXPECT_EQ(back.verdict, why.verdict);
        if (why.axis->gap > -0.01) {  // deeper, another way out may be found
            EXPECT_NEAR(back.axis->gap, why.axis->gap, 2e-6);
        }
        if (meshes_overlap(ma.bvh(), mb.bvh(), inverse(pa) * pb)) {
            ++touching;
            EXPECT_EQ(why.verdict, PairVerdict::Touching);
            EXPECT_EQ(why.distance->lower, 0.0);
            EXPECT_TRUE(why.distance->cores_overlap);
            EXPECT_EQ(why.axis->source, AxisSource::Contact);
            float least = 1.0f;
            for (const Manifold& m : why.manifolds) least = std::min(least, least_separation(m));
            EXPECT_EQ(why.axis->gap, static_cast<double>(least));
            continue;
        }
        ++apart;
        double least = 1e9;
        const auto placed = [](const TriangleMesh& mesh, const Pose& pose, std::uint32_t t) {
            const auto c = mesh.corners(t);
            return geo::Triangle<double>{transform_point(pose, dvec3(c[0])), transform_point(pose, dvec3(c[1])), transform_point(pose, dvec3(c[2]))};
        };
        for (std::uint32_t s = 0; s < ma.triangles().size(); ++s) {
            const geo::Triangle<double> x = placed(ma, pa, s);
            for (std::uint32_t t = 0; t < mb.triangles().size(); ++t) {
                least = std::min(least, std::sqrt(geo::closest_points(x, placed(mb, pb, t)).distance_sq));
            }
        }
        EXPECT_EQ(why.verdict, PairVerdict::Apart);
        EXPECT_LE(why.distance->lower, least + 1e-12);
        EXPECT_GE(why.distance->upper, least - 1e-12);
        EXPECT_LT(why.distance->upper - why.distance->lower, 1e-11);
        EXPECT_NEAR(why.axis->gap, least, 1e-9);
        EXPECT_NEAR(glm::length(why.distance->on_b - why.distance->on_a), least, 1e-11);
        const geo::Triangle<double> x = placed(ma, pa, why.triangle), y = placed(mb, pb, why.triangle_b);
        EXPECT_NEAR(std::sqrt(geo::closest_points(x, y).distance_sq), least, 1e-11);
        near += least < 0.05;
        EXPECT_EQ(why.manifolds.empty(), least > 0.05);
    }
    EXPECT_GT(apart, 60);
    EXPECT_GT(near, 5);
    EXPECT_GT(touching, 60);
}

TEST(Explain, AMeshInsideOfAnotherIsAsDeepAsItsContact) {
    Random r(505);
    const Shape outer = seeded_ball(r), inner = box_mesh({0.02f, 0.02f, 0.02f}, 1);
    const PairExplanation why = explain_at(outer, {}, inner, {{0.38, 0.0, 0.0}, kIdentityRotation});
    EXPECT_EQ(why.verdict, PairVerdict::Touching);
    EXPECT_EQ(why.axis->source, AxisSource::Contact);
    EXPECT_LT(why.axis->gap, -0.05);
    EXPECT_GT(why.distance->lower, 0.0) << "the surfaces are apart";
    EXPECT_FALSE(why.distance->cores_overlap);
    EXPECT_EQ(why.disagreement, "");
}

TEST(Explain, WhatIsFartherThanNumbersGoIsApart) {
    for (const double far : {1e200, 1.7e308}) {
        const PairExplanation why = explain_at(kCube, {{-far, 0, 0}}, kCube, {{far, 0, 0}});
        EXPECT_EQ(why.verdict, PairVerdict::Apart) << far;
        EXPECT_TRUE(why.manifolds.empty());
    }
}

int g_reports = 0;
void count_report(const Error&) { ++g_reports; }

TEST(Explain, MisuseIsReported) {
    g_reports = 0;
    set_error_handler(count_report);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(explain({nullptr, &kCube, {}, {}, 0.0f}).axis);
    EXPECT_FALSE(explain_at(kCube, {{nan, 0, 0}}, kCube, {}).axis);
    EXPECT_FALSE(explain_at(kCube, {}, kCube, {}, -1.0f).axis);
    const Shape plane = Plane{};
    EXPECT_FALSE(explain_at(plane, {}, plane, {}).axis);
    set_error_handler(nullptr);
    EXPECT_EQ(g_reports, 4);
}

}  // namespace
}  // namespace carom
