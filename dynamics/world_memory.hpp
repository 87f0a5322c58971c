// What a world holds of memory, by part.
//
//   WorldMemory memory = world.memory();
//   memory.total() / world.body_count()
#pragma once

#include <cstddef>

namespace carom {

/// Bytes, room for growth included, as the world asked for them: what an allocator adds is not in it. Nor are hulls, meshes and compounds, which worlds may share,
/// nor the executor, nor what the narrowphase keeps from call to call, for a thousand pairs at a time (some 200 kB for boxes).
struct WorldMemory {
    std::size_t bodies = 0;      ///< states, masses, records and names; where each was as the step began
    std::size_t shapes = 0;      ///< as they were given, and as a step sees them
    std::size_t joints = 0;      ///< and their solver
    std::size_t broadphase = 0;  ///< boxes and pairs
    std::size_t contacts = 0;    ///< manifolds and their impulses; of what sleeps too
    std::size_t solver = 0;      ///< bundles of contacts, and islands that are solved directly
    std::size_t scratch = 0;     ///< shared by the stages of a step
    std::size_t other = 0;       ///< impacts, continuous collision, sleep, and what reports ask for

    [[nodiscard]] std::size_t total() const noexcept { return bodies + shapes + joints + broadphase + contacts + solver + scratch + other; }
};

}  // namespace carom
