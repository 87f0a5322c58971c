// Casts seeded shapes at a target, along the rays that cast_rays() would cast.
//
//   CastRecord record = cast_shapes(*target, {.rays = 10'000, .mover = Mover::Capsule}, executor);
#pragma once

#include <carom/cli/cast_rays.hpp>

namespace carom::cli {

/// Each cast goes once through the sphere that it starts on, in the orientation of the world's axes. A mesh stands in a world of its own.
/// @param settings  whose mover is no ray. What is cast starts outside of the target, so nothing may be met behind what the ray hits: `late` counts it.
[[nodiscard]] CastRecord cast_shapes(const CastTarget& target, const CastSettings& settings, Executor& executor);

}  // namespace carom::cli
