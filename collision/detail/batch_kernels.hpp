// The wide halves of batch_tests.hpp: a block of items in float, and the numbers of those that floats cannot decide.
//
//   std::size_t unsure = sphere_boxes(sphere, boxes, hits, unclear);   // hits[unclear[0 .. unsure - 1]] are to be computed in double
//
// Each kernel bounds its own rounding, and is certain only where the answer in double cannot differ; NaN, infinity and sizes outside
// 2^-28 .. 2^60 are never certain.
#pragma once

#include <carom/collision/closest_points.hpp>
#include <carom/collision/primitives.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

namespace carom::geo::detail {

/// Items a kernel takes at once, at most; `unclear` has room for kBlock + 16.
inline constexpr std::size_t kBlock = 1024;

std::size_t ray_boxes(const Ray<float>& ray, std::span<const Aabb<float>> boxes, float* t, std::int32_t* unclear);
std::size_t ray_triangles(const Ray<float>& ray, std::span<const Triangle<float>> triangles, float* t, std::int32_t* unclear);
std::size_t sphere_boxes(const Sphere<float>& sphere, std::span<const Aabb<float>> boxes, std::uint8_t* hit, std::int32_t* unclear);
std::size_t box_boxes(const Obb<float>& box, std::span<const Obb<float>> boxes, std::uint8_t* hit, std::int32_t* unclear);
std::size_t point_triangles(const Vec3<float>& point, std::span<const Triangle<float>> triangles, ClosestPoints<float>* closest,
                            std::int32_t* unclear);

}  // namespace carom::geo::detail
