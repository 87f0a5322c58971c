// The group `rays`: single rays, leaks and builds by Carom and by Embree.
//
//   Result<std::vector<Row>> rows = run_rays_group({.filter = "bumpy1m/chords", .table = stdout});
#pragma once

#include <carom/bench/row.hpp>
#include <carom/bench/step_group.hpp>

#include <carom/core/result.hpp>

#include <vector>

namespace carom::bench {

/// Casts the camera rays and chords of scenes/bumpy.hpp one by one on one thread, closest hit. The contenders take turns of 50,000 rays
/// and each goes through all rays several times; the time of a row is the mean of a pass, in CPU time of the process. `leaks` is a
/// million rays from inside aimed at edges and vertices, `build` the mean of three builds.
/// Quality: wrong_rays are rays that miss where the cast in double hits or the other way round, or hit another part of the surface
/// (t differs by more than 1e-4 of 1 + t); leaks are rays from inside that hit nothing; bytes_per_triangle and sah_cost of the tree.
/// @return UnknownName where the filter matches no row.
[[nodiscard]] Result<std::vector<Row>> run_rays_group(const GroupRequest& request);

}  // namespace carom::bench
