// The threads of an executor, together for a whole step.
//
//   team.run(executor, [&] { ... team.parallel_for(count, grain, body); ... });
//
// A step is some sixty loops of 2 to 500 µs with work for one thread between them. A pool's threads go to sleep within 50 µs and take 15 to 30 µs to
// come back. Here they come in once, at the start of the step: one does the work, the others wait for its loops, awake for some 400 µs, then asleep.
//
// No thread waits for another to come in: who comes first works, and takes all blocks of its loops if nobody else does, so that an executor may run its ranges
// one after the other on one thread. A loop waits only for blocks that others are at.
//
// A loop lies in parts, one a thread, and each takes the blocks of its own part first, then those of others: from loop to loop a thread finds what it
// touched before in its own cache.
#pragma once

#include <carom/core/executor.hpp>
#include <carom/core/function_ref.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace carom::dynamics {

/// Waits a moment for another thread, the `count`-th in a row: with the processor at first, then without.
void pause_or_yield(int count) noexcept;

class Team final : public Executor {
public:
    /// Runs `work` once, on whichever thread of the executor comes in first, and returns when it is done; what it throws is thrown again. `work` may call
    /// parallel_for() of the team, and must not use the executor itself.
    void run(Executor& executor, FunctionRef<void()> work);
    /// Whether run() is at work.
    [[nodiscard]] bool is_running() const noexcept { return threads_ > 0; }

    /// Of the executor that is running; 1 outside run().
    [[nodiscard]] int thread_count() const noexcept override { return threads_ > 0 ? threads_ : 1; }
    /// Called by the one that works. From within a body, and outside run(), all is done by the caller.
    /// @param body  must not throw.
    void parallel_for(std::size_t count, std::size_t grain, Body body) override;

private:
    static constexpr std::size_t kMostParts = 16, kBlocksOfAPart = 8;
    struct alignas(64) Part {
        std::atomic<std::uint64_t> ticket{0};
    };

    void help(std::uint32_t thread) noexcept;
    void take_blocks(std::uint32_t thread, std::uint32_t loop) noexcept;

    int threads_ = 0;
    std::atomic<bool> has_leader_{false}, in_loop_{false};
    std::atomic<std::uint32_t> helpers_{0};  // that came in
    // A loop. To be read by who has taken a block of it: until that is done it stays.
    std::atomic<const Body*> body_{nullptr};
    std::atomic<std::size_t> count_{0}, blocks_{0}, parts_{1};
    alignas(64) std::atomic<std::uint32_t> loop_{0};  // its number; changes once more at the end
    std::atomic<bool> is_over_{false};
    alignas(64) std::atomic<std::size_t> done_{0};  // blocks
    Part parts_left_[kMostParts];
};

}  // namespace carom::dynamics
