// Memory for one step: handed out in sequence, taken back all at once.
//
//   arena.reset();
//   std::span<float> radii = arena.allocate<float>(n);       // valid until the next reset
#pragma once

#include <carom/core/check.hpp>

#include <cstddef>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <vector>

namespace carom {

/// A monotonic arena. It grows as needed; after the first reset that follows the largest step it holds one block of that
/// size and asks the system for nothing more. Not thread-safe.
class Arena {
public:
    static constexpr std::size_t kAlignment = 64;

    Arena() = default;

    /// @return (count,) uninitialised objects, the first one on a cache line of its own; empty for zero.
    /// Misuse: more than the address space holds is reported and gives an empty span. Throws std::bad_alloc.
    template <class T>
    [[nodiscard]] std::span<T> allocate(std::size_t count) {
        static_assert(std::is_trivially_destructible_v<T> && std::is_trivially_default_constructible_v<T>,
                      "the arena runs no constructors and no destructors");
        static_assert(alignof(T) <= kAlignment);
        CAROM_REQUIRE(count <= std::numeric_limits<std::size_t>::max() / 4 / sizeof(T), ErrorCode::InvalidArgument,
                      "an allocation larger than the address space", {});
        if (count == 0) return {};
        return {::new (take(count * sizeof(T))) T[count], count};
    }

    /// Takes everything back: all spans end here.
    void reset() {
        if (blocks_.size() > 1) {
            const std::size_t total = capacity();
            blocks_.clear();
            add_block(total);
        }
        used_ = 0;
    }

    /// @return bytes held, used or not.
    [[nodiscard]] std::size_t capacity() const noexcept {
        std::size_t total = 0;
        for (const Block& block : blocks_) total += block.size;
        return total;
    }

private:
    struct Free {
        void operator()(std::byte* memory) const noexcept { ::operator delete(memory, std::align_val_t{kAlignment}); }
    };
    struct Block {
        std::unique_ptr<std::byte, Free> memory;
        std::size_t size = 0;
    };

    void add_block(std::size_t size) {
        blocks_.reserve(blocks_.size() + 1);
        auto* memory = static_cast<std::byte*>(::operator new(size, std::align_val_t{kAlignment}));
        blocks_.push_back({std::unique_ptr<std::byte, Free>(memory), size});
    }

    // Only the last block has room; each new one is as large as all before it, so there are few.
    void* take(std::size_t bytes) {
        bytes = (bytes + kAlignment - 1) / kAlignment * kAlignment;
        if (blocks_.empty() || blocks_.back().size - used_ < bytes) {
            const std::size_t held = capacity();
            add_block(bytes > held ? bytes : held);
            used_ = 0;
        }
        void* memory = blocks_.back().memory.get() + used_;
        used_ += bytes;
        return memory;
    }

    std::vector<Block> blocks_;
    std::size_t used_ = 0;  // bytes of the last block
};

}  // namespace carom
