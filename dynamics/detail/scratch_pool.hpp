// Memory of lists that live for some stages of a step, one after the other: what one stage gives back the next one takes.
//
//   ScratchPool pool;
//   ScratchList<Side> sides(pool);
//   sides.resize(n);      // anything is in it
//   ...
//   sides.release();      // before the step is over: others may have it
//
// Lists of one stage that are needed together lie in one block: it fits more of the other stages' than each by itself.
//
//   std::byte* next = block.data();
//   bodies = cut<SolverBody>(next, n), masses = cut<SolverMass>(next, n);
//
// A step asks for about what the step before did, so nothing is allocated once that is known. One thread takes and gives back.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace carom::dynamics {

class ScratchPool {
public:
    static constexpr std::size_t kAlignment = 64;
    struct Block {
        std::byte* data = nullptr;
        std::size_t size = 0;   ///< [bytes]
        std::size_t asked = 0;  ///< of these
    };

    ScratchPool() = default;
    ScratchPool(const ScratchPool&) = delete;
    ScratchPool& operator=(const ScratchPool&) = delete;
    ~ScratchPool() { drop(); }

    /// @return the smallest block that is free and has `size` bytes; where there is none, a new one in place of the largest that is free.
    [[nodiscard]] Block take(std::size_t size);
    void give_back(Block block) noexcept;
    /// Frees all that nobody has, where much more is held than was asked for at once since the last call: what asks for little may have a large block.
    void trim() noexcept;
    /// Held, by whomever [bytes].
    [[nodiscard]] std::size_t memory() const noexcept { return held_; }

private:
    void drop() noexcept;
    void free(Block block) noexcept;

    std::vector<Block> free_;
    std::size_t held_ = 0, asked_ = 0, most_asked_ = 0;  // [bytes]
    std::size_t blocks_ = 0;                             // there are, free or had
};

/// What a list takes of a block in which another one follows.
template <class T>
[[nodiscard]] constexpr std::size_t bytes_of(std::size_t size) noexcept {
    static_assert(std::is_trivially_destructible_v<T> && std::is_trivially_copyable_v<T> && alignof(T) <= ScratchPool::kAlignment);
    return (size * sizeof(T) + ScratchPool::kAlignment - 1) / ScratchPool::kAlignment * ScratchPool::kAlignment;
}

/// A list of plain values in a block of a pool.
template <class T>
class ScratchList {
    static_assert(std::is_trivially_destructible_v<T> && std::is_trivially_copyable_v<T> && alignof(T) <= ScratchPool::kAlignment);

public:
    explicit ScratchList(ScratchPool& pool) noexcept : pool_(&pool) {}
    ScratchList(ScratchList&& other) noexcept : pool_(other.pool_), block_(std::exchange(other.block_, {})), size_(std::exchange(other.size_, 0)) {}
    ScratchList(const ScratchList&) = delete;
    ScratchList& operator=(const ScratchList&) = delete;
    ~ScratchList() { release(); }

    /// What was in it is lost, and the new values are anything.
    void resize(std::size_t size) {
        if (size * sizeof(T) > block_.size) {
            release();
            block_ = pool_->take(size * sizeof(T));
        }
        size_ = size;
    }
    /// Room for so many; what is in it stays.
    void reserve(std::size_t size) {
        if (size * sizeof(T) <= block_.size) return;
        const ScratchPool::Block more = pool_->take(size * sizeof(T));
        if (size_ > 0) std::memcpy(more.data, block_.data, size_ * sizeof(T));
        if (block_.data != nullptr) pool_->give_back(block_);
        block_ = more;
    }
    /// Half as much room again where there is none.
    void push_back(const T& value) {
        if ((size_ + 1) * sizeof(T) > block_.size) reserve(size_ + size_ / 2 + 64);
        data()[size_++] = value;
    }
    /// The first `size` of what is there.
    void shorten(std::size_t size) noexcept { size_ = size; }
    /// The others stay in their order.
    template <class Goes>
    void erase_if(const Goes& goes) {
        size_ = static_cast<std::size_t>(std::remove_if(begin(), end(), goes) - begin());
    }
    void swap(ScratchList& other) noexcept { std::swap(pool_, other.pool_), std::swap(block_, other.block_), std::swap(size_, other.size_); }
    /// Gives the memory back. It is empty then.
    void release() noexcept {
        if (block_.data != nullptr) pool_->give_back(block_);
        block_ = {};
        size_ = 0;
    }

    [[nodiscard]] ScratchPool& pool() const noexcept { return *pool_; }
    [[nodiscard]] T* data() noexcept { return reinterpret_cast<T*>(block_.data); }
    [[nodiscard]] const T* data() const noexcept { return reinterpret_cast<const T*>(block_.data); }
    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
    [[nodiscard]] T* begin() noexcept { return data(); }
    [[nodiscard]] T* end() noexcept { return data() + size_; }
    [[nodiscard]] const T* begin() const noexcept { return data(); }
    [[nodiscard]] const T* end() const noexcept { return data() + size_; }
    [[nodiscard]] T& operator[](std::size_t i) noexcept { return data()[i]; }
    [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return data()[i]; }

private:
    ScratchPool* pool_;
    ScratchPool::Block block_;
    std::size_t size_ = 0;
};

/// @return room for so many, from `next` on, which goes on behind it: bytes_of<T>() of them.
template <class T>
[[nodiscard]] std::span<T> cut(std::byte*& next, std::size_t size) noexcept {
    return {reinterpret_cast<T*>(std::exchange(next, next + bytes_of<T>(size))), size};
}

}  // namespace carom::dynamics
