// Moving spheres and capsules against primitives, many pairs at once, in double: the same operations in the same order as narrowphase/sweep.cpp,
// sweep_plane.cpp, sweep_solid.cpp and sweep_parts.cpp have for one pair, which explain them, so the same bits at every width.
//
//   SweptRows rows;                                // fill rows.in[..][i] for i < count, a multiple of 8
//   sweep_lanes(Sweeper::Sphere, SweptCore::Box, rows, count);
//   if (rows.out[SweptRows::kState][i] == SweptRows::kUnsure) ...   // a pair for the single call
#pragma once

#include <cstddef>

namespace carom::detail {

enum class Sweeper : unsigned char { Sphere, Capsule };
enum class SweptCore : unsigned char { Plane, Point, Segment, Box, TurnedBox, Triangle, Tube };

/// One pair a column.
struct SweptRows {
    static constexpr std::size_t kPairs = 64, kStep = 8;  ///< the most at once; the widest of all targets
    static constexpr std::size_t kInput = 25, kOutput = 9;
    // The moving sphere's centre, or one end of the capsule's axis, its radius and motion, and the axis' other end; then B's numbers in the order of
    // its members; of boxes that turn the axes come last.
    static constexpr std::size_t kRadius = 3, kMotion = 4, kEnd = 7;
    static constexpr std::size_t kTime = 0, kPoint = 1, kNormal = 4, kState = 7, kChecks = 8;  ///< the last is set by tubes alone
    [[nodiscard]] static constexpr std::size_t shape_row(Sweeper a) noexcept { return a == Sweeper::Sphere ? kEnd : kEnd + 3; }
    // As ImpactStatus; kUnsure: bad input, and motions so short that the single call scales them.
    static constexpr double kSeparated = 0.0, kTouching = 1.0, kOverlapping = 2.0, kUnsure = 3.0;

    alignas(64) double in[kInput][kPairs];
    alignas(64) double out[kOutput][kPairs];
};

/// Spheres against all of them, capsules against all but tubes.
/// @param count  a multiple of SweptRows::kStep, at most kPairs: all these columns are filled. Or 1: a step is filled, and one group of lanes is answered.
void sweep_lanes(Sweeper a, SweptCore b, SweptRows& rows, std::size_t count) noexcept;

}  // namespace carom::detail
