// Distances and verdicts of single primitives in numbers of 300 bits, by the plainest formulas there are: what the primitive tests in
// float and double are held against.
//
//   PreciseAnswer first = oracle::first_hit(sphere, ray);         // first.hit, first.value
//
// Inputs are exact doubles. Sums and products of them lose nothing that 300 bits do not hold, so verdicts are exact unless two values
// that are not rational agree in their first 80 digits.
#pragma once

#include <carom/collision/primitives.hpp>

namespace carom::oracle {

/// Whether they meet, and the number asked for, rounded to double (0 where there is none).
struct PreciseAnswer {
    bool hit = false;
    double value = 0.0;
};

/// The least t in [ray.t_min, ray.t_max] at which the ray is in the solid or on the surface.
[[nodiscard]] PreciseAnswer first_hit(const geo::Sphere<double>& sphere, const geo::Ray<double>& ray);
[[nodiscard]] PreciseAnswer first_hit(const geo::Aabb<double>& box, const geo::Ray<double>& ray);
/// Edges and corners included; a ray in the triangle's plane misses.
[[nodiscard]] PreciseAnswer first_hit(const geo::Triangle<double>& triangle, const geo::Ray<double>& ray);

/// Whether the two share a point, and the distance of the points, segments and triangles, or of the axes of capsules.
[[nodiscard]] PreciseAnswer distance(const dvec3& point, const geo::Triangle<double>& triangle);
[[nodiscard]] PreciseAnswer distance(const geo::Segment<double>& a, const geo::Segment<double>& b);
[[nodiscard]] PreciseAnswer overlap(const geo::Sphere<double>& sphere, const geo::Aabb<double>& box);
[[nodiscard]] PreciseAnswer overlap(const geo::Capsule<double>& a, const geo::Capsule<double>& b);
/// The boxes are the parallelepipeds that center, axes and half extents span, orthonormal or not.
[[nodiscard]] PreciseAnswer overlap(const geo::Obb<double>& a, const geo::Obb<double>& b);

}  // namespace carom::oracle
