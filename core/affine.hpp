// Affine maps as 4 x 4 matrices: from poses, to poses where they are rigid, and what they do to normals.
//
//   Result<Pose> pose = pose_from_matrix(node_transform);
//   if (!pose) { auto [rigid, scale] = decompose(node_transform).value(); bake(scale); }
//   dvec3 n = transform_normal(dmat3(node_transform), normal);
//
// Matrices are GLM's: columns, so that m * vec4(p, 1) is where p goes. Of a float matrix take glm::dmat4(m).
#pragma once

#include <carom/core/pose.hpp>
#include <carom/core/result.hpp>

#include <glm/mat4x4.hpp>

namespace carom {

using glm::dmat4;

/// How far the product of a matrix' columns may be from that of perpendicular unit vectors: above what float matrices lose.
inline constexpr double kRigidTolerance = 0x1p-18;

/// @return the matrix of a pose. Accuracy: as rotation_matrix(); the position is exact.
[[nodiscard]] dmat4 to_matrix(const Pose& pose) noexcept;

/// The pose of a rigid map.
/// @param m          the last row is 0 0 0 1.
/// @param tolerance  >= 0; how far the columns may be from perpendicular unit vectors. Within it the rotation is the one of
///                   rotation_from_matrix() after one step towards orthonormal columns, which squares the error.
/// @return           Error: NotFinite for NaN and infinity; InvalidArgument, with what was found, for a projection, a scale, a shear or
///                   a mirror; Degenerate for a map that flattens space.
[[nodiscard]] Result<Pose> pose_from_matrix(const dmat4& m, double tolerance = kRigidTolerance);

/// A map that scales along its own axes, then rotates and moves: x -> pose (scale * x).
struct ScaledPose {
    Pose pose;
    dvec3 scale{1.0};
};

/// Decomposes m into rotation and scale.
/// @param m, tolerance  as above; the columns may have any lengths, but are perpendicular within the tolerance, relative to the lengths.
/// @return              scale > 0, but for mirrors, whose scale.x is negative. Error: as above; InvalidArgument for a shear,
///                      Degenerate where a column has no length or the columns lie in a plane, to rounding (14 eps).
[[nodiscard]] Result<ScaledPose> decompose(const dmat4& m, double tolerance = kRigidTolerance);

/// How a linear map turns a surface: the normal of the image of a plane with normal n. That is not m n unless m is rigid, but the
/// inverse transpose, computed here by cofactors, so that maps that flatten space along other directions than the plane's work too.
/// @return unit, on the same side as n: what was outside stays outside, for mirrors too. Zero where the plane's image is a line or a
///         point, or m or n is not finite.
/// Source: Akenine-Moller et al., Real-Time Rendering (2018), sec. 4.1.7.
[[nodiscard]] dvec3 transform_normal(const dmat3& m, const dvec3& n) noexcept;

}  // namespace carom
