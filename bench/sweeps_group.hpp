// The group `sweeps`: when moving convex shapes first touch, by Carom, FCL's conservative advancement and Bullet's convex casts.
//
//   Result<std::vector<Row>> rows = run_sweeps_group({.filter = "hulls/turning", .table = stdout});
#pragma once

#include <carom/bench/step_group.hpp>

namespace carom::bench {

/// Rows balls/moving, boxes/moving, hulls/moving, boxes/turning and hulls/turning, each against `fcl` and `bullet`.
///
/// 200 shapes, boxes and hulls of random_shapes.hpp, balls of radius r(.2, 1) against boxes that stand; 4,000 pairs with uniform random
/// rotations that start 4 m apart and come r(.5, 2) of the way nearer, B or both of them moving; `turning` by up to 0.7 rad besides, which
/// is all that Bullet follows. The contenders take turns of 200 pairs, seven passes after one to warm up, and the median counts; CPU time
/// of the process, a pair. Everybody has his defaults: Carom ends within 1e-9 of the sizes. FCL's and Bullet's motions are ready beforehand.
/// Quality, over all pairs: `missed` (no contact said where an overlap is proved), `late` (by more than 1e-5 of the motion behind a time at which an
/// overlap is proved) and `latest`, `made_up` (contact said where its absence is proved), `early` (mean lead over a time before which
/// contact is excluded, of those that are neither), `no_answer` (exceptions). What is proved is by distance() at sampled times, bisected, and by
/// time_of_impact() with a cap of 16,384.
/// @return UnknownName where the filter matches no row.
[[nodiscard]] Result<std::vector<Row>> run_sweeps_group(const GroupRequest& request);

}  // namespace carom::bench
