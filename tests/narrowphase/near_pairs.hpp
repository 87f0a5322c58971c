// Pairs of convex shapes in the conditions that distance and overlap queries are tested under.
//
//   NearPair pair = near_pair(random, ShapeType::Box, ShapeType::ConvexHull, Condition::NearContact);
#pragma once

#include "oracle.hpp"

#include <carom/narrowphase/distance.hpp>

#include <array>
#include <cmath>

namespace carom::test {

enum class Condition { Random, NearContact, Aligned, Deep, Thin, Far, Tiny, Huge };
inline constexpr std::array kConditions{Condition::Random, Condition::NearContact, Condition::Aligned, Condition::Deep,
                                        Condition::Thin,   Condition::Far,         Condition::Tiny,    Condition::Huge};

struct NearPair {
    Shape a, b;
    Pose pose_a, pose_b;
    double size = 1.0;  ///< of the shapes, about [m]
};

inline Shape scaled_shape(const Shape& shape, float s, Random& r) {
    if (const Sphere* x = std::get_if<Sphere>(&shape)) return Sphere{s * x->radius};
    if (const Capsule* x = std::get_if<Capsule>(&shape)) return Capsule{s * x->radius, s * x->half_segment};
    if (const Box* x = std::get_if<Box>(&shape)) return Box{s * x->half_extents};
    if (const Cylinder* x = std::get_if<Cylinder>(&shape)) return Cylinder{s * x->radius, s * x->half_height};
    if (const Cone* x = std::get_if<Cone>(&shape)) return Cone{s * x->radius, s * x->half_height};
    std::vector<vec3> points;
    for (const vec3& v : (*std::get_if<ConvexHullPtr>(&shape))->vertices()) points.push_back(s * v);
    const ConvexHullPtr hull = hull_of(points);
    return hull != nullptr ? hull : scaled_shape(random_shape(ShapeType::ConvexHull, r), s, r);
}

inline Shape thin_shape(ShapeType type, Random& r) {
    const auto thin = static_cast<float>(std::exp2(r.range(-16.0, -6.0)));
    switch (type) {
        case ShapeType::Box: return Box{{r.unit() < 0.5 ? thin : 0.7f, thin, 1.0f}};
        case ShapeType::Capsule: return Capsule{thin, 1.0f};
        case ShapeType::Cylinder: return Cylinder{1.0f, std::max(thin, 1e-3f)};
        case ShapeType::Cone: return Cone{std::max(thin, 1e-3f), 1.0f};
        case ShapeType::ConvexHull: {
            std::vector<vec3> points;
            for (int i = 0; i < 12; ++i) points.push_back(vec3(random_direction(r) * dvec3{1.0, std::max(double(thin), 1e-3), 0.6}));
            const ConvexHullPtr hull = hull_of(points);
            return hull != nullptr ? Shape(hull) : random_shape(type, r);
        }
        default: return random_shape(type, r);
    }
}

/// A rotation by quarter turns about the axes.
inline dquat quarter_turns(Random& r) {
    dquat q = kIdentityRotation;
    for (int k = 0; k < 3; ++k) {
        const double h = std::sqrt(0.5);
        const dquat turns[4] = {{h, h, 0, 0}, {h, 0, h, 0}, {h, 0, 0, h}, {1, 0, 0, 0}};
        q = glm::normalize(q * turns[static_cast<int>(r.range(0.0, 4.0))]);
    }
    return q;
}

/// Moves b along the normal of contact until the gap is `gap`, as far as doubles hold the place.
inline void bring_near(NearPair& p, double gap) {
    const DistanceResult d = distance(p.a, p.pose_a, p.b, p.pose_b);
    if (d.lower > 0.0) {
        p.pose_b.position += (gap - d.upper) * d.normal;
        return;
    }
    const PenetrationResult in = penetration(p.a, p.pose_a, p.b, p.pose_b);
    p.pose_b.position += (gap + in.upper) * in.normal;
}

inline NearPair near_pair(Random& r, ShapeType a, ShapeType b, Condition condition) {
    NearPair p{random_shape(a, r), random_shape(b, r), {}, {}, 1.0};
    if (condition == Condition::Thin) p.a = thin_shape(a, r), p.b = thin_shape(b, r);
    if (condition == Condition::Tiny || condition == Condition::Huge) {
        p.size = std::exp2(std::floor(condition == Condition::Tiny ? r.range(-100.0, -20.0) : r.range(20.0, 100.0)));
        p.a = scaled_shape(p.a, static_cast<float>(p.size), r);
        p.b = scaled_shape(p.b, static_cast<float>(p.size), r);
    }
    p.pose_a.orientation = condition == Condition::Aligned ? quarter_turns(r) : random_rotation(r);
    p.pose_b.orientation = condition == Condition::Aligned ? quarter_turns(r) : random_rotation(r);
    if (condition == Condition::Aligned && r.unit() < 0.5) {  // all but parallel
        const double angle = std::exp2(r.range(-50.0, -3.0));
        p.pose_b.orientation = glm::normalize(p.pose_b.orientation * about(random_direction(r), angle));
    }
    const double reach = condition == Condition::Deep ? r.range(0.0, 0.2) : r.range(0.2, 2.4);
    p.pose_b.position = (condition == Condition::Deep && r.unit() < 0.2 ? 0.0 : p.size * reach) * random_direction(r);
    const double origin = condition == Condition::Far ? std::exp2(r.range(10.0, 30.0)) : p.size * r.range(0.0, 4.0);
    p.pose_a.position = origin * random_direction(r);
    p.pose_b.position += p.pose_a.position;
    const bool near = condition == Condition::NearContact || (condition != Condition::Random && condition != Condition::Deep && r.unit() < 0.5);
    if (near) bring_near(p, (r.unit() < 0.5 ? -1.0 : 1.0) * p.size * (r.unit() < 0.2 ? 0.0 : std::exp2(r.range(-54.0, -10.0))));
    return p;
}

}  // namespace carom::test
