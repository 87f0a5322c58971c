// The triangles of a static hierarchy that a moving box or ball may meet, near ones mostly first.
//
//   triangles_along(bvh, {.origin = centre, .direction = motion, .t_max = 1}, radius, [&](std::uint32_t triangle, const vec3* corners) {
//       return first = std::min(first, time_of_contact(triangle, corners));  // nothing later is wanted
//   });
#pragma once

#include <carom/collision/primitives.hpp>
#include <carom/collision/static_bvh.hpp>
#include <carom/core/function_ref.hpp>

#include <cstdint>

namespace carom {

/// Called for a triangle, by its number in the mesh. @return the t beyond which no triangle is wanted any more.
using SweepVisit = FunctionRef<double(std::uint32_t triangle)>;
/// The same with its three corners, or null where the hierarchy does not hold them to the bit: they are at hand then, and the mesh's own are not.
using BallVisit = FunctionRef<double(std::uint32_t triangle, const vec3* corners)>;

/// Visits the triangles whose boxes may come to touch the box with the half extents `half` about ray.origin + t ray.direction while t is in
/// [0, ray.t_max] and not above what the last visit returned. None of these is left out; others may be visited.
/// @param ray   finite, in the mesh's frame; t_min is not read. A direction of zero stands still.
/// @param half  finite, >= 0. Bad input visits nothing.
/// Cost: O(log m + triangles near the path): some 10 ns a node or leaf that is met. No allocation, thread-safe.
void triangles_along(const StaticBvh& bvh, const geo::Ray<double>& ray, const dvec3& half, SweepVisit visit);

/// The same for the ball about ray.origin + t ray.direction: visits the triangles that may come as near to its centre as `radius` and 3e-7 of
/// their farthest point's distance from it at t = 0. Of a leaf's, those first which it may touch first, so most of those met later are left out.
/// @param radius  finite, >= 0. Bad input visits nothing.
/// Cost: as above; a leaf that is met 60 to 100 ns.
void triangles_along(const StaticBvh& bvh, const geo::Ray<double>& ray, double radius, BallVisit visit);

}  // namespace carom
