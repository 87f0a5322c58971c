// The vector types of every public header, from GLM.
//
//   carom::dvec3 p{0, 2, 0};
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#if defined(GLM_FORCE_QUAT_DATA_WXYZ) || defined(GLM_FORCE_DEFAULT_ALIGNED_GENTYPES) || \
    defined(GLM_FORCE_DEFAULT_ALIGNED_GENTYPE) || defined(GLM_FORCE_LEFT_HANDED)
#error "Carom needs GLM's default layout: a GLM_FORCE_* setting that changes layout or constructor order is on."
#endif

namespace carom {

using glm::dmat3;
using glm::dquat;
using glm::dvec2;
using glm::dvec3;
using glm::mat3;
using glm::quat;
using glm::vec2;
using glm::vec3;

static_assert(sizeof(vec3) == 12 && sizeof(dvec3) == 24, "GLM was configured with aligned types");
static_assert(sizeof(quat) == 16 && sizeof(dquat) == 32);

/// The unit quaternion that rotates nothing. GLM's default constructor leaves a quaternion uninitialised.
inline constexpr dquat kIdentityRotation{1.0, 0.0, 0.0, 0.0};

/// True if every component is finite (no NaN, no infinity).
[[nodiscard]] inline bool is_finite(double x) noexcept { return x - x == 0.0; }
[[nodiscard]] inline bool is_finite(float x) noexcept { return x - x == 0.0f; }
template <class T>
[[nodiscard]] bool is_finite(const glm::vec<3, T>& v) noexcept {
    return is_finite(v.x) && is_finite(v.y) && is_finite(v.z);
}
template <class T>
[[nodiscard]] bool is_finite(const glm::qua<T>& q) noexcept {
    return is_finite(q.x) && is_finite(q.y) && is_finite(q.z) && is_finite(q.w);
}

}  // namespace carom
