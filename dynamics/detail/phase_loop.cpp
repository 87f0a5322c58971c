#include <carom/dynamics/detail/phase_loop.hpp>

#include <carom/core/flush_to_zero.hpp>
#include <carom/dynamics/detail/team.hpp>

#include <algorithm>
#include <chrono>

namespace carom::dynamics {
namespace {

/// Adds what passes between two labels to the first.
class Watch {
public:
    Watch(bool runs, std::span<double> milliseconds) : runs_(runs && !milliseconds.empty()), milliseconds_(milliseconds) {}
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

struct Range {
    std::size_t begin = 0, end = 0;
};

Range part_of(const Phase& phase, std::size_t part, std::size_t parts) noexcept {
    if (phase.starts != nullptr) return {phase.starts[part], phase.starts[part + 1]};
    return {part * phase.count / parts, (part + 1) * phase.count / parts};
}

}  // namespace

// Nobody sets them back: a flag holds the number of the run, and stays in the cache of the thread whose part it is.
bool PhaseLoop::State::take(std::size_t part, std::uint32_t run) noexcept {
    std::atomic<std::uint32_t>& flag = taken[part].run;
    return flag.load(std::memory_order_relaxed) != run && flag.exchange(run, std::memory_order_acq_rel) != run;
}

void PhaseLoop::State::wait(std::size_t parts, std::uint32_t run) const noexcept {
    for (std::size_t part = 0; part < parts; ++part) {
        for (int spins = 0; done[part].run.load(std::memory_order_acquire) != run; ++spins) pause_or_yield(spins);
    }
}

void PhaseLoop::take_part(std::size_t thread, std::size_t parts, std::span<const Phase> phases, Body body,
                          std::span<double> milliseconds) noexcept {
    const FlushToZero no_denormals;
    Watch watch(!is_timed_.exchange(true, std::memory_order_relaxed), milliseconds);
    for (std::size_t p = 0; p < phases.size(); ++p) {
        const Phase& phase = phases[p];
        State& state = states_[p];
        watch.look(phase.label);
        for (std::size_t k = 0; k < parts; ++k) {
            const std::size_t part = (thread + k) % parts;
            if (!state.take(part, run_)) continue;
            const Range range = part_of(phase, part, parts);
            if (range.begin < range.end) body(p, range.begin, range.end);
            state.done[part].run.store(run_, std::memory_order_release);
        }
        state.wait(parts, run_);
    }
    watch.look(-1);
}

std::size_t PhaseLoop::part_count(const Executor& executor) noexcept {
    return std::min(static_cast<std::size_t>(executor.thread_count()), kMostParts);
}

void PhaseLoop::run(std::span<const Phase> phases, Executor& executor, Body body, std::span<double> milliseconds) {
    const auto threads = static_cast<std::size_t>(executor.thread_count());
    if (threads == 1) {
        const FlushToZero no_denormals;
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
    ++run_;
    is_timed_.store(false, std::memory_order_relaxed);
    const std::size_t parts = part_count(executor);
    executor.parallel_for(threads, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t thread = begin; thread < end; ++thread) take_part(thread, parts, phases, body, milliseconds);
    });
}

}  // namespace carom::dynamics
