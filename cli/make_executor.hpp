// The executor for --threads.
#pragma once

#include <carom/core/executor.hpp>
#include <carom/core/result.hpp>

#include <memory>

namespace carom::cli {

/// @param threads  >= 1.
/// @return the executor; null for one thread, which needs none; an error for more in a build without oneTBB.
[[nodiscard]] Result<std::unique_ptr<Executor>> make_executor(int threads);

}  // namespace carom::cli
