// Axis and points of contact of a truncated cone (a cylinder or a cone) with a polytope, a rounded segment or another one.
//
//   ContactAxis axis;
//   CollideStatus status = CollideStatus::Ok;
//   if (find_axis(solid, polytope, margin, axis, status)) build_patch(solid, polytope, axis, margin, AxisPoint::Keep, scratch, patch);
#pragma once

#include <carom/narrowphase/detail/polytope_patch.hpp>
#include <carom/narrowphase/detail/segment_polytope.hpp>
#include <carom/narrowphase/detail/truncated_cone.hpp>

namespace carom::detail {

/// The axis along which `a` is nearest to b, or least deep in it, both in one frame. Apart: GJK. Touching or overlapping: EPA,
/// and where a flat end, a face of b or a line of the side is as good to 1e-6 of the size, that, so that flat contacts have the
/// normal of their faces to the last bit. Of a rounded segment the axis is that of the segment itself, without its radius.
/// @param status  becomes Undecided where EPA stopped at its cap: another direction may be less deep.
/// @return false where the two are farther apart than `margin`.
bool find_axis(const TruncatedCone& a, Polytope& b, double margin, ContactAxis& axis, CollideStatus& status);
bool find_axis(const TruncatedCone& a, const RoundSegment& b, double margin, ContactAxis& axis, CollideStatus& status);
bool find_axis(const TruncatedCone& a, const TruncatedCone& b, double margin, ContactAxis& axis, CollideStatus& status);

/// Fills `patch` with up to four points. Each of the two shows the axis the feature that faces it best: a flat end or face, a line (of the
/// side, or the segment), and what the two features share is the contact: face on face a region, a line on a face or on a line along it
/// two points, anything else the closest or deepest pair of points.
void build_patch(const TruncatedCone& a, const Polytope& b, const ContactAxis& axis, const Asked& asked, AxisPoint axis_point,
                 PolygonScratch& scratch, Patch& patch);
void build_patch(const TruncatedCone& a, const RoundSegment& b, const ContactAxis& axis, const Asked& asked, AxisPoint axis_point,
                 PolygonScratch& scratch, Patch& patch);
void build_patch(const TruncatedCone& a, const TruncatedCone& b, const ContactAxis& axis, const Asked& asked, AxisPoint axis_point,
                 PolygonScratch& scratch, Patch& patch);

}  // namespace carom::detail
