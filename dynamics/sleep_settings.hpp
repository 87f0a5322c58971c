// When islands of bodies that have come to rest are put to sleep.
//
//   World world({.sleep = {.enabled = true}});
//   world.step(dt).asleep;   // bodies that the step had nothing to do for
#pragma once

namespace carom {

/// Off by default: what sleeps is held where it is, which changes the state's last digits, and only what leaves the state bit-identical happens
/// without being asked for. docs/dynamics.md has the criterion and what it rests on.
struct SleepSettings {
    bool enabled = false;
    double time = 0.5;     ///< for so long an island must have been still [s], within 0.01 .. 1000
    double motion = 1e-3;  ///< that is: no point of a body has moved by more than this share of its smallest shape's smallest extent, within
                           ///< 1e-9 .. 0.1, nor by more than a small share of what gravity moves a free body by in that time
};

}  // namespace carom
