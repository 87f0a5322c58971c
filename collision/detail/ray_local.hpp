// Ray casts in a shape's own frame, one function per shape.
//
//   std::optional<RayHit> hit = cast_local(sphere, LocalRay{origin, unit_direction, 20.0});
#pragma once

#include <carom/collision/ray_cast.hpp>
#include <carom/core/types.hpp>

#include <optional>

namespace carom {

/// A valid ray with a direction of unit length to a few ulp, in the frame of the shape.
struct LocalRay {
    dvec3 origin{0.0};
    dvec3 direction{0.0, 0.0, 1.0};
    double max_distance = 0.0;
};

// Each follows the contract of cast_ray. Overflow on the way (origins beyond 1e150) ends in a NaN or an infinity, which every
// comparison below treats as a miss.
[[nodiscard]] std::optional<RayHit> cast_local(const Sphere& sphere, const LocalRay& ray) noexcept;
[[nodiscard]] std::optional<RayHit> cast_local(const Box& box, const LocalRay& ray) noexcept;
[[nodiscard]] std::optional<RayHit> cast_local(const Capsule& capsule, const LocalRay& ray) noexcept;
[[nodiscard]] std::optional<RayHit> cast_local(const Plane& plane, const LocalRay& ray) noexcept;
[[nodiscard]] std::optional<RayHit> cast_local(const ConvexHull& hull, const LocalRay& ray) noexcept;
[[nodiscard]] std::optional<RayHit> cast_local(const TriangleMesh& mesh, const LocalRay& ray) noexcept;
[[nodiscard]] std::optional<RayHit> cast_local(const Cylinder& cylinder, const LocalRay& ray) noexcept;
[[nodiscard]] std::optional<RayHit> cast_local(const Cone& cone, const LocalRay& ray) noexcept;
[[nodiscard]] std::optional<RayHit> cast_local(const Compound& compound, const LocalRay& ray) noexcept;

/// How far the origin of `ray` can move along it and stay outside the ball of `radius` about `center`, by at least `radius`; 0 if
/// the origin is nearer than that or the ray leads away. Working from there keeps the rounding error of far origins to the
/// one of this move.
[[nodiscard]] double free_distance(const LocalRay& ray, const dvec3& center, double radius) noexcept;

/// @return what a ray hits that starts inside a solid.
[[nodiscard]] inline RayHit hit_from_inside(const LocalRay& ray) noexcept {
    return {0.0, ray.origin, -ray.direction, 0};
}

}  // namespace carom
