// Threads that take the pieces of a loop in an order of their own.
#pragma once

#include <carom/core/executor.hpp>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace carom::test {

/// Cuts every loop into many pieces and runs them on several threads, last piece first.
class ShuffledExecutor final : public Executor {
public:
    explicit ShuffledExecutor(int threads) : threads_(threads) {}
    [[nodiscard]] int thread_count() const noexcept override { return threads_; }
    void parallel_for(std::size_t count, std::size_t grain, Body body) override {
        const std::size_t pieces = (count + grain - 1) / grain;
        std::atomic<std::size_t> left{pieces};
        const auto work = [&] {
            for (;;) {
                const std::size_t taken = left.fetch_sub(1);
                if (taken == 0 || taken > pieces) return;
                const std::size_t begin = (taken - 1) * grain;
                body(begin, std::min(begin + grain, count));
            }
        };
        std::vector<std::thread> others;
        for (int i = 1; i < threads_ && pieces > 1; ++i) others.emplace_back(work);
        work();
        for (std::thread& t : others) t.join();
    }

private:
    int threads_;
};

}  // namespace carom::test
