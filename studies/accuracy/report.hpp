// The results of studies as JSON, as CSV and as a table.
//
//   write_text("rays.json", to_json(results));
#pragma once

#include <carom/studies/accuracy/study.hpp>

#include <span>
#include <string>

namespace carom::accuracy {

/// @return {"studies": [...]}; docs/accuracy.md defines every key. What there is none of is null. Indented, with a final newline.
[[nodiscard]] std::string to_json(std::span<const StudyResult> results);

/// @return a header line and a line for each point: who, settings, time_s, time_iqr_s, error (empty where there is none),
/// failures, front (1 or 0). Numbers round-trip. Fields are quoted as RFC 4180 says.
[[nodiscard]] std::string to_csv(const StudyResult& result);

/// @return the points in order of time, those of the front marked with '*', failed ones last, and the times to reach kReach for
/// each of those who took part.
[[nodiscard]] std::string to_table(const StudyResult& result);

}  // namespace carom::accuracy
