// The threads of an executor for a whole step, however they come.
#include <carom/dynamics/detail/team.hpp>

#include "odd_executors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <vector>

namespace carom::dynamics {
namespace {

using test::OddExecutor;

// Each loop adds up what the one before left, so whatever is missed, done twice or too early shows in the last.
std::vector<std::uint64_t> run_chain(Team& team, Executor& executor, int loops) {
    std::vector<std::uint64_t> values(1, 1);
    team.run(executor, [&] {
        EXPECT_EQ(team.thread_count(), executor.thread_count());
        for (int loop = 0; loop < loops; ++loop) {
            const std::size_t count = loop % 11 == 0 ? 0 : 1 + static_cast<std::size_t>(loop * 37 % 300),
                              grain = 1 + static_cast<std::size_t>(loop % 7);
            std::vector<std::uint64_t> next(count);
            const std::uint64_t sum = std::accumulate(values.begin(), values.end(), std::uint64_t{0});
            team.parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
                EXPECT_GE(end - begin, std::min(grain, count));
                for (std::size_t i = begin; i < end; ++i) next[i] += 3 * sum + i;
            });
            if (count > 0) values = next;
        }
    });
    return values;
}

TEST(Team, DoesEveryIndexOnceAndInTurnOnAnyThreads) {
    SerialExecutor serial;
    Team team;
    const std::vector<std::uint64_t> expected = run_chain(team, serial, 300);
    EXPECT_GT(expected.size(), 1u);
    for (const auto& [name, how] : test::odd_ways()) {
        for (const int threads : {1, 2, 3, 8, 19}) {
            OddExecutor executor(threads, how);
            for (int again = 0; again < 3; ++again) EXPECT_EQ(run_chain(team, executor, 300), expected) << name << " " << threads;
        }
    }
}

// The second block of a loop that two have come to waits for the first one's: both are in at once.
TEST(Team, OthersTakePart) {
    OddExecutor executor(2, [](std::size_t count, const Executor::Body& body) { test::in_threads(count, body, false); });
    Team team;
    std::atomic<int> in{0};
    bool met = false;
    const auto meet = [&] {
        in = 0;
        team.parallel_for(2, 1, [&](std::size_t, std::size_t) {
            in.fetch_add(1);
            const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
            while (in.load() < 2 && std::chrono::steady_clock::now() < end) std::this_thread::yield();
        });
        met = in.load() == 2;
    };
    const auto meet_on_two_threads = [&] {
        std::set<std::thread::id> who;
        std::mutex mutex;
        met = false;
        team.parallel_for(2, 1, [&](std::size_t, std::size_t) {
            {
                const std::lock_guard lock(mutex);
                who.insert(std::this_thread::get_id());
            }
            const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
            for (std::size_t seen = 0; seen < 2 && std::chrono::steady_clock::now() < end; std::this_thread::yield()) {
                const std::lock_guard lock(mutex);
                seen = who.size();
            }
        });
        met = who.size() == 2;
    };
    team.run(executor, [&] {
        meet();
        EXPECT_TRUE(met) << "at once";
        meet_on_two_threads();
        EXPECT_TRUE(met) << "at once, again";
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
        meet_on_two_threads();
        EXPECT_TRUE(met) << "after the other has gone to sleep";
    });
}

TEST(Team, ALoopIsOverWhenAllBlocksAreDone) {
    OddExecutor executor(2, [](std::size_t count, const Executor::Body& body) { test::in_threads(count, body, false); });
    Team team;
    team.run(executor, [&] {
        const std::thread::id worker = std::this_thread::get_id();
        for (int loop = 0; loop < 5; ++loop) {
            std::atomic<int> in{0};
            std::array<int, 2> done{};
            team.parallel_for(2, 1, [&](std::size_t begin, std::size_t end) {
                in.fetch_add(1);
                const auto late = std::chrono::steady_clock::now() + std::chrono::seconds(20);
                while (in.load() < 2 && std::chrono::steady_clock::now() < late) std::this_thread::yield();  // one each
                if (std::this_thread::get_id() != worker) std::this_thread::sleep_for(std::chrono::milliseconds(5));
                for (std::size_t i = begin; i < end; ++i) done[i] = 1;
            });
            EXPECT_EQ(done[0] + done[1], 2);
        }
    });
}

TEST(Team, ALoopWithinALoopIsItsCallers) {
    OddExecutor executor(3, [](std::size_t count, const Executor::Body& body) { test::in_threads(count, body, false); });
    Team team;
    std::vector<int> done(64 * 16, 0);
    team.run(executor, [&] {
        team.parallel_for(64, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                team.parallel_for(16, 1, [&](std::size_t first, std::size_t last) {
                    EXPECT_EQ(last - first, 16u);
                    for (std::size_t k = first; k < last; ++k) ++done[16 * i + k];
                });
            }
        });
    });
    EXPECT_EQ(std::count(done.begin(), done.end(), 1), 64 * 16);
}

TEST(Team, WhatTheWorkThrowsComesOutAndNobodyIsLeftBehind) {
    SerialExecutor serial;
    Team team;
    const std::vector<std::uint64_t> expected = run_chain(team, serial, 20);
    for (const auto& [name, how] : test::odd_ways()) {
        OddExecutor executor(3, how);
        EXPECT_THROW(team.run(executor,
                              [&] {
                                  team.parallel_for(100, 1, [](std::size_t, std::size_t) {});
                                  throw std::runtime_error("no");
                              }),
                     std::runtime_error)
            << name;
        EXPECT_FALSE(team.is_running());
        EXPECT_EQ(run_chain(team, executor, 20), expected) << name;
    }
}

TEST(Team, AnExecutorThatThrowsLeavesNobodyRunning) {
    struct Broken final : Executor {
        [[nodiscard]] int thread_count() const noexcept override { return 3; }
        void parallel_for(std::size_t, std::size_t, Body) override { throw std::runtime_error("no threads"); }
    } broken;
    Team team;
    EXPECT_THROW(team.run(broken, [] {}), std::runtime_error);
    EXPECT_FALSE(team.is_running());
}

TEST(Team, OutsideOfRunIsOneThread) {
    Team team;
    EXPECT_EQ(team.thread_count(), 1);
    EXPECT_FALSE(team.is_running());
    std::vector<std::pair<std::size_t, std::size_t>> ranges;
    team.parallel_for(1000, 1, [&](std::size_t begin, std::size_t end) { ranges.emplace_back(begin, end); });
    team.parallel_for(0, 1, [&](std::size_t begin, std::size_t end) { ranges.emplace_back(begin, end); });
    ASSERT_EQ(ranges.size(), 1u);
    EXPECT_EQ(ranges[0], std::make_pair(std::size_t{0}, std::size_t{1000}));
}

}  // namespace
}  // namespace carom::dynamics
