// How near two cores are, with bounds that are proved.
//
//   Proximity p = find_proximity(pair, {.decide = pair.a.radius + pair.b.radius}, nullptr);
#pragma once

#include <carom/narrowphase/detail/convex_core.hpp>
#include <carom/narrowphase/detail/gjk_simplex.hpp>
#include <carom/narrowphase/distance.hpp>

namespace carom::detail {

struct Proximity {
    double lower = 0.0;    ///< the cores' distance is at least this, in the pair's unit
    double upper = 0.0;    ///< and at most this
    dvec3 normal{0.0};     ///< unit, from a to b: across the support plane that gave `lower`, or along the witness; zero where neither is
    dvec3 on_a{0.0};       ///< where `upper` is met; without meaning where the cores overlap
    dvec3 on_b{0.0};
    DistanceStatus status = DistanceStatus::Converged;
    int iterations = 0;
};

struct ProximityGoal {
    double decide = -1.0;     ///< stop once it is known on which side of this the distance lies; negative: never
    double tolerance = 0.0;   ///< stop once the bounds are this near, as a share of the upper one
    int most_iterations = 128;
};

/// Method: Gilbert, Johnson, Keerthi (1988); the lower bound is that of the best support plane seen (ibid., theorem 2), less
/// `pair.rounding`. Where the cores overlap, the last tetrahedron proves it if the origin is deeper inside than the rounding; otherwise a
/// polytope grows round the origin (epa_hull.hpp) until its faces prove it, or a support plane shows that rounding decides.
/// @param cache  null, or the simplex of an earlier call to begin with; becomes this call's.
/// Total: ends after most_iterations rounds and 128 points of the polytope, never throws. No allocation.
[[nodiscard]] Proximity find_proximity(const CorePair& pair, const ProximityGoal& goal, DistanceCache* cache) noexcept;

}  // namespace carom::detail
