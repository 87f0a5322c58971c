#include <carom/cli/make_executor.hpp>

#include <carom/core/tbb/tbb_executor.hpp>

namespace carom::cli {

Result<std::unique_ptr<Executor>> make_executor(int threads) {
    return threads == 1 ? std::unique_ptr<Executor>{} : std::make_unique<TbbExecutor>(threads);
}

}  // namespace carom::cli
