// What became of two bodies on their way, as text (for people) and as JSON (for programs).
//
//   fmt::print("{}", way_text(sweep, passages, run.world));
#pragma once

#include <carom/dynamics/explain_sweep.hpp>
#include <carom/dynamics/world.hpp>

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace carom::cli {

/// @return a line for how each of the two moved, for how they met on their way, and for each impact of theirs.
[[nodiscard]] std::string way_text(const SweepExplanation& sweep, const World& world);

/// @return the sentence of the last step, where one of the two was followed, should have been or passed and that is not told better by a passage before,
/// and those of passages in steps before; else "".
[[nodiscard]] std::string way_sentences(const SweepExplanation& sweep, const std::vector<Passage>& passages);

/// @return the keys that docs/cli.md defines.
[[nodiscard]] nlohmann::ordered_json to_json(const SweepExplanation& sweep);
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<Passage>& passages);

}  // namespace carom::cli
