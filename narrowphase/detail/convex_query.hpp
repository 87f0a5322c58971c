// What distance(), penetration() and overlaps() have in common: what is misuse, planes, and the way from cores to shapes.
//
//   const PairFault fault = query_fault(a, pose_a, b, pose_b);
//   const DistanceResult r = pair_distance(a, pose_a, b, pose_b, settings, cache);
#pragma once

#include <carom/narrowphase/detail/check_pair.hpp>
#include <carom/narrowphase/detail/proximity.hpp>
#include <carom/narrowphase/overlap.hpp>

#include <optional>

namespace carom::detail {

/// @return what makes the two types and the hulls' pointers unfit.
[[nodiscard]] PairFault query_fault(const Shape& a, const Shape& b) noexcept;
/// The same with the poses.
[[nodiscard]] PairFault query_fault(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) noexcept;
/// @return what is out of range, or null.
[[nodiscard]] const char* settings_fault(const DistanceSettings& settings) noexcept;

/// How high the lowest point of a shape lies over a plane.
struct PlaneHeight {
    double height = 0.0;    ///< [m], negative below
    double rounding = 0.0;  ///< what it may err by [m]
    dvec3 normal{0.0};      ///< from A to B, unit
    dvec3 on_a{0.0};        ///< the lowest point and its foot, from A's origin along world axes [m]
    dvec3 on_b{0.0};
};

/// @return nothing where neither is a plane.
[[nodiscard]] std::optional<PlaneHeight> plane_height(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) noexcept;
/// distance() and overlaps() of a pair that is fit.
[[nodiscard]] DistanceResult pair_distance(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                                           const DistanceSettings& settings, DistanceCache* cache) noexcept;
[[nodiscard]] Overlap pair_overlaps(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, DistanceCache* cache) noexcept;

}  // namespace carom::detail
