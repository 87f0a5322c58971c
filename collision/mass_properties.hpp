// Mass, centre of mass and inertia of solids.
//
//   Result<MassProperties> m = mass_properties(shape, 1000.0);
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/pose.hpp>

#include <span>

namespace carom {

/// Mass [kg], centre of mass [m] and the inertia about it [kg m²], in the frame of the shape (or body) it describes.
struct MassProperties {
    double mass = 0.0;
    dvec3 center{0.0};
    dmat3 inertia{0.0};  ///< symmetric, about `center`
};

/// The principal frame of an inertia: `inertia` = R diag(moments) Rᵀ.
struct PrincipalAxes {
    dvec3 moments{0.0};                     ///< [kg m²]; in ascending order unless the inertia was diagonal already
    dquat orientation{kIdentityRotation};   ///< R; the identity where the inertia was diagonal already
};

/// Mass properties of a solid of uniform `density` [kg/m³] > 0.
/// Closed meshes and hulls: exact polyhedral integrals (Mirtich 1996; Eberly 2002) about a local origin, in double.
/// A compound is the sum of its parts, each of its own density where it has one; where parts overlap, their matter counts twice.
/// An open mesh has no volume: its convex hull's properties are given (for a dynamic body, give your own where that is wrong).
/// @return InvalidArgument (density, or a mesh wound inside out), WrongType (plane), Degenerate (an open mesh whose hull is flat).
/// Accuracy: 1e-12 relative for closed forms; polyhedra pinned in tests/collision/.
[[nodiscard]] Result<MassProperties> mass_properties(const Shape& shape, double density);

/// @return the same solid placed by `pose` in another frame.
[[nodiscard]] MassProperties transform(const MassProperties& m, const Pose& pose);

/// @return the sum of several solids in one frame, inertia about the common centre.
[[nodiscard]] MassProperties combine(std::span<const MassProperties> parts);

/// Principal moments and axes (Eigen's symmetric solver). Right-handed.
[[nodiscard]] PrincipalAxes principal_axes(const dmat3& inertia);

/// Checks: mass finite and > 0, inertia finite, symmetric to 1e-9 of its trace, positive definite, and the triangle
/// inequality of moments to 1e-6.
[[nodiscard]] Status validate(const MassProperties& m);

}  // namespace carom
