// Whether two primitives overlap: spheres, boxes, capsules and triangles, in all pairs, in float or double.
//
//   if (geo::overlaps(geo::Sphere<float>{player, 0.4f}, geo::Obb<float>{.center = crate})) { ... }
//   bool hit = geo::overlaps(geo::Capsule<double>{{foot, head}, 0.3}, geo::Triangle<double>{a, b, c});
#pragma once

#include <carom/collision/closest_points.hpp>

namespace carom::geo {

/// Sphere, Aabb, Obb, Capsule or Triangle, of float or of double.
template <class A>
concept Overlappable = detail::kIsOneOf<A, Sphere, Aabb, Obb, Capsule, Triangle>;

/// Whether `a` and `b` share a point. Both are closed: those that only touch do. All but the triangle are solid.
///
/// @param a, b  in one frame; of the same scalar type. Triangles may be degenerate, boxes flat, capsules and spheres points. Coordinate
///              differences stay below the scalar's largest number.
/// @return      false for bad input: NaN, infinity (allowed in the bounds of two Aabbs), a negative radius or half extent, an
///              inverted box. Symmetric up to the accuracy below.
/// Accuracy, with eps = 2^-52 for float and double alike, u T's machine epsilon, and size = the largest coordinate difference of the
/// two, half extent or radius: conservative, so `false` is certain, and `true` is wrong at most where the two are within 32 eps size
/// of each other; with an Obb, whose axes are orthonormal only to T, within 128 u size, and `false` is certain for axes
/// orthonormal to 2 u. Two Aabbs are exact.
/// Cost: O(1), no allocation, thread-safe; some 20 ns for a sphere and an Aabb, 75 to 130 ns for turned boxes. Triangles that touch
/// others or boxes to rounding cost their distance too.
/// Source: Gottschalk, Lin, Manocha (1996) for boxes, Akenine-Moller (2001) for triangle and box, Ericson (2005) sec. 5.2. Instead of a
/// constant added to parallel edges, a verdict that an edge's axis cannot carry is left to the distance (closest_points.hpp).
template <Overlappable A, Overlappable B>
requires std::same_as<detail::Scalar<A>, detail::Scalar<B>>
[[nodiscard]] bool overlaps(const A& a, const B& b) noexcept;

}  // namespace carom::geo
