// Brute force for the narrowphase tests: all separating axes in long double, random poses, point-in-shape distances.
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/math.hpp>
#include <carom/core/pose.hpp>
#include <carom/core/random.hpp>
#include <carom/narrowphase/collide.hpp>

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <vector>

namespace carom::test {

using Real = long double;
using RealVec = glm::vec<3, Real>;

inline dvec3 random_direction(Random& random) {
    for (;;) {
        const double x = random.range(-1, 1), y = random.range(-1, 1), z = random.range(-1, 1);
        const double length = std::sqrt(x * x + y * y + z * z);
        if (length > 0.1 && length <= 1.0) return dvec3{x, y, z} / length;
    }
}

inline dquat random_rotation(Random& random) {
    const dvec3 axis = random_direction(random);
    const double angle = random.range(0.0, 2.0 * kPi);
    const double s = std::sin(0.5 * angle);
    return {std::cos(0.5 * angle), s * axis.x, s * axis.y, s * axis.z};
}

inline dquat about(const dvec3& axis, double angle) {
    const dvec3 n = axis / std::sqrt(glm::dot(axis, axis));
    const double s = std::sin(0.5 * angle);
    return {std::cos(0.5 * angle), s * n.x, s * n.y, s * n.z};
}

/// A convex solid as the brute force sees it, in world axes about the origin of the pair's A.
struct Solid {
    std::vector<RealVec> vertices;
    std::vector<RealVec> normals;  ///< of faces, unit
    std::vector<RealVec> edges;    ///< directions
};

inline RealVec real(const dvec3& v) { return {Real(v.x), Real(v.y), Real(v.z)}; }

inline Solid solid_of(const Box& box, const Pose& pose, const dvec3& origin) {
    Solid solid;
    const dvec3 h(box.half_extents);
    for (int i = 0; i < 8; ++i) {
        const dvec3 corner{i & 1 ? h.x : -h.x, i & 2 ? h.y : -h.y, i & 4 ? h.z : -h.z};
        solid.vertices.push_back(real(pose.position - origin) + carom::rotate(glm::qua<Real>(pose.orientation), real(corner)));
    }
    for (int k = 0; k < 3; ++k) {
        RealVec axis{Real(0)};
        axis[k] = 1;
        axis = carom::rotate(glm::qua<Real>(pose.orientation), axis);
        solid.normals.push_back(axis);
        solid.normals.push_back(-axis);
        solid.edges.push_back(axis);
    }
    return solid;
}

struct Separation {
    Real value = -1e30L;
    RealVec normal{Real(0)};  ///< from a to b
};

/// Separation of the projections on `n`, from a to b.
inline Real gap_along(const Solid& a, const Solid& b, const RealVec& n) {
    Real top = -1e30L, bottom = 1e30L;
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
            if (length < 1e-9L * std::sqrt(glm::dot(e, e) * glm::dot(f, f))) continue;
            consider(c / length);
            consider(-c / length);
        }
    }
    return best;
}

inline std::vector<Manifold> collide_all(const Shape& a, const Pose& pa, const Shape& b, const Pose& pb, float margin) {
    std::vector<Manifold> out;
    collide(ShapePair{&a, &b, pa, pb, margin}, 7, out);
    return out;
}

inline float least_separation(const Manifold& m) {
    float least = m.points[0].separation;
    for (const ContactPoint& p : m.used()) least = std::min(least, p.separation);
    return least;
}

}  // namespace carom::test
