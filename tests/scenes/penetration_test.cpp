// The geometric penetration against closed forms, and its quick ways against slow ones.
#include "support.hpp"

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>
#include <carom/studies/oracle/penetration.hpp>
#include <carom/studies/oracle/polytope.hpp>

#include <algorithm>
#include <array>
#include <ctime>
#include <limits>

namespace carom::test {
namespace {

using oracle::geometric_penetration;
using oracle::make_polytope;
using oracle::make_round;
using oracle::overlap_depth;
using oracle::Penetration;
using oracle::Polytope;

// Sizes are about 1 m; sums of a few products in double.
constexpr double kRounding = 1e-13;

/// Every axis there is: faces of both and all crosses of edges, both ways, supports over all vertices.
double brute_force_depth(const Polytope& a, const Polytope& b) {
    std::vector<dvec3> axes;
    for (const auto& face : a.faces) axes.push_back(face.normal);
    for (const auto& face : b.faces) axes.push_back(face.normal);
    for (const auto& e : a.edges) {
        for (const auto& f : b.edges) {
            const dvec3 axis = glm::cross(a.vertices[e.b] - a.vertices[e.a], b.vertices[f.b] - b.vertices[f.a]);
            const double length = glm::length(axis);
            if (length > 1e-9) axes.push_back(axis / length);
        }
    }
    const auto extent = [](const Polytope& p, const dvec3& n) {
        double low = std::numeric_limits<double>::infinity();
        double high = -low;
        for (const dvec3& v : p.vertices) {
            low = std::min(low, glm::dot(n, v + p.position));
            high = std::max(high, glm::dot(n, v + p.position));
        }
        return std::array<double, 2>{low, high};
    };
    double depth = std::numeric_limits<double>::infinity();
    for (const dvec3& n : axes) {
        const auto [a_low, a_high] = extent(a, n);
        const auto [b_low, b_high] = extent(b, n);
        depth = std::min({depth, a_high - b_low, b_high - a_low});
    }
    return std::max(depth, 0.0);
}

Shape draw_polytope(Random& random) {
    if (random.unit() < 0.4) {
        return Box{vec3(dvec3{random.range(0.2, 1.0), random.range(0.2, 1.0), random.range(0.2, 1.0)})};
    }
    std::vector<vec3> points;
    for (int i = 0; i < 12; ++i) points.push_back(vec3(draw_vector(random, 0.7)));
    return *ConvexHull::build(points);
}

Pose draw_pose(Random& random, double size) {
    const dvec3 position = draw_vector(random, size);
    return {position, draw_rotation(random)};
}

TEST(OverlapDepth, OfPolytopesIsThatOfEveryAxis) {
    Random random(20261);
    int overlapping = 0;
    for (int i = 0; i < 4000; ++i) {
        const Shape a = draw_polytope(random);
        const Shape b = draw_polytope(random);
        const Polytope p = *make_polytope(a, draw_pose(random, 0.9));
        const Polytope q = *make_polytope(b, draw_pose(random, 0.9));
        const double expected = brute_force_depth(p, q);
        if (expected > 0.0) ++overlapping;
        // Hulls merge faces that are coplanar to 1e-5; no random hull has such.
        ASSERT_NEAR(overlap_depth(p, q), expected, kRounding) << i;
        ASSERT_NEAR(overlap_depth(q, p), expected, kRounding) << i;
    }
    EXPECT_GT(overlapping, 1000);  // the seed gives both kinds
    EXPECT_LT(overlapping, 3000);
}

TEST(OverlapDepth, OfBoxesIsThatOfTheirPolytopes) {
    Random random(20262);
    for (int i = 0; i < 5000; ++i) {
        const Box a{vec3(dvec3{random.range(0.2, 1.0), random.range(0.2, 1.0), random.range(0.2, 1.0)})};
        const Box b{vec3(dvec3{random.range(0.2, 1.0), random.range(0.2, 1.0), random.range(0.2, 1.0)})};
        const Pose at_a = draw_pose(random, 0.8);
        Pose at_b = draw_pose(random, 0.8);
        if (i % 4 == 0) at_b.orientation = at_a.orientation;  // all edges parallel
        const double expected = brute_force_depth(*make_polytope(a, at_a), *make_polytope(b, at_b));
        ASSERT_NEAR(overlap_depth(a, at_a, b, at_b), expected, kRounding) << i;
    }
}

TEST(OverlapDepth, OfCubesIsKnown) {
    const Box cube{vec3{0.5f}};
    const Pose at_origin;
    EXPECT_NEAR(overlap_depth(cube, at_origin, cube, {{0.0, 0.9, 0.0}, kIdentityRotation}), 0.1, kRounding);
    EXPECT_EQ(overlap_depth(cube, at_origin, cube, {{0.0, 1.0, 0.0}, kIdentityRotation}), 0.0);  // they touch
    EXPECT_EQ(overlap_depth(cube, at_origin, cube, {{0.9, 1.1, 0.9}, kIdentityRotation}), 0.0);
    EXPECT_NEAR(overlap_depth(cube, at_origin, cube, at_origin), 1.0, kRounding);
    // Edge against edge: one stands on its edge along x, the other along z; their edges meet at height sqrt(1/2).
    const double r = std::sqrt(0.5);
    const Pose below{dvec3{0.0}, rotation_about({1, 0, 0}, kPi / 4)};
    const Pose above{{0.0, 2 * r - 0.01, 0.0}, rotation_about({0, 0, 1}, kPi / 4)};
    EXPECT_NEAR(overlap_depth(cube, below, cube, above), 0.01, kRounding);
}

TEST(OverlapDepth, DoesNotSufferFarFromTheOrigin) {
    const Box cube{vec3{0.5f}};
    const dvec3 far{1e7, -2e7, 3e7};  // exact in double, and so is the half below
    const Pose a{far, rotation_about({0, 1, 0}, 0.3)};
    const Pose b{far + dvec3{0.0, 0.5, 0.0}, rotation_about({0, 1, 0}, 0.9)};
    EXPECT_NEAR(overlap_depth(cube, a, cube, b), 0.5, kRounding);
    EXPECT_NEAR(overlap_depth(*make_polytope(cube, a), *make_polytope(cube, b)), 0.5, kRounding);
}

/// The least distance over a grid of both parameters: never under the true one, and within the grid's pitch of it.
double sampled_segment_distance(const dvec3& a0, const dvec3& a1, const dvec3& b0, const dvec3& b1) {
    constexpr int kSteps = 60;
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kSteps; ++i) {
        const dvec3 p = a0 + (a1 - a0) * (static_cast<double>(i) / kSteps);
        for (int j = 0; j <= kSteps; ++j) {
            best = std::min(best, glm::distance(p, b0 + (b1 - b0) * (static_cast<double>(j) / kSteps)));
        }
    }
    return best;
}

TEST(SegmentDistance, IsNeverBeatenBySamplesAndNearTheBestOfThem) {
    Random random(20263);
    for (int i = 0; i < 500; ++i) {
        const dvec3 a0 = draw_vector(random, 1.0);
        const dvec3 b0 = draw_vector(random, 1.0);
        const dvec3 a1 = i % 7 == 0 ? a0 : draw_vector(random, 1.0);                    // a point
        const dvec3 b1 = i % 5 == 0 ? b0 + 0.7 * (a1 - a0) : draw_vector(random, 1.0);  // parallel
        const double distance = oracle::segment_distance(a0, a1, b0, b1);
        const double sampled = sampled_segment_distance(a0, a1, b0, b1);
        const double pitch = (glm::distance(a0, a1) + glm::distance(b0, b1)) / 120.0;
        ASSERT_LE(distance, sampled + kRounding) << i;
        ASSERT_GE(distance, sampled - pitch) << i;
    }
}

TEST(OverlapDepth, OfSpheresAndCapsulesIsKnown) {
    const Sphere ball{0.5f};
    const Capsule rod{0.25f, 1.0f};
    const Pose up{{0.0, 1.4, 0.0}, kIdentityRotation};
    EXPECT_NEAR(overlap_depth(*make_round(ball, {}), *make_round(ball, {{0.6, 0.0, 0.0}, kIdentityRotation})), 0.4,
                kRounding);
    EXPECT_NEAR(overlap_depth(*make_round(rod, up), *make_round(ball, {})), 0.35, kRounding);  // end at 0.4, radii 0.75
    const Pose across{{0.0, 0.0, 0.4}, rotation_about({0, 0, 1}, kPi / 2)};
    EXPECT_NEAR(overlap_depth(*make_round(rod, {}), *make_round(rod, across)), 0.1, kRounding);
    EXPECT_EQ(overlap_depth(*make_round(ball, {}), *make_round(ball, {{1.0, 0.0, 0.0}, kIdentityRotation})), 0.0);
}

TEST(OverlapDepth, OfARoundAndABoxIsKnown) {
    const Polytope cube = *make_polytope(Box{vec3{0.5f}}, {});
    const auto ball = [](const dvec3& at) { return *make_round(Sphere{0.25f}, {at, kIdentityRotation}); };
    EXPECT_NEAR(overlap_depth(ball({0.0, 0.7, 0.0}), cube), 0.05, kRounding);                         // over a face
    EXPECT_NEAR(overlap_depth(ball({0.6, 0.6, 0.0}), cube), 0.25 - 0.1 * std::sqrt(2.0), kRounding);  // over an edge
    EXPECT_NEAR(overlap_depth(ball({0.6, 0.6, 0.6}), cube), 0.25 - 0.1 * std::sqrt(3.0), kRounding);  // over a corner
    EXPECT_EQ(overlap_depth(ball({0.7, 0.7, 0.0}), cube), 0.0);                                       // past the edge
    EXPECT_NEAR(overlap_depth(ball({0.0, 0.4, 0.0}), cube), 0.35, kRounding);                         // centre inside
    // A rod through the cube along x, 0.2 under its top: out by the top, with the radius.
    const Pose through{{0.0, 0.3, 0.0}, rotation_about({0, 0, 1}, kPi / 2)};
    EXPECT_NEAR(overlap_depth(*make_round(Capsule{0.1f, 2.0f}, through), cube), 0.2 + static_cast<double>(0.1f),
                kRounding);
    // A slanting rod that cuts the edge along z: out across edge and rod, at 45°.
    const Pose slant{{0.45, 0.45, 0.0}, rotation_about({0, 0, 1}, kPi / 4)};
    EXPECT_NEAR(overlap_depth(*make_round(Capsule{0.1f, 2.0f}, slant), cube),
                0.1 / std::sqrt(2.0) + static_cast<double>(0.1f), kRounding);
}

TEST(OverlapDepth, OfARoundAndAHullIsThatOfDenselySampledTranslations) {
    // The depth is the least distance by which a translation parts them: no direction may need less, and one needs just
    // that.
    Random random(20264);
    for (int i = 0; i < 60; ++i) {
        const Shape shape = draw_polytope(random);
        const Polytope p = *make_polytope(shape, draw_pose(random, 0.2));
        oracle::Round rod = *make_round(Capsule{0.3f, 0.4f}, draw_pose(random, 0.4));
        const double depth = overlap_depth(rod, p);
        if (depth == 0.0) continue;
        for (int k = 0; k < 200; ++k) {
            dvec3 way = draw_vector(random, 1.0);
            way *= (depth * 0.999) / glm::length(way);
            oracle::Round moved = rod;
            moved.a += way;
            moved.b += way;
            ASSERT_GT(overlap_depth(moved, p), 0.0) << i;
        }
    }
}

TEST(ClosestOnTriangle, IsNeverBeatenBySamples) {
    Random random(20265);
    for (int i = 0; i < 2000; ++i) {
        const dvec3 a = draw_vector(random, 1.0), b = draw_vector(random, 1.0), c = draw_vector(random, 1.0);
        const dvec3 p = draw_vector(random, 1.5);
        const double distance = glm::distance(p, oracle::closest_on_triangle(p, a, b, c));
        double best = std::numeric_limits<double>::infinity();
        for (int u = 0; u <= 20; ++u) {
            for (int v = 0; u + v <= 20; ++v) {
                best = std::min(best, glm::distance(p, a + (b - a) * (u / 20.0) + (c - a) * (v / 20.0)));
            }
        }
        ASSERT_LE(distance, best + kRounding) << i;
        ASSERT_GE(distance, best - (glm::distance(a, b) + glm::distance(a, c)) / 20.0) << i;
    }
}

TEST(GeometricPenetration, OfABuiltWorldIsKnown) {
    World world;
    const auto add = [&](BodyType type, const dvec3& at, Shape shape) {
        const BodyId body = world.create_body({.type = type, .position = at});
        world.add_shape(body, std::move(shape));
        return body;
    };
    add(BodyType::Static, {0.0, -0.5, 0.0}, Box{{10.0f, 0.5f, 10.0f}});
    add(BodyType::Static, {0.0, -0.4, 0.0}, Box{{10.0f, 0.5f, 10.0f}});  // static in static: does not count
    add(BodyType::Dynamic, {-3.0, 0.48, 0.0}, Box{vec3{0.5f}});          // 0.02 and 0.12 in the two grounds
    add(BodyType::Dynamic, {3.0, 0.45, 0.0}, Sphere{0.5f});              // 0.05 and 0.15
    Penetration p = geometric_penetration(world);
    EXPECT_EQ(p.polytopes.pairs, 2u);
    EXPECT_NEAR(p.polytopes.maximum, 0.12, kRounding);
    EXPECT_NEAR(p.polytopes.mean, 0.07, kRounding);
    EXPECT_EQ(p.round.pairs, 2u);
    EXPECT_NEAR(p.round.maximum, 0.15, kRounding);
    EXPECT_EQ(p.terrain.pairs, 0u);
    p = geometric_penetration(world, {.polytopes = false, .round = false, .terrain = false});
    EXPECT_EQ(p.polytopes.pairs + p.round.pairs + p.terrain.pairs, 0u);
}

TEST(GeometricPenetration, LeavesOutWhatDoesNotMeet) {
    World world;
    for (int i = 0; i < 2; ++i) {
        const BodyId body = world.create_body();
        world.add_shape(body, Box{}, {.layer = 1, .mask = 2});
        world.add_shape(body, Box{}, {.layer = 1, .mask = 2});  // two shapes of one body overlap as they like
    }
    EXPECT_EQ(geometric_penetration(world).polytopes.pairs, 0u);
}

TEST(GeometricPenetration, FindsEveryPairThatAllPairsFind) {
    const scenes::SceneRun run = scene("pile_mixed", {.bodies = 300});
    World world(WorldDef{});
    Random random(20266);
    std::vector<std::pair<Shape, Pose>> placed;
    for (const BodyId body : dynamic_bodies(run.world)) {
        const Pose pose = draw_pose(random, 2.5);
        const BodyId id = world.create_body({.position = pose.position, .orientation = pose.orientation});
        world.add_shape(id, first_shape(run.world, body));
        placed.emplace_back(first_shape(run.world, body), world.shape_pose(world.shapes(id)[0]));
    }
    std::size_t polytopes = 0, round = 0;
    double deepest = 0.0, sum = 0.0, deepest_round = 0.0;
    for (std::size_t i = 0; i < placed.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const auto p = make_polytope(placed[i].first, placed[i].second),
                       q = make_polytope(placed[j].first, placed[j].second);
            const auto r = make_round(placed[i].first, placed[i].second),
                       s = make_round(placed[j].first, placed[j].second);
            const double depth =
                p && q ? overlap_depth(*p, *q)
                       : (r && s ? overlap_depth(*r, *s) : (r ? overlap_depth(*r, *q) : overlap_depth(*s, *p)));
            if (depth == 0.0) continue;
            if (p && q) {
                ++polytopes;
                sum += depth;
                deepest = std::max(deepest, depth);
            } else {
                ++round;
                deepest_round = std::max(deepest_round, depth);
            }
        }
    }
    const Penetration found = geometric_penetration(world);
    EXPECT_EQ(found.polytopes.pairs, polytopes);
    EXPECT_EQ(found.round.pairs, round);
    EXPECT_GT(polytopes, 100u);
    EXPECT_NEAR(found.polytopes.maximum, deepest, kRounding);
    EXPECT_NEAR(found.polytopes.mean, sum / static_cast<double>(polytopes), kRounding);
    EXPECT_NEAR(found.round.maximum, deepest_round, kRounding);
}

TEST(GeometricPenetration, OfTerrainIsTheDepthBehindTheSurface) {
    // A wedge roof: the ridge along z at height 1, both slopes at 45°.
    const std::array<vec3, 6> vertices{vec3{-5, -4, -5}, vec3{-5, -4, 5}, vec3{0, 1, -5},
                                       vec3{0, 1, 5},    vec3{5, -4, -5}, vec3{5, -4, 5}};
    const std::array<TriangleMesh::Triangle, 4> triangles{{{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}}};
    World world;
    const BodyId roof = world.create_body({.type = BodyType::Static, .position = {0.0, 10.0, 0.0}});
    world.add_shape(roof, *TriangleMesh::build(vertices, triangles));
    const BodyId floor = world.create_body({.type = BodyType::Static});
    world.add_shape(floor, Plane{{0.0f, 1.0f, 0.0f}, 0.25f});
    const auto add = [&](const dvec3& at, Shape shape) {
        world.add_shape(world.create_body({.position = at}), std::move(shape));
    };

    add({2.0, 0.5, 0.0}, Box{vec3{0.5f}});  // 0.25 under the plane
    EXPECT_NEAR(geometric_penetration(world).terrain.maximum, 0.25, kRounding);
    add({0.0, 11.3, 0.0}, Sphere{0.5f});  // 0.3 over the ridge: 0.2 deep
    const oracle::PenetrationSummary two = geometric_penetration(world).terrain;
    EXPECT_EQ(two.pairs, 2u);
    EXPECT_NEAR(two.maximum, 0.25, kRounding);
    EXPECT_NEAR(two.mean, 0.225, kRounding);
    add({0.0, 10.8, 0.0}, Sphere{0.5f});  // centre 0.2 under the ridge: the slopes are 0.2 / sqrt 2 away
    EXPECT_NEAR(geometric_penetration(world).terrain.maximum, 0.5 + 0.2 / std::sqrt(2.0), 1e-9);
    // A capsule on the slope, lying along it, 0.1 too deep.
    const dvec3 outward = glm::normalize(dvec3{1.0, 1.0, 0.0});
    const dvec3 on_slope{2.0, 9.0, 0.0};
    const BodyId rod =
        world.create_body({.position = on_slope + outward * 0.9, .orientation = rotation_about({0, 0, 1}, kPi / 4)});
    world.add_shape(rod, Capsule{1.0f, 0.5f});
    EXPECT_EQ(geometric_penetration(world).terrain.pairs, 4u);
}

TEST(GeometricPenetration, KnowsOutsideFromInsideAtASharpRidge) {
    // Slopes of 5 : 1. The ball's centre is over the ridge, yet behind the plane of the left slope.
    const std::array<vec3, 6> vertices{vec3{-1, -5, -5}, vec3{-1, -5, 5}, vec3{0, 0, -5},
                                       vec3{0, 0, 5},    vec3{1, -5, -5}, vec3{1, -5, 5}};
    for (const bool left_first : {true, false}) {
        std::vector<TriangleMesh::Triangle> triangles{{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}};
        if (!left_first) std::ranges::reverse(triangles);
        World world;
        const BodyId ridge = world.create_body({.type = BodyType::Static});
        world.add_shape(ridge, *TriangleMesh::build(vertices, triangles));
        world.add_shape(world.create_body({.position = {0.1, 0.3, 0.0}}), Sphere{0.5f});
        EXPECT_NEAR(geometric_penetration(world).terrain.maximum, 0.5 - std::sqrt(0.1), 1e-9);
    }
}

TEST(GeometricPenetration, WhatPassesThroughAOneSidedMeshFromBehindIsNotInIt) {
    const std::array<vec3, 4> vertices{vec3{-5, 0, -5}, vec3{-5, 0, 5}, vec3{5, 0, 5}, vec3{5, 0, -5}};
    const std::array<TriangleMesh::Triangle, 2> triangles{{{0, 1, 2}, {0, 2, 3}}};
    for (const bool one_sided : {true, false}) {
        World world;
        const BodyId sheet = world.create_body({.type = BodyType::Static});
        world.add_shape(sheet, *TriangleMesh::build(vertices, triangles, {.one_sided = one_sided}));
        world.add_shape(world.create_body({.position = {1.0, -0.2, 0.0}}), Box{vec3{0.5f}});
        EXPECT_EQ(geometric_penetration(world).terrain.pairs, one_sided ? 0u : 1u);
        world.add_shape(world.create_body({.position = {-1.0, 0.4, 0.0}}), Box{vec3{0.5f}});
        EXPECT_NEAR(geometric_penetration(world).terrain.maximum, one_sided ? 0.1 : 0.7, 1e-6);
    }
}

TEST(GeometricPenetration, TakesWellUnderASecondForSixteenThousandBodies) {
    const scenes::SceneRun run = scene("pile_mixed", {.bodies = 16000});
    const std::clock_t start = std::clock();  // of this process, however busy the machine is
    static_cast<void>(geometric_penetration(run.world));
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    // About 0.1 s optimised; an unoptimised build with sanitizers is some thirty times slower.
    EXPECT_LT(seconds, 5.0);
}

}  // namespace
}  // namespace carom::test
