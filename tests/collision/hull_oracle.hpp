// What a hull must be: its invariants, its support function, and what Qhull says of the same points.
//
//   ConvexHullPtr hull = test::expect_hull(points);
#pragma once

#include "hull_inputs.hpp"

#include <carom/collision/convex_hull.hpp>
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
#include <set>
#include <vector>

namespace carom::test {

inline double extent_of(std::span<const vec3> points) {
    dvec3 lower{points[0]};
    dvec3 upper{points[0]};
    for (const vec3& p : points) {
        lower = glm::min(lower, dvec3{p});
        upper = glm::max(upper, dvec3{p});
    }
    return std::max({upper.x - lower.x, upper.y - lower.y, upper.z - lower.z});
}

inline std::vector<dvec3> polygon(const ConvexHull& hull, const ConvexHull::Face& face) {
    std::vector<dvec3> corners;
    std::uint32_t edge = face.first_edge;
    do {
        corners.emplace_back(hull.vertices()[hull.edges()[edge].origin]);
        edge = hull.edges()[edge].next;
    } while (edge != face.first_edge && corners.size() <= hull.edges().size());
    return corners;
}

/// Everything that the header promises. `slack` is in units of the largest extent.
inline void expect_invariants(const ConvexHull& hull, std::span<const vec3> points, double slack = 1e-5) {
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

inline double volume(const ConvexHull& hull) {
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

inline double support_value(std::span<const vec3> points, const dvec3& direction) {
    double best = -std::numeric_limits<double>::infinity();
    for (const vec3& p : points) best = std::max(best, glm::dot(dvec3{p}, direction));
    return best;
}

inline void expect_same_support(const ConvexHull& hull, std::span<const vec3> points, double slack = 1e-5) {
    Random random(424242);
    const double extent = extent_of(points);
    for (int k = 0; k < 200; ++k) {
        const dvec3 direction = random_direction(random);
        const double ours = glm::dot(dvec3{hull.vertices()[hull.support(direction)]}, direction);
        EXPECT_NEAR(ours, support_value(points, direction), slack * extent);
    }
}

inline ConvexHullPtr expect_hull(std::span<const vec3> points) {
    Result<ConvexHullPtr> hull = ConvexHull::build(points);
    if (!hull) {
        ADD_FAILURE() << hull.error().message;
        return nullptr;
    }
    expect_invariants(**hull, points);
    expect_same_support(**hull, points);
    return *hull;
}

// Qhull as the oracle ---------------------------------------------------------------------------------------------

struct QhullAnswer {
    double volume = 0.0;
    std::set<std::size_t> vertices;
};

/// Qhull with its default merging ("" options). @return nothing useful (volume 0) where it refuses.
inline QhullAnswer ask_qhull(std::span<const vec3> points) {
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

inline std::set<std::size_t> vertex_indices(const ConvexHull& hull, std::span<const vec3> points) {
    std::set<std::size_t> indices;
    for (const vec3& v : hull.vertices()) {
        indices.insert(static_cast<std::size_t>(std::find(points.begin(), points.end(), v) - points.begin()));
    }
    return indices;
}

}  // namespace carom::test
