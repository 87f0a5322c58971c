// Files written whole, with every failure reported.
#pragma once

#include <carom/core/result.hpp>

#include <string>
#include <string_view>

namespace carom::detail {

/// Replaces the file `path` by `bytes`. @return Io with the path and the system's reason.
[[nodiscard]] Status write_file(const std::string& path, std::string_view bytes);

/// Makes the directory and its parents. @return Io with the path and the system's reason.
[[nodiscard]] Status make_directory(const std::string& path);

}  // namespace carom::detail
