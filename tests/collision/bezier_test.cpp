// Bézier patches: evaluation against the Bernstein form, normals at poles, and the distance between triangles and surface.
#include <carom/collision/bezier.hpp>
#include <carom/collision/detail/patch_grid.hpp>
#include <carom/core/check.hpp>
#include <carom/core/random.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace carom {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

BezierPatch random_patch(Random& random) {
    BezierPatch patch;
    for (std::size_t k = 0; k < 16; ++k) {
        patch.points[k] = {static_cast<double>(k % 4) + random.range(-0.6, 0.6), random.range(-0.6, 0.6),
                           -static_cast<double>(k / 4) + random.range(-0.6, 0.6)};
    }
    return patch;
}

std::array<double, 4> bernstein(double t) {
    const double s = 1.0 - t;
    return {s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t};
}

dvec3 oracle(const BezierPatch& patch, double u, double v) {
    const auto bu = bernstein(u), bv = bernstein(v);
    dvec3 sum{0.0};
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            sum += bv[i] * bu[j] * patch.points[4 * i + j];
        }
    }
    return sum;
}

// The distance from p to a triangle, by the projection inside or the nearest of the three edges.
double distance(const dvec3& p, const std::array<dvec3, 3>& t) {
    double best = kInfinity;
    for (std::size_t k = 0; k < 3; ++k) {
        const dvec3 a = t[k], ab = t[(k + 1) % 3] - a;
        const double length_sq = glm::dot(ab, ab);
        const double s = length_sq > 0.0 ? std::clamp(glm::dot(p - a, ab) / length_sq, 0.0, 1.0) : 0.0;
        best = std::min(best, glm::length(p - (a + s * ab)));
    }
    const dvec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
    bool inside = glm::dot(n, n) > 0.0;
    for (std::size_t k = 0; k < 3 && inside; ++k) {
        inside = glm::dot(glm::cross(t[(k + 1) % 3] - t[k], p - t[k]), n) >= 0.0;
    }
    return inside ? std::min(best, std::abs(glm::dot(p - t[0], n)) / glm::length(n)) : best;
}

double distance(const dvec3& p, const MeshData& mesh) {
    double best = kInfinity;
    for (const auto& t : mesh.triangles) {
        best = std::min(best, distance(p, {dvec3(mesh.vertices[t[0]]), dvec3(mesh.vertices[t[1]]), dvec3(mesh.vertices[t[2]])}));
    }
    return best;
}

// How far the surface's samples are from the triangles, at worst.
double worst_distance(const BezierPatch& patch, const MeshData& mesh, int samples) {
    double worst = 0.0;
    for (int i = 0; i <= samples; ++i) {
        for (int j = 0; j <= samples; ++j) {
            worst = std::max(worst, distance(oracle(patch, double(j) / samples, double(i) / samples), mesh));
        }
    }
    return worst;
}

// Directed edges that no triangle runs along the other way, and a check that none is used twice in one direction.
std::size_t open_edges(const MeshData& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(++edges[std::pair(t[k], t[(k + 1) % 3])], 1) << "two triangles run along one edge in one direction";
        }
    }
    return static_cast<std::size_t>(std::count_if(edges.begin(), edges.end(), [&](const auto& edge) {
        return !edges.contains(std::pair(edge.first.second, edge.first.first));
    }));
}

BezierPatch flipped(const BezierPatch& patch, bool u, bool v) {
    BezierPatch out;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            out.points[4 * i + j] = patch.points[4 * (v ? 3 - i : i) + (u ? 3 - j : j)];
        }
    }
    return out;
}

// A quarter of a dome: row 0 is the pole.
BezierPatch dome() {
    constexpr double k = 0.55;
    BezierPatch patch;
    const std::array<dvec3, 4> ring{dvec3{1, 0, 0}, dvec3{1, 0, -k}, dvec3{k, 0, -1}, dvec3{0, 0, -1}};
    for (std::size_t j = 0; j < 4; ++j) {
        patch.points[j] = {0, 1, 0};
        patch.points[4 + j] = k * ring[3 - j] + dvec3{0, 1, 0};
        patch.points[8 + j] = ring[3 - j] + dvec3{0, k, 0};
        patch.points[12 + j] = ring[3 - j];
    }
    return patch;
}

TEST(Bezier, EvaluationIsTheBernsteinSum) {
    Random random(101);
    for (int n = 0; n < 200; ++n) {
        const BezierPatch patch = random_patch(random);
        const double u = random.unit(), v = random.unit(), h = 1e-6;
        const SurfacePoint p = evaluate(patch, u, v);
        // A few roundings of numbers up to 4.
        EXPECT_LT(glm::length(p.position - oracle(patch, u, v)), 1e-14);
        // Central differences: second-order error h^2 and rounding 1e-15 / h.
        if (u > h && u < 1 - h && v > h && v < 1 - h) {
            EXPECT_LT(glm::length(p.along_u - (oracle(patch, u + h, v) - oracle(patch, u - h, v)) / (2 * h)), 1e-7);
            EXPECT_LT(glm::length(p.along_v - (oracle(patch, u, v + h) - oracle(patch, u, v - h)) / (2 * h)), 1e-7);
        }
        const dvec3 n_expected = glm::normalize(glm::cross(p.along_u, p.along_v));
        EXPECT_LT(glm::length(p.normal - n_expected), 1e-9);
    }
}

TEST(Bezier, CornersAreControlPoints) {
    Random random(102);
    const BezierPatch patch = random_patch(random);
    EXPECT_EQ(evaluate(patch, 0, 0).position, patch.points[0]);
    EXPECT_EQ(evaluate(patch, 1, 0).position, patch.points[3]);
    EXPECT_EQ(evaluate(patch, 0, 1).position, patch.points[12]);
    EXPECT_EQ(evaluate(patch, 1, 1).position, patch.points[15]);
}

TEST(Bezier, NormalAtAPoleIsTheLimit) {
    for (const auto& [flip_u, flip_v] : {std::pair(false, false), {true, false}, {false, true}, {true, true}}) {
        const BezierPatch patch = flipped(dome(), flip_u, flip_v);
        // Turning one parameter round turns the surface inside out.
        const double outward = flip_u == flip_v ? 1.0 : -1.0;
        for (double u : {0.0, 0.25, 0.5, 0.8, 1.0}) {
            const SurfacePoint pole = evaluate(patch, u, flip_v ? 1.0 : 0.0);
            EXPECT_EQ(pole.position, dvec3(0, 1, 0));
            EXPECT_EQ(pole.along_u, dvec3(0, 0, 0));
            EXPECT_LT(glm::length(pole.normal - outward * dvec3(0, 1, 0)), 1e-12) << u;
            // Near the pole the normal turns by the curvature times the distance, both about 1.
            const SurfacePoint near = evaluate(patch, u, flip_v ? 1.0 - 1e-4 : 1e-4);
            EXPECT_LT(glm::length(near.normal - pole.normal), 1e-3);
        }
    }
}

TEST(Bezier, NormalWhereTwoEdgesMeetInALineIsTheLimit) {
    // The first corner's neighbours lie on one line, so the cross product vanishes there but nowhere near it.
    Random random(103);
    BezierPatch patch = random_patch(random);
    patch.points[4] = patch.points[0] + 0.5 * (patch.points[1] - patch.points[0]);
    const SurfacePoint corner = evaluate(patch, 0, 0);
    EXPECT_LT(glm::length(glm::cross(corner.along_u, corner.along_v)), 1e-14);
    const double s = 1e-6;
    EXPECT_LT(glm::length(corner.normal - evaluate(patch, s, s).normal), 1e-4);
    EXPECT_NEAR(glm::length(corner.normal), 1.0, 1e-14);
}

TEST(Bezier, ACurveHasNoNormal) {
    BezierPatch curve;
    for (std::size_t k = 0; k < 16; ++k) {
        curve.points[k] = {double(k % 4), 0.5 * double((k % 4) * (k % 4)), 0};
    }
    EXPECT_EQ(evaluate(curve, 0.3, 0.7).normal, dvec3(0, 0, 0));
    EXPECT_EQ(tessellate(std::span(&curve, 1)).error().code, ErrorCode::Empty);
}

TEST(Bezier, TrianglesStayWithinTheChordError) {
    Random random(104);
    for (double chord_error : {0.3, 0.1, 0.03}) {
        for (int n = 0; n < 4; ++n) {
            BezierPatch patch = random_patch(random);
            if (n % 2 == 1) {
                // Straight edges round a curved inside: the strips have to be thin.
                for (std::size_t side : {0u, 12u}) {
                    patch.points[side + 1] = (2.0 * patch.points[side] + patch.points[side + 3]) / 3.0;
                    patch.points[side + 2] = (patch.points[side] + 2.0 * patch.points[side + 3]) / 3.0;
                }
            }
            const Result<MeshData> mesh = tessellate(std::span(&patch, 1), {.chord_error = chord_error});
            ASSERT_TRUE(mesh) << mesh.error().message;
            // Vertices are rounded to float; coordinates are below 4.
            EXPECT_LT(worst_distance(patch, *mesh, 40), chord_error + 4.0 * 1e-7) << "patch " << n;
        }
    }
}

TEST(Bezier, TrianglesAreCounterClockwiseAboutTheNormal) {
    Random random(105);
    // Gentle enough that no triangle can fold over.
    BezierPatch patch;
    for (std::size_t k = 0; k < 16; ++k) {
        patch.points[k] = {double(k % 4), random.range(-0.3, 0.3), -double(k / 4)};
    }
    const Result<MeshData> mesh = tessellate(std::span(&patch, 1), {.chord_error = 0.003});
    ASSERT_TRUE(mesh);
    for (const auto& t : mesh->triangles) {
        const dvec3 a(mesh->vertices[t[0]]), b(mesh->vertices[t[1]]), c(mesh->vertices[t[2]]);
        EXPECT_GT(glm::cross(b - a, c - a).y, 0.0);
    }
}

TEST(Bezier, NeighboursOfAnyDirectionLeaveNoCrack) {
    Random random(106);
    for (int n = 0; n < 40; ++n) {
        const BezierPatch left = random_patch(random);
        BezierPatch right = random_patch(random);
        for (std::size_t i = 0; i < 4; ++i) {
            right.points[4 * i] = left.points[4 * i + 3];
        }
        // Much more curved than its neighbour on one side of the shared edge.
        right.points[6].y += 3.0;
        const bool turn = n % 2 == 1;
        const std::array<BezierPatch, 2> pair{left, turn ? flipped(right, true, true) : right};
        const double chord_error = random.range(0.005, 0.3);
        const Result<MeshData> mesh = tessellate(pair, {.chord_error = chord_error});
        ASSERT_TRUE(mesh);
        std::size_t border = 0;
        for (const BezierPatch& patch : pair) {
            const auto& p = patch.points;
            for (const std::array<dvec3, 4>& edge : {std::array{p[0], p[1], p[2], p[3]}, std::array{p[12], p[13], p[14], p[15]},
                                                     std::array{p[0], p[4], p[8], p[12]}, std::array{p[3], p[7], p[11], p[15]}}) {
                border += static_cast<std::size_t>(detail::edge_divisions(edge, chord_error));
            }
        }
        const std::array<dvec3, 4> shared{left.points[3], left.points[7], left.points[11], left.points[15]};
        border -= 2 * static_cast<std::size_t>(detail::edge_divisions(shared, chord_error));
        EXPECT_EQ(open_edges(*mesh), border);
    }
}

TEST(Bezier, AnEdgeIsDividedByItsOwnPointsAlone) {
    Random random(107);
    BezierPatch patch = random_patch(random);
    const std::array<dvec3, 4> edge{patch.points[0], patch.points[1], patch.points[2], patch.points[3]};
    const int parts = detail::edge_divisions(edge, 0.01);
    const auto edge_vertices = [&](const BezierPatch& p) {
        const MeshData mesh = tessellate(std::span(&p, 1), {.chord_error = 0.01}).value();
        std::vector<std::tuple<float, float, float>> on_edge;
        for (int k = 0; k <= parts; ++k) {
            const dvec3 place = oracle(p, double(k) / parts, 0.0);
            for (const vec3& v : mesh.vertices) {
                if (glm::length(dvec3(v) - place) < 1e-6) on_edge.emplace_back(v.x, v.y, v.z);
            }
        }
        return on_edge;
    };
    const auto before = edge_vertices(patch);
    ASSERT_GE(parts, 3);
    ASSERT_EQ(before.size(), static_cast<std::size_t>(parts + 1));
    for (std::size_t k = 4; k < 16; ++k) {
        patch.points[k].y += random.range(-2.0, 2.0);
    }
    EXPECT_EQ(edge_vertices(patch), before);
}

TEST(Bezier, APoleLeavesNoDegenerateTriangle) {
    const BezierPatch patch = dome();
    const Result<MeshData> mesh = tessellate(std::span(&patch, 1), {.chord_error = 1e-3});
    ASSERT_TRUE(mesh);
    std::size_t at_pole = 0;
    for (const vec3& v : mesh->vertices) {
        at_pole += v == vec3(0, 1, 0) ? 1 : 0;
    }
    EXPECT_EQ(at_pole, 1u);
    for (const auto& t : mesh->triangles) {
        const dvec3 a(mesh->vertices[t[0]]), b(mesh->vertices[t[1]]), c(mesh->vertices[t[2]]);
        EXPECT_GT(glm::length(glm::cross(b - a, c - a)), 0.0);
    }
    EXPECT_LT(worst_distance(patch, *mesh, 30), 1e-3 + 1e-7);
}

TEST(Bezier, AFlatSquareIsTwoTriangles) {
    BezierPatch square;
    for (std::size_t k = 0; k < 16; ++k) {
        square.points[k] = {double(k % 4), 0, -double(k / 4)};
    }
    const Result<MeshData> mesh = tessellate(std::span(&square, 1));
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->triangles.size(), 2u);
    EXPECT_EQ(mesh->vertices.size(), 4u);
}

TEST(Bezier, BadInputIsRefused) {
    Random random(108);
    std::array<BezierPatch, 2> patches{random_patch(random), random_patch(random)};
    for (double bad : {0.0, -1.0, kNaN, kInfinity, 1e-12}) {
        const Result<MeshData> mesh = tessellate(patches, {.chord_error = bad});
        ASSERT_FALSE(mesh) << bad;
        EXPECT_EQ(mesh.error().code, ErrorCode::InvalidArgument) << bad;
    }
    EXPECT_EQ(tessellate({}).error().code, ErrorCode::Empty);
    patches[1].points[5].z = kNaN;
    const Result<MeshData> mesh = tessellate(patches);
    ASSERT_FALSE(mesh);
    EXPECT_EQ(mesh.error().code, ErrorCode::NotFinite);
    EXPECT_NE(mesh.error().where.find("patch 1"), std::string::npos);
    patches[1].points[5].z = -kInfinity;
    EXPECT_EQ(tessellate(patches).error().code, ErrorCode::NotFinite);
    // Finite, but its differences are not.
    patches[1].points[5].z = 1e308;
    EXPECT_FALSE(tessellate(patches));
    EXPECT_THROW(static_cast<void>(evaluate(patches[0], kNaN, 0)), MisuseError);
    EXPECT_THROW(static_cast<void>(evaluate(patches[0], 0, 1.5)), MisuseError);
    EXPECT_THROW(static_cast<void>(evaluate(patches[0], -0.1, 0)), MisuseError);
}

TEST(Weld, JoinsEqualPositionsAndDropsWhatCollapses) {
    MeshData mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0f, 1, 0}, {1, 0, 0}, {1, 1, 0}, {9, 9, 9}};
    mesh.triangles = {{0, 1, 2}, {4, 5, 3}, {2, 3, 0}};
    const MeshData welded = weld(mesh);
    EXPECT_EQ(welded.vertices, (std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
    EXPECT_EQ(welded.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {1, 3, 2}}));
}

}  // namespace
}  // namespace carom
