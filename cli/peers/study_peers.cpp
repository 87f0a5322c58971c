#include <carom/cli/study_peers.hpp>

#include <carom/studies/peers/ray_peers.hpp>

namespace carom::cli {

std::vector<accuracy::RayCaster> study_ray_peers() { return peers::ray_peers(); }

}  // namespace carom::cli
