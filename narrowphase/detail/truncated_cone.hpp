// Cylinder and cone in the frame of a pair, as one solid: the hull of two coaxial discs.
//
//   TruncatedCone solid = truncated_cone(pair.first, dmat3{1.0}, dvec3{0.0});
//   dvec3 p = solid.support(direction);
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/narrowphase/detail/polygon_contact.hpp>

#include <vector>

namespace carom::detail {

/// The discs lie about centre -+ half_height axes[1], square to it; the upper radius is 0 in a cone. Points of the rims are counted by
/// angle from axes[0], so that they stay where they are on the body.
struct TruncatedCone {
    dvec3 centre{0.0};
    dmat3 axes{1.0};
    double half_height = 0.0;
    double lower_radius = 0.0;
    double upper_radius = 0.0;

    [[nodiscard]] const dvec3& axis() const noexcept { return axes[1]; }
    [[nodiscard]] double largest_radius() const noexcept { return lower_radius > upper_radius ? lower_radius : upper_radius; }
    /// @return the largest extent along the axis or across it [m].
    [[nodiscard]] double size() const noexcept { return 2.0 * (half_height > largest_radius() ? half_height : largest_radius()); }
    [[nodiscard]] dvec3 lower_centre() const noexcept { return centre - half_height * axis(); }
    [[nodiscard]] dvec3 upper_centre() const noexcept { return centre + half_height * axis(); }

    /// @return a unit vector square to the axis, towards `direction`; axes[0] for one along the axis.
    [[nodiscard]] dvec3 outward(const dvec3& direction) const noexcept;
    /// @return a point farthest along `direction`, on a rim. Accuracy: a few ulp of the size.
    [[nodiscard]] dvec3 support(const dvec3& direction) const noexcept;
    /// @return the largest dot product of `direction` with a point.
    [[nodiscard]] double reach(const dvec3& direction) const noexcept;
    /// @return the normal of the side where it faces `outward`, a unit vector square to the axis.
    [[nodiscard]] dvec3 side_normal(const dvec3& outward) const noexcept;
};

/// @return `shape`, a Cylinder or a Cone, placed by `axes` and `centre`.
[[nodiscard]] TruncatedCone truncated_cone(const Shape& shape, const dmat3& axes, const dvec3& centre) noexcept;

/// @return the box of the solid in a frame in which it has the given axes and centre.
[[nodiscard]] Aabb box_of(const TruncatedCone& solid) noexcept;

/// Corners by which a disc is clipped against a face: the region of contact lies within 2 % of the radius of the exact one, and every
/// point of it on the disc.
inline constexpr int kRimCorners = 16;

/// Names of the points of a truncated cone: corners of the lower rim, then of the upper one, then the rims' deepest points, the ends of
/// a line of the side.
inline constexpr std::uint32_t kRimPoint = 2 * kRimCorners;
inline constexpr std::uint32_t kSidePoint = kRimPoint + 2;

/// Fills in the corners of a disc as a face with its normal, counter-clockwise seen from outside.
/// @param upper  which of the two; its radius must not be 0.
FacePolygon disc_of(const TruncatedCone& solid, bool upper, const ContactPlane& plane, std::vector<FaceCorner>& corners);

/// The same for the line of the side that faces `outward`, from the lower rim to the upper one.
FacePolygon side_line_of(const TruncatedCone& solid, const dvec3& outward, const ContactPlane& plane, std::vector<FaceCorner>& corners);

}  // namespace carom::detail
