// Rays against single primitives: the first point hit, and of solids the whole interval inside.
//
//   geo::Sphere<float> ball{.center = {0, 2, 0}, .radius = 0.5f};
//   if (auto hit = geo::cast_ray(ball, {.origin = {0, 9, 0}, .direction = {0, -1, 0}})) { hit->t; hit->normal; }
//   if (auto inside = geo::ray_interval(ball, ray)) { inside->t_enter; inside->t_exit; }
//
// For all of them:
//   t          counts lengths of the ray's direction; a t that double (float) cannot hold is infinite, and never that of a hit.
//   Verdict    solids are closed: what touches, hits. A hit has t_min <= t <= t_max.
//   Bad input  NaN or infinity in origin, direction or shape, a zero direction, t_min > t_max, an inverted box, a negative radius, and
//              what primitives.hpp forbids for a shape (a cylinder of no height, a zero normal; a height below 1e-270 of the largest
//              coordinate may count as none): no hit. Never a NaN in a result. -0 is
//              0; t_min and t_max may be infinite.
//   Accuracy   in double, and float is computed in double and rounded once. Each function states k: the answer is that of the exact
//              shape with its surface moved by at most k eps S, and t besides is rounded to T; eps is that of double (2.3e-16), S the
//              distance of the ray's origin from the shape's center (tip, corner) plus the shape's size, plus, for underflow, 1e-120
//              of the largest coordinate. So verdicts are exact outside of k eps S, near the world's origin and far from it. Pinned in
//              tests/collision/ray_primitives_test.cpp against exact rationals.
//   Cost       O(1), no allocation, thread-safe.
#pragma once

#include <carom/collision/primitives.hpp>

#include <optional>
#include <span>

namespace carom::geo {

/// The first point of a ray on a primitive: ray.origin + t ray.direction.
template <class T>
struct RayHit {
    T t = T(0);
    Vec3<T> normal{T(0)};  ///< unit; of a solid outward, of a surface against the ray
};

/// The points t_enter <= t <= t_exit of the line of a ray that lie in a solid. t_enter < t_min: the ray starts inside.
template <class T>
struct RayInterval {
    T t_enter = T(0);
    T t_exit = T(0);
    Vec3<T> normal_enter{T(0)};  ///< unit, outward, where the line enters; zero where t_enter is infinite
    Vec3<T> normal_exit{T(0)};
};

template <class T>
struct TriangleHit {
    T t = T(0);
    Vec3<T> normal{T(0)};   ///< unit, against the ray
    Vec3<T> weights{T(0)};  ///< of the corners: the point is their mean by these, which sum to 1
};

/// The interval of a line in a solid, not cut to the ray's range.
/// @return nothing where no point of the ray, t_min <= t <= t_max, is in the solid.
///
/// Sphere: k = 4. From the point of closest approach (Haines, Günther, Akenine-Möller, in Ray Tracing Gems, 2019, ch.
/// 7); near the surface from the product of the roots, so that an origin that is exactly on it has t = 0.
template <class T>
[[nodiscard]] std::optional<RayInterval<T>> ray_interval(const Sphere<T>& sphere, const Ray<T>& ray) noexcept;
/// Aabb: k = 2, where S is the distance of each face's plane from the origin: t has a relative error of 2 eps at most, and where it underflows it
/// is off by the least number above zero at most.
/// Slabs (Kay and Kajiya 1986), divided rather than multiplied by a reciprocal, so that 0 * infinity does not come up.
template <class T>
[[nodiscard]] std::optional<RayInterval<T>> ray_interval(const Aabb<T>& box, const Ray<T>& ray) noexcept;
/// Obb: k = 4. Slabs in the box's own frame. Axes that are not orthonormal move the surface by as much as they are off.
template <class T>
[[nodiscard]] std::optional<RayInterval<T>> ray_interval(const Obb<T>& box, const Ray<T>& ray) noexcept;
/// Capsule: k = 4. The union of its two balls and the cylinder between; one whose ends are equal is a ball.
template <class T>
[[nodiscard]] std::optional<RayInterval<T>> ray_interval(const Capsule<T>& capsule, const Ray<T>& ray) noexcept;
/// Cylinder: k = 8.
template <class T>
[[nodiscard]] std::optional<RayInterval<T>> ray_interval(const Cylinder<T>& cylinder, const Ray<T>& ray) noexcept;
/// Cone: k = 8. The quadratic about the point closest to the tip, with the discriminant as a difference of two squares
/// that both vanish towards the tip (Lagrange's identity), so that rays at the tip are as exact as others.
template <class T>
[[nodiscard]] std::optional<RayInterval<T>> ray_interval(const Cone<T>& cone, const Ray<T>& ray) noexcept;
/// The half-space below a plane: k = 9, where S is the distance of the hit from the ray's origin: t has a relative
/// error of 9 eps, and the verdict is exact up to that. An end is infinite; both are where the line runs in the
/// half-space.
template <class T>
[[nodiscard]] std::optional<RayInterval<T>> ray_interval(const Plane<T>& below, const Ray<T>& ray) noexcept;

/// First hit of a ray on a solid, by ray_interval(), whose k it has. A ray that starts inside or on the surface hits at
/// t_min, with the normal against its direction.
template <class T>
[[nodiscard]] std::optional<RayHit<T>> cast_ray(const Sphere<T>& sphere, const Ray<T>& ray) noexcept;
template <class T>
[[nodiscard]] std::optional<RayHit<T>> cast_ray(const Aabb<T>& box, const Ray<T>& ray) noexcept;
template <class T>
[[nodiscard]] std::optional<RayHit<T>> cast_ray(const Obb<T>& box, const Ray<T>& ray) noexcept;
template <class T>
[[nodiscard]] std::optional<RayHit<T>> cast_ray(const Capsule<T>& capsule, const Ray<T>& ray) noexcept;
template <class T>
[[nodiscard]] std::optional<RayHit<T>> cast_ray(const Cylinder<T>& cylinder, const Ray<T>& ray) noexcept;
template <class T>
[[nodiscard]] std::optional<RayHit<T>> cast_ray(const Cone<T>& cone, const Ray<T>& ray) noexcept;

/// The plane itself, from either side: k and S of its half-space. A ray parallel to it misses it, within it too; one
/// within an angle of 2^-400 of that may.
template <class T>
[[nodiscard]] std::optional<RayHit<T>> cast_ray(const Plane<T>& plane, const Ray<T>& ray) noexcept;
/// From either side, the rim included: k = 9. A ray parallel to the disc misses it, within it too; one within an angle of 2^-400 of that may.
template <class T>
[[nodiscard]] std::optional<RayHit<T>> cast_ray(const Disc<T>& disc, const Ray<T>& ray) noexcept;

/// From either side, edges and corners included: k = 4, where S is the distance of each corner from the ray's origin.
/// Watertight: triangles that share an edge or a corner leave no gap between them, whatever the ray. A ray in the
/// triangle's plane misses it. The normal of a triangle without area is against the ray. Source: Woop, Benthin, Wald,
/// Watertight Ray/Triangle Intersection (JCGT 2013). Departure: edge functions have exact signs and full relative
/// precision, so that t is as good on needles as elsewhere.
template <class T>
[[nodiscard]] std::optional<TriangleHit<T>> cast_ray(const Triangle<T>& triangle, const Ray<T>& ray) noexcept;

/// A flat polygon of n >= 3 corners in order, convex or not, from either side. Its plane is the one through the first
/// corner with Newell's normal. Inside is where a line outward crosses its outline an odd number of times, counted in
/// the plane of the two axes on which the normal is smallest; points on the outline are inside. A ray parallel to the
/// plane misses it. k = 4 (1 + D²/A), with S the distance of the first corner from the ray's origin plus D, the
/// polygon's diameter, and A its area.
/// @return nothing also for fewer than 3 corners, or without area: A below n (n + 6) eps D². Cost: O(n).
/// Source: Haines, Point in Polygon Strategies (Graphics Gems IV, 1994), crossings test. Departure: the outline is
/// closed.
template <class T>
[[nodiscard]] std::optional<RayHit<T>> cast_ray_polygon(std::span<const Vec3<T>> corners, const Ray<T>& ray) noexcept;

}  // namespace carom::geo
