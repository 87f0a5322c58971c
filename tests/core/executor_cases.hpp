// What every executor must do.
#pragma once

#include <carom/core/executor.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

namespace carom::test {

inline void covers_every_index_once(Executor& executor) {
    for (const std::size_t count : {0u, 1u, 7u, 64u, 65u, 10000u}) {
        for (const std::size_t grain : {1u, 64u, 100000u}) {
            std::vector<std::atomic<int>> visits(count);
            executor.parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
                EXPECT_LT(begin, end);
                for (std::size_t i = begin; i < end; ++i) ++visits[i];
            });
            for (const auto& v : visits) ASSERT_EQ(v.load(), 1) << count << " in grains of " << grain;
        }
    }
}

}  // namespace carom::test
