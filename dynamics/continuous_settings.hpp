// Which bodies are followed along their paths, so that they pass through nothing.
//
//   World world({.continuous = {.most_impacts = 32}});
//   world.step(dt).continuous.impacts;   // what they met between the start of the step and its end
#pragma once

namespace carom {

/// On by default. docs/continuous.md states what is promised, and what it costs.
struct ContinuousSettings {
    bool enabled = true;
    double motion = 0.5;    ///< a body is followed where a point of it may have moved by more than this share of its smallest shape's smallest extent in
                            ///< the step, within 1e-3 .. 0.5. At a half, what is not followed cannot bring its middle to where it had not come near
    int most_impacts = 16;  ///< of a body in a step, 1 .. 1000; one that comes to more stays where the last one was, until the step is over
};

/// Whether one body is followed.
enum class Continuity : unsigned char {
    Automatic,  ///< by its motion
    Always,     ///< in every step in which it moves
    Never,      ///< not by its own motion; others that are followed meet it nevertheless
};
/// @return "automatic", "always", "never": as scene files spell it.
[[nodiscard]] const char* to_string(Continuity continuity) noexcept;

}  // namespace carom
