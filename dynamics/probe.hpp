// Ray probes on the bodies of a world: what the wheels of vehicles feel.
//
//   std::vector<WorldProbe> wheels{{.body = car, .probe = {.centre = {0.8, -0.3, 1.2}, .radius = 0.35, .reach = 0.1}}, ...};
//   std::vector<WorldProbeContact> contacts;
//   probe(world, wheels, executor, contacts);
#pragma once

#include <carom/core/executor.hpp>
#include <carom/core/ids.hpp>
#include <carom/dynamics/world.hpp>
#include <carom/narrowphase/probe.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom {

struct WorldProbe {
    BodyId body;          ///< whose frame the probe is in; its own shapes are not felt
    RayProbe probe;
    std::uint64_t mask = ~std::uint64_t{0};  ///< layers of shapes that are felt
};

struct WorldProbeContact {
    BodyId body;          ///< what was met
    ShapeId shape;
    ProbeContact contact;  ///< `shape` in it counts shapes by bodies, in order of creation
};

/// What the probes feel of a world as it stands, in their order; replaces `out`. <carom/narrowphase/probe.hpp> says how wrong it is.
/// Shapes of quarantined bodies are not felt.
/// Misuse (a dead body, a probe out of range, by its message) is reported and changes nothing.
/// Cost: the box of every shape of the world, a look at each box for every probe, and the casts at those whose boxes the probe's
/// comes near. The same bits on every number of threads. Allocates.
void probe(const World& world, std::span<const WorldProbe> probes, Executor& executor, std::vector<WorldProbeContact>& out);

}  // namespace carom
