// ConvexHull against Qhull, and its invariants on the inputs that break hull builders.
#include "hull_inputs.hpp"
#include "hull_oracle.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

namespace carom {
namespace {

using namespace test;

TEST(ConvexHull, BoxOfEightAndInteriorPoints) {
    Points points = box_grid({0.5, 1.0, 2.0}, 2);  // each corner three times
    for (const vec3& p : cloud(11, 500)) points.push_back(0.45f * p);
    const ConvexHullPtr hull = expect_hull(points);
    ASSERT_TRUE(hull);
    EXPECT_EQ(hull->vertices().size(), 8u);
    ASSERT_EQ(hull->faces().size(), 6u);
    EXPECT_EQ(hull->edges().size(), 24u);
    for (const ConvexHull::Face& face : hull->faces()) EXPECT_EQ(face.edge_count, 4u);
    EXPECT_EQ(volume(*hull), 8.0);
}

TEST(ConvexHull, GridsOnTheSidesOfABoxLeaveEightCorners) {
    Random random(12);
    const Points grid = box_grid({0.5, 1.0, 2.0}, 17);
    for (int k = 0; k < 20; ++k) {
        const dquat turn = k == 0 ? kIdentityRotation : some_rotation(random);
        const ConvexHullPtr hull = expect_hull(moved(grid, dvec3{1.0}, turn, dvec3{0.0}));
        ASSERT_TRUE(hull);
        EXPECT_EQ(hull->vertices().size(), 8u) << k;
        EXPECT_EQ(hull->faces().size(), 6u) << k;
        EXPECT_NEAR(volume(*hull), 8.0, 1e-4);
    }
}

TEST(ConvexHull, Tetrahedron) {
    const ConvexHullPtr hull = expect_hull(Points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    ASSERT_TRUE(hull);
    EXPECT_EQ(hull->faces().size(), 4u);
    EXPECT_EQ(volume(*hull), 1.0 / 6.0);
}

TEST(ConvexHull, PrismsHaveTwoPolygonsAndQuadrilaterals) {
    Random random(13);
    for (const int sides : {3, 4, 5, 6, 8, 12, 32, 100}) {
        const Points points = moved(prism(sides, 1.0, 0.5), dvec3{1.0}, some_rotation(random), dvec3{0.0});
        const ConvexHullPtr hull = expect_hull(points);
        ASSERT_TRUE(hull);
        const auto n = static_cast<std::uint32_t>(sides);
        EXPECT_EQ(hull->vertices().size(), 2 * n);
        ASSERT_EQ(hull->faces().size(), n + 2);
        const auto polygons = std::count_if(hull->faces().begin(), hull->faces().end(),
                                            [&](const auto& face) { return face.edge_count == n; });
        EXPECT_EQ(polygons, n == 4 ? 6 : 2);
    }
}

TEST(ConvexHull, GeodesicSpheresKeepEveryPoint) {
    for (const int frequency : {1, 2, 5, 16}) {
        const Points points = geodesic(frequency);
        const ConvexHullPtr hull = expect_hull(points);
        ASSERT_TRUE(hull);
        EXPECT_EQ(hull->vertices().size(), static_cast<std::size_t>(10 * frequency * frequency + 2));
        EXPECT_EQ(hull->faces().size(), static_cast<std::size_t>(20 * frequency * frequency));
    }
}

TEST(ConvexHull, SpheresOfLatitudeKeepTheirQuadrilaterals) {
    // The sine of pi is not zero in double, so each pole is a crowd of points some 1e-16 apart.
    Random random(22);
    for (const int n : {8, 20, 50}) {
        Points points;
        for (int i = 0; i <= n; ++i) {
            for (int j = 0; j < n; ++j) {
                const double down = std::numbers::pi * i / n;
                const double round = 2.0 * std::numbers::pi * j / n;
                points.push_back(to_float({std::sin(down) * std::cos(round), std::cos(down), std::sin(down) * std::sin(round)}));
            }
        }
        for (const dquat& turn : {kIdentityRotation, some_rotation(random)}) {
            const ConvexHullPtr hull = expect_hull(moved(points, dvec3{1.0}, turn, dvec3{0.0}));
            ASSERT_TRUE(hull);
            EXPECT_EQ(hull->vertices().size(), static_cast<std::size_t>(n * (n - 1) + 2));
            EXPECT_EQ(hull->faces().size(), static_cast<std::size_t>(n * n));
        }
    }
}

TEST(ConvexHull, CloudsAgreeWithQhull) {
    for (std::uint64_t seed = 100; seed < 160; ++seed) {
        const int count = 4 + static_cast<int>(seed % 10) * static_cast<int>(seed % 10) * 5;
        const Points points = cloud(seed, count, seed % 2 == 0);
        const ConvexHullPtr hull = expect_hull(points);
        ASSERT_TRUE(hull);
        const QhullAnswer qhull = ask_qhull(points);
        EXPECT_NEAR(volume(*hull), qhull.volume, 1e-12) << "seed " << seed;
        EXPECT_EQ(vertex_indices(*hull, points), qhull.vertices) << "seed " << seed;
    }
}

TEST(ConvexHull, StonesOfTwelvePointsAgreeWithQhull) {
    Random random(777);
    for (int k = 0; k < 300; ++k) {
        const Points points = stone(random);
        const ConvexHullPtr hull = expect_hull(points);
        ASSERT_TRUE(hull);
        EXPECT_EQ(hull->vertices().size(), 12u);
        EXPECT_NEAR(volume(*hull), ask_qhull(points).volume, 1e-6 * volume(*hull));
    }
}

TEST(ConvexHull, LatticesAgreeWithQhull) {
    // Small integers: many exactly coplanar, collinear and repeated points, so vertex sets are exact.
    Random random(14);
    for (int k = 0; k < 200; ++k) {
        Points points;
        const double range = 1.0 + k % 4;
        for (int i = 0; i < 4 + k; ++i) {
            points.push_back({std::floor(random.range(0, range + 1)), std::floor(random.range(0, range + 1)),
                              std::floor(random.range(0, range + 1))});
        }
        const Result<ConvexHullPtr> hull = ConvexHull::build(points);
        const QhullAnswer qhull = ask_qhull(points);
        ASSERT_EQ(hull.has_value(), qhull.volume > 0.0) << k;
        if (!hull) continue;
        expect_invariants(**hull, points, 1e-14);
        expect_same_support(**hull, points, 1e-14);
        EXPECT_NEAR(volume(**hull), qhull.volume, 1e-10) << k;
    }
}

TEST(ConvexHull, ScalesOffsetsAndNeedles) {
    Random random(15);
    const std::vector<Points> bodies = {box_grid(dvec3{1.0}, 5), prism(7, 1.0, 2.0), geodesic(3), cloud(16, 60), cloud(17, 200, true)};
    for (const double size : {1e-30, 1e-4, 1e-2, 1.0, 1e5, 1e30}) {
        for (const dvec3& stretch : {dvec3{1.0}, dvec3{1.0, 1.0, 1e-4}, dvec3{1e-4, 1.0, 1e-4}, dvec3{1.0, 3e-6, 1.0}}) {
            for (const double away : {0.0, 1.0, 300.0}) {
                for (const Points& body : bodies) {
                    const dvec3 shift = random_direction(random) * away * size;
                    const Points points = moved(body, stretch * size, some_rotation(random), shift);
                    const Result<ConvexHullPtr> hull = ConvexHull::build(points);
                    if (!hull) {
                        // Far away, the rounding of the points can flatten what is thin: the error must be typed.
                        EXPECT_EQ(hull.error().code, ErrorCode::Degenerate);
                        EXPECT_TRUE(away > 0.0 && stretch.y < 1e-5) << size << " " << away;
                        continue;
                    }
                    expect_invariants(**hull, points);
                    expect_same_support(**hull, points);
                }
            }
        }
    }
}

TEST(ConvexHull, PointsThatAreNearlyCoplanarEverywhere) {
    // Faces bumpy by amounts round the tolerance of merging.
    Random random(18);
    for (int k = 0; k < 300; ++k) {
        const double noise = std::ldexp(1e-9, k % 20);
        Points points = k % 3 == 0 ? box_grid({0.5, 1.0, 0.7}, 6) : k % 3 == 1 ? prism(24, 1.0, 0.3) : geodesic(2);
        const dquat turn = some_rotation(random);
        for (vec3& p : points) {
            const dvec3 shaken = dvec3{p} + noise * dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
            p = to_float(rotate(turn, shaken));
        }
        expect_hull(points);
    }
}

TEST(ConvexHull, ShallowDomesAndTightClusters) {
    Random random(19);
    for (int k = 0; k < 200; ++k) {
        Points points;
        const double depth = std::ldexp(1.0, -(k % 24));
        for (int i = 0; i < 60; ++i) {
            const double x = random.range(-1, 1);
            const double y = random.range(-1, 1);
            points.push_back(to_float({x, y, depth * (1.0 - 0.5 * (x * x + y * y))}));
        }
        points.push_back({0.0f, 0.0f, -0.01f});
        for (int i = 0; i < 40; ++i) {  // crowds round three corners
            const dvec3 corner{i % 3 == 0 ? 1.0 : -1.0, i % 3 == 1 ? 1.0 : -1.0, 0.0};
            points.push_back(to_float(corner + depth * 1e-2 * random_direction(random)));
        }
        expect_hull(points);
    }
}

TEST(ConvexHull, NoDependenceOnDuplicatesOrOrder) {
    const Points points = cloud(20, 80);
    Points other(points.rbegin(), points.rend());
    other.insert(other.end(), points.begin(), points.end());
    const ConvexHullPtr a = expect_hull(points);
    const ConvexHullPtr b = expect_hull(other);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(vertex_indices(*a, points), vertex_indices(*b, points));
    EXPECT_NEAR(volume(*a), volume(*b), 1e-15);
}

TEST(ConvexHull, SameInputSameBits) {
    const Points points = cloud(21, 300);
    const ConvexHullPtr a = expect_hull(points);
    const ConvexHullPtr b = expect_hull(points);
    ASSERT_TRUE(a && b);
    EXPECT_TRUE(std::equal(a->vertices().begin(), a->vertices().end(), b->vertices().begin(), b->vertices().end()));
    EXPECT_TRUE(std::equal(a->faces().begin(), a->faces().end(), b->faces().begin(), b->faces().end(),
                           [](const auto& f, const auto& g) { return f.normal == g.normal && f.offset == g.offset; }));
}

TEST(ConvexHull, SupportTiesGoToTheLowestIndex) {
    const ConvexHullPtr hull = expect_hull(box_grid(dvec3{1.0}, 2));
    ASSERT_TRUE(hull);
    const std::uint32_t best = hull->support({0.0, 1e-3, 0.0});
    for (std::uint32_t i = 0; i < best; ++i) EXPECT_LT(hull->vertices()[i].y, 1.0f);
    EXPECT_EQ(hull->vertices()[best].y, 1.0f);
}

TEST(ConvexHull, BadInputIsNamed) {
    const auto code = [](const Points& points) {
        const Result<ConvexHullPtr> hull = ConvexHull::build(points);
        return hull ? ErrorCode::Io : hull.error().code;
    };
    const float inf = std::numeric_limits<float>::infinity();
    EXPECT_EQ(code({}), ErrorCode::Empty);
    EXPECT_EQ(code({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), ErrorCode::Empty);
    EXPECT_EQ(code({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, inf}}), ErrorCode::NotFinite);
    EXPECT_EQ(code({{0, 0, 0}, {1, 0, 0}, {0, std::nanf(""), 0}, {0, 0, 1}}), ErrorCode::NotFinite);
    EXPECT_EQ(code(Points(9, vec3{3.0f, 2.0f, 1.0f})), ErrorCode::Degenerate);
    EXPECT_EQ(code({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}), ErrorCode::Degenerate);
    EXPECT_EQ(code({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}, {0.3f, 0.2f, 1}}), ErrorCode::Degenerate);
    EXPECT_EQ(code({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 5e-7f}}), ErrorCode::Degenerate);
    EXPECT_EQ(code({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 5e-6f}}), ErrorCode::Io);  // thin, but a hull
}

}  // namespace
}  // namespace carom
