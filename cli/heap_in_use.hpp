// How much memory this program holds.
#pragma once

#include <cstddef>
#include <optional>

namespace carom::cli {

/// @return bytes that malloc has given and not got back, for the calling thread's part and large blocks; nothing where the C library does not say, as
/// under sanitizers. Differences of it on one thread are what was allocated in between.
[[nodiscard]] std::optional<std::size_t> heap_in_use();

}  // namespace carom::cli
