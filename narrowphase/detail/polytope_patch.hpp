// The points of contact of two polytopes along an axis.
#pragma once

#include <carom/narrowphase/detail/polygon_contact.hpp>
#include <carom/narrowphase/detail/polytope_axis.hpp>

namespace carom::detail {

/// Whether the pair of points that the axis names belongs to the contact. It does not where the axis was replaced by another.
enum class AxisPoint : unsigned char { Keep, Leave };

/// @return face `face` as a polygon in the plane; `corners` holds it.
[[nodiscard]] FacePolygon polygon_of(const Polytope& p, std::uint32_t face, const ContactPlane& plane, std::vector<FaceCorner>& corners);

/// @return the length of the shortest side of a polygon [m]; infinite where there is no corner.
[[nodiscard]] double least_side(std::span<const FaceCorner> corners) noexcept;

/// Fills `patch` with up to four points of the contact of a and b along `axis`. With AxisPoint::Keep it is
/// never empty: where the two faces share no region, the closest or deepest pair of points stands alone.
void build_patch(const Polytope& a, const Polytope& b, const ContactAxis& axis, const Asked& asked, AxisPoint axis_point,
                 PolygonScratch& scratch, Patch& patch);

}  // namespace carom::detail
