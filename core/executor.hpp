// The hook through which every parallel loop runs. Serial by default; core/tbb has an adapter for oneTBB.
//
//   executor.parallel_for(n, 64, [&](std::size_t begin, std::size_t end) { ... });
#pragma once

#include <carom/core/function_ref.hpp>

#include <cstddef>

namespace carom {

/// Runs ranges of a loop, in any order and on any thread. Results must not depend on how the range is cut: each index
/// writes only what is its own, and reductions have a fixed shape.
class Executor {
public:
    using Body = FunctionRef<void(std::size_t begin, std::size_t end)>;

    virtual ~Executor() = default;
    Executor() = default;
    Executor(const Executor&) = delete;
    Executor& operator=(const Executor&) = delete;

    /// @return how many threads may run bodies at once, >= 1.
    [[nodiscard]] virtual int thread_count() const noexcept = 0;

    /// Calls `body` on disjoint ranges that cover [0, count) and returns when all are done.
    /// @param grain  ranges hold at least this many indices where count allows it; >= 1.
    virtual void parallel_for(std::size_t count, std::size_t grain, Body body) = 0;
};

/// Runs everything on the calling thread, as one range.
class SerialExecutor final : public Executor {
public:
    [[nodiscard]] int thread_count() const noexcept override { return 1; }
    void parallel_for(std::size_t count, std::size_t grain, Body body) override;
};

}  // namespace carom
