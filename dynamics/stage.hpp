// The stages of a step: the rows of the profile, of the plan and of the hash log, and the headings of docs/step.md.
#pragma once

#include <array>

namespace carom {

enum class Stage : unsigned char {
    Bounds,
    Pairs,
    Collide,
    Restitution,
    Islands,
    Direct,
    Joints,
    Prepare,
    Velocities,
    WarmStart,
    Solve,
    Positions,
    Relax,
    Store,
    Continuous,
    Quarantine,
    Sleep,
};
inline constexpr int kStageCount = static_cast<int>(Stage::Sleep) + 1;

/// @return the name as written above.
[[nodiscard]] const char* to_string(Stage stage) noexcept;

/// All stages in the order they run.
[[nodiscard]] std::array<Stage, kStageCount> all_stages() noexcept;

}  // namespace carom
