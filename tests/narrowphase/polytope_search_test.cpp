// The search for the best separation, against all faces and all pairs of edges one after the other.
#include "oracle.hpp"

#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/detail/polytope_search.hpp>

#include <gtest/gtest.h>

namespace carom {
namespace {

using namespace test;
using detail::Polytope;

constexpr double kNone = -std::numeric_limits<double>::infinity();

double least_along(const Polytope& p, const dvec3& direction) {
    double least = -kNone;
    for (std::uint32_t v = 0; v < p.vertex_count; ++v) least = std::min(least, glm::dot(direction, p.vertex(v)));
    return least;
}

double best_face(const Polytope& p, const Polytope& other) {
    double best = kNone;
    for (std::uint32_t f = 0; f < p.face_count(); ++f) best = std::max(best, least_along(other, p.normal(f)) - p.offset(f));
    return best;
}

// Along the axis of each two edges, both ways, from all vertices; so it needs no Gauss map.
double best_edges(const Polytope& a, const Polytope& b) {
    double best = kNone;
    for (std::uint32_t i = 0; i < a.edge_count(); ++i) {
        for (std::uint32_t j = 0; j < b.edge_count(); ++j) {
            const dvec3 axis = glm::cross(a.edge(i).direction, b.edge(j).direction);
            const double length = glm::length(axis);
            if (length < 1e-6 * glm::length(a.edge(i).direction) * glm::length(b.edge(j).direction)) continue;
            for (const dvec3& n : {axis / length, -axis / length}) best = std::max(best, least_along(b, n) + least_along(a, -n));
        }
    }
    return best;
}

// A box or a hull, which must outlive its use.
void load_any(Random& r, Polytope& p, const dvec3& origin, const ConvexHull& hull) {
    const dmat3 axes = glm::mat3_cast(random_rotation(r));
    if (r.range(0.0, 1.0) < 0.5) {
        detail::load_hull(p, hull, axes, origin);
    } else {
        detail::load_box(p, dvec3{r.range(0.1, 1.0), r.range(0.1, 1.0), r.range(0.1, 1.0)}, axes, origin);
    }
}

TEST(PolytopeSearch, FindsTheBestOfAllFacesAndEdges) {
    Random r(21);
    int by_edges = 0, deep = 0;
    for (int i = 0; i < 400; ++i) {
        Polytope a, b;
        const ConvexHullPtr one = random_hull(r, 6 + i % 12, 0.3, 1.0), other = random_hull(r, 6 + i % 7, 0.3, 1.0);
        load_any(r, a, dvec3{0.0}, *one);
        load_any(r, b, random_direction(r) * r.range(0.0, 1.6), *other);
        const double of_a = best_face(a, b), of_b = best_face(b, a), face = std::max(of_a, of_b), edges = best_edges(a, b);
        for (const int width : available_simd_widths()) {
            set_simd_width(width);
            const detail::Separations found = detail::find_separations(a, b, a.centre, b.centre, -kNone);
            ASSERT_NEAR(found.of_a.separation, of_a, 1e-14) << i;
            ASSERT_NEAR(found.of_b.separation, face, 1e-14) << i;
            ASSERT_LE(found.edges.separation, std::max(edges, face) + 1e-12) << i;
            if (edges < 0.0 && edges > face + 1e-12) {
                ASSERT_NEAR(found.edges.separation, edges, 1e-12) << i << ", width " << width;
                const dvec3 n = found.edges.normal;
                ASSERT_NEAR(least_along(b, n) + least_along(a, -n), edges, 1e-12) << i;
                ++by_edges;
            }
        }
        deep += face < -0.2 ? 1 : 0;
    }
    set_simd_width(0);
    EXPECT_GT(by_edges, 100);
    EXPECT_GT(deep, 100);
}

TEST(PolytopeSearch, FindsTheBestAgainstATriangle) {
    Random r(22);
    int by_edges = 0, by_triangle = 0, without_arcs = 0;
    for (int i = 0; i < 1000; ++i) {
        Polytope a, b;
        const ConvexHullPtr hull = random_hull(r, 6 + i % 40, 0.3, 1.0);
        load_any(r, a, dvec3{0.0}, *hull);
        const double extent = std::pow(10.0, r.range(-1.0, 1.0));
        const dvec3 middle = random_direction(r) * r.range(0.0, 1.2);
        const auto corner = [&] { return middle + extent * random_direction(r); };
        ASSERT_TRUE(detail::load_triangle(b, {corner(), corner(), corner()}));
        const double of_a = best_face(a, b), face = std::max(of_a, best_face(b, a)), edges = best_edges(a, b);
        for (const int width : available_simd_widths()) {
            set_simd_width(width);
            const detail::Separations found = detail::find_separations(a, b, a.centre, b.centre, -kNone);
            ASSERT_NEAR(found.of_a.separation, of_a, 1e-14) << i;
            ASSERT_EQ(glm::dot(a.normal(found.of_a.plane), b.vertex(found.of_a.deepest)), least_along(b, a.normal(found.of_a.plane)));
            ASSERT_NEAR(found.of_b.separation, face, 1e-14) << i;
            ASSERT_LE(found.edges.separation, std::max(edges, face) + 1e-12) << i;
            if (edges < 0.0 && edges > face + 1e-12) {
                ASSERT_NEAR(found.edges.separation, edges, 1e-12) << i << ", width " << width;
                ASSERT_NEAR(least_along(b, found.edges.normal) + least_along(a, -found.edges.normal), edges, 1e-12) << i;
                ++by_edges;
            }
            by_triangle += face > of_a ? 1 : 0;
            without_arcs += found.edges.separation == kNone ? 1 : 0;
            EXPECT_EQ(detail::find_separations(a, b, a.centre, b.centre, face - 0.1).edges.separation, kNone);  // a face was enough
        }
    }
    set_simd_width(0);
    EXPECT_GT(by_edges, 100);
    EXPECT_GT(by_triangle, 100);
    EXPECT_GT(without_arcs, 100);
}

// A small triangle over the edge of a sharp wedge: 0.115 along y, where edges cross, and 0.08 along the triangle's own normal; but no corner of it is
// higher than 0.04 over either side of the wedge.
TEST(PolytopeSearch, OverASharpEdgeTwoEdgesMayDoBetterThanAllTheirFaces) {
    Polytope wedge, triangle;
    const float half_base = 0.17632698f;  // of 20 degrees
    const ConvexHullPtr hull = hull_of({{0, 0, -1}, {0, 0, 1}, {half_base, -1, -1}, {half_base, -1, 1}, {-half_base, -1, -1}, {-half_base, -1, 1}});
    detail::load_hull(wedge, *hull, dmat3{1.0}, dvec3{0.0});
    ASSERT_TRUE(detail::load_triangle(triangle, {dvec3{-0.02, 0.115, 0.0}, dvec3{0.02, 0.115, 0.0}, dvec3{0.0, 0.1325, 0.5}}));
    const double face = std::max(best_face(wedge, triangle), best_face(triangle, wedge)), edges = best_edges(wedge, triangle);
    ASSERT_NEAR(face, 0.08, 1e-3);
    ASSERT_NEAR(edges, 0.115, 1e-6);
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        const detail::Separations found = detail::find_separations(wedge, triangle, wedge.centre, triangle.centre, 1.0);
        set_simd_width(0);
        EXPECT_NEAR(found.of_b.separation, face, 1e-14) << width;
        EXPECT_NEAR(found.edges.separation, edges, 1e-14) << width;
    }
}

TEST(PolytopeSearch, AFaceThatSeparatesByMoreEndsIt) {
    Polytope a, b;
    detail::load_box(a, dvec3{0.5});
    detail::load_box(b, dvec3{0.5}, dmat3{1.0}, dvec3{0.0, 3.0, 0.0});
    const detail::Separations found = detail::find_separations(a, b, a.centre, b.centre, 1.0);
    EXPECT_EQ(std::max(found.of_a.separation, found.of_b.separation), 2.0);
    EXPECT_EQ(found.edges.separation, kNone);
}

TEST(PolytopeSearch, SidesOfATriangleCountWhereTheyDoBetter) {
    Polytope triangle, box;
    ASSERT_TRUE(detail::load_triangle(triangle, {dvec3{0.0, 0.0, 0.0}, dvec3{2.0, 0.0, 0.0}, dvec3{0.0, 0.0, 2.0}}));
    detail::load_box(box, dvec3{0.5}, dmat3{1.0}, dvec3{0.5, 0.0, -0.75});
    const detail::FaceSeparation side = detail::best_side(triangle, box, -0.5);
    EXPECT_NEAR(side.separation, 0.25, 1e-15);
    EXPECT_EQ(detail::best_side(triangle, box, 0.3).separation, 0.3);
}

}  // namespace
}  // namespace carom
