// What the continuous stage followed in the last step, as layers of a debug frame: swept volumes, impacts, steps of conservative advancement.
//
//   World world({.record_paths = true});
//   DebugFrame frame = make_debug_frame(world);
//   append_sweep_layers(frame, world);
#pragma once

#include <carom/dynamics/world.hpp>
#include <carom/viz/debug_frame.hpp>

#include <vector>

namespace carom {

inline constexpr const char* kSweepVolumes = "sweep-volumes";
inline constexpr const char* kSweepGhosts = "sweep-ghosts";
inline constexpr const char* kSweepSteps = "sweep-steps";

struct SweepLayerSettings {
    std::vector<BodyId> bodies{};  ///< whose ways are drawn, and what these met, also where they were kept from being followed; empty: of all that were
    int most_copies = 24;          ///< of a body along its way, 2..256
    int segments = 12;             ///< of round shapes, see ShapeStyle
};

/// Appends, of bodies that were followed in the last step or met by one that was, where the step had them:
/// volumes: copies of each body along its way, so close that its middle leaves no gap where `most_copies` allow it, hardly opaque, and the path of its origin;
/// ghosts: each impact: the bodies that move at its time, half transparent, the point with a line along the normal, and the time;
/// steps: the boxes of the two at each time at which conservative advancement looked on its way to an impact, the later the darker; closed forms have none.
/// Planes are not drawn. A layer that has nothing is not there: where nothing was followed there is none. The frame holds no layer of these names yet.
/// Misuse is reported, and then nothing is appended: a world without WorldDef::record_paths, settings out of range, a dead body. Cost: that of
/// World::sweeps(), and linear in copies times vertices; none where it is not called.
void append_sweep_layers(DebugFrame& frame, const World& world, const SweepLayerSettings& settings = {});

}  // namespace carom
