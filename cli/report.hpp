// The record of a run as JSON (for programs) and as one screen of text (for people).
#pragma once

#include <carom/cli/simulate.hpp>

#include <nlohmann/json.hpp>

#include <string>

namespace carom::cli {

/// @return the report whose keys docs/cli.md defines; what does not apply is null.
[[nodiscard]] nlohmann::ordered_json to_json(const RunRecord& record);

/// @return time per stage and errors, at most 40 lines.
[[nodiscard]] std::string summary(const RunRecord& record);

}  // namespace carom::cli
