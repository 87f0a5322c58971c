// On which side of a plane something lies, and how far.
//
//   geo::Plane<float> floor{.normal = {0, 1, 0}, .offset = 0};
//   if (geo::side_of(floor, box) == geo::Side::Above) { ... }
//   float depth = -geo::extent(floor, ball).lowest;
//
// Distances are dot(normal, x) - offset: metres where the normal is of unit length, otherwise metres times its length.
//   Accuracy   computed in double, float rounded once. Points, triangles, hulls and AABBs: distances within 4 eps of themselves, and sides
//              with margin 0 always right. Spheres, capsules, OBBs: sides are those of the exact plane moved by at most 12 eps of the
//              shape's size (radius, half diagonal) and its distance; eps is that of double, far from the world's origin too. Pinned
//              in tests/collision/plane_tests_test.cpp.
//   Bad input  NaN anywhere, an inverted box, a negative radius or half extent, an empty hull: Across, and NaN for distances. Numbers
//              above 1e150 in double may count as such, and below 1e-150 the sign is no longer exact.
//   Cost       O(1), hull O(n); no allocation, thread-safe.
#pragma once

#include <carom/collision/primitives.hpp>

#include <span>

namespace carom::geo {

enum class Side {
    Below,   ///< every point is below, or farther below than the margin
    Across,  ///< it touches the plane, is cut by it or within the margin of it
    Above,
};

/// The signed distances of a shape's lowest and highest point.
template <class T>
struct Extent {
    T lowest = T(0);
    T highest = T(0);
};

template <class T>
[[nodiscard]] T signed_distance(const Plane<T>& plane, const Vec3<T>& point) noexcept;

/// By the vertices farthest against and along the normal for boxes (n- and p-vertex; Greene 1994), by the normal's
/// components along its axes for an OBB, by the center or the ends and the radius for spheres and capsules.
template <class T>
[[nodiscard]] Extent<T> extent(const Plane<T>& plane, const Sphere<T>& sphere) noexcept;
template <class T>
[[nodiscard]] Extent<T> extent(const Plane<T>& plane, const Aabb<T>& box) noexcept;
template <class T>
[[nodiscard]] Extent<T> extent(const Plane<T>& plane, const Obb<T>& box) noexcept;
template <class T>
[[nodiscard]] Extent<T> extent(const Plane<T>& plane, const Capsule<T>& capsule) noexcept;
template <class T>
[[nodiscard]] Extent<T> extent(const Plane<T>& plane, const Triangle<T>& triangle) noexcept;
/// Of a hull by its vertices, (n,).
template <class T>
[[nodiscard]] Extent<T> extent(const Plane<T>& plane, std::span<const Vec3<T>> hull) noexcept;

/// @param margin  >= 0, in units of the distances: Above and Below only beyond it.
template <class T>
[[nodiscard]] Side side_of(const Plane<T>& plane, const Vec3<T>& point, T margin = T(0)) noexcept;
template <class T>
[[nodiscard]] Side side_of(const Plane<T>& plane, const Sphere<T>& sphere, T margin = T(0)) noexcept;
template <class T>
[[nodiscard]] Side side_of(const Plane<T>& plane, const Aabb<T>& box, T margin = T(0)) noexcept;
template <class T>
[[nodiscard]] Side side_of(const Plane<T>& plane, const Obb<T>& box, T margin = T(0)) noexcept;
template <class T>
[[nodiscard]] Side side_of(const Plane<T>& plane, const Capsule<T>& capsule, T margin = T(0)) noexcept;
template <class T>
[[nodiscard]] Side side_of(const Plane<T>& plane, const Triangle<T>& triangle, T margin = T(0)) noexcept;
template <class T>
[[nodiscard]] Side side_of(const Plane<T>& plane, std::span<const Vec3<T>> hull, T margin = T(0)) noexcept;

}  // namespace carom::geo
