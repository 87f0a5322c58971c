// Whether two boxes overlap, one pair in double: what lanes of floats leave undecided.
//
//   Overlap verdict = judge_boxes(box_a.half_extents, pose_a, box_b.half_extents, pose_b);
#pragma once

#include <carom/core/pose.hpp>
#include <carom/narrowphase/overlap.hpp>

namespace carom::detail {

/// Poses finite. Method: as overlap_boxes() of pair_lanes.hpp, with doubles for floats.
/// Rounding: entries of the product of two rotation matrices err by 16 u (u = 2^-53), the separation of the box that it describes by 16
/// roundings of the lengths' sum: with orientations of unit length to rounding less than 64 u S. The bound is twice that: E of distance().
/// Undecided where lengths are so small or large that their products leave the range of doubles. Cost: 0.15 µs.
[[nodiscard]] Overlap judge_boxes(const vec3& half_a, const Pose& pose_a, const vec3& half_b, const Pose& pose_b) noexcept;

}  // namespace carom::detail
