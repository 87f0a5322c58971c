// The group `narrowphase`: boxes, hulls and meshes in pairs, by Carom and FCL.
//
//   Result<std::vector<Row>> rows = run_narrowphase_group({.filter = "mesh/all", .table = stdout});
#pragma once

#include <carom/bench/step_group.hpp>

namespace carom::bench {

/// The rows of convex_group.hpp, then mesh/build, mesh/boolean and mesh/all against `fcl`: the ball of bumps of 69,312 triangles with itself at 100 poses, of which
/// most touch. Seed 11; a uniform random rotation and a direction, both redrawn while their length is over 1 or under .1, and a distance
/// r(1.6, 2.25). mesh/aligned/boolean and /all: the ball moved by 0.01 to 1.9 along axes and a diagonal, without a turn, 24 poses;
/// mesh/coincident/boolean and /all: where it is itself. The contenders take turns pose by pose, three times over; CPU time of the process.
/// Times are a query's, or a build's. Quality: pairs, or poses that touch; and of Carom the least of its speeds at any of the poses, times FCL's.
/// @return UnknownName where the filter matches no row, WrongType where the two disagree on the number of pairs of mesh/boolean or mesh/all by more
/// than a thousandth: FCL's verdicts on triangles that touch are not exact, so the other rows only show both numbers.
[[nodiscard]] Result<std::vector<Row>> run_narrowphase_group(const GroupRequest& request);

}  // namespace carom::bench
