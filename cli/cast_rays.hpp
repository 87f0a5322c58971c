// Casts seeded random rays at a target, and counts and times what comes back.
//
//   CastRecord record = cast_rays(*target, {.rays = 1'000'000, .aim = Aim::Edges}, executor);
#pragma once

#include <carom/cli/cast_target.hpp>

#include <cstdint>
#include <functional>
#include <optional>

namespace carom::cli {

/// Where rays go. All start on a sphere round the target, so outside of it.
enum class Aim : unsigned char {
    Chords,  ///< to another point of the sphere
    Edges,   ///< to a corner, or a point of an edge, of a random triangle: where a mesh that is not watertight leaks. Meshes only
};

struct CastSettings {
    std::uint64_t rays = 100'000;  ///< >= 1
    std::uint64_t seed = 1;
    Aim aim = Aim::Chords;
    std::function<void(std::uint64_t done)> progress{};  ///< may be empty
};

struct CastRecord {
    double time_s = 0.0;                 ///< in the casts: neither making the rays nor looking for leaks is part of it [s]
    std::uint64_t hits = 0;
    std::optional<std::uint64_t> leaks;  ///< of a closed mesh: rays with an odd number of crossings, or that miss what they cross
    std::uint64_t answer_hash = 0;       ///< of all distances in order; the same on any number of threads
};

[[nodiscard]] CastRecord cast_rays(const CastTarget& target, const CastSettings& settings, Executor& executor);

}  // namespace carom::cli
