// Contacts of the batch before, for pairs that have hardly moved since they were last looked at.
//
//   if (may_reuse(record, pair, placed)) to = moved_manifold(last, motion);
//
// Seen from the larger of two shapes, no point of the smaller moves by more than d = |t - t0| + angle * reach, where t is the smaller one's
// origin and `reach` that of its points from it. So:
// - A pair that was farther apart than margin + d is farther apart than the margin.
// - The separation along any direction has changed by at most d. The points of a manifold are carried by both shapes, and their
//   separations are taken between where they are now: right to second order, d^2 / size, as long as the same features decide; where others
//   do now, the depth is too large by 2 d at most.
// - Points on flat sides, edges and corners stay where they are on their shapes. On curved sides they would roll away with the material, and
//   a rolling body would stand on a flat spot of the size of the slack: manifolds of curved shapes are not carried.
// A pair is looked at anew where d exceeds its slack, or the margin has grown by more than the slack leaves, and after at most
// kMostReuses steps, since each step rounds positions to floats.
#pragma once

#include <carom/narrowphase/collide.hpp>

#include <cstdint>
#include <span>

namespace carom::detail {

/// A pair is looked at in one of this many batches.
inline constexpr std::uint32_t kMostReuses = 64;

/// What is known of a pair of the batch before.
struct PairRecord {
    dvec3 offset{0.0};             ///< of the smaller shape's origin, along the larger one's axes, when the pair was last looked at [m]
    float turn[4] = {};            ///< the smaller shape's orientation in the larger one's frame then: x, y, z, w
    float margin = 0.0f;           ///< that was looked into [m]
    float reach = 0.0f;            ///< of the smaller shape's points from its origin [m]
    std::uint32_t a = 0, b = 0;
    std::uint32_t first = 0;       ///< manifolds of the batch before
    std::uint32_t count = 0;
    std::uint16_t left = 0;        ///< steps for which it may still serve
    bool b_is_smaller = false;
    bool undecided = false;
    bool flat = false;             ///< both shapes are flat-sided
};

/// How a shape has moved since the batch before.
struct ShapeMotion {
    dmat3 turn{1.0};    ///< world axes
    double angle = 0.0; ///< an upper bound [rad]
};
[[nodiscard]] ShapeMotion motion_between(const Pose& before, const Pose& now) noexcept;

/// @return the record of a pair that is looked at now.
[[nodiscard]] PairRecord record_of(const NumberedPair& pair, const PlacedShapes& placed) noexcept;

/// @return whether what the record says holds to within the pair's slack.
[[nodiscard]] bool may_reuse(const PairRecord& record, const NumberedPair& pair, const PlacedShapes& placed) noexcept;

/// The two shapes of a manifold, then and now.
struct PairMotion {
    const ShapeMotion& a;
    const ShapeMotion& b;
    dvec3 between_before{0.0};  ///< from A's origin to B's [m]
    dvec3 between_now{0.0};
};
/// @return the manifold carried along: the normal by the shape that turned less, each point by both.
[[nodiscard]] Manifold moved_manifold(const Manifold& before, const PairMotion& motion) noexcept;

}  // namespace carom::detail
