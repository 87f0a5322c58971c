// What the narrowphase tests and their fuzzers share: brute force in long double, random shapes and poses. Nothing of GoogleTest.
#pragma once

#include "support/random_pose.hpp"

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/math.hpp>
#include <carom/core/pose.hpp>
#include <carom/core/random.hpp>
#include <carom/narrowphase/collide.hpp>
#include <carom/studies/oracle/brute_force.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace carom::test {

using oracle::Real;
using oracle::RealVec;
using oracle::Solid;
using oracle::real;
using oracle::placed;
using oracle::solid_of;
using oracle::corners_of;
using oracle::nearest_on_segment;
using oracle::length_of;
using oracle::distance_to_triangle;
using oracle::distance_of_segments;
using oracle::Separation;
using oracle::gap_along;
using oracle::greatest_separation;
using oracle::solid_of_segment;
using oracle::signed_distance;

inline dquat about(const dvec3& axis, double angle) {
    const dvec3 n = axis / std::sqrt(glm::dot(axis, axis));
    const double s = std::sin(0.5 * angle);
    return {std::cos(0.5 * angle), s * n.x, s * n.y, s * n.z};
}

inline ConvexHullPtr hull_of(const std::vector<vec3>& points) {
    Result<ConvexHullPtr> hull = ConvexHull::build(points);
    return hull ? *hull : nullptr;
}

/// Points of the unit sphere, scaled per axis.
inline ConvexHullPtr random_hull(Random& random, int points, double low, double high) {
    const dvec3 scale{random.range(low, high), random.range(low, high), random.range(low, high)};
    std::vector<vec3> cloud;
    for (int i = 0; i < points; ++i) cloud.push_back(vec3(random_direction(random) * scale));
    return hull_of(cloud);
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

/// A convex shape of the type, with sizes below 1 m; a hull where it is no primitive.
inline Shape random_shape(ShapeType type, Random& r) {
    const auto size = [&](double low, double high) { return static_cast<float>(r.range(low, high)); };
    switch (type) {
        case ShapeType::Sphere: return Sphere{size(0.05, 0.6)};
        case ShapeType::Capsule: return Capsule{size(0.05, 0.4), size(0.0, 0.8)};
        case ShapeType::Box: return Box{{size(0.1, 1), size(0.1, 1), size(0.1, 1)}};
        case ShapeType::Cylinder: return Cylinder{size(0.05, 0.7), size(0.05, 0.8)};
        case ShapeType::Cone: return Cone{size(0.05, 0.7), size(0.05, 0.8)};
        default: return random_hull(r, 8 + static_cast<int>(r.range(0, 20)), 0.3, 1.0);
    }
}

}  // namespace carom::test
