// Other physics engines with scenes of ours in them.
//
//   std::unique_ptr<accuracy::Engine> engine = make_bullet(accuracy::scene_bodies(run.world));
//   StudyOptions options{.engine_peers = engine_peers()};
#pragma once

#include <carom/studies/accuracy/engine.hpp>

#include <memory>
#include <vector>

namespace carom::peers {

/// Bullet: btDiscreteDynamicsWorld, sequential impulses, btDbvtBroadphase.
/// @throws std::invalid_argument for shapes that the comparison leaves out: planes, cylinders, cones, compounds.
[[nodiscard]] std::unique_ptr<accuracy::Engine> make_bullet(const accuracy::SceneBodies& bodies);
/// ODE: dWorldQuickStep over a sweep-and-prune space. @throws std::invalid_argument as make_bullet does.
[[nodiscard]] std::unique_ptr<accuracy::Engine> make_ode(const accuracy::SceneBodies& bodies);

/// @return both, as candidates of the studies of whole worlds.
[[nodiscard]] std::vector<accuracy::EngineMaker> engine_peers();

}  // namespace carom::peers
