#include <carom/dynamics/detail/phase_loop.hpp>

#include <hwy/cache_control.h>

#include <algorithm>
#include <chrono>
#include <thread>

namespace carom::dynamics {
namespace {

/// Adds what passes between two labels to the first.
class Watch {
public:
    Watch(bool runs, std::span<double> milliseconds) : runs_(runs), milliseconds_(milliseconds) {}
    void look(int label) {
        if (!runs_ || label == label_) return;
        const Clock::time_point now = Clock::now();
        if (label_ >= 0) milliseconds_[static_cast<std::size_t>(label_)] += std::chrono::duration<double, std::milli>(now - since_).count();
        since_ = now;
        label_ = label;
    }

private:
    using Clock = std::chrono::steady_clock;
    bool runs_;
    std::span<double> milliseconds_;
    int label_ = -1;
    Clock::time_point since_;
};

std::size_t block_count(const Phase& phase) noexcept { return (phase.count + phase.grain - 1) / phase.grain; }

void wait_for(const std::atomic<std::uint32_t>& done, std::size_t blocks) noexcept {
    constexpr int kSpins = 2000;  // some 50 µs; then whoever holds a block may be without a processor
    for (int spins = 0; done.load(std::memory_order_acquire) < blocks; ++spins) {
        if (spins < kSpins) {
            hwy::Pause();
        } else {
            std::this_thread::yield();
        }
    }
}

}  // namespace

void PhaseLoop::take_part(std::size_t thread, std::size_t parts, std::span<const Phase> phases, Body body,
                          std::span<double> milliseconds) noexcept {
    Watch watch(!is_timed_.exchange(true, std::memory_order_relaxed), milliseconds);
    for (std::size_t p = 0; p < phases.size(); ++p) {
        const Phase& phase = phases[p];
        State& state = states_[p];
        const std::size_t blocks = block_count(phase);
        watch.look(phase.label);
        std::uint32_t mine = 0;
        for (std::size_t k = 0; k < parts; ++k) {
            const std::size_t part = (thread + k) % parts, end = (part + 1) * blocks / parts;
            std::size_t block = part * blocks / parts;
            if (block == end) continue;
            const std::size_t first = block;
            while ((block = first + state.next[part].fetch_add(1, std::memory_order_relaxed)) < end) {
                body(p, block * phase.grain, std::min(phase.count, (block + 1) * phase.grain));
                ++mine;
            }
        }
        if (mine > 0) state.done.fetch_add(mine, std::memory_order_acq_rel);
        wait_for(state.done, blocks);
    }
    watch.look(-1);
}

std::size_t PhaseLoop::part_count(const Executor& executor) noexcept {
    return std::min(static_cast<std::size_t>(executor.thread_count()), kMostParts);
}

void PhaseLoop::run(std::span<const Phase> phases, Executor& executor, Body body, std::span<double> milliseconds) {
    const auto threads = static_cast<std::size_t>(executor.thread_count());
    if (threads == 1) {
        Watch watch(true, milliseconds);
        for (std::size_t p = 0; p < phases.size(); ++p) {
            watch.look(phases[p].label);
            if (phases[p].count > 0) body(p, 0, phases[p].count);
        }
        watch.look(-1);
        return;
    }
    if (state_count_ < phases.size()) {
        state_count_ = phases.size() + phases.size() / 2;
        states_ = std::make_unique<State[]>(state_count_);
    }
    for (std::size_t p = 0; p < phases.size(); ++p) {
        for (auto& next : states_[p].next) next.store(0, std::memory_order_relaxed);
        states_[p].done.store(0, std::memory_order_relaxed);
    }
    is_timed_.store(false, std::memory_order_relaxed);
    const std::size_t parts = part_count(executor);
    executor.parallel_for(threads, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t thread = begin; thread < end; ++thread) take_part(thread, parts, phases, body, milliseconds);
    });
}

}  // namespace carom::dynamics
