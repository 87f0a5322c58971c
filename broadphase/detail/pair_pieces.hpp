// Pairs as methods find them: in pieces, on any threads, in any order, and never more than a limit.
//
//   pieces.begin(count, limit); executor.parallel_for(count, 1, [&] { find(..., pieces[k]); });
#pragma once

#include <carom/broadphase/proxy.hpp>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace carom::detail {

/// Pairs as found, each one's slots in arrays of their own and in either order, with room to write ahead.
class alignas(64) PairBuffer {  // its counts are one thread's
public:
    /// Starts anew. Once more than `limit` pairs are in, is_full() says so, and whoever adds them should stop.
    void clear(std::size_t limit) noexcept {
        most_ = std::max(most_, count_);
        count_ = 0;
        limit_ = limit;
    }
    [[nodiscard]] bool is_full() const noexcept { return count_ > limit_; }
    [[nodiscard]] std::size_t size() const noexcept { return count_; }
    [[nodiscard]] ProxyPair operator[](std::size_t i) const noexcept {
        const auto a = static_cast<std::uint32_t>(first_[i]), b = static_cast<std::uint32_t>(second_[i]);
        return a < b ? ProxyPair{a, b} : ProxyPair{b, a};
    }

    /// The slots of each pair, readable up to kReadAhead beyond the last where there are any.
    static constexpr std::size_t kReadAhead = 16;
    [[nodiscard]] const std::int32_t* firsts() const noexcept { return first_.data(); }
    [[nodiscard]] const std::int32_t* seconds() const noexcept { return second_.data(); }

    /// Where the kernel writes next, once there is room.
    void make_room(std::size_t count) {
        if (first_.size() - count_ < count + kReadAhead) grow(count + kReadAhead);
    }
    [[nodiscard]] std::int32_t* next_first() noexcept { return first_.data() + count_; }
    [[nodiscard]] std::int32_t* next_second() noexcept { return second_.data() + count_; }
    void added(std::size_t count) noexcept { count_ += count; }

    void add(std::uint32_t a, std::uint32_t b) {
        make_room(1);
        first_[count_] = static_cast<std::int32_t>(a);
        second_[count_++] = static_cast<std::int32_t>(b);
    }

    /// Keeps the pairs for which `keep(pair)` holds, in order.
    template <class F>
    void keep_if(F keep) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            if (!keep((*this)[i])) continue;
            first_[kept] = first_[i];
            second_[kept++] = second_[i];
        }
        count_ = kept;
    }
    /// Empties it, and gives back what is much more than any use since the last call needed.
    void trim();
    [[nodiscard]] std::size_t memory() const noexcept { return 2 * sizeof(std::int32_t) * first_.capacity(); }

private:
    void grow(std::size_t count);
    std::vector<std::int32_t> first_, second_;
    std::size_t count_ = 0;
    std::size_t most_ = 0;  // that were in since trim()
    std::size_t limit_ = 0;
};

/// The buffers of one update. Once more pairs were found than the limit, work may stop: what was found is then worth nothing.
class PairPieces {
public:
    /// Starts anew with `count` empty pieces.
    void begin(std::size_t count, std::size_t limit) {
        if (pieces_.size() < count) pieces_.resize(count);
        count_ = count;
        limit_ = limit;
        total_.store(0, std::memory_order_relaxed);
        for (std::size_t k = 0; k < count; ++k) pieces_[k].clear(limit);
    }
    /// Empties all pieces, and gives back what they have much too much of.
    void trim() {
        for (PairBuffer& piece : pieces_) piece.trim();
    }
    /// Gives the memory of the pieces back, and them with it.
    void drop() noexcept {
        std::vector<PairBuffer>().swap(pieces_);
        count_ = 0;
    }
    [[nodiscard]] std::size_t count() const noexcept { return count_; }
    [[nodiscard]] std::size_t limit() const noexcept { return limit_; }
    [[nodiscard]] PairBuffer& operator[](std::size_t k) noexcept { return pieces_[k]; }
    [[nodiscard]] const PairBuffer& operator[](std::size_t k) const noexcept { return pieces_[k]; }

    /// Adds to the number of pairs found so far. @return whether the limit is passed.
    bool found(std::size_t more) noexcept { return total_.fetch_add(more, std::memory_order_relaxed) + more > limit_; }
    [[nodiscard]] bool is_full() const noexcept { return total_.load(std::memory_order_relaxed) > limit_; }

    [[nodiscard]] std::size_t memory() const noexcept {
        std::size_t sum = 0;
        for (const PairBuffer& piece : pieces_) sum += piece.memory();
        return sum;
    }

private:
    std::vector<PairBuffer> pieces_;
    std::size_t count_ = 0;
    std::size_t limit_ = 0;
    std::atomic<std::size_t> total_{0};
};

}  // namespace carom::detail
