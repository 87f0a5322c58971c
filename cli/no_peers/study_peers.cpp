#include <carom/cli/study_peers.hpp>

namespace carom::cli {

std::vector<accuracy::RayCaster> study_ray_peers() { return {}; }
std::vector<accuracy::EngineMaker> study_engine_peers() { return {}; }

}  // namespace carom::cli
