// Overlap and distance of many pairs at once, in floats with a bound on their rounding: what kernels take and give.
//
//   overlap_boxes(pairs, verdicts);                              // two boxes each, by fifteen axes
//   search_cores(pairs, LaneGoal::Distance, results);            // points of any number and a radius, by GJK
//
// Both bring a pair into A's frame, in float, and call S = |t|_1 + reach_a + reach_b (+ radii), t from A's origin to B's. What floats do to
// a separation along a unit direction, or to a point of the difference, is below E = 2^-16 S:
// - orientations are of unit length to e = 2^-20.5, or the pair is left out: their product's matrix is off by 2 e of a rotation, and rounding of
//   quaternions, product and matrix adds 20 roundings (2^-24) to an entry: points of B err by 2^-18 of reach_b, t by as much of itself;
// - the matrix is skew by as much, so that normals of B's faces lie 2^-18 off its axes, which counts as much of S along them;
// - products with a unit direction add 8 roundings, and directions that are rounded move a support by no more than 8.
#pragma once

#include <carom/collision/convex_hull.hpp>
#include <carom/core/pose.hpp>
#include <carom/narrowphase/distance.hpp>
#include <carom/narrowphase/overlap.hpp>

#include <cstdint>
#include <span>

namespace carom::detail {

/// E over S.
inline constexpr float kLaneRounding = 0x1p-16f;
/// S of pairs that floats take [m]: squares of E and cubes of S stay normal numbers.
inline constexpr float kSmallestLaneSize = 0x1p-20f;
inline constexpr float kLargestLaneSize = 0x1p30f;

/// Where two shapes are.
struct LanePlace {
    const Pose* a = nullptr;
    const Pose* b = nullptr;
};

/// Two boxes.
struct LaneBoxes {
    LanePlace place;
    const vec3* half_a = nullptr;
    const vec3* half_b = nullptr;
};

/// A core: the points of a hull, or, where there are none, of a box, a segment along y or a point; in a ball of `radius`.
struct LaneCore {
    const ConvexHull::VertexBundle* points = nullptr;
    std::uint32_t bundles = 0;
    vec3 half{0.0f};
    float reach = 0.0f;
    float radius = 0.0f;
};
struct LaneCores {
    LanePlace place;
    LaneCore a, b;
};

enum class LaneGoal : unsigned char { Verdict, Distance };

/// What the search ended with. Verdicts but Undecided are proved. The simplex is one for pair_distance() to begin with.
struct LaneResult {
    Overlap verdict = Overlap::Undecided;
    std::int32_t rounds = 0;
    DistanceCache simplex;
};

/// @param verdicts  (n,), and room for as many as fill the last bundle.
/// Method: Gottschalk, Lin, Manocha (1996), faces first. B's axes as rounded describe a box that is a little skew, and all products are taken from
/// them as they are; so along an edge axis, of whatever length s, the separation errs by its share of s, and the fifteen axes decide of the
/// skew box what they decide of a true one. A box holds a ball of its least half extent about its centre, so two overlap where one's centre is nearer to the
/// other box than that. Of random pairs of which half overlap, faces and balls leave a fifth to the axes of edges.
void overlap_boxes(std::span<const LaneBoxes> pairs, Overlap* verdicts);

/// @param results  (n,). In a search for the distance those that are apart are Undecided, with their simplex.
/// Method: GJK in lockstep, a lane a pair; supports pair by pair, over the vertices; the simplex across lanes. A lane that is done takes
/// the next pair.
void search_cores(std::span<const LaneCores> pairs, LaneGoal goal, LaneResult* results);

}  // namespace carom::detail
