// The oneTBB executor.
//
//   TbbExecutor executor(2);
//   World world({.executor = &executor});
#pragma once

#include <carom/core/executor.hpp>

#include <memory>

namespace carom {

/// Runs loops on `threads` threads of an arena of its own, the caller's included.
class TbbExecutor final : public Executor {
public:
    /// @param threads  >= 1; otherwise misuse is reported and one thread is used.
    explicit TbbExecutor(int threads);
    ~TbbExecutor() override;

    [[nodiscard]] int thread_count() const noexcept override;
    void parallel_for(std::size_t count, std::size_t grain, Body body) override;

private:
    struct Arena;
    std::unique_ptr<Arena> arena_;
};

}  // namespace carom
