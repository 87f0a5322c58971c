// The triangles of a static hierarchy that a moving box may meet, near ones mostly first.
//
//   triangles_along(bvh, {.origin = centre, .direction = motion, .t_max = 1}, dvec3{radius}, [&](std::uint32_t triangle) {
//       return first = std::min(first, time_of_contact(triangle));         // nothing later is wanted
//   });
#pragma once

#include <carom/collision/primitives.hpp>
#include <carom/collision/static_bvh.hpp>
#include <carom/core/function_ref.hpp>

#include <cstdint>

namespace carom {

/// Called for a triangle, by its number in the mesh. @return the t beyond which no triangle is wanted any more.
using SweepVisit = FunctionRef<double(std::uint32_t triangle)>;

/// Visits the triangles whose boxes may come to touch the box with the half extents `half` about ray.origin + t ray.direction while t is in
/// [0, ray.t_max] and not above what the last visit returned. None of these is left out; others may be visited.
/// @param ray   finite, in the mesh's frame; t_min is not read. A direction of zero stands still.
/// @param half  finite, >= 0. Bad input visits nothing.
/// Cost: O(log m + triangles near the path): some 10 ns a node or leaf that is met. No allocation, thread-safe.
void triangles_along(const StaticBvh& bvh, const geo::Ray<double>& ray, const dvec3& half, SweepVisit visit);

}  // namespace carom
