// The triangles that a ray in double may hit, near ones mostly first.
//
//   WideRay wide;
//   if (prepare(tree, ray, wide)) visit_ray_candidates(tree, wide, [&](const WideLeaf& leaf, unsigned triangles) { ... });
#pragma once

#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/collision/detail/wide_ray.hpp>
#include <carom/core/function_ref.hpp>

namespace carom {

/// Calls `visit` with leaves and, as bits, the triangles in them that the exact ray from which `ray` was prepared may hit at a
/// parameter up to ray.t_max. `visit` returns the new ray.t_max, which must not be below the nearest hit so far.
void visit_ray_candidates(const WideBvh& tree, WideRay& ray, FunctionRef<float(const WideLeaf& leaf, unsigned triangles)> visit);

}  // namespace carom
