// How far two boxes are apart, from the features that are nearest.
//
//   if (const auto r = box_distance(half_a, pose_a, half_b, pose_b, 0.0)) return *r;   // else the general search
#pragma once

#include <carom/core/pose.hpp>
#include <carom/narrowphase/distance.hpp>

#include <optional>

namespace carom::detail {

/// Method: each box's point goes to the one nearest to the other's, one after the other (von Neumann 1950). That finds out in a step or two
/// which faces, edges and corners look at each other; the points on these are then got at once: the lowest corner over a face, where it
/// lies over it, or else where the way down a face's or an edge's slope leaves the other face, and the nearest points of two edges.
/// Nothing is believed for where it comes from: both points are members of their boxes, so their distance is an upper bound, and the
/// lower one is that of the support plane across the way between them, or square to the features; an overlap is a point of one
/// box that is deeper in the other than rounding.
/// @return distance()'s answer, Converged or Overlap; or nothing where a few steps prove neither, where the boxes are within a few roundings of
/// touching, or where lengths leave [1e-60, 1e60] m.
[[nodiscard]] std::optional<DistanceResult> box_distance(const vec3& half_a, const Pose& pose_a, const vec3& half_b, const Pose& pose_b,
                                                         double tolerance) noexcept;

}  // namespace carom::detail
