// What an engine's bodies do over a run: their states at given times, and the time that the steps took.
//
//   const Track track = follow(*engine, bodies, times, 1.0 / 60.0);
#pragma once

#include <carom/studies/accuracy/engine.hpp>
#include <carom/studies/oracle/free_body.hpp>

#include <span>
#include <vector>

namespace carom::accuracy {

using BodyStates = std::vector<std::vector<oracle::FreeBodyState>>;  ///< of the frames of mass, by body, by time

struct Track {
    double seconds = 0.0;  ///< of the processor, for the steps alone
    BodyStates states{};
};

/// Steps `engine`, which holds `bodies`, through all times.
/// @param times  evenly spaced from one spacing on [s]; not empty.
/// @param dt     of which the spacing is a multiple [s].
[[nodiscard]] Track follow(Engine& engine, const SceneBodies& bodies, std::span<const double> times, double dt);

/// @return whether all positions, orientations and velocities are finite.
[[nodiscard]] bool is_finite(const Track& track);

/// @return `count` times, `spacing` apart, from `spacing` on [s].
[[nodiscard]] std::vector<double> even_times(double spacing, int count);

}  // namespace carom::accuracy
