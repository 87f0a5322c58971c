// Where a ray first meets triangles, in integers without any rounding: what faster and less exact casts are held against.
//
//   std::optional<double> t = oracle::exact_distance(vertices, triangles, offset, ray);
#pragma once

#include <carom/collision/ray_cast.hpp>
#include <carom/core/types.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace carom::oracle {

/// The first point of `ray` on the triangles moved by `offset`, by the contract of cast_ray: edges and corners belong to their
/// triangles, a ray in the plane of a triangle misses it. Ray, offset and vertices are taken as the exact numbers that they are:
/// the signs of all orientations are exact, and the direction is not rounded to unit length.
///
/// @param vertices, triangles  (n,), (m,) indices below n; finite.
/// @param ray  validate(ray) holds; max_distance takes no part.
/// @return the distance along the normalised direction, within 1 ulp of the exact one [m]; none where the ray misses.
/// Cost: O(m), 10 ns for a triangle far from the ray's line and some 10 us for one near it.
[[nodiscard]] std::optional<double> exact_distance(std::span<const vec3> vertices,
                                                   std::span<const std::array<std::uint32_t, 3>> triangles, const dvec3& offset,
                                                   const Ray& ray);

}  // namespace carom::oracle
