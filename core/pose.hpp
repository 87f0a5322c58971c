// A rigid placement: rotate, then translate.
//
//   dvec3 world = transform_point(body, local);
//   Pose  b_in_a = inverse(a) * b;
#pragma once

#include <carom/core/types.hpp>

namespace carom {

/// Position [m] and unit orientation of a frame, in its parent's frame. Scale never lives here: it is baked into geometry.
struct Pose {
    dvec3 position{0.0};
    dquat orientation{kIdentityRotation};

    friend bool operator==(const Pose&, const Pose&) = default;
};

/// @return the vector `v` rotated by the unit quaternion `q`: v + 2 w (u × v) + 2 u × (u × v).
/// Accuracy: a few ulp of |v|. Cost: 2 cross products.
template <class T>
[[nodiscard]] glm::vec<3, T> rotate(const glm::qua<T>& q, const glm::vec<3, T>& v) noexcept {
    const glm::vec<3, T> u{q.x, q.y, q.z};
    const glm::vec<3, T> t = T(2) * glm::cross(u, v);
    return v + q.w * t + glm::cross(u, t);
}

/// @return `v` rotated by the inverse of the unit quaternion `q`.
template <class T>
[[nodiscard]] glm::vec<3, T> rotate_inverse(const glm::qua<T>& q, const glm::vec<3, T>& v) noexcept {
    return rotate(glm::qua<T>{q.w, -q.x, -q.y, -q.z}, v);
}

[[nodiscard]] inline dvec3 transform_point(const Pose& pose, const dvec3& local) noexcept {
    return pose.position + rotate(pose.orientation, local);
}

[[nodiscard]] inline dvec3 inverse_transform_point(const Pose& pose, const dvec3& world) noexcept {
    return rotate_inverse(pose.orientation, world - pose.position);
}

/// Directions, velocities and, as a pose is rigid, normals: rotated only. Normals under other maps: affine.hpp.
[[nodiscard]] inline dvec3 transform_vector(const Pose& pose, const dvec3& local) noexcept { return rotate(pose.orientation, local); }
[[nodiscard]] inline dvec3 inverse_transform_vector(const Pose& pose, const dvec3& world) noexcept {
    return rotate_inverse(pose.orientation, world);
}

/// @return the point with coordinates `p` in the frame `from`, in coordinates of the frame `to`; both frames in one parent. Only the
/// difference of the frames' positions enters: nothing is lost far from the parent's origin.
[[nodiscard]] inline dvec3 change_frame(const Pose& from, const Pose& to, const dvec3& p) noexcept {
    return rotate_inverse(to.orientation, (from.position - to.position) + rotate(from.orientation, p));
}
/// @return the vector or normal with components `v` in the frame `from`, in components of the frame `to`.
[[nodiscard]] inline dvec3 change_frame_vector(const Pose& from, const Pose& to, const dvec3& v) noexcept {
    return rotate_inverse(to.orientation, rotate(from.orientation, v));
}

/// @return the pose that undoes `pose`.
[[nodiscard]] inline Pose inverse(const Pose& pose) noexcept {
    const dquat conjugate{pose.orientation.w, -pose.orientation.x, -pose.orientation.y, -pose.orientation.z};
    return {-rotate(conjugate, pose.position), conjugate};
}

/// @return the placement, in a's parent, of a frame placed by `b` inside `a`.
[[nodiscard]] inline Pose operator*(const Pose& a, const Pose& b) noexcept {
    return {a.position + rotate(a.orientation, b.position), a.orientation * b.orientation};
}

[[nodiscard]] inline bool is_finite(const Pose& pose) noexcept {
    return is_finite(pose.position) && is_finite(pose.orientation);
}

}  // namespace carom
