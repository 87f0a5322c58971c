// Points to build hulls of: clouds, stones, grids, prisms, geodesic spheres.
//
//   Result<ConvexHullPtr> hull = ConvexHull::build(test::stone(random));
#pragma once

#include "support/random_pose.hpp"

#include <carom/collision/convex_hull.hpp>
#include <carom/core/pose.hpp>
#include <carom/core/random.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>
#include <vector>

namespace carom::test {

using Points = std::vector<vec3>;

/// The farthest any of the points is along a direction.
inline vec3 to_float(const dvec3& p) { return vec3{p}; }

/// Points in the ball, or on the sphere.
inline Points cloud(std::uint64_t seed, int count, bool on_sphere = false) {
    Random random(seed);
    Points points;
    for (int i = 0; i < count; ++i) {
        const dvec3 d = random_direction(random);
        points.push_back(to_float(on_sphere ? d : d * random.unit()));
    }
    return points;
}

/// The hulls that the mixed pile scatters: 12 points of one length.
inline Points stone(Random& random) {
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
inline Points box_grid(const dvec3& half, int n) {
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

inline Points prism(int sides, double radius, double height) {
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
inline Points geodesic(int frequency) {
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

inline Points moved(const Points& points, const dvec3& scale, const dquat& turn, const dvec3& shift) {
    Points result;
    for (const vec3& p : points) result.push_back(to_float(shift + rotate(turn, scale * dvec3{p})));
    return result;
}

inline dquat some_rotation(Random& random) {
    const dvec3 axis = random_direction(random) * random.range(0.3, 3.0);
    return glm::normalize(dquat{1.0, axis.x, axis.y, axis.z});
}

}  // namespace carom::test
