// The group `broadphase`: the pairs of moving boxes by Carom, Bullet, FCL and CGAL.
//
//   Result<std::vector<Row>> rows = run_broadphase_group({.filter = "moving/100000", .table = stdout});
#pragma once

#include <carom/bench/step_group.hpp>

namespace carom::bench {

/// Rows moving/<boxes>/<percent that moves> and scratch/<boxes>. In each frame the contenders take turns, in CPU time of the process; the
/// first three frames do not count. The pairs of every contender that overlap exactly are compared with Carom's in the first and the last
/// frame. Quality: false_pairs, the share of a contender's pairs that do not overlap.
/// @return UnknownName where the filter matches no row, WrongType where two contenders disagree.
[[nodiscard]] Result<std::vector<Row>> run_broadphase_group(const GroupRequest& request);

}  // namespace carom::bench
