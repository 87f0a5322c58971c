// Boxes and hulls of 32 vertices, pair by pair: the rows box/... and hull32/... of the group `narrowphase`.
//
//   std::vector<Row> rows = run_convex_rows({.filter = "box/boolean"});
#pragma once

#include <carom/bench/step_group.hpp>

namespace carom::bench {

/// Rows box/boolean, box/manifold, hull32/boolean, hull32/distance and hull32/manifold against `fcl`, which the filter matches.
///
/// 200 shapes, boxes of half extents r(.2, 1) or hulls of 32 points of the unit sphere scaled along each axis by r(.4, 1), and 20,000
/// pairs of them with uniform random rotations and centres r(.5, 2.4) apart; a stream of its own for boxes (seed 12) and hulls (13). The
/// contenders take turns in batches of 1,000 pairs, seven passes over all after one to warm up, and the median pass counts; CPU time of the
/// process, a pair.
/// FCL's poses are ready beforehand; Carom starts from Pose. Manifolds are held against FCL's penetration (one point and a depth).
/// Quality: of the first 4,000 pairs, wrong verdicts (but for gaps and depths below 1e-9); depths off by more than 1e-3, by a double
/// oracle over all separating axes; distances off by more than 1e-6, by the bounds of distance(); and the largest error of each [m].
[[nodiscard]] std::vector<Row> run_convex_rows(const GroupRequest& request);

}  // namespace carom::bench
