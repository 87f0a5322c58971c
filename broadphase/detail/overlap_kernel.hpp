// The inner loop of every method: boxes as a structure of arrays, each tested against the ones after it, many at once.
//
//   entries.resize(n); entries.set(i, box, tag); entries.close(n);
//   find_overlaps(entries, 0, n, Order::Sorted, out);        // out: pairs of tags
#pragma once

#include <carom/broadphase/broadphase.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace carom::detail {

/// A box's index and what keeps a pair from being reported: a bit that both boxes of a pair carry.
using Tag = std::uint32_t;
inline constexpr Tag kNotHome1 = Tag{1} << 31;   ///< the box is listed in an earlier strip of axis 1 too
inline constexpr Tag kNotHome2 = Tag{1} << 30;   ///< the same on axis 2
inline constexpr Tag kImmovable = Tag{1} << 29;
inline constexpr Tag kIndexMask = kImmovable - 1;

/// Boxes as arrays. Axis 0 is the one that is swept. Runs of boxes are closed by sentinels that overlap nothing, so the
/// kernel may read past a run's end.
struct Entries {
    static constexpr std::size_t kSentinels = 16;
    std::vector<float> lower[3];
    std::vector<float> upper[3];
    std::vector<std::int32_t> tag;

    /// Grows to hold `size` entries, sentinels included; the contents are then to be set anew.
    void grow(std::size_t size);
    void set(std::size_t i, const FloatAabb& box, const int axes[3], Tag box_tag) noexcept {
        for (int k = 0; k < 3; ++k) {
            lower[k][i] = box.lower[axes[k]];
            upper[k][i] = box.upper[axes[k]];
        }
        tag[i] = static_cast<std::int32_t>(box_tag);
    }
    /// Puts sentinels at end .. end + kSentinels - 1.
    void close(std::size_t end) noexcept;
};

/// Pairs as found, the smaller and the larger index in arrays of their own, with room to write ahead.
class PairBuffer {
public:
    void clear() noexcept { count_ = 0; }
    [[nodiscard]] std::size_t size() const noexcept { return count_; }
    [[nodiscard]] std::uint32_t lesser(std::size_t i) const noexcept { return static_cast<std::uint32_t>(lesser_[i]); }
    [[nodiscard]] std::uint32_t greater(std::size_t i) const noexcept { return static_cast<std::uint32_t>(greater_[i]); }

    /// Where the kernel writes next, once there is room.
    void make_room(std::size_t count) {
        if (lesser_.size() - count_ < count) grow(count);
    }
    [[nodiscard]] std::int32_t* next_lesser() noexcept { return lesser_.data() + count_; }
    [[nodiscard]] std::int32_t* next_greater() noexcept { return greater_.data() + count_; }
    void added(std::size_t count) noexcept { count_ += count; }

    /// Keeps the pairs for which `keep(a, b)` holds, in order.
    template <class F>
    void keep_if(F keep) noexcept {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            if (!keep(lesser(i), greater(i))) continue;
            lesser_[kept] = lesser_[i];
            greater_[kept++] = greater_[i];
        }
        count_ = kept;
    }

private:
    void grow(std::size_t count);
    std::vector<std::int32_t> lesser_, greater_;
    std::size_t count_ = 0;
};

/// Whether each run is ascending in lower[0], so that the search may stop early.
enum class Order { Sorted, Any };

/// Tests each entry in [begin, end) against the entries after it: to the end of its run if sorted, else to `last`, where
/// sentinels stand. Adds the pairs that overlap (closed test) and share no tag bit to `out`.
void find_overlaps(const Entries& entries, std::size_t begin, std::size_t end, std::size_t last, Order order,
                   PairBuffer& out);

}  // namespace carom::detail
