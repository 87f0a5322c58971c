// What a test program has asked of operator new, where one of its sources includes count_allocations.hpp.
#pragma once

#include <atomic>

namespace carom::test {
inline std::atomic<long> g_allocations{0};
inline std::atomic<long> g_bytes{0};
inline std::atomic<long> g_fails_at{-1};
inline long allocations() { return g_allocations.load(); }
/// As the allocator hands them out: what was asked for, rounded up to its blocks.
inline long bytes_held() { return g_bytes.load(); }
/// The n-th allocation from now on, n from 1, throws std::bad_alloc, and no other.
inline void fail_allocation(long n) { g_fails_at = g_allocations + n; }
}  // namespace carom::test
