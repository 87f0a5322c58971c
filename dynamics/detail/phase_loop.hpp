// Many short loops, one after the other, each shared by all threads, in one parallel region.
//
//   phases.push_back({.count = bodies, .grain = 128, .label = int(Stage::Velocities)});
//   loop.run(phases, executor, [&](std::size_t phase, std::size_t begin, std::size_t end) { ... }, milliseconds);
//
// A step of the contact solver is some three hundred loops of a few microseconds: 8 substeps, several passes, a dozen colours each. To start as many
// loops of an executor takes longer than they do. Here threads come in once. They take blocks of a phase from counters, and go on to the next phase
// when all of its blocks are done.
//
// No thread waits for another to come in: who comes first begins, and does all of it if nobody else does, so that an executor may run
// its ranges one after the other on one thread. One waits only for blocks that others are at. Each thread takes the blocks of its own part of a phase
// first, which lie in its cache since the last pass, then those of others.
#pragma once

#include <carom/core/executor.hpp>
#include <carom/core/function_ref.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace carom::dynamics {

/// One loop over [0, count).
struct Phase {
    std::size_t count = 0;
    std::size_t grain = 1;  ///< indices of a block, >= 1
    int label = 0;          ///< where its time goes
};

class PhaseLoop {
public:
    using Body = FunctionRef<void(std::size_t phase, std::size_t begin, std::size_t end)>;

    /// @return of how many parts a phase is, each of which is mostly one thread's.
    [[nodiscard]] static std::size_t part_count(const Executor& executor) noexcept;

    /// Runs the phases in order. Results must not depend on how a phase is cut.
    /// @param body  must not use the executor, and must not throw.
    /// @param milliseconds  by label; what passes is added, as the thread that comes in first sees it.
    void run(std::span<const Phase> phases, Executor& executor, Body body, std::span<double> milliseconds);

private:
    static constexpr std::size_t kMostParts = 8;
    struct alignas(64) State {
        std::atomic<std::uint32_t> next[kMostParts];  // block of each part
        std::atomic<std::uint32_t> done;              // blocks
    };
    void take_part(std::size_t thread, std::size_t parts, std::span<const Phase> phases, Body body,
                   std::span<double> milliseconds) noexcept;

    std::unique_ptr<State[]> states_;
    std::atomic<bool> is_timed_{false};  // some thread has come in
    std::size_t state_count_ = 0;
};

}  // namespace carom::dynamics
