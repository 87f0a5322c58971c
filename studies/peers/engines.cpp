#include <carom/studies/peers/engines.hpp>

namespace carom::peers {

std::vector<accuracy::EngineMaker> engine_peers() { return {{"bullet", make_bullet}, {"ode", make_ode}}; }

}  // namespace carom::peers
