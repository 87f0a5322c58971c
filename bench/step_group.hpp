// The group `step`: whole steps of the same scenes by Carom, Bullet and ODE.
//
//   Result<std::vector<Row>> rows = run_step_group({.filter = "pile_boxes/4000", .table = stdout});
#pragma once

#include <carom/bench/row.hpp>

#include <carom/core/result.hpp>

#include <cstdio>
#include <string>
#include <vector>

namespace carom::bench {

/// What a group is asked for.
struct GroupRequest {
    std::string filter{};        ///< rows whose "bench/peer" contains it, e.g. "pile_boxes/4000" or "bullet"; empty: all
    std::FILE* table = stdout;   ///< where rows are printed as they are done
};

/// Runs every scene once. In each, the engines take turns of ten steps, so that a machine whose speed drifts treats all alike;
/// the time is the mean over the whole run, in CPU time of the process: other programs that share the machine are not counted, and
/// a thread that an engine might start is. Quality: max_penetration and mean_penetration [m] over boxes and hulls at the end of the
/// run, from poses and shapes alone, the same way for every engine.
/// @return UnknownName where the filter matches no row.
[[nodiscard]] Result<std::vector<Row>> run_step_group(const GroupRequest& request);

}  // namespace carom::bench
