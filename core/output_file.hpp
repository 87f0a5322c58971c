// Where a report goes: a file, or standard output for "-".
//
//   if (Status s = check_writable(path); !s) ...        // before the run
//   if (Status s = write_text(path, text); !s) ...      // after it
#pragma once

#include <carom/core/result.hpp>

#include <string>

namespace carom {

/// Opens the file for writing without changing it; one that did not exist does not exist afterwards.
/// @return Io with the path and the system's reason. "-" is always writable.
[[nodiscard]] Status check_writable(const std::string& path);

/// Replaces the file by `text`, or prints it. @return Io with the path and the system's reason.
[[nodiscard]] Status write_text(const std::string& path, const std::string& text);

}  // namespace carom
