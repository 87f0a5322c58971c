// Counts what a test program asks of operator new, for "nothing is allocated once warm" and for bytes held.
//
//   const long before = test::allocations(), held = test::bytes_held();
//   ...
//   EXPECT_EQ(test::allocations(), before);
//
// Include it in one source of a program: it replaces the global operators.
#pragma once

#include <support/allocations.hpp>

#include <cstddef>
#include <cstdlib>
#include <new>

#include <malloc.h>

namespace carom::test {
inline bool fails() { return ++g_allocations == g_fails_at; }
inline void* counted(void* memory) {
    g_bytes += static_cast<long>(malloc_usable_size(memory));
    return memory;
}
inline void release(void* memory) {
    g_bytes -= static_cast<long>(malloc_usable_size(memory));
    std::free(memory);
}
}  // namespace carom::test

// Not inlined: GCC 12 under sanitizers otherwise takes malloc() and delete, or new and free(), for pairs that do not match.
[[gnu::noinline]] void* operator new(std::size_t size) {
    if (carom::test::fails()) throw std::bad_alloc{};
    if (void* memory = std::malloc(size > 0 ? size : 1)) return carom::test::counted(memory);
    throw std::bad_alloc{};
}
// std::stable_sort asks for its buffer this way.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    return carom::test::fails() ? nullptr : carom::test::counted(std::malloc(size > 0 ? size : 1));
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
    const auto unit = static_cast<std::size_t>(alignment);
    if (carom::test::fails()) throw std::bad_alloc{};
    if (void* memory = std::aligned_alloc(unit, (size + unit - 1) / unit * unit)) return carom::test::counted(memory);
    throw std::bad_alloc{};
}
[[gnu::noinline]] void operator delete(void* memory, const std::nothrow_t&) noexcept { carom::test::release(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept { carom::test::release(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { carom::test::release(memory); }
[[gnu::noinline]] void operator delete(void* memory) noexcept { carom::test::release(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { carom::test::release(memory); }
