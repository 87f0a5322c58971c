// Whether two convex shapes overlap: yes, no, or too near to say.
//
//   if (overlaps(box, pose_a, hull, pose_b) != Overlap::Apart) { /* they may touch */ }
//   overlaps({shapes, poses}, pairs, executor, verdicts);          // 16 pairs at a time
#pragma once

#include <carom/narrowphase/distance.hpp>

namespace carom {

/// Shapes are closed: two that share a point, be it one of their surfaces, overlap. Apart and Overlapping are proved. Undecided says
/// that the two are within the rounding bound of touching, and a caller who must not miss a contact takes it for an overlap.
enum class Overlap : unsigned char { Apart, Overlapping, Undecided };
/// @return "apart", "overlapping" or "undecided".
[[nodiscard]] const char* to_string(Overlap verdict) noexcept;

/// @param a, b, cache  as for distance(), misuse too, which gives Undecided.
/// Accuracy: Undecided only within 8 E of touching, E as in distance(), for two boxes, and for other flat shapes if none is thin: where the
/// thickness is a share s of the size, E / s. With cylinders and cones within 1e-9 of the size.
/// Cost: two boxes 0.15 µs, two hulls of 14 vertices 0.5 to 1.5 µs, some 6 µs where shapes touch; no allocation; thread-safe.
[[nodiscard]] Overlap overlaps(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, DistanceCache* cache = nullptr);

/// The verdicts of many pairs; margins are not read.
///
/// Two boxes: the fifteen axes (Gottschalk, Lin, Manocha 1996), sixteen pairs at a time in float; hulls, spheres, capsules and boxes
/// against these: GJK in float, sixteen pairs in lockstep. What floats cannot prove (1e-5 of the size about touching) goes to the call
/// for one pair, as do cylinders, cones and planes. Verdicts never contradict that call's: what one proves the other does not refute.
/// @param placed, pairs  as collide() takes them, but for meshes and compounds.
/// @param out  (n,) afterwards.
/// Misuse as in the single call, sizes that differ, or a number beyond the last shape: nothing changes.
/// The same bits on every number of threads and at every SIMD width.
void overlaps(const PlacedShapes& placed, std::span<const NumberedPair> pairs, Executor& executor, std::vector<Overlap>& out);

}  // namespace carom
