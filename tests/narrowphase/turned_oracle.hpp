// Signed distance of convex solids by support functions alone, in long double: the greatest gap over all directions, which is the distance
// where they are apart and the least depth where they overlap. Written apart from the engine: a solid is what it reaches along a direction.
#pragma once

#include "oracle.hpp"

#include <functional>

namespace carom::test {

/// How far a solid reaches along a direction, in world axes about `origin`.
using Reach = std::function<Real(const RealVec&)>;

inline Reach reach_of(const Shape& shape, const Pose& pose, const dvec3& origin) {
    const RealVec centre = real(pose.position) - real(origin);
    const glm::qua<Real> q(pose.orientation);
    const RealVec axis = carom::rotate(q, RealVec(0, 1, 0));
    const auto turned = [=](Real lower, Real upper, Real h) -> Reach {
        return [=](const RealVec& n) {
            const Real along = glm::dot(n, axis);
            const RealVec across = n - along * axis;
            const Real side = std::sqrt(glm::dot(across, across));
            return glm::dot(n, centre) + std::max(h * along + upper * side, -h * along + lower * side);
        };
    };
    const auto corners = [=](std::span<const vec3> local) -> Reach {
        std::vector<RealVec> world;
        for (const vec3& v : local) world.push_back(centre + carom::rotate(q, real(dvec3(v))));
        return [world](const RealVec& n) {
            Real best = -1e30L;
            for (const RealVec& v : world) best = std::max(best, glm::dot(n, v));
            return best;
        };
    };
    switch (type_of(shape)) {
        case ShapeType::Sphere: {
            const Real r = std::get<Sphere>(shape).radius;
            return [=](const RealVec& n) { return glm::dot(n, centre) + r * length_of(n); };
        }
        case ShapeType::Capsule: {
            const Capsule& c = std::get<Capsule>(shape);
            const Real r = c.radius, h = c.half_segment;
            return [=](const RealVec& n) { return glm::dot(n, centre) + h * std::abs(glm::dot(n, axis)) + r * length_of(n); };
        }
        case ShapeType::Cylinder: {
            const Cylinder& c = std::get<Cylinder>(shape);
            return turned(c.radius, c.radius, c.half_height);
        }
        case ShapeType::Cone: return turned(std::get<Cone>(shape).radius, 0, std::get<Cone>(shape).half_height);
        case ShapeType::Box: return corners(corners_of(std::get<Box>(shape)));
        default: return corners(std::get<ConvexHullPtr>(shape)->vertices());
    }
}

/// The gap that a direction from a to b shows; negative where they overlap along it.
inline Real gap_along(const Reach& a, const Reach& b, const RealVec& n) { return -b(-n) - a(n); }

/// The direction of the greatest gap: directions spread over the sphere, and the best of them followed by pattern search to 1e-9, with
/// steps in turned axes so that the ridges where two features compete do not stop it.
inline Separation greatest_gap(const Reach& a, const Reach& b, Random& random) {
    constexpr int kSpread = 300, kFollowed = 4;
    std::vector<Separation> found;
    for (int i = 0; i < kSpread; ++i) {  // a Fibonacci spiral
        const double z = 1.0 - 2.0 * (i + 0.5) / kSpread, s = std::sqrt(1.0 - z * z), angle = i * kPi * (3.0 - std::sqrt(5.0));
        const RealVec n = real({s * std::cos(angle), s * std::sin(angle), z});
        found.push_back({gap_along(a, b, n), n});
    }
    std::stable_sort(found.begin(), found.end(), [](const Separation& x, const Separation& y) { return x.value > y.value; });
    Separation best;
    for (int f = 0; f < kFollowed; ++f) {
        Separation at = found[static_cast<std::size_t>(f)];
        for (Real step = 0.1L; step > 1e-8L;) {
            const RealVec u = real(any_perpendicular(dvec3(at.normal))), w = glm::cross(at.normal, u);
            const double phase = random.range(0.0, 2.0 * kPi);
            Separation next = at;
            for (int k = 0; k < 8; ++k) {
                const double angle = phase + 0.25 * kPi * k;
                RealVec n = at.normal + step * (Real(std::cos(angle)) * u + Real(std::sin(angle)) * w);
                n /= length_of(n);
                const Real value = gap_along(a, b, n);
                if (value > next.value) next = {value, n};
            }
            if (next.value > at.value) {
                at = next;
            } else {
                step *= 0.6L;
            }
        }
        if (at.value > best.value) best = at;
    }
    return best;
}

}  // namespace carom::test
