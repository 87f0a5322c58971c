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
inline constexpr Tag kNotHome = Tag{1} << 31;    ///< the box is listed in an earlier strip too
inline constexpr Tag kImmovable = Tag{1} << 30;
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

/// Pairs as found, (smaller index << 32) | larger index, with room to write ahead.
class PairBuffer {
public:
    void clear() noexcept { count_ = 0; }
    [[nodiscard]] std::size_t size() const noexcept { return count_; }
    [[nodiscard]] std::uint64_t* data() noexcept { return keys_.data(); }
    [[nodiscard]] const std::uint64_t* data() const noexcept { return keys_.data(); }
    /// @return where to write up to `count` more.
    [[nodiscard]] std::uint64_t* room_for(std::size_t count) {
        if (keys_.size() - count_ < count) grow(count);
        return keys_.data() + count_;
    }
    void added(std::size_t count) noexcept { count_ += count; }
    void keep_first(std::size_t count) noexcept { count_ = count; }

private:
    void grow(std::size_t count);
    std::vector<std::uint64_t> keys_;
    std::size_t count_ = 0;
};

/// Whether each run is ascending in lower[0], so that the search may stop early.
enum class Order { Sorted, Any };

/// Tests each entry in [begin, end) against the entries after it: to the end of its run if sorted, else to `last`, where
/// sentinels stand. Adds the pairs that overlap (closed test) and share no tag bit to `out`.
void find_overlaps(const Entries& entries, std::size_t begin, std::size_t end, std::size_t last, Order order,
                   PairBuffer& out);

}  // namespace carom::detail
