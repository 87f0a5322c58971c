// A segment with a radius (a capsule's core) against a polytope.
//
//   ContactAxis axis;
//   if (find_axis(core, polytope, margin, scratch, axis)) build_patch(core, polytope, axis, margin, scratch, patch);
#pragma once

#include <carom/narrowphase/detail/polytope_patch.hpp>
#include <carom/narrowphase/detail/segment.hpp>

namespace carom::detail {

/// All points within `radius` of the segment, which may be a point.
struct RoundSegment {
    Segment segment;
    double radius = 0.0;
};

/// Finds the axis of contact of the segment itself and a polytope in one frame; `axis.separation` and the points are those of the
/// segment, without its radius. Apart: the distance, by trying the face that separates best and the edges next to planes below the
/// segment. Touching or overlapping: the least depth over the faces and over the edges that the segment crosses.
/// @return false where the rounded segment is farther from the polytope than `margin`.
bool find_axis(const RoundSegment& core, const Polytope& polytope, double margin, PolygonScratch& scratch, ContactAxis& axis);

/// Fills `patch` with the points where the segment enters and leaves the region over the face that it lies along, and with the
/// closest point. Up to two points.
void build_patch(const RoundSegment& core, const Polytope& polytope, const ContactAxis& axis, double margin, AxisPoint axis_point,
                 PolygonScratch& scratch, Patch& patch);

}  // namespace carom::detail
