// An executor that cuts loops into ranges in no fixed order, for tests that threads leave no trace.
#pragma once

#include <carom/core/executor.hpp>

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

namespace carom::test {

/// Each thread takes every so many-th range.
class ScatteringExecutor final : public Executor {
public:
    explicit ScatteringExecutor(std::size_t threads = 3) : threads_(threads) {}
    [[nodiscard]] int thread_count() const noexcept override { return static_cast<int>(threads_); }
    void parallel_for(std::size_t count, std::size_t grain, Body body) override {
        std::vector<std::thread> threads;
        const std::size_t stride = threads_ * grain;
        for (std::size_t t = 0; t < threads_; ++t) {
            threads.emplace_back([=] {
                for (std::size_t begin = t * grain; begin < count; begin += stride) body(begin, std::min(begin + grain, count));
            });
        }
        for (std::thread& thread : threads) thread.join();
    }

private:
    std::size_t threads_;
};

}  // namespace carom::test
