// Contact of a ball, or of a point of a capsule's segment, with anything.
#pragma once

#include <carom/narrowphase/detail/kernel.hpp>

#include <glm/geometric.hpp>

#include <cmath>

namespace carom::detail {

/// The contact of a ball with a surface at the signed distance `distance` from its centre along `normal` (from the ball to the surface;
/// negative where the centre is inside).
inline void add_ball(Patch& patch, const dvec3& centre, double radius, double distance, std::uint64_t feature) noexcept {
    patch.add(centre + (0.5 * (radius + distance)) * patch.normal, distance - radius, feature);
}

/// A unit vector along `v` with its length; `fallback` with length 0 where v is too short to have a direction.
struct Direction {
    dvec3 unit{0.0};
    double length = 0.0;
};
[[nodiscard]] inline Direction direction_of(const dvec3& v, const dvec3& fallback) noexcept {
    const double length = std::sqrt(glm::dot(v, v));
    if (!(length > 1e-140)) return {fallback, 0.0};  // the squares are about to underflow
    return {v / length, length};
}

}  // namespace carom::detail
