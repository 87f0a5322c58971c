// The inner loop of every method: boxes as a structure of arrays, each tested against the ones after it, many at once.
//
//   entries.resize(n); entries.set(i, box, tag); entries.close(n);
//   find_overlaps(entries, 0, n, Order::Sorted, out);        // out: pairs of tags
#pragma once

#include <carom/broadphase/detail/pair_pieces.hpp>
#include <carom/broadphase/proxy.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::detail {

/// A box's index and what keeps a pair from being reported: a bit that both boxes of a pair carry.
using Tag = std::uint32_t;
inline constexpr Tag kNotHome1 = Tag{1} << 31;  ///< the box is listed in an earlier strip of axis 1 too
inline constexpr Tag kNotHome2 = Tag{1} << 30;  ///< the same on axis 2
inline constexpr Tag kImmovable = Tag{1} << 29;
inline constexpr Tag kMoved = Tag{1} << 28;  ///< the box moved in this update
inline constexpr Tag kIndexMask = kMoved - 1;

/// Boxes as arrays. Axis 0 is the one that is swept. Runs of boxes are closed by sentinels that overlap nothing, so the
/// kernel may read past a run's end.
struct Entries {
    static constexpr std::size_t kSentinels = 16;
    std::vector<float> lower[3];
    std::vector<float> upper[3];
    std::vector<std::int32_t> tag;

    /// Grows to hold `size` entries, sentinels included; the contents stay.
    void grow(std::size_t size);
    [[nodiscard]] std::size_t memory() const noexcept { return 28 * tag.capacity(); }
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

/// Whether each run is ascending in lower[0], so that the search may stop early.
enum class Order { Sorted, Any };

/// Tests each entry in [begin, end) against the entries after it: to the end of its run if sorted, else to `last`, where
/// sentinels stand. Adds the pairs that overlap (closed test) and share no tag bit to `out`; stops early once `out` is full.
void find_overlaps(const Entries& entries, std::size_t begin, std::size_t end, std::size_t last, Order order, PairBuffer& out);

/// A box that moved, its axes in the order of the entries.
struct Mover {
    float lower[3], upper[3];          ///< now
    float old_lower[3], old_upper[3];  ///< before
    Tag tag = 0;
};
[[nodiscard]] inline Mover mover(const FloatAabb& now, const FloatAabb& before, const int axes[3], Tag tag) noexcept {
    Mover m;
    for (int k = 0; k < 3; ++k) {
        m.lower[k] = now.lower[axes[k]];
        m.upper[k] = now.upper[axes[k]];
        m.old_lower[k] = before.lower[axes[k]];
        m.old_upper[k] = before.upper[axes[k]];
    }
    m.tag = tag;
    return m;
}

/// Adds the pairs of each mover with the entries in [0, end) that overlap it now, but for those with entries not tagged kMoved that
/// overlapped it before too.
void find_begun(const Entries& entries, std::size_t end, std::span<const Mover> movers, PairBuffer& out);

/// @return bit i for each entry begin + i that overlaps the box (closed test); of [begin, end), which are at most 64.
[[nodiscard]] std::uint64_t find_near(const Entries& entries, std::size_t begin, std::size_t end, const FloatAabb& box);

}  // namespace carom::detail
