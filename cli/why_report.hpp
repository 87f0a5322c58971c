// An explanation of a pair as text (for people) and as JSON (for programs).
//
//   fmt::print("{}", to_text(why, run.world, way));
#pragma once

#include <carom/dynamics/explain.hpp>

#include <nlohmann/json.hpp>

#include <string>

namespace carom::cli {

/// @return "body 3 (crate, box, dynamic)": its number, its name where it has one, what shapes it has, and whether it moves.
[[nodiscard]] std::string body_text(const World& world, BodyId body);

/// @return a line for each rung of the deciding pair, those of their way, and the sentence.
[[nodiscard]] std::string to_text(const ContactExplanation& why, const World& world, const std::string& way);

/// @return the keys that docs/cli.md defines; what a pair did not reach is null.
[[nodiscard]] nlohmann::ordered_json to_json(const ContactExplanation& why, const World& world);

}  // namespace carom::cli
