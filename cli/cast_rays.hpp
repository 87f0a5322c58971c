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

/// What is cast.
enum class Mover : unsigned char {
    Ray,
    Ball,
    Capsule,  ///< two radii longer than a ball
    Box,      ///< a cube, as wide as the ball
    Hull,     ///< twelve corners on the ball
};
/// @return "ray", "ball", "capsule", "box" or "hull".
[[nodiscard]] const char* to_string(Mover mover) noexcept;

struct CastSettings {
    std::uint64_t rays = 100'000;  ///< >= 1
    Mover mover = Mover::Ray;
    double radius = 0.0;           ///< of what is cast but for a ray [m]; 0: a hundredth of the target
    std::uint64_t seed = 1;
    Aim aim = Aim::Chords;
    std::function<void(std::uint64_t done)> progress{};  ///< may be empty
};

struct CastRecord {
    double time_s = 0.0;                 ///< in the casts: neither making the rays nor looking for leaks is part of it [s]
    std::uint64_t hits = 0;
    std::optional<std::uint64_t> leaks;  ///< of a closed mesh: rays with an odd number of crossings, or that miss what they cross
    std::optional<std::uint64_t> late;   ///< of shapes: casts that end behind what the ray along their centre hits
    double radius = 0.0;                 ///< of what was cast [m]; 0 of rays
    std::uint64_t answer_hash = 0;       ///< of all distances in order; the same on any number of threads
};

[[nodiscard]] CastRecord cast_rays(const CastTarget& target, const CastSettings& settings, Executor& executor);

}  // namespace carom::cli
