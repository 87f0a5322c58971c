// ConvexHull against Qhull, and its invariants on the inputs that break hull builders.
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/detail/orientation.hpp>
#include <carom/core/pose.hpp>
#include <carom/core/random.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <vector>

namespace carom {
namespace {

using Points = std::vector<vec3>;

// ---- what a hull must be ---------------------------------------------------------------------------------------------

double extent_of(std::span<const vec3> points) {
    dvec3 lower{points[0]};
    dvec3 upper{points[0]};
    for (const vec3& p : points) {
        lower = glm::min(lower, dvec3{p});
        upper = glm::max(upper, dvec3{p});
    }
    return std::max({upper.x - lower.x, upper.y - lower.y, upper.z - lower.z});
}

std::vector<dvec3> polygon(const ConvexHull& hull, const ConvexHull::Face& face) {
    std::vector<dvec3> corners;
    std::uint32_t edge = face.first_edge;
    do {
        corners.emplace_back(hull.vertices()[hull.edges()[edge].origin]);
        edge = hull.edges()[edge].next;
    } while (edge != face.first_edge && corners.size() <= hull.edges().size());
    return corners;
}

/// Everything that the header promises. `slack` is in units of the largest extent.
void expect_invariants(const ConvexHull& hull, std::span<const vec3> points, double slack = 1e-5) {
    const double extent = extent_of(points);
    const auto edges = hull.edges();
    ASSERT_EQ(hull.vertices().size() + hull.faces().size(), edges.size() / 2 + 2) << "Euler's formula";
    std::vector<int> degree(hull.vertices().size(), 0);
    std::vector<std::uint32_t> counted(hull.faces().size(), 0);
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
        ++degree[edges[e].origin];
        ++counted[edges[e].face];
        ASSERT_EQ(edges[edges[e].next].origin, edges[ConvexHull::twin(e)].origin);
        ASSERT_EQ(edges[edges[e].next].face, edges[e].face);
        ASSERT_NE(edges[e].face, edges[ConvexHull::twin(e)].face);
    }
    for (const int d : degree) EXPECT_GE(d, 3);
    for (std::size_t f = 0; f < hull.faces().size(); ++f) {
        const ConvexHull::Face& face = hull.faces()[f];
        EXPECT_NEAR(glm::length(face.normal), 1.0, 1e-15);
        const std::vector<dvec3> corners = polygon(hull, face);
        const std::size_t n = corners.size();
        ASSERT_EQ(n, face.edge_count);
        ASSERT_EQ(n, counted[f]);
        ASSERT_GE(n, 3u);
        for (std::size_t i = 0; i < n; ++i) {
            const dvec3 a = corners[i];
            const dvec3 b = corners[(i + 1) % n];
            const dvec3 c = corners[(i + 2) % n];
            EXPECT_GT(glm::dot(glm::cross(b - a, c - b), face.normal), 0.0) << "face " << f << " is not convex at " << i;
            EXPECT_GE(glm::dot(face.normal, a) - face.offset, -slack * extent);
        }
        double farthest = 0.0;
        for (const vec3& v : hull.vertices()) farthest = std::max(farthest, glm::length(dvec3{v}));
        for (const vec3& v : hull.vertices()) {
            EXPECT_LE(glm::dot(face.normal, dvec3{v}) - face.offset, 1e-14 * extent + 1e-15 * farthest) << "face " << f;
        }
        for (const vec3& p : points) EXPECT_LE(glm::dot(face.normal, dvec3{p}) - face.offset, slack * extent);
    }
    for (std::uint32_t e = 0; e < edges.size(); e += 2) {
        const dvec3 along = dvec3{hull.vertices()[edges[e + 1].origin]} - dvec3{hull.vertices()[edges[e].origin]};
        const dvec3 turn = glm::cross(hull.faces()[edges[e].face].normal, hull.faces()[edges[e + 1].face].normal);
        EXPECT_GT(glm::dot(turn, along), 0.0) << "edge " << e << " is not convex";
    }
}

double volume(const ConvexHull& hull) {
    const dvec3 origin{hull.vertices()[0]};
    double six = 0.0;
    for (const ConvexHull::Face& face : hull.faces()) {
        const std::vector<dvec3> corners = polygon(hull, face);
        for (std::size_t i = 2; i < corners.size(); ++i) {
            six += glm::dot(corners[0] - origin, glm::cross(corners[i - 1] - origin, corners[i] - origin));
        }
    }
    return six / 6.0;
}

dvec3 random_direction(Random& random) {
    for (;;) {
        const dvec3 v{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
        const double square = glm::dot(v, v);
        if (square > 0.01 && square <= 1.0) return v / std::sqrt(square);
    }
}

/// The farthest any of the points is along a direction.
double support_value(std::span<const vec3> points, const dvec3& direction) {
    double best = -std::numeric_limits<double>::infinity();
    for (const vec3& p : points) best = std::max(best, glm::dot(dvec3{p}, direction));
    return best;
}

void expect_same_support(const ConvexHull& hull, std::span<const vec3> points, double slack = 1e-5) {
    Random random(424242);
    const double extent = extent_of(points);
    for (int k = 0; k < 200; ++k) {
        const dvec3 direction = random_direction(random);
        const double ours = glm::dot(dvec3{hull.vertices()[hull.support(direction)]}, direction);
        EXPECT_NEAR(ours, support_value(points, direction), slack * extent);
    }
}

ConvexHullPtr expect_hull(std::span<const vec3> points) {
    Result<ConvexHullPtr> hull = ConvexHull::build(points);
    if (!hull) {
        ADD_FAILURE() << hull.error().message;
        return nullptr;
    }
    expect_invariants(**hull, points);
    expect_same_support(**hull, points);
    return *hull;
}

// ---- Qhull as the oracle ---------------------------------------------------------------------------------------------

struct QhullAnswer {
    double volume = 0.0;
    std::set<std::size_t> vertices;
};

/// Qhull with its default merging ("" options). @return nothing useful (volume 0) where it refuses.
QhullAnswer ask_qhull(std::span<const vec3> points) {
    std::vector<double> coordinates;
    for (const vec3& p : points) {
        for (int axis = 0; axis < 3; ++axis) coordinates.push_back(static_cast<double>(p[axis]));
    }
    qhT memory;
    qhT* qh = &memory;
    qh_zero(qh, nullptr);
    char command[] = "qhull Pp";
    QhullAnswer answer;
    const int refused = qh_new_qhull(qh, 3, static_cast<int>(points.size()), coordinates.data(), False, command, nullptr, nullptr);
    if (refused == 0) {
        qh_getarea(qh, qh->facet_list);
        answer.volume = qh->totvol;
        for (vertexT* vertex = qh->vertex_list; vertex != nullptr && vertex->next != nullptr; vertex = vertex->next) {
            answer.vertices.insert(static_cast<std::size_t>(qh_pointid(qh, vertex->point)));
        }
    }
    qh_freeqhull(qh, !qh_ALL);
    int left = 0;
    int left_bytes = 0;
    qh_memfreeshort(qh, &left, &left_bytes);
    return answer;
}

std::set<std::size_t> vertex_indices(const ConvexHull& hull, std::span<const vec3> points) {
    std::set<std::size_t> indices;
    for (const vec3& v : hull.vertices()) {
        indices.insert(static_cast<std::size_t>(std::find(points.begin(), points.end(), v) - points.begin()));
    }
    return indices;
}

// ---- inputs ----------------------------------------------------------------------------------------------------------

vec3 to_float(const dvec3& p) { return vec3{p}; }

/// Points in the ball, or on the sphere.
Points cloud(std::uint64_t seed, int count, bool on_sphere = false) {
    Random random(seed);
    Points points;
    for (int i = 0; i < count; ++i) {
        const dvec3 d = random_direction(random);
        points.push_back(to_float(on_sphere ? d : d * random.unit()));
    }
    return points;
}

/// The hulls that the mixed pile scatters: 12 points of one length.
Points stone(Random& random) {
    Points points;
    const double radius = random.range(0.35, 0.5);
    while (points.size() < 12) {
        const dvec3 p{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
        const double length = glm::length(p);
        if (length <= 1.0 && length >= 0.1) points.push_back(to_float(p / length * radius));
    }
    return points;
}

/// A grid of n × n points on each side of a box.
Points box_grid(const dvec3& half, int n) {
    Points points;
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = -1; side <= 1; side += 2) {
            for (int i = 0; i < n; ++i) {
                for (int j = 0; j < n; ++j) {
                    dvec3 p{0.0};
                    p[axis] = side;
                    p[(axis + 1) % 3] = -1.0 + 2.0 * i / (n - 1);
                    p[(axis + 2) % 3] = -1.0 + 2.0 * j / (n - 1);
                    points.push_back(to_float(p * half));
                }
            }
        }
    }
    return points;
}

Points prism(int sides, double radius, double height) {
    Points points;
    for (int i = 0; i < sides; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / sides;
        const double s = std::sin(angle);
        const double c = std::cos(angle);
        points.push_back(to_float({radius * c, -0.5 * height, radius * s}));
        points.push_back(to_float({radius * c, 0.5 * height, radius * s}));
    }
    return points;
}

/// An icosahedron's faces cut in frequency² triangles and blown up to the unit sphere.
Points geodesic(int frequency) {
    const double g = 0.5 * (1.0 + std::sqrt(5.0));
    std::vector<dvec3> corners;
    for (const double a : {-1.0, 1.0}) {
        for (const double b : {-g, g}) {
            corners.push_back({0.0, a, b});
            corners.push_back({a, b, 0.0});
            corners.push_back({b, 0.0, a});
        }
    }
    Points points;
    for (std::size_t i = 0; i < 12; ++i) {
        for (std::size_t j = i + 1; j < 12; ++j) {
            for (std::size_t k = j + 1; k < 12; ++k) {
                if (glm::distance(corners[i], corners[j]) > 2.1 || glm::distance(corners[j], corners[k]) > 2.1 ||
                    glm::distance(corners[i], corners[k]) > 2.1) {
                    continue;
                }
                for (int u = 0; u <= frequency; ++u) {
                    for (int v = 0; u + v <= frequency; ++v) {
                        const dvec3 p = corners[i] * double(u) + corners[j] * double(v) + corners[k] * double(frequency - u - v);
                        points.push_back(to_float(glm::normalize(p)));
                    }
                }
            }
        }
    }
    return points;
}

Points moved(const Points& points, const dvec3& scale, const dquat& turn, const dvec3& shift) {
    Points result;
    for (const vec3& p : points) result.push_back(to_float(shift + rotate(turn, scale * dvec3{p})));
    return result;
}

dquat some_rotation(Random& random) {
    const dvec3 axis = random_direction(random) * random.range(0.3, 3.0);
    return glm::normalize(dquat{1.0, axis.x, axis.y, axis.z});
}

// ---- tests -----------------------------------------------------------------------------------------------------------

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

TEST(Orientation, ExactWhereDoublesAreNot) {
    // A point moved off a slanted plane by one unit of the last place of a float.
    const dvec3 u{0.5f, 0.25f, -0.125f};
    const dvec3 v{-0.25f, 0.5f, 0.375f};
    const dvec3 origin{0.25, 0.5, 0.125};
    const dvec3 d = origin + u + v;
    EXPECT_EQ(detail::orientation(origin, origin + u, origin + v, d), 0);
    const dvec3 n = glm::cross(u, v);
    for (int axis = 0; axis < 3; ++axis) {
        for (const float towards : {-10.0f, 10.0f}) {
            dvec3 moved_point = d;
            moved_point[axis] = static_cast<double>(std::nextafter(static_cast<float>(d[axis]), towards));
            const double side = (moved_point[axis] - d[axis]) * n[axis];
            EXPECT_EQ(detail::orientation(origin, origin + u, origin + v, moved_point), side > 0.0 ? 1 : -1);
        }
    }
    // The determinant is far below what the sum of products in double can resolve.
    const double big = 0x1p60;
    const double tiny = 0x1p-60;
    EXPECT_EQ(detail::orientation({big, big, big}, {-big, -big, -big}, {big, -big, 0.0}, {0.0, 0.0, 0.0}), 0);
    EXPECT_EQ(detail::orientation({big, big, big}, {-big, -big, -big}, {big, -big, 0.0}, {0.0, 0.0, tiny}),
              -detail::orientation({big, big, big}, {-big, -big, -big}, {big, -big, 0.0}, {0.0, 0.0, -tiny}));
    EXPECT_NE(detail::orientation({big, big, big}, {-big, -big, -big}, {big, -big, 0.0}, {0.0, 0.0, tiny}), 0);
}

}  // namespace
}  // namespace carom
