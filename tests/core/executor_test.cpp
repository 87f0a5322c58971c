// What an executor promises, and the reference to a callable that it takes.
#include "core/executor_cases.hpp"

#include <carom/core/executor.hpp>
#include <carom/core/function_ref.hpp>

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>

namespace carom {
namespace {

TEST(FunctionRef, CallsWhatItRefersTo) {
    int calls = 0;
    auto add = [&](int x) { return calls += x; };
    FunctionRef<int(int)> ref = add;
    EXPECT_EQ(ref(3), 3);
    const FunctionRef<int(int)> copy = ref;
    EXPECT_EQ(copy(4), 7);
    const auto moved = [](std::unique_ptr<int> p) { return *p; };
    FunctionRef<int(std::unique_ptr<int>)> takes_ownership = moved;
    EXPECT_EQ(takes_ownership(std::make_unique<int>(9)), 9);
}

TEST(SerialExecutor, RunsEverythingAsOneRange) {
    SerialExecutor executor;
    EXPECT_EQ(executor.thread_count(), 1);
    test::covers_every_index_once(executor);
    int ranges = 0;
    executor.parallel_for(1000, 10, [&](std::size_t, std::size_t) { ++ranges; });
    EXPECT_EQ(ranges, 1);
}

TEST(SerialExecutor, LetsExceptionsThrough) {
    SerialExecutor executor;
    EXPECT_THROW(executor.parallel_for(3, 1, [](std::size_t, std::size_t) { throw std::runtime_error("x"); }), std::runtime_error);
}

}  // namespace
}  // namespace carom
