// Executors that run their ranges in unusual ways.
#pragma once

#include <carom/core/executor.hpp>

#include <chrono>
#include <functional>
#include <thread>
#include <utility>
#include <vector>

namespace carom::test {

/// Says that it has `threads`, and runs the ranges as `how` does.
class OddExecutor final : public Executor {
public:
    using How = std::function<void(std::size_t count, const Body& body)>;
    OddExecutor(int threads, How how) : threads_(threads), how_(std::move(how)) {}
    [[nodiscard]] int thread_count() const noexcept override { return threads_; }
    void parallel_for(std::size_t count, std::size_t, Body body) override { how_(count, body); }

private:
    int threads_;
    How how_;
};

inline void in_threads(std::size_t count, const Executor::Body& body, bool late) {
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < count; ++i) {
        threads.emplace_back([=, &body] {
            if (late && i % 2 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
            body(i, i + 1);
        });
    }
    for (std::thread& t : threads) t.join();
}

struct Way {
    const char* name;
    OddExecutor::How how;
};

inline std::vector<Way> odd_ways() {
    return {
        {"one range", [](std::size_t count, const Executor::Body& body) { body(0, count); }},
        {"one after the other, the last first",
         [](std::size_t count, const Executor::Body& body) {
             for (std::size_t i = count; i-- > 0;) body(i, i + 1);
         }},
        {"threads", [](std::size_t count, const Executor::Body& body) { in_threads(count, body, false); }},
        {"threads of which every other is late", [](std::size_t count, const Executor::Body& body) { in_threads(count, body, true); }},
    };
}

}  // namespace carom::test
