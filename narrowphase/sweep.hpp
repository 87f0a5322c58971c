// Moving spheres, capsules, boxes and half-spaces against single primitives and meshes: when they first touch, in closed form.
//
//   geo::Sphere<float> ball{.center = {0, 9, 0}, .radius = 0.5f};
//   BasicImpact<float> hit = geo::sweep(ball, {0, -12, 0}, geo::Aabb<float>{{-1, 0, -1}, {1, 1, 1}});
//   if (hit.status == ImpactStatus::Touching) ball.center += hit.t * motion;
//
// For all of them:
//   Motion     A moves by `motion` from t = 0 to t = 1 without turning; B stands still. Where both move, give A the difference.
//   Verdict    solids are closed: what touches, touches. Overlapping: they touch or overlap at t = 0. A motion of zero is one: Overlapping
//              or Separated.
//   Contact    `point` lies on B, `normal` points from A to B; for Overlapping both are zero. A triangle is solid on both sides.
//   Guarantee  t is never later than the true time, and what is Separated is apart at every t. Each answer is that of B with its surface
//              moved outward by at most k eps S, k = 96, eps = 2.2e-16 (computed in double for float too), S the distance of A from B's
//              farthest point plus both radii (of half-spaces motion and offset besides, of capsules A's axis), plus 1e-69 m; t is rounded
//              downward to T.
//              Of capsules against boxes k is 160. Of triangles whose largest angle is a, and of edges that meet at the angle a, k is 160 and
//              it is k eps S / sin a, but never more than 3e-7 S. So contact is reported at most that much too early, measured along the normal,
//              and only what passes
//              within that is made up.
//   Bad input  NaN or infinity, a negative radius or half extent, an inverted box, a plane's normal shorter than 1e-140, coordinates
//              beyond 1e70: Invalid.
//              Shapes of zero size are points, segments and rectangles.
//   Cost       O(1), no allocation, thread-safe: 20 to 200 ns for spheres, 40 to 400 ns for capsules but for cylinders and hulls, 1 to 2.4 µs.
//
// Method: a moving sphere touches S where its centre, a ray, meets S grown by the radius (Ericson, Real-Time Collision Detection, 2005, sec.
// 5.5): the union of the faces moved outward, cylinders about the edges and balls about the corners. A moving capsule besides meets
// edges with its axis: the ray meets the parallelogram of the two, grown; the single call is a batch of one. Departure: of boxes the squared distance along the ray, which
// is convex and quadratic between the crossings of the slabs, is solved piece by piece, which needs no regions (sec. 5.5.7 there misses rays
// that pass from the region of one edge by a corner to that of another). Cylinders, whose grown rim is a torus: the distance of a convex set is convex along a
// line, so where the plane between the two closest points lets them meet is before they do, and next to it in a few such steps (van den Bergen 2004 with
// the distance itself in the place of GJK). Shapes not listed here: time_of_impact.hpp.
#pragma once

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/primitives.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/check.hpp>
#include <carom/narrowphase/impact.hpp>

#include <cstdint>
#include <span>
#include <type_traits>

namespace carom::geo {

/// Against the half-space below a plane, whose normal need not be of unit length.
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Sphere<T>& a, const Vec3<T>& motion, const Plane<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Sphere<T>& a, const Vec3<T>& motion, const Sphere<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Sphere<T>& a, const Vec3<T>& motion, const Capsule<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Sphere<T>& a, const Vec3<T>& motion, const Aabb<T>& b) noexcept;
/// Axes that are not orthonormal turn the box by as much as they are off.
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Sphere<T>& a, const Vec3<T>& motion, const Obb<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Sphere<T>& a, const Vec3<T>& motion, const Triangle<T>& b) noexcept;

/// Against a solid cylinder, or one without length, which is taken for a ball of its radius: 0.2 µs. By planes that part the two (below).
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Sphere<T>& a, const Vec3<T>& motion, const Cylinder<T>& b) noexcept;

template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Capsule<T>& a, const Vec3<T>& motion, const Plane<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Capsule<T>& a, const Vec3<T>& motion, const Sphere<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Capsule<T>& a, const Vec3<T>& motion, const Capsule<T>& b) noexcept;
/// The box swept along the axis, grown: its boundary is of the box at either end, and of what edges and corners sweep.
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Capsule<T>& a, const Vec3<T>& motion, const Aabb<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Capsule<T>& a, const Vec3<T>& motion, const Obb<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Capsule<T>& a, const Vec3<T>& motion, const Triangle<T>& b) noexcept;
/// By planes that part the two: 2 µs. k is 1e5 here.
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Capsule<T>& a, const Vec3<T>& motion, const Cylinder<T>& b) noexcept;

/// Against the hull of the vertices, in its frame: as time_of_impact() has what does not turn (time_of_impact.hpp), so contact is found within 1e-9 of the
/// sizes and 2^-46 of the motion, and Clamped is an answer. 1 µs for 32 vertices.
[[nodiscard]] Impact sweep(const Sphere<double>& a, const Vec3<double>& motion, const ConvexHull& b) noexcept;
[[nodiscard]] Impact sweep(const Capsule<double>& a, const Vec3<double>& motion, const ConvexHull& b) noexcept;

/// Two boxes along the axes: slabs (Kay and Kajiya 1986).
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Aabb<T>& a, const Vec3<T>& motion, const Aabb<T>& b) noexcept;

/// The half-space below a moving plane against what stands still: the lowest point of B, whose height falls linearly.
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Plane<T>& a, const Vec3<T>& motion, const Sphere<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Plane<T>& a, const Vec3<T>& motion, const Capsule<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Plane<T>& a, const Vec3<T>& motion, const Aabb<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Plane<T>& a, const Vec3<T>& motion, const Obb<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Plane<T>& a, const Vec3<T>& motion, const Cylinder<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Plane<T>& a, const Vec3<T>& motion, const Cone<T>& b) noexcept;
template <class T>
[[nodiscard]] BasicImpact<T> sweep(const Plane<T>& a, const Vec3<T>& motion, const Triangle<T>& b) noexcept;
/// Every vertex is looked at; the mesh may be open.
[[nodiscard]] Impact sweep(const Plane<double>& a, const Vec3<double>& motion, const ConvexHull& b) noexcept;
[[nodiscard]] Impact sweep(const Plane<double>& a, const Vec3<double>& motion, const TriangleMesh& b) noexcept;

/// The first contact with a mesh, and its triangle.
struct MeshImpact : Impact {
    static constexpr std::uint32_t kNone = 0xffffffffu;
    std::uint32_t triangle = kNone;  ///< the lowest of several at one t; kNone where they do not touch
};
/// In the mesh's frame. Solid is only the surface: what is inside a closed mesh and touches none of it is Separated. Of a one-sided mesh
/// contacts count where A's centre is in front of it then, and was in front of the triangle's plane at t = 0.
/// Cost: O(log m + triangles that the sweep comes near before the sphere's centre, or an end of the capsule's axis, hits the mesh); spheres judge these
/// in lanes, and few one by one.
[[nodiscard]] MeshImpact sweep(const Sphere<double>& a, const Vec3<double>& motion, const TriangleMesh& b);
[[nodiscard]] MeshImpact sweep(const Capsule<double>& a, const Vec3<double>& motion, const TriangleMesh& b);

/// The batches that kernels take several of at once; sweep() below calls it, and says what the spans are.
template <class A, class B, class T>
void sweep_together(std::span<const A> a, std::span<const Vec3<T>> motions, std::span<const B> b, std::span<BasicImpact<T>> out);
/// What sweep_together() takes.
template <class A, class B, class T>
inline constexpr bool kSweptTogether = std::is_same_v<B, Cylinder<T>> ? std::is_same_v<A, Sphere<T>>
                                                                      : (std::is_same_v<A, Sphere<T>> || std::is_same_v<A, Capsule<T>>)&&(
                                                                            std::is_same_v<B, Plane<T>> || std::is_same_v<B, Sphere<T>> ||
                                                                            std::is_same_v<B, Capsule<T>> || std::is_same_v<B, Aabb<T>> ||
                                                                            std::is_same_v<B, Obb<T>> || std::is_same_v<B, Triangle<T>>);

/// Batches: a[i] by motions[i] against b[i], the same bits as of the single call. For every pair of types above but meshes.
/// Cost: several at once, spheres against planes, spheres, capsules, boxes and triangles 11 to 45 ns, against cylinders 85; capsules against planes and
/// spheres 12 to 22 ns, against capsules, boxes and triangles 33 to 67. What else there is, one by one.
/// @param motions, b, out  (n,) as a; otherwise reports misuse and changes nothing.
template <class A, class B, class T>
void sweep(std::span<const A> a, std::span<const Vec3<T>> motions, std::span<const B> b, std::span<BasicImpact<T>> out) {
    CAROM_REQUIRE(a.size() == motions.size() && a.size() == b.size() && a.size() == out.size(), ErrorCode::InvalidArgument,
                  "sweep: spans differ in length");
    if constexpr (kSweptTogether<A, B, T>) {
        sweep_together(a, motions, b, out);
    } else {
        for (std::size_t i = 0; i < a.size(); ++i) out[i] = sweep(a[i], motions[i], b[i]);
    }
}

}  // namespace carom::geo
