// Shapes of every kind, motions past them, and the first contact found the long way: part by part with time_of_impact().
//
//   const Shape wall = any_shape(random, i);
//   const Impact truth = first_by_search(ball, motion, wall, pose, {});
#pragma once

#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/narrowphase/time_of_impact.hpp>

#include <support/box_mesh.hpp>
#include <support/random_pose.hpp>

#include <utility>
#include <vector>

namespace carom::test {

inline constexpr int kConvexKinds = 6, kKinds = 9;

inline Shape any_convex(Random& random, int kind) {
    const auto size = [&] { return static_cast<float>(random.range(0.1, 0.6)); };
    switch (kind % kConvexKinds) {
        case 0: return Sphere{size()};
        case 1: return Box{{size(), size(), size()}};
        case 2: return Capsule{size(), size()};
        case 3: return Cylinder{size(), size()};
        case 4: return Cone{size(), size()};
        default: break;
    }
    std::vector<vec3> points;
    for (int i = 0; i < 12; ++i) points.push_back(size() * vec3(random_direction(random)));
    return *ConvexHull::build(points);
}

/// Besides the convex ones a plane, a mesh and a compound of four parts.
inline Shape any_shape(Random& random, int kind) {
    switch (kind % kKinds) {
        case 6: return Plane{vec3(random_direction(random)), static_cast<float>(random.range(-0.5, 0.5))};
        case 7: return box_mesh({0.5f, 0.3f, 0.4f}, 3);
        case 8: break;
        default: return any_convex(random, kind);
    }
    std::vector<CompoundPart> parts;
    for (int i = 0; i < 4; ++i) parts.push_back({any_convex(random, kind + i), {0.6 * random_direction(random), random_rotation(random)}});
    return *Compound::build(std::move(parts));
}

/// From `distance` away towards, past or through the origin, turning by up to `spin`.
inline RigidMotion any_motion(Random& random, double distance, double spin) {
    RigidMotion m;
    m.start = {distance * random_direction(random), random_rotation(random)};
    m.translation = 0.5 * random_direction(random) - m.start.position * random.range(0.3, 2.0);
    m.rotation = spin * random.unit() * random_direction(random);
    if (spin > 0.0) m.pivot = 0.1 * random_direction(random);
    return m;
}

inline Impact first_by_search(const Shape& a, const RigidMotion& motion, const Shape& b, const Pose& pose, const TimeOfImpactSettings& settings) {
    if (const CompoundPtr* compound = std::get_if<CompoundPtr>(&b)) {
        Impact first;
        for (const CompoundPart& part : (*compound)->parts()) {
            const Impact next = first_by_search(a, motion, part.shape, pose * part.pose, settings);
            if (may_touch(next.status) && (!may_touch(first.status) || next.t < first.t)) first = next;
        }
        return first;
    }
    if (const TriangleMeshPtr* mesh = std::get_if<TriangleMeshPtr>(&b)) return time_of_impact(a, motion, **mesh, {.start = pose}, settings);
    return time_of_impact(a, motion, b, {.start = pose}, settings);
}

}  // namespace carom::test
