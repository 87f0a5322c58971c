// One primitive against many, sixteen at a time: rays, spheres, boxes and points against arrays of boxes and triangles as they lie in
// memory.
//
//   std::vector<geo::Aabb<float>> boxes = ...;
//   std::vector<float> t(boxes.size());
//   geo::cast_ray_batch(boxes, ray, t);                        // t[i]: where the ray enters box i; infinity where it does not
//   std::vector<std::uint8_t> hit(boxes.size());
//   geo::overlaps_batch(boxes, geo::Sphere<float>{p, 2}, hit);  // hit[i]: 1 or 0
//
// Verdicts are those of the functions for one pair (ray_primitives.hpp, overlap_tests.hpp), always: floats decide what is clear beyond
// their own rounding, and the few items that are not, bad and extreme input included, are computed one by one in double. So the same
// bits come out at every SIMD width too. Sizes of spans that differ are misuse and leave the output as it was. No allocation,
// thread-safe.
#pragma once

#include <carom/collision/closest_points.hpp>
#include <carom/collision/overlap_tests.hpp>
#include <carom/collision/ray_primitives.hpp>

#include <cstdint>
#include <span>

namespace carom::geo {

/// Where the ray enters each box, as cast_ray(box, ray).
/// @param boxes  (n,) @param ray  any; a bad one hits nothing.
/// @param t      (n,), becomes t of the hit, ray.t_min where the ray starts inside, infinity for a miss. Within 8 float eps of itself.
/// Cost: some 3 ns a box with AVX-512, 6 with AVX2.
void cast_ray_batch(std::span<const Aabb<float>> boxes, const Ray<float>& ray, std::span<float> t);

/// Where the ray hits each triangle, from either side, as cast_ray(triangle, ray); its watertight verdicts too. For the weights and the
/// normal call that function with the triangle that is wanted.
/// @param triangles  (n,)
/// @param t          (n,), becomes t of the hit, infinity for a miss. The point t lies at is within 512 float eps S of the true one,
///                   with S the distance of the ray's origin from the triangle's corners.
/// Cost: some 13 ns a triangle with AVX-512, 16 with AVX2; what the ray grazes and needles cost as much as one alone.
void cast_ray_batch(std::span<const Triangle<float>> triangles, const Ray<float>& ray, std::span<float> t);

/// Whether the sphere overlaps each box, as overlaps(sphere, box).
/// @param boxes  (n,) @param hit  (n,), becomes 1 or 0.
/// Cost: some 3 ns a box with AVX-512, 6 with AVX2.
void overlaps_batch(std::span<const Aabb<float>> boxes, const Sphere<float>& sphere, std::span<std::uint8_t> hit);

/// Whether `box` overlaps each of the boxes, as overlaps(box, boxes[i]).
/// @param boxes  (n,) @param hit  (n,), becomes 1 or 0.
/// Cost: some 8 to 10 ns a box with AVX-512, 13 to 19 with AVX2.
void overlaps_batch(std::span<const Obb<float>> boxes, const Obb<float>& box, std::span<std::uint8_t> hit);

/// The point of each triangle that is closest to `point`, and the squared distance; on_a is `point`.
/// @param triangles  (n,)
/// @param closest    (n,). NaN throughout where closest_points() has NaN.
/// Accuracy: float throughout, unlike closest_points(): distances are met, and points lie on their triangles, within 16 float eps of
/// the largest coordinate difference; points besides are rounded to float, each coordinate by half an ulp of itself: far from the
/// world's origin that is more.
/// Cost: some 13 ns a triangle with AVX-512, 21 with AVX2.
void closest_points_batch(std::span<const Triangle<float>> triangles, const Vec3<float>& point, std::span<ClosestPoints<float>> closest);

}  // namespace carom::geo
