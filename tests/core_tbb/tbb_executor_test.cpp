#include "core/executor_cases.hpp"

#include <carom/core/check.hpp>
#include <carom/core/tbb/tbb_executor.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

namespace carom {
namespace {

TEST(TbbExecutor, CoversEveryIndexOnceOnAnyThreadCount) {
    for (const int threads : {1, 2, 4}) {
        TbbExecutor executor(threads);
        EXPECT_EQ(executor.thread_count(), threads);
        test::covers_every_index_once(executor);
    }
}

TEST(TbbExecutor, RangesAreNoShorterThanTheGrain) {
    TbbExecutor executor(4);
    for (const std::size_t count : {128u, 129u, 255u, 256u, 257u, 1000u, 100000u}) {
        std::atomic<std::size_t> shortest{count};
        executor.parallel_for(count, 128, [&](std::size_t begin, std::size_t end) {
            std::size_t seen = shortest.load();
            while (end - begin < seen && !shortest.compare_exchange_weak(seen, end - begin)) {
            }
        });
        EXPECT_GE(shortest.load(), 128u) << count;
    }
}

TEST(TbbExecutor, TwoGrainsAreTwoRanges) {
    TbbExecutor executor(2);
    for (const std::size_t grain : {1u, 2u, 64u}) {
        std::atomic<int> two{0};
        executor.parallel_for(2 * grain, grain, [&](std::size_t, std::size_t) { ++two; });
        EXPECT_EQ(two.load(), 2) << grain;
        std::atomic<int> one{0};
        executor.parallel_for(2 * grain - 1, grain, [&](std::size_t, std::size_t) { ++one; });
        EXPECT_EQ(one.load(), 1) << grain;
    }
}

TEST(TbbExecutor, LetsExceptionsThrough) {
    TbbExecutor executor(2);
    EXPECT_THROW(executor.parallel_for(1000, 1, [](std::size_t, std::size_t) { throw std::runtime_error("x"); }),
                 std::runtime_error);
}

TEST(TbbExecutor, NoThreadsAtAllIsMisuse) {
    EXPECT_THROW(TbbExecutor(0), MisuseError);
    EXPECT_THROW(TbbExecutor(-2), MisuseError);
    const ErrorHandler before = set_error_handler([](const Error&) {});
    EXPECT_EQ(TbbExecutor(0).thread_count(), 1);
    set_error_handler(before);
}

}  // namespace
}  // namespace carom
