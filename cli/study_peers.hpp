// Other libraries that join the studies: none but in builds with peers.
#pragma once

#include <carom/studies/accuracy/engine.hpp>
#include <carom/studies/accuracy/ray_problem.hpp>

#include <vector>

namespace carom::cli {

[[nodiscard]] std::vector<accuracy::RayCaster> study_ray_peers();
[[nodiscard]] std::vector<accuracy::EngineMaker> study_engine_peers();

}  // namespace carom::cli
