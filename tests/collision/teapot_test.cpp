// The Utah teapot's figures and its triangles.
#include <carom/collision/teapot.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

namespace carom {
namespace {

using Key = std::tuple<double, double, double>;
using Edge = std::array<dvec3, 4>;

Key key(const dvec3& p) { return {p.x + 0.0, p.y + 0.0, p.z + 0.0}; }

std::array<Edge, 4> edges_of(const BezierPatch& patch) {
    const auto& p = patch.points;
    return {Edge{p[0], p[1], p[2], p[3]}, Edge{p[3], p[7], p[11], p[15]}, Edge{p[15], p[14], p[13], p[12]},
            Edge{p[12], p[8], p[4], p[0]}};
}

std::vector<Key> keys(const Edge& edge, bool reversed) {
    std::vector<Key> out{key(edge[0]), key(edge[1]), key(edge[2]), key(edge[3])};
    if (reversed) {
        std::reverse(out.begin(), out.end());
    }
    return out;
}

TEST(Teapot, HasNewellsCounts) {
    EXPECT_EQ(teapot_points().size(), 306u);
    EXPECT_EQ(teapot_patches().size(), 32u);
    std::set<std::uint16_t> used;
    for (const auto& patch : teapot_indices()) {
        for (std::uint16_t i : patch) {
            ASSERT_LT(i, 306);
            used.insert(i);
        }
    }
    EXPECT_EQ(used.size(), 302u);
    for (std::uint16_t unused : std::initializer_list<std::uint16_t>{204, 205, 215, 222}) {
        EXPECT_FALSE(used.contains(unused));
    }
}

TEST(Teapot, PointsFillTheKnownBox) {
    dvec3 lower{std::numeric_limits<double>::infinity()}, upper{-lower};
    for (const dvec3& p : teapot_points()) {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    EXPECT_EQ(lower, dvec3(-3, -2, 0));
    EXPECT_EQ(upper, dvec3(3.525, 2, 3.15));
}

TEST(Teapot, IsItsOwnMirrorImage) {
    // y to -y maps the set of points onto itself, but not the four tiny ones about the lid's pole in order.
    std::multiset<Key> points, mirrored;
    for (const dvec3& p : teapot_points()) {
        points.insert(key(p));
        mirrored.insert(key({p.x, -p.y, p.z}));
    }
    EXPECT_EQ(points, mirrored);
}

// Which patch edges have no neighbour that runs along them the other way, by part of the pot.
TEST(Teapot, OpenEdgesAreTheKnownOnes) {
    struct Part {
        const char* name;
        std::size_t first, last, open;
    };
    // Rim: inner ring. Body: none. Handle: two ends of two patches each. Spout: root and mouth. Lid: outer ring. Bottom: none.
    const std::array<Part, 6> parts{Part{"rim", 0, 3, 4},    {"body", 4, 11, 0}, {"handle", 12, 15, 4},
                                    {"spout", 16, 19, 4}, {"lid", 20, 27, 4}, {"bottom", 28, 31, 0}};
    std::map<std::vector<Key>, int> all;
    for (const BezierPatch& patch : teapot_patches()) {
        for (const Edge& edge : edges_of(patch)) {
            if (edge[0] != edge[3] || edge[0] != edge[1]) {
                EXPECT_EQ(++all[keys(edge, false)], 1) << "two patches run along one edge in one direction";
            }
        }
    }
    for (const Part& part : parts) {
        std::size_t open = 0, poles = 0;
        for (std::size_t i = part.first; i <= part.last; ++i) {
            for (const Edge& edge : edges_of(teapot_patches()[i])) {
                const bool pole = edge[0] == edge[3] && edge[0] == edge[1];
                poles += pole ? 1 : 0;
                open += !pole && !all.contains(keys(edge, true)) ? 1 : 0;
            }
        }
        EXPECT_EQ(open, part.open) << part.name;
        EXPECT_EQ(poles, part.first >= 20 && part.first != 24 ? 4u : 0u) << part.name;
    }
}

TEST(Teapot, NormalsAtTheLidAndTheBottomAreVertical) {
    for (std::size_t i = 20; i < 24; ++i) {
        EXPECT_LT(glm::length(evaluate(teapot_patches()[i], 0.4, 0).normal - dvec3(0, 0, 1)), 1e-12);
    }
    for (std::size_t i = 28; i < 32; ++i) {
        EXPECT_LT(glm::length(evaluate(teapot_patches()[i], 0.4, 0).normal - dvec3(0, 0, -1)), 1e-12);
    }
    // The body's widest ring looks outward.
    for (std::size_t i = 4; i < 8; ++i) {
        const SurfacePoint p = evaluate(teapot_patches()[i], 0.5, 1);
        EXPECT_GT(glm::dot(p.normal, glm::normalize(dvec3(p.position.x, p.position.y, 0))), 0.999);
    }
}

TEST(Teapot, MeshHasTheAskedSize) {
    const Result<MeshData> pot = teapot(0.3, 2e-4);
    ASSERT_TRUE(pot) << pot.error().message;
    dvec3 lower{std::numeric_limits<double>::infinity()}, upper{-lower};
    for (const vec3& v : pot->vertices) {
        lower = glm::min(lower, dvec3(v));
        upper = glm::max(upper, dvec3(v));
    }
    // The spout's lip need not have a vertex at its farthest point: within the chord error.
    EXPECT_NEAR(upper.x - lower.x, 0.3, 2e-4);
    EXPECT_LE(upper.x - lower.x, 0.3 * (1 + 1e-6));
    EXPECT_EQ(lower.y, 0.0);
    EXPECT_NEAR(upper.y, 0.3 * 3.15 / 6.4340751254711077, 1e-7);
    EXPECT_NEAR(upper.z, -lower.z, 1e-7);
    EXPECT_GT(upper.x, -lower.x) << "the spout points to +x";
}

// Open edges of the mesh lie on the known open rings only, and every point of the surface is near the triangles' vertices.
TEST(Teapot, MeshIsOpenOnlyWhereThePatchesAre) {
    for (double chord_error : {0.01, 1e-3, 1e-4}) {
        const Result<MeshData> pot = teapot(1.0, chord_error);
        ASSERT_TRUE(pot);
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
        for (const auto& t : pot->triangles) {
            for (std::size_t k = 0; k < 3; ++k) {
                EXPECT_EQ(++edges[std::pair(t[k], t[(k + 1) % 3])], 1);
            }
        }
        const double unit = 1.0 / 6.4340751254711077;
        std::size_t rings[5]{};
        std::size_t open = 0;
        for (const auto& [edge, count] : edges) {
            if (edges.contains(std::pair(edge.second, edge.first))) {
                continue;
            }
            ++open;
            const dvec3 p = (dvec3(pot->vertices[edge.first]) + dvec3(pot->vertices[edge.second])) / (2 * unit);
            const double r = std::hypot(p.x, p.z), slack = chord_error / unit + 1e-5;
            if (std::abs(p.y - 2.4) < 1e-5 && std::abs(r - 1.4) < 0.03 + slack) {
                ++rings[0];  // inner ring of the rim
            } else if (std::abs(p.y - 2.4) < 1e-5 && std::abs(r - 1.3) < 0.03 + slack) {
                ++rings[1];  // outer ring of the lid
            } else if (p.x < -1.4 && std::abs(p.z) <= 0.3) {
                ++rings[2];  // ends of the handle
            } else if (std::abs(p.x - 1.7) < 1e-5) {
                ++rings[3];  // root of the spout
            } else if (std::abs(p.y - 2.4) < 1e-5 && p.x > 2.7) {
                ++rings[4];  // mouth of the spout
            }
        }
        EXPECT_EQ(open, rings[0] + rings[1] + rings[2] + rings[3] + rings[4]);
        for (std::size_t ring : rings) {
            EXPECT_GE(ring, 4u);
        }
    }
}

TEST(Teapot, BadSizesAreRefused) {
    EXPECT_EQ(teapot(0.0, 1e-3).error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(teapot(-1.0, 1e-3).error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(teapot(std::numeric_limits<double>::quiet_NaN(), 1e-3).error().code, ErrorCode::NotFinite);
    EXPECT_EQ(teapot(std::numeric_limits<double>::infinity(), 1e-3).error().code, ErrorCode::NotFinite);
    EXPECT_EQ(teapot(1.0, 0.0).error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(teapot(1.0, std::numeric_limits<double>::quiet_NaN()).error().code, ErrorCode::InvalidArgument);
}

}  // namespace
}  // namespace carom
