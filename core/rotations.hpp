// Rotations written in other ways: matrices, axis and angle, Euler angles; and back.
//
//   EulerAngles e = euler_angles(q, EulerOrder::ZYX);     // e.first: yaw about z, e.second: pitch about y, e.third: roll about x
//   dquat q = rotation_from_euler(e, EulerOrder::ZYX);
//   auto [axis, angle] = axis_angle(q);
#pragma once

#include <carom/core/types.hpp>

namespace carom {

/// The order of three turns about the body's own axes as they stand by then (intrinsic): XYZ first about x, then about the new y, then
/// about the new z, so R = Rx(first) Ry(second) Rz(third). The same turns about fixed axes (extrinsic) in the opposite order: ZYX is
/// also roll about the fixed x, then pitch about the fixed y, then yaw about the fixed z.
enum class EulerOrder { XYZ, XZY, YXZ, YZX, ZXY, ZYX };

/// Angles [rad] in the order of the EulerOrder.
struct EulerAngles {
    double first = 0.0;
    double second = 0.0;
    double third = 0.0;
};

/// A turn by `angle` [rad] about the unit vector `axis`.
struct AxisAngle {
    dvec3 axis{1.0, 0.0, 0.0};
    double angle = 0.0;
};

/// @return the unit quaternion of the angles, any finite ones. Accuracy: a few ulp of 1.
[[nodiscard]] dquat rotation_from_euler(const EulerAngles& angles, EulerOrder order) noexcept;

/// @param q  unit.
/// @return   first and third in [-pi, pi], second in [-pi/2, pi/2]. At the gimbal lock, where the second is a right angle to within
///           2^-50 and the other two turn about one axis, the first is 0 and the third is all of that turn: the same rotation.
/// Accuracy: the rotation of the angles is that of q to a few ulp of 1, next to the lock too, where each of the two outer angles alone
/// is as uncertain as it must be. Not finite for a q that is not.
[[nodiscard]] EulerAngles euler_angles(const dquat& q, EulerOrder order) noexcept;

/// @param q  unit.
/// @return   an angle in [0, pi], however q is signed; the x axis and 0 for the identity. Accuracy: a few ulp of each component, for
///           tiny turns too. For the way back there is rotation_about() in math.hpp.
[[nodiscard]] AxisAngle axis_angle(const dquat& q) noexcept;

/// @return the vector along the axis whose length is the angle [rad], at most pi: what rotation_from_vector() in math.hpp undoes.
[[nodiscard]] dvec3 rotation_vector(const dquat& q) noexcept;

/// @return the matrix that rotates as the unit quaternion q. Accuracy: 4 ulp of 1 in each entry.
[[nodiscard]] dmat3 rotation_matrix(const dquat& q) noexcept;

/// @param m  a rotation, orthonormal to rounding; of what is not (a scale, a mirror) the result means nothing: affine.hpp checks.
/// @return   the unit quaternion, w >= 0. Accuracy: a few ulp of 1, added to how far m is from a rotation. Not finite for such an m.
/// Source: Shepperd (1978): the largest of four components first.
[[nodiscard]] dquat rotation_from_matrix(const dmat3& m) noexcept;

}  // namespace carom
