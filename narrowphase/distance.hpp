// How far two convex shapes are apart, or how deep in each other, with bounds that are proved: GJK and EPA in double.
//
//   DistanceResult r = distance(box, pose_a, hull, pose_b);
//   if (r.lower > 0.1) { /* certainly farther apart than 10 cm */ }
//   DistanceCache cache;                       // one a pair, kept from step to step
//   r = distance(box, pose_a, hull, pose_b, {}, &cache);
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/pose.hpp>
#include <carom/narrowphase/collide.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace carom {

/// How a search for the distance ended.
enum class DistanceStatus : unsigned char {
    Converged,  ///< the bounds met, to the tolerance and rounding
    Overlap,    ///< the shapes share points: proved. Both bounds are 0
    Rounding,   ///< rounding allowed no progress: the bounds hold, but are farther apart than the tolerance; or the shapes touch to
                ///< within rounding, and the lower bound is 0
    Stopped,    ///< at the cap on iterations: the bounds hold
};
/// @return "converged", "overlap", "rounding" or "stopped".
[[nodiscard]] const char* to_string(DistanceStatus status) noexcept;

struct DistanceSettings {
    double tolerance = 0.0;     ///< bounds this near, as a share of the upper one (of spheres and capsules: of that of their centres and
                                ///< segments, radii not taken off), are near enough; 0: as near as rounding lets them
    int most_iterations = 128;  ///< >= 1. Two boxes may take up to six more, and shapes that touch to within rounding take up to 128 support points more
};

/// Where a search ended, for the next one of the same two shapes to begin: the numbers of the corners of the last simplex. Of another pair
/// it costs time and changes no bound. Cylinders and cones have no corners: theirs stays empty.
struct DistanceCache {
    std::array<std::uint32_t, 4> a{}, b{};
    std::uint32_t count = 0;
};

struct DistanceResult {
    double lower = 0.0;  ///< the distance is at least this [m]: a support plane proves it, less what rounding may do
    double upper = 0.0;  ///< and at most this [m]: the distance of the witness points, plus what rounding may do
    dvec3 on_a{0.0};     ///< points of a and b that are `upper` apart, from A's origin along world axes [m]; zero for Overlap
    dvec3 on_b{0.0};
    dvec3 normal{0.0};  ///< unit, from a to b, world axes; zero for Overlap, and where shapes touch to within rounding
    DistanceStatus status = DistanceStatus::Converged;
    int iterations = 0;  ///< support points of each shape that were looked for; of two boxes steps from one to the other
};

/// The distance of two convex shapes: spheres, boxes, capsules, hulls, cylinders, cones; and of one such and a plane.
///
/// Method: Gilbert, Johnson, Keerthi (1988), in double, on lengths scaled by a power of two, so that sizes and distances from 1e-37 m to
/// the end of double's range work alike. Departure: both bounds are carried along and what is returned is what they prove. Two boxes without a
/// cache are asked for their nearest features first (detail/box_distance.hpp), which as a rule is all.
/// @param a, b  valid shapes; poses finite, orientations of unit length to rounding: one that is off by e moves its shape by e of its size.
/// @param cache  null, or see DistanceCache; becomes the last simplex.
/// Accuracy: with E = 2^-46 (distance of the origins + sizes) = 1.4e-14 of them, the bounds hold strictly, and Converged means upper - lower
/// <= 4 E + tolerance * upper for flat shapes. With cylinders and cones it is 1e-12 of the distance more, and near contact Rounding leaves
/// the bounds up to 1e-9 of the size apart (1e-7 for shapes thinner than a thousandth).
/// Misuse (a null hull, a mesh, a compound, two planes: WrongType; a pose that is not finite; settings out of range) is reported and gives
/// an empty result: [0, inf), Stopped. Cost: 0.15 µs for boxes, 0.5 to 3 µs for hulls, some 6 µs where shapes touch; no allocation; thread-safe.
[[nodiscard]] DistanceResult distance(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                                      const DistanceSettings& settings = {}, DistanceCache* cache = nullptr);

/// How deep two shapes are in each other.
struct PenetrationResult {
    double lower = 0.0;  ///< no translation shorter than this parts them [m]; 0 where they are not proved to overlap
    double upper = 0.0;  ///< moving b by this along `normal` does [m]; 0 where they are apart
    dvec3 normal{0.0};   ///< unit, from a to b, world axes; zero where they are apart
    dvec3 on_a{0.0};     ///< the deepest points along it, from A's origin along world axes [m]
    dvec3 on_b{0.0};
};

/// The least translation that parts two convex shapes.
///
/// Method: the expanding polytope of van den Bergen (GDC 2001), from support points of its own, so that it does not depend on where GJK
/// ended; round shapes by the distance of their cores where these are apart. The polytope's nearest face bounds the depth from below,
/// the overlap along its normal from above.
/// Whatever overlaps() calls Overlapping has lower >= 0, upper > 0 and a unit normal here, and upper - lower is below 1e-9 of the size for
/// boxes and hulls of up to some 32 vertices whose least extent is above 1e-5 of that (of a needle of 6 million to one it was 1.4e-9); of
/// larger hulls and round shapes the polytope may end at 128 points with bounds farther apart.
/// @param a, b  as for distance(), misuse too.
/// Cost: 2 to 8 µs for boxes and small hulls; no allocation; thread-safe.
[[nodiscard]] PenetrationResult penetration(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b);

/// The distance of each of the pairs, as distance() has it; margins are not read.
/// Hulls, boxes, spheres and capsules, but not two boxes, are searched for in floats first, sixteen pairs at a time, and the last simplex is finished
/// in double, so witness points may be others, equally near, than those of the call for one pair. The bits do not depend on threads, on the
/// SIMD width or on what else is in the batch.
/// @param placed, pairs  as collide() takes them, but for meshes and compounds. @param caches  (n,) or empty; pairs with caches are
/// searched for one by one.
/// @param out  (n,) afterwards.
/// Misuse as in the single call, sizes that differ, or a number beyond the last shape: nothing changes.
void distance(const PlacedShapes& placed, std::span<const NumberedPair> pairs, Executor& executor, std::span<DistanceCache> caches,
              std::vector<DistanceResult>& out, const DistanceSettings& settings = {});

}  // namespace carom
