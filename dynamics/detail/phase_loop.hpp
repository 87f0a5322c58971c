// Many short loops, one after the other, each shared by all threads, in one parallel region.
//
//   phases.push_back({.count = bodies, .label = int(Stage::Velocities)});
//   loop.run(phases, executor, [&](std::size_t phase, std::size_t begin, std::size_t end) { ... }, milliseconds);
//
// A step of the contact solver is some two hundred loops of a few microseconds: 8 substeps, several passes, a dozen colours each. To start as many
// loops of an executor takes longer than they do. Here threads come in once. A phase lies in parts, one for each thread; who takes a part does
// all of it, and goes on to the next phase when all parts are done.
//
// No thread waits for another to come in: who comes first begins, and does all of it if nobody else does, so that an executor may run
// its ranges one after the other on one thread. One waits only for parts that others are at. Parts are not shared further: what another core has
// changed takes longer to fetch than its owner to do (of the passes of 4,000 boxes on two threads, 1.7 x one, 1.5 x where blocks of a part may be
// taken by the other).
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
    int label = 0;                          ///< where its time goes
    const std::uint32_t* starts = nullptr;  ///< (part_count() + 1,): first index of each part, and `count`; null: parts of one length
};

class PhaseLoop {
public:
    using Body = FunctionRef<void(std::size_t phase, std::size_t begin, std::size_t end)>;

    /// @return of how many parts a phase is, each of which is mostly one thread's.
    [[nodiscard]] static std::size_t part_count(const Executor& executor) noexcept;

    /// Runs the phases in order. Results must not depend on how a phase is cut. Denormals are 0 in them: what comes to rest goes on by ever smaller numbers.
    /// @param body  must not use the executor, and must not throw.
    /// @param milliseconds  by label; what passes is added, as the thread that comes in first sees it. Empty: nobody looks.
    void run(std::span<const Phase> phases, Executor& executor, Body body, std::span<double> milliseconds);

private:
    static constexpr std::size_t kMostParts = 8;
    struct alignas(64) Flag {
        std::atomic<std::uint32_t> run{0};
    };
    struct State {
        Flag taken[kMostParts], done[kMostParts];
        [[nodiscard]] bool take(std::size_t part, std::uint32_t run) noexcept;
        void wait(std::size_t parts, std::uint32_t run) const noexcept;
    };
    void take_part(std::size_t thread, std::size_t parts, std::span<const Phase> phases, Body body,
                   std::span<double> milliseconds) noexcept;

    std::unique_ptr<State[]> states_;
    std::uint32_t run_ = 0;              // its number
    std::atomic<bool> is_timed_{false};  // some thread has come in
    std::size_t state_count_ = 0;
};

}  // namespace carom::dynamics
