// Contacts of the batch before, for pairs that have hardly moved since they were last looked at.
//
//   lines[k] = motion_line(shape, pose_before, pose_now);             // once for each shape
//   const unsigned reusable = find_reusable(lines, pairs, records, drift);
//   move_manifolds(lines, moves, last, out);
//
// Seen from the larger of two shapes L, which carries all of space with it, a point r of the smaller one S moves in a batch by
// u + (E_S - E_L) r, where E is a turn less the identity, d the motion of an origin, and u = d_S - d_L - E_L (p_S - p_L). With w the axial vector
// of E_S - E_L, that is u + w x r and a rest of second order. The sums U of the u and W of the w since the pair was last looked at say how
// far the point has come: by m = |U| + |W| reach + rest at most, where the rest holds the symmetric parts of E, |E|^2 / 2 reach each, what
// turning the sums along with L would change, |E_L| (|U| + |W| reach) in each batch, and what r has turned itself, |w| |W| reach. So:
// - A pair that was farther apart than margin + m is farther apart than the margin.
// - The separation along any direction has changed by at most m. The points of a manifold are carried by both shapes, and their
//   separations are taken between where they are now: right to second order, m^2 / size, as long as the same features decide; where others
//   do now, the depth is too large by 2 m at most.
// - Points on flat sides, edges and corners stay where they are on their shapes. On curved sides they would roll away with the material, and
//   a rolling body would stand on a flat spot of the size of the slack. Of spheres and capsules it is the point of the core that is carried,
//   and the contact is a radius away from it along the new normal, which is the other shape's, or that of the two cores. Manifolds of
//   cylinders, of cones and of compounds with curved parts are not carried.
// - Of a mesh, the side on which the centre of the other shape lies is that of the last look. Where a one-sided mesh has no manifold, the
//   shape may be about to come through from behind: such pairs are looked at in every batch.
// A pair is looked at anew where m exceeds its slack, where the margin has grown by more than the slack leaves, and in one of kMostReuses
// batches, since each rounds positions to floats.
#pragma once

#include <carom/core/bundle.hpp>
#include <carom/narrowphase/collide.hpp>

#include <cstdint>
#include <span>

namespace carom::detail {

inline constexpr std::uint32_t kMostReuses = 64;

/// How a shape has moved since the batch before, as lanes read it: five rows of four floats.
struct alignas(16) MotionLine {
    float turn[3][4] = {};    ///< rows of E; then the motion of the origin along that axis [m]
    float before[2][4] = {};  ///< where the origin was, as two floats a coordinate; then the radius about the core
};
[[nodiscard]] MotionLine motion_line(const Shape& shape, const Pose& before, const Pose& now) noexcept;

/// What is known of a pair of the batch before: four rows of four words.
struct alignas(64) PairRecord {
    vec3 shift{0.0f};           ///< U [m]
    float rest = 0.0f;          ///< [m]
    vec3 turn{0.0f};            ///< W [rad]
    float margin = 0.0f;        ///< that was looked into [m]
    float reach = 0.0f;         ///< of the smaller shape's points from its origin [m]
    std::int32_t state = 0;     ///< how often it may still serve (the low 8 bits), and the bits below
    std::uint32_t a = 0, b = 0;
    std::uint32_t first = 0, count = 0;  ///< manifolds of that batch
};
inline constexpr std::int32_t kLeftMask = 0xff;
inline constexpr std::int32_t kBSmaller = 1 << 8;    ///< B is the smaller shape
inline constexpr std::int32_t kUndecided = 1 << 9;
inline constexpr std::int32_t kRolls = 1 << 10;      ///< it is looked at in every batch

/// What records need of a shape.
struct ShapeTrait {
    float reach = 0.0f;    ///< of its points from its origin, rounded up [m]
    bool carried = false;  ///< points of contact may be carried along with it, or with its core
    bool one_sided = false;
};
[[nodiscard]] ShapeTrait trait_of(const Shape& shape) noexcept;

/// @return the record of a pair that is looked at now, without its manifolds.
[[nodiscard]] PairRecord record_of(const NumberedPair& pair, const ShapeTrait& a, const ShapeTrait& b, bool touches, bool undecided) noexcept;

/// Sixteen pairs. Those that are new, and lanes without a pair, name record 0 and have a negative slack.
struct ReuseBundle {
    IntBundle a, b, last;
    FloatBundle margin, slack;
};
/// How far the two have come by now.
struct DriftBundle {
    FloatBundle shift[3], turn[3], rest;
};
/// @return the bits of the pairs whose records hold to within their slack.
/// Roundings to floats, 1e-6 of the motions of the two shapes, are counted as motion.
[[nodiscard]] std::uint32_t find_reusable(std::span<const MotionLine> lines, const ReuseBundle& pairs, std::span<const PairRecord> records,
                                          DriftBundle& drift) noexcept;

/// Sixteen manifolds: from where, to where (kNoMove: nowhere), of which shapes, and the number of their pair.
struct MoveBundle {
    IntBundle from, to, a, b, pair;
};
inline constexpr std::int32_t kNoMove = 0x7fffffff;
/// Carries manifolds along: the normal by the shape that turned less (the one that is not round; two round ones: by their cores), each point
/// by both.
void move_manifolds(std::span<const MotionLine> lines, std::span<const MoveBundle> moves, std::span<const Manifold> last, Manifold* out) noexcept;

}  // namespace carom::detail
