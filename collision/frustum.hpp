// The view volume of a camera, and what is outside of it for certain.
//
//   auto view = geo::frustum_of(geo::Camera<float>{.position = {0, 2, 8}, .fovy = 1.0f, .aspect = 16.0f / 9.0f});
//   if (geo::classify(*view, box) != geo::Containment::Outside) { draw(); }
#pragma once

#include <carom/collision/primitives.hpp>
#include <carom/core/result.hpp>

#include <glm/mat4x4.hpp>

#include <array>

namespace carom::geo {

/// The points above all six planes: their normals point inward and are of unit length, so that distances are in metres.
/// A far plane at infinity has the normal 0 and the offset -1, above which everything is.
template <class T>
struct Frustum {
    std::array<Plane<T>, 6> planes;  ///< left, right, bottom, top, near, far
};

/// A perspective camera.
template <class T>
struct Camera {
    Vec3<T> position{T(0)};
    Vec3<T> forward{T(0), T(0), T(-1)};  ///< of any length
    Vec3<T> up{T(0), T(1), T(0)};        ///< of any length, not along `forward`; need not be at a right angle to it
    T fovy = T(1);                       ///< the whole vertical field of view [rad], in (0, pi)
    T aspect = T(1);                     ///< width over height, > 0
    T near_distance = T(0.1);            ///< >= 0
    T far_distance = T(1000);            ///< > near_distance; may be infinite
};

/// Which z a projection maps the near and far planes to.
enum class ClipDepth {
    MinusOneToOne,  ///< OpenGL
    ZeroToOne,      ///< Direct3D, Vulkan, Metal; reversed z too, where left to top are as usual and near and far change places
};

enum class Containment { Outside, Across, Inside };

/// @return NotFinite, InvalidArgument (a field out of its range) or Degenerate (`forward` or `up` is zero, or one is
/// along the other to 4 eps of T).
/// Accuracy: the planes are those of the camera to 4 eps of T in the normal, and 4 eps of |position| + distance in the
/// offset.
template <class T>
[[nodiscard]] Result<Frustum<T>> frustum_of(const Camera<T>& camera);

/// @param view_projection  from the frame that the planes shall be in to clip coordinates, for column vectors as GLM
/// has it.
/// @return NotFinite, or Degenerate where one of the four sides has no direction, or near or far has neither that nor
/// everything above it.
/// Accuracy: the planes are those of the matrix to 4 eps of T.
/// Source: Gribb and Hartmann, Fast Extraction of Viewing Frustum Planes (2001).
template <class T>
[[nodiscard]] Result<Frustum<T>> frustum_of(const glm::mat<4, 4, T>& view_projection,
                                            ClipDepth depth = ClipDepth::MinusOneToOne);

/// Conservative: nothing that overlaps the frustum's planes' volume is Outside, and nothing is Inside unless all of it
/// is; rounding is on the side of Across. What lies beyond an edge or corner but not wholly beyond one plane is Across
/// too. Bad input (NaN, inverted boxes, negative radii): Across. Cost: O(1), no allocation, thread-safe. Source:
/// Greene, Detecting Intersection of a Rectangular Solid and a Convex Polyhedron (Graphics Gems IV, 1994).
template <class T>
[[nodiscard]] Containment classify(const Frustum<T>& frustum, const Sphere<T>& sphere) noexcept;
template <class T>
[[nodiscard]] Containment classify(const Frustum<T>& frustum, const Aabb<T>& box) noexcept;
/// An OBB is center + axes x with |x| <= half_extents here, whether or not its axes are quite orthonormal.
template <class T>
[[nodiscard]] Containment classify(const Frustum<T>& frustum, const Obb<T>& box) noexcept;

}  // namespace carom::geo
