// Ray casts against every shape, in the shape's own frame or placed by a pose.
//
//   if (auto hit = cast_ray(shape, pose, {.origin = {0, 9, 0}, .direction = {0, -1, 0}, .max_distance = 20})) ...
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/pose.hpp>

#include <cstdint>
#include <limits>
#include <optional>

namespace carom {

/// A half-line. `direction` need not be of unit length, but not zero; `max_distance` is in metres along the normalised direction.
struct Ray {
    dvec3 origin{0.0};
    dvec3 direction{0.0, 0.0, 1.0};
    double max_distance = std::numeric_limits<double>::infinity();
};

/// The first point of a ray on a shape.
struct RayHit {
    double distance = 0.0;       ///< along the normalised direction [m]
    dvec3 point{0.0};            ///< on the surface, in the ray's frame [m]
    dvec3 normal{0.0};           ///< unit, outward; of a triangle: against the ray
    std::uint32_t triangle = 0;  ///< of a mesh; otherwise 0
    std::uint32_t part = 0;      ///< of a compound; otherwise 0
};

/// @return NotFinite or InvalidArgument where the ray has a non-finite origin or direction, a zero direction, or a NaN or
/// negative max_distance.
[[nodiscard]] Status validate(const Ray& ray);

/// First hit of `ray` on `shape` in the shape's own frame, at a distance in [0, max_distance].
///
/// A ray that starts in a solid shape or on its surface hits at distance 0, at its origin, with the normal against the ray's
/// direction; meshes are surfaces, so there is no inside. Of a mesh, edges and corners belong to their triangles, a closed mesh
/// lets no ray through between triangles, a ray in the plane of a triangle misses that triangle, and of several triangles at
/// one distance the lowest is hit; of several parts of a compound too.
/// @return nothing where the ray misses, and where validate(ray) fails. Never a NaN.
/// Accuracy: distance to 1e-12 relative to the larger of distance and shape size, in double, for rays that do not graze; pinned
/// in tests/collision/.
/// Cost: O(1); hull O(faces); mesh O(log triangles) and compound O(log parts) expected. No allocation, thread-safe.
/// Source: Ericson, Real-Time Collision Detection (2005), sec. 5.3; triangles by Woop, Benthin, Wald (JCGT 2013).
[[nodiscard]] std::optional<RayHit> cast_ray(const Shape& shape, const Ray& ray);

/// The same for `shape` placed at `pose`; ray and hit are in the frame that `pose` is in.
/// @return nothing where `pose` is not finite, besides the above.
/// Accuracy: as above, and what rounding the ray into the shape's frame costs: a few ulp of |origin - position|.
[[nodiscard]] std::optional<RayHit> cast_ray(const Shape& shape, const Pose& pose, const Ray& ray);

}  // namespace carom
