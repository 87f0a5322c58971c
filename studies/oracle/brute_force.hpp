// Brute force over convex solids in long double: all separating axes, all pairs of features. Slow, plain, and independent of the engine.
//
//   Real d = oracle::signed_distance(oracle::solid_of(box, pose_a, origin), oracle::solid_of(hull, pose_b, origin));
#pragma once

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/pose.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace carom::oracle {

using Real = long double;
inline constexpr Real kInfinite = std::numeric_limits<Real>::infinity();
using RealVec = glm::vec<3, Real>;

/// A convex solid as the brute force sees it, in world axes about the origin of the pair's A.
struct Solid {
    std::vector<RealVec> vertices;
    std::vector<RealVec> normals;  ///< of faces, unit
    std::vector<RealVec> edges;    ///< directions
    std::vector<std::array<RealVec, 3>> triangles;  ///< of the surface
};

inline RealVec real(const dvec3& v) { return {Real(v.x), Real(v.y), Real(v.z)}; }

inline RealVec placed(const dvec3& local, const Pose& pose, const dvec3& origin) {
    return real(pose.position) - real(origin) + carom::rotate(glm::qua<Real>(pose.orientation), real(local));
}

inline Solid solid_of(const ConvexHull& hull, const Pose& pose, const dvec3& origin) {
    Solid solid;
    for (const vec3& v : hull.vertices()) solid.vertices.push_back(placed(dvec3(v), pose, origin));
    for (const ConvexHull::Face& face : hull.faces()) {
        solid.normals.push_back(carom::rotate(glm::qua<Real>(pose.orientation), real(face.normal)));
        std::vector<std::uint32_t> loop;
        std::uint32_t e = face.first_edge;
        for (std::uint32_t k = 0; k < face.edge_count; ++k, e = hull.edges()[e].next) loop.push_back(hull.edges()[e].origin);
        for (std::size_t k = 2; k < loop.size(); ++k) {
            solid.triangles.push_back({solid.vertices[loop[0]], solid.vertices[loop[k - 1]], solid.vertices[loop[k]]});
        }
    }
    for (std::uint32_t e = 0; e < hull.edges().size(); e += 2) {
        solid.edges.push_back(solid.vertices[hull.edges()[e + 1].origin] - solid.vertices[hull.edges()[e].origin]);
    }
    return solid;
}

inline std::vector<vec3> corners_of(const Box& box) {
    std::vector<vec3> corners;
    const vec3 h = box.half_extents;
    for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? h.x : -h.x, i & 2 ? h.y : -h.y, i & 4 ? h.z : -h.z});
    return corners;
}

inline Solid solid_of(const Box& box, const Pose& pose, const dvec3& origin) {
    constexpr int kQuads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    Solid solid;
    for (const vec3& corner : corners_of(box)) solid.vertices.push_back(placed(dvec3(corner), pose, origin));
    for (int k = 0; k < 3; ++k) {
        RealVec axis{Real(0)};
        axis[k] = 1;
        axis = carom::rotate(glm::qua<Real>(pose.orientation), axis);
        solid.normals.push_back(axis);
        solid.normals.push_back(-axis);
        solid.edges.push_back(axis);
    }
    for (const auto& q : kQuads) {
        const auto v = [&](int i) { return solid.vertices[static_cast<std::size_t>(q[i])]; };
        solid.triangles.push_back({v(0), v(1), v(2)});
        solid.triangles.push_back({v(0), v(2), v(3)});
    }
    return solid;
}

inline RealVec nearest_on_segment(const RealVec& a, const RealVec& b, const RealVec& p) {
    const RealVec d = b - a;
    const Real dd = glm::dot(d, d);
    const Real t = dd > 0 ? std::min(Real(1), std::max(Real(0), glm::dot(p - a, d) / dd)) : Real(0);
    return a + t * d;
}

inline Real length_of(const RealVec& v) { return std::sqrt(glm::dot(v, v)); }

inline Real distance_to_triangle(const std::array<RealVec, 3>& t, const RealVec& p) {
    Real best = length_of(nearest_on_segment(t[0], t[1], p) - p);
    best = std::min(best, length_of(nearest_on_segment(t[1], t[2], p) - p));
    best = std::min(best, length_of(nearest_on_segment(t[2], t[0], p) - p));
    const RealVec n = glm::cross(t[1] - t[0], t[2] - t[0]);
    const bool inside = glm::dot(glm::cross(t[1] - t[0], n), p - t[0]) <= 0 && glm::dot(glm::cross(t[2] - t[1], n), p - t[1]) <= 0 &&
                        glm::dot(glm::cross(t[0] - t[2], n), p - t[2]) <= 0;
    if (inside) best = std::min(best, std::abs(glm::dot(n, p - t[0])) / length_of(n));
    return best;
}

/// Distance of two segments: the ends against the other segment, and the crossing of the two lines where it lies on both.
inline Real distance_of_segments(const RealVec& a, const RealVec& b, const RealVec& c, const RealVec& d) {
    Real best = std::min({length_of(nearest_on_segment(c, d, a) - a), length_of(nearest_on_segment(c, d, b) - b),
                          length_of(nearest_on_segment(a, b, c) - c), length_of(nearest_on_segment(a, b, d) - d)});
    const RealVec u = b - a, v = d - c, n = glm::cross(u, v);
    const Real nn = glm::dot(n, n);
    if (nn > 1e-24L * glm::dot(u, u) * glm::dot(v, v)) {
        const Real s = glm::dot(glm::cross(c - a, v), n) / nn, t = glm::dot(glm::cross(c - a, u), n) / nn;
        if (s >= 0 && s <= 1 && t >= 0 && t <= 1) best = std::min(best, std::abs(glm::dot(c - a, n)) / std::sqrt(nn));
    }
    return best;
}

struct Separation {
    Real value = -kInfinite;
    RealVec normal{Real(0)};  ///< from a to b
};

/// Separation of the projections on `n`, from a to b.
inline Real gap_along(const Solid& a, const Solid& b, const RealVec& n) {
    Real top = -kInfinite, bottom = kInfinite;
    for (const RealVec& v : a.vertices) top = std::max(top, glm::dot(n, v));
    for (const RealVec& v : b.vertices) bottom = std::min(bottom, glm::dot(n, v));
    return bottom - top;
}

/// The largest separation over all face normals and all cross products of edges.
inline Separation greatest_separation(const Solid& a, const Solid& b) {
    Separation best;
    const auto consider = [&](const RealVec& n) {
        const Real s = gap_along(a, b, n);
        if (s > best.value) best = {s, n};
    };
    for (const RealVec& n : a.normals) consider(n);
    for (const RealVec& n : b.normals) consider(-n);
    for (const RealVec& e : a.edges) {
        for (const RealVec& f : b.edges) {
            const RealVec c = glm::cross(e, f);
            const Real length = std::sqrt(glm::dot(c, c));
            if (!(length > 1e-9L * std::sqrt(glm::dot(e, e) * glm::dot(f, f)))) continue;
            consider(c / length);
            consider(-c / length);
        }
    }
    return best;
}

/// A segment (or a point) as a solid without faces.
inline Solid solid_of_segment(const RealVec& from, const RealVec& to) {
    Solid solid;
    solid.vertices = {from, to};
    solid.edges = {to - from};
    return solid;
}

/// Signed distance of two solids: the distance where they are apart, the least depth (negative) where they overlap.
inline Real signed_distance(const Solid& a, const Solid& b) {
    const Separation axis = greatest_separation(a, b);
    const bool thin = a.triangles.empty() && b.triangles.empty();  // two segments do not overlap
    if (!thin && axis.value < 0) return axis.value;
    Real best = kInfinite;
    for (const RealVec& v : a.vertices) {
        for (const auto& t : b.triangles) best = std::min(best, distance_to_triangle(t, v));
    }
    for (const RealVec& v : b.vertices) {
        for (const auto& t : a.triangles) best = std::min(best, distance_to_triangle(t, v));
    }
    const auto edges_of = [](const Solid& s) {
        std::vector<std::array<RealVec, 2>> edges;
        if (s.triangles.empty()) edges.push_back({s.vertices[0], s.vertices[1]});
        for (const auto& t : s.triangles) {
            for (std::size_t k = 0; k < 3; ++k) edges.push_back({t[k], t[(k + 1) % 3]});
        }
        return edges;
    };
    for (const auto& e : edges_of(a)) {
        for (const auto& f : edges_of(b)) best = std::min(best, distance_of_segments(e[0], e[1], f[0], f[1]));
    }
    return best;
}

}  // namespace carom::oracle
