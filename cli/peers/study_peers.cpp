#include <carom/cli/study_peers.hpp>

#include <carom/studies/peers/engines.hpp>
#include <carom/studies/peers/ray_peers.hpp>

namespace carom::cli {

std::vector<accuracy::RayCaster> study_ray_peers() { return peers::ray_peers(); }
std::vector<accuracy::EngineMaker> study_engine_peers() { return peers::engine_peers(); }

}  // namespace carom::cli
