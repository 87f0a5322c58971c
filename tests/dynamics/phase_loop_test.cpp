// Loops that follow one another on threads that come late, early, one after the other or not at all.
#include <carom/dynamics/detail/phase_loop.hpp>

#include "odd_executors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <numeric>
#include <thread>
#include <vector>

namespace carom::dynamics {
namespace {

using test::in_threads;
using test::OddExecutor;

// Each phase adds up what the one before left, so whatever is missed, done twice or out of turn shows in the last.
std::vector<std::uint64_t> run_chain(Executor& executor, std::span<const std::size_t> counts, PhaseLoop& loop,
                                     std::span<double> milliseconds) {
    std::vector<Phase> phases;
    const std::size_t parts = PhaseLoop::part_count(executor);
    std::vector<std::vector<std::uint32_t>> starts(counts.size());  // uneven parts, some of them empty
    for (std::size_t p = 0; p < counts.size(); ++p) {
        for (std::size_t part = 0; part < parts; ++part)
            starts[p].push_back(static_cast<std::uint32_t>(counts[p] * (part * part) / (parts * parts)));
        starts[p].push_back(static_cast<std::uint32_t>(counts[p]));
        phases.push_back({.count = counts[p], .label = static_cast<int>(p % 3), .starts = p % 2 == 0 ? starts[p].data() : nullptr});
    }
    std::vector<std::vector<std::uint64_t>> values(counts.size());
    for (std::size_t p = 0; p < counts.size(); ++p) values[p].assign(counts[p], 0);
    const auto body = [&](std::size_t phase, std::size_t begin, std::size_t end) {
        EXPECT_LT(begin, end);
        std::size_t before = phase;  // the last one that is not empty
        while (before > 0 && counts[before - 1] == 0) --before;
        for (std::size_t i = begin; i < end; ++i) {
            std::uint64_t sum = i + 1;
            if (before > 0) sum += 3 * std::accumulate(values[before - 1].begin(), values[before - 1].end(), std::uint64_t{0});
            values[phase][i] += sum;
        }
    };
    loop.run(phases, executor, body, milliseconds);
    return values.back();
}

TEST(PhaseLoop, DoesEveryIndexOnceAndInTurnOnAnyThreads) {
    std::vector<std::size_t> counts;
    for (std::size_t p = 0; p < 200; ++p) counts.push_back(p % 11 == 0 ? 0 : 1 + p * 37 % 90);
    counts.push_back(64);
    SerialExecutor serial;
    PhaseLoop loop;
    std::array<double, 3> milliseconds{};
    const std::vector<std::uint64_t> expected = run_chain(serial, counts, loop, milliseconds);
    EXPECT_GT(milliseconds[0] + milliseconds[1] + milliseconds[2], 0.0);
    for (const auto& [name, how] : test::odd_ways()) {
        for (const int threads : {1, 2, 3, 4, 8, 11}) {
            OddExecutor executor(threads, how);
            for (int again = 0; again < 3; ++again)
                EXPECT_EQ(run_chain(executor, counts, loop, milliseconds), expected) << name << " " << threads;
        }
    }
}

TEST(PhaseLoop, TheTimeIsThatOfWhoeverComesFirst) {
    OddExecutor executor(4, [](std::size_t count, const Executor::Body& body) {
        for (std::size_t i = count; i-- > 0;) body(i, i + 1);
    });
    PhaseLoop loop;
    std::array<double, 3> milliseconds{};
    const std::array<Phase, 3> phases{Phase{.count = 1, .label = 0}, {.count = 3, .label = 1}, {.count = 1, .label = 2}};
    const auto body = [](std::size_t phase, std::size_t, std::size_t) {
        if (phase == 1) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    };
    loop.run(phases, executor, body, milliseconds);
    EXPECT_GE(milliseconds[1], 6.0);
}

TEST(PhaseLoop, OfNothingDoesNothing) {
    OddExecutor executor(2, [](std::size_t count, const Executor::Body& body) { in_threads(count, body, false); });
    PhaseLoop loop;
    std::array<double, 3> milliseconds{};
    EXPECT_TRUE(run_chain(executor, std::array<std::size_t, 3>{0, 0, 0}, loop, milliseconds).empty());
}

}  // namespace
}  // namespace carom::dynamics
