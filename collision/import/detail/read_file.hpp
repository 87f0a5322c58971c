// A whole file as bytes.
//
//   Result<std::string> contents = read_file("bunny.off");
#pragma once

#include <carom/core/result.hpp>

#include <string>

namespace carom {

/// @return Io: missing, not a regular file, or not to be read. InvalidArgument: more than kMostMeshFileBytes.
[[nodiscard]] Result<std::string> read_file(const std::string& path);

}  // namespace carom
