// The search for the best separation, against all faces and all pairs of edges one after the other.
#include "oracle.hpp"

#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/detail/polytope_axis.hpp>
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
    int by_edges = 0, by_triangle = 0, without_arcs = 0, by_side = 0, without_side = 0;
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
            const double side = detail::best_side(b, a, kNone).separation;
            ASSERT_LE(side, found.side_promise) << i;
            by_side += found.side_promise > face && face > kNone ? 1 : 0;
            without_side += found.side_promise <= face ? 1 : 0;
            by_triangle += face > of_a ? 1 : 0;
            without_arcs += found.edges.separation == kNone ? 1 : 0;
            EXPECT_EQ(detail::find_separations(a, b, a.centre, b.centre, face - 0.1).edges.separation, kNone);  // a face was enough
        }
    }
    set_simd_width(0);
    EXPECT_GT(by_edges, 100);
    EXPECT_GT(by_triangle, 100);
    EXPECT_GT(without_arcs, 100);
    EXPECT_GT(by_side, 100);
    EXPECT_GT(without_side, 100);
}

// Of all pairs of edges whose arcs cross, one after the other: the first of those that separate best.
detail::EdgePair first_best_edges(const Polytope& a, const Polytope& b) {
    detail::EdgePair best;
    for (std::uint32_t i = 0; i < a.edge_count(); ++i) {
        for (std::uint32_t j = 0; j < b.edge_count(); ++j) {
            const Polytope::Edge e = a.edge(i), f = b.edge(j);
            const double cba = -glm::dot(f.left, e.direction), dba = -glm::dot(f.right, e.direction);
            const double adc = glm::dot(e.left, f.direction), bdc = glm::dot(e.right, f.direction);
            if (!(cba * dba < 0.0) || !(adc * bdc < 0.0) || !(cba * bdc > 0.0)) continue;
            const dvec3 normal = glm::cross(e.direction, f.direction);
            const double along = glm::dot(normal, f.from - e.from) / std::sqrt(glm::dot(normal, normal));
            const double outward = glm::dot(normal, e.left + e.right) < 0.0 ? -along : along;
            if (outward > best.separation) best = {outward, normal, i, j};
        }
    }
    return best;
}

// Boxes about the centre of a box or a triangle: many pairs of edges are as good as one another.
TEST(PolytopeSearch, OfEqualPairsOfEdgesTheFirstCounts) {
    Random r(23);
    int compared = 0, ties = 0;
    for (int i = 0; i < 1500; ++i) {
        Polytope a, b;
        const ConvexHullPtr hull = random_hull(r, 6 + i % 20, 0.3, 1.0);
        const dmat3 axes = glm::mat3_cast(random_rotation(r));
        const bool is_tied = i % 3 == 0;
        if (is_tied) {
            detail::load_box(a, dvec3{0.5});
        } else {
            detail::load_hull(a, *hull);
        }
        if (i % 2 == 0) {
            detail::load_box(b, dvec3{0.5}, axes, is_tied ? dvec3{0.0} : random_direction(r) * r.range(0.0, 1.2));
        } else {
            const dvec3 middle = is_tied ? dvec3{0.0} : random_direction(r) * r.range(0.0, 0.8);
            const dvec3 u = random_direction(r), w = random_direction(r);
            if (!detail::load_triangle(b, {middle + u, middle + w, middle - u - w})) continue;
        }
        const double face = std::max(best_face(a, b), best_face(b, a));
        const detail::EdgePair first = first_best_edges(a, b);
        if (!(first.separation > face)) continue;
        for (const int width : available_simd_widths()) {
            set_simd_width(width);
            const detail::EdgePair found = detail::find_separations(a, b, a.centre, b.centre, -kNone).edges;
            ASSERT_EQ(found.separation, first.separation) << i << ", width " << width;
            ASSERT_EQ(found.a, first.a) << i << ", width " << width;
            ASSERT_EQ(found.b, first.b) << i << ", width " << width;
        }
        ++compared;
        ties += is_tied ? 1 : 0;
    }
    set_simd_width(0);
    std::printf("%d compared, %d of them tied\n", compared, ties);
    EXPECT_GT(compared, 200);
    EXPECT_GT(ties, 30);
}

// What a plane between the middles parts is never anything that the search would find, and most of what it would look for in vain.
TEST(PolytopeSearch, WhatPassesByHasNoAxis) {
    Random r(24);
    int apart[2] = {}, passed[2] = {};
    for (int i = 0; i < 12000; ++i) {
        Polytope a, b;
        const ConvexHullPtr one = random_hull(r, 6 + i % 26, 0.3, 1.0), other = random_hull(r, 6 + i % 17, 0.3, 1.0);
        const bool is_triangle = i % 2 == 0;
        load_any(r, a, is_triangle ? random_direction(r) : dvec3{0.0}, *one);
        const double margin = i % 5 == 0 ? 0.0 : r.range(0.0, 0.2);
        bool passes = false;
        if (is_triangle) {
            const dvec3 middle = a.centre + random_direction(r) * r.range(0.0, 1.5);
            const double extent = std::exp2(r.range(-4.0, 2.0));
            const auto corner = [&] { return middle + extent * random_direction(r); };
            const detail::Corners corners{corner(), corner(), corner()};
            if (!detail::load_triangle(b, corners)) continue;
            passes = detail::passes_by(a, corners, margin);
        } else {
            const dmat3 axes = glm::mat3_cast(random_rotation(r));
            const dvec3 origin = random_direction(r) * r.range(0.5, 2.0);
            detail::load_hull(b, *other, axes, origin);
            passes = detail::passes_by(a, *other, axes, origin, margin);
        }
        detail::ContactAxis axis;
        const bool found = detail::find_axis(a, b, a.centre, b.centre, margin, axis);
        ASSERT_FALSE(found && passes) << i;
        apart[is_triangle] += found ? 0 : 1;
        passed[is_triangle] += passes ? 1 : 0;
    }
    std::printf("hulls: %d of %d, triangles: %d of %d\n", passed[0], apart[0], passed[1], apart[1]);
    EXPECT_GT(5 * passed[0], 2 * apart[0]);
    EXPECT_GT(5 * passed[1], 4 * apart[1]);
    EXPECT_GT(apart[0], 1000);
    EXPECT_GT(apart[1], 1000);
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

// Boxes and hulls that a corner, an edge or a face of theirs has at or in a triangle.
TEST(PolytopeSearch, AFaceThatDecidesIsTheBestOfAllAxes) {
    Random r(15);
    int decided = 0, below = 0, apart = 0;
    for (int i = 0; i < 4000; ++i) {
        Polytope a, triangle;
        const ConvexHullPtr hull = random_hull(r, 6 + i % 12, 0.3, 1.0);
        load_any(r, a, dvec3{0.0}, *hull);
        const dvec3 n = random_direction(r);
        const dvec3 u = glm::normalize(glm::cross(n, random_direction(r))), w = glm::cross(n, u);
        const double level = least_along(a, n) + (i % 3 == 0 ? r.range(0.0, 0.05) : i % 3 == 1 ? r.range(0.0, 0.6) : -r.range(0.0, 0.05));
        const double size = std::exp2(r.range(-3.0, 2.0));
        const dvec3 at = level * n + r.range(-0.7, 0.7) * u + r.range(-0.7, 0.7) * w;
        const auto corner = [&](double angle) { return at + size * (std::cos(angle) * u + std::sin(angle) * w); };
        const double first = r.range(0.0, 2.0), second = first + r.range(0.3, 2.5);
        if (!detail::load_triangle(triangle, {corner(first), corner(second), corner(second + r.range(0.3, 2.5))})) continue;
        detail::ContactAxis axis;
        if (!detail::face_decides(a, triangle, axis)) continue;
        ++decided;
        below += axis.separation < -1e-3 ? 1 : 0;
        apart += axis.separation > 0.0 ? 1 : 0;
        double best = std::max({best_face(a, triangle), best_face(triangle, a), best_edges(a, triangle)});
        best = std::max(best, detail::best_side(triangle, a, -1e3).separation);
        EXPECT_NEAR(axis.separation, best, 1e-9) << i;
        EXPECT_NEAR(axis.separation, least_along(a, -axis.normal) - triangle.offset(axis.feature_b), 1e-12);
        EXPECT_EQ(axis.normal, -triangle.normal(axis.feature_b));
    }
    std::printf("%d decided, %d of them deep, %d apart\n", decided, below, apart);
    EXPECT_GT(decided, 400);
    EXPECT_GT(below, 100);
    EXPECT_GT(apart, 100);
}

}  // namespace
}  // namespace carom
