// When two convex shapes that move and turn first touch, and a convex shape and a mesh: never later than they do.
//
//   RigidMotion fall{.start = pose, .translation = dt * velocity, .rotation = dt * spin};
//   Impact hit = time_of_impact(box, fall, wall, {.start = wall_pose});
//   if (may_touch(hit.status)) pose = pose_at(fall, hit.t);
#pragma once

#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/pose.hpp>
#include <carom/narrowphase/distance.hpp>
#include <carom/narrowphase/sweep.hpp>

namespace carom {

/// A screw: from t = 0 to t = 1 a point of the shape moves by `translation` on a straight line at constant speed, while the shape turns about
/// it at the constant rate `rotation`, by as many turns as that makes: not by the short arc between two poses.
struct RigidMotion {
    Pose start{};             ///< of the shape at t = 0; the orientation of unit length to rounding
    dvec3 translation{0.0};   ///< of the pivot [m]
    dvec3 rotation{0.0};      ///< angular velocity times duration, world axes [rad]
    dvec3 pivot{0.0};         ///< what the shape turns about, in its own frame [m]: a body's centre of mass
};

/// @return where a shape is at t.
[[nodiscard]] Pose pose_at(const RigidMotion& motion, double t) noexcept;

struct TimeOfImpactSettings {
    double separation = 0.0;  ///< shapes this near count as touching [m]; 0 to 1e70
    double tolerance = 0.0;   ///< the search ends once they are within separation + tolerance [m]; 0 to 1e70. At least 1e-9 of their sizes
    int most_checks = 128;    ///< cap on the certificates, each of which moves t on; >= 1
    double until = 1.0;       ///< contacts later than this are not looked for, and Separated says nothing of them; 0 to 1
};

/// The first contact of two convex shapes: spheres, boxes, capsules, hulls, cylinders, cones; and of one such and a plane, which may turn too.
///
/// Guarantee: no contact before t, whatever the status (but for Invalid), and none up to `until` where it is Separated. Each step from t to t + h is
/// paid for by a plane with the normal n that keeps the shapes apart: along n a point r from its pivot moves by n . (v s + w x r s) but for
/// a remainder of at most |w| |w x n| |r| s^2 / 2, so the gap is at least a concave function of s, the support functions of the shapes
/// along n + s (n x w), less the remainder and what rounding may do. Where that is positive at s = 0 and at h, it is between.
///
/// Method: conservative advancement (Mirtich 1996) from the closest points (GJK). Departures: the bound on the motion is not |v| + |w| r but
/// the support functions above, so that a step is limited by the curvature of the paths alone; its length is found by the secant of
/// the concave gap, which cannot overshoot. Without rotation it is the ray cast of van den Bergen (2004). Two boxes have planes along one of their fifteen
/// axes in the place of closest points, and where neither turns and no separation is asked for, the closed form of the last axis to part them.
/// @param cache  null, or where the search for closest points begins; see DistanceCache. Boxes rarely need it, and then it stays as it was.
/// @return `point` on B. Clamped: at the cap on checks.
/// Accuracy: where Touching the shapes are within separation + tolerance + 8 E, with E = 1.4e-14 (1 + |rotations|) (sizes, distance, motion).
/// Bad input: Invalid. NaN, infinity, lengths beyond 1e70 m (of settings too), turns beyond 1e9 rad, settings out of range; of shapes sizes that
/// are negative or not finite and a plane's normal of zero, a mesh or compound, two planes, a null hull. Sizes of zero are points,
/// segments, rectangles.
/// Cost: some 1 µs a certificate, of boxes half of it; 3 without turning (boxes 1), 8 for turns of 2 rad, 37 for a thin rod at 42 rad; one ball test where balls about the
/// pivots never meet. No allocation; thread-safe.
[[nodiscard]] Impact time_of_impact(const Shape& a, const RigidMotion& motion_a, const Shape& b, const RigidMotion& motion_b,
                                    const TimeOfImpactSettings& settings = {}, DistanceCache* cache = nullptr) noexcept;

/// The first contact of a convex shape and the surface of a mesh, and its triangle (the lowest of several at one t). Of a one-sided mesh
/// contacts count where the shape's centre is in front of it then, and was in front of the triangle's plane at t = 0.
/// @param a  convex, not a plane; else Invalid. Cost: the sum over the triangles near the ball about A's pivot as it moves.
[[nodiscard]] geo::MeshImpact time_of_impact(const Shape& a, const RigidMotion& motion_a, const TriangleMesh& b,
                                             const RigidMotion& motion_b, const TimeOfImpactSettings& settings = {});

}  // namespace carom
