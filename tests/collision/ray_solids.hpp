// Solids as functions of long double, which rays are bisected against.
#pragma once

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/random.hpp>

#include "support_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace carom::test {

using Real = long double;

struct RealPoint {
    Real x, y, z;
};

/// Convex, negative inside, zero on the surface: so along a line it has one minimum and at most one entry.
using Function = std::function<Real(const RealPoint&)>;

struct Solid {
    std::string name;
    Shape shape;
    Function function;
    double size;
};

inline Solid sphere(float radius) {
    return {"sphere", Sphere{radius},
            [=](const RealPoint& p) { return std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z) - static_cast<Real>(radius); },
            static_cast<double>(radius)};
}

inline Solid box(const vec3& h) {
    return {"box", Box{h},
            [=](const RealPoint& p) {
                return std::max({std::abs(p.x) - static_cast<Real>(h.x), std::abs(p.y) - static_cast<Real>(h.y),
                                 std::abs(p.z) - static_cast<Real>(h.z)});
            },
            static_cast<double>(std::max({h.x, h.y, h.z}))};
}

inline Solid capsule(float radius, float half) {
    return {"capsule", Capsule{radius, half},
            [=](const RealPoint& p) {
                const Real y = p.y - std::clamp(p.y, -static_cast<Real>(half), static_cast<Real>(half));
                return std::sqrt(p.x * p.x + y * y + p.z * p.z) - static_cast<Real>(radius);
            },
            static_cast<double>(radius + half)};
}

inline Solid plane(const vec3& n, float offset) {
    return {"plane", Plane{n, offset},
            [=](const RealPoint& p) {
                return static_cast<Real>(n.x) * p.x + static_cast<Real>(n.y) * p.y + static_cast<Real>(n.z) * p.z -
                       static_cast<Real>(offset);
            },
            1.0};
}

inline Solid hull(std::uint64_t seed) {
    Random random(seed);
    std::vector<vec3> points;
    for (int i = 0; i < 40; ++i) {
        points.push_back(vec3(random_point(random, 1.0)));
    }
    const ConvexHullPtr built = ConvexHull::build(points).value();
    return {"hull", built,
            [built](const RealPoint& p) {
                Real most = -std::numeric_limits<Real>::infinity();
                for (const ConvexHull::Face& f : built->faces()) {
                    most = std::max(most, f.normal.x * p.x + f.normal.y * p.y + f.normal.z * p.z - f.offset);
                }
                return most;
            },
            1.0};
}

inline std::vector<Solid> solids() {
    return {sphere(0.7f),
            box({0.5f, 1.0f, 0.25f}),
            capsule(0.3f, 0.8f),
            capsule(0.5f, 0.0f),
            plane({0, 1, 0}, 0.2f),
            plane({0.6f, -0.48f, 0.64f}, -0.3f),
            hull(5)};
}

}  // namespace carom::test
