// The sorted list of pairs, and how it changes: made anew, or patched where boxes moved.
//
//   set.replace(pieces, slots, executor);                          // all pairs, found anew
//   set.patch(pieces, ended, changed, keep, limit);                // only what began; what ended is named too, or found here
#pragma once

#include <carom/broadphase/detail/pair_pieces.hpp>
#include <carom/broadphase/detail/slot_bits.hpp>
#include <carom/broadphase/proxy.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/core/radix_sort.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::detail {

/// @return the pair as a number that sorts like it.
[[nodiscard]] inline std::uint64_t key_of(const ProxyPair& pair) noexcept { return (std::uint64_t{pair.a} << 32) | pair.b; }

/// Makes room for `size`, and a quarter more where there is none.
template <class T>
void grow(std::vector<T>& v, std::size_t size) {
    if (v.size() >= size) return;
    v.reserve(size + size / 4);  // no more: vectors double as they are resized
    v.resize(size + size / 4);
}

class PairSet {
public:
    [[nodiscard]] std::span<const ProxyPair> pairs() const noexcept { return {pairs_.data(), count_}; }
    [[nodiscard]] std::span<const ProxyPair> begun() const noexcept { return begun_; }
    [[nodiscard]] std::span<const ProxyPair> ended() const noexcept { return {ended_.data(), ended_count_}; }

    /// Whether replace() says what began and what ended: otherwise it needs no list of the pairs before. At first it does.
    void list_changes(bool wanted) noexcept { lists_changes_ = wanted; }

    void clear() noexcept;
    /// Nothing began and nothing ended.
    void keep() noexcept;

    /// The pairs in the pieces, each once, are all there are; slots are below `slots`.
    void replace(const PairPieces& found, std::size_t slots, Executor& executor);
    /// The same with a list that is sorted already.
    void replace(std::span<const ProxyPair> sorted);

    /// What decides whether a pair with a changed slot stays: its boxes overlap, and `wanted`, if there is one, says yes.
    struct Keep {
        std::span<const FloatAabb> boxes;
        const FunctionRef<bool(ProxyPair)>* wanted = nullptr;
        [[nodiscard]] bool operator()(ProxyPair pair) const {
            return overlaps(boxes[pair.a], boxes[pair.b]) && (wanted == nullptr || (*wanted)(pair));
        }
    };
    /// Pairs with a changed slot stay only if `keep` says so; the pairs in `found`, in any order and some more than once or there
    /// already, are added. `ended`, if it is there, names every pair of a changed slot and an unchanged one that `keep` does not keep, and
    /// maybe some that are not in the list; without it all of the list is looked through.
    /// @return false where that would be more than `limit` pairs: then the pairs are what they were.
    bool patch(const PairPieces& found, const PairPieces* ended, const SlotBits& changed, const Keep& keep, std::size_t limit);

    [[nodiscard]] std::size_t memory() const noexcept;
    /// Gives memory back where the list holds more than twice what the pairs take, and that of lists that no update since the last call made use of: one that is
    /// patched needs no second one. Forgets what began and ended where it does. @return whether it did.
    bool trim();

private:
    /// What changed among some rows: runs of ended_ and begun_store_.
    struct ListChanges {
        std::size_t ended_at = 0, ended = 0, begun_at = 0, begun = 0;
    };
    void count_rows(const PairPieces& found, std::size_t first, std::size_t last);
    void deal_out(const PairPieces& found, std::size_t first, std::size_t last);
    void begin_list(std::size_t count);
    [[nodiscard]] ListChanges compare_rows(std::size_t first, std::size_t last, std::size_t begin, std::size_t end);
    void take_changes(std::span<const ListChanges> shares);
    // pair_patch.cpp
    void sort_candidates(const PairPieces& found);
    void index_rows(std::size_t slots);
    void shift_index();
    [[nodiscard]] std::size_t guess_place(std::uint64_t key) const noexcept;
    [[nodiscard]] std::size_t place_of(std::uint64_t key) const noexcept;
    template <class F>
    void for_places(F use) const;
    void look_through(const SlotBits& changed, const Keep& keep);
    void look_up_ended(const PairPieces& ended, const SlotBits& changed, const Keep& keep);
    void look_up_begun(const PairPieces& found);
    void splice();

    std::vector<ProxyPair> pairs_, next_;  // grown, and shrunk by trim() alone, as all below: the first count_ of pairs_ hold
    std::size_t count_ = 0;
    std::size_t previous_count_ = 0;  // of next_, while the two lists are compared
    bool lists_changes_ = true;
    std::size_t most_changes_ = 0;  // that the lists of a patch had to hold since trim()
    bool was_replaced_ = false, was_looked_through_ = false;  // since trim()
    std::span<const ProxyPair> begun_;
    std::vector<ProxyPair> begun_store_, ended_;
    std::size_t ended_count_ = 0;
    std::vector<std::uint32_t> row_values_, row_ends_;
    // While the list is patched: places in pairs_ of pairs that may end, that do, and before which others begin.
    std::vector<std::uint32_t> touched_, ended_places_, begun_places_;
    struct Run {
        std::uint32_t first, last;
        std::int64_t shift;
    };
    std::vector<Run> runs_;                  // what stays, and how far it goes
    std::vector<std::uint32_t> row_starts_;  // of every kRowsAStart-th row, in pairs_; empty: not known
    std::vector<std::uint64_t> candidates_;
    std::vector<std::uint32_t> payload_;
    RadixScratch scratch_;
};

/// Lists the places of the pairs of which a slot is changed, ascending. `out` has room for pairs.size() + 16.
/// @return how many.
std::size_t find_touched(std::span<const ProxyPair> pairs, const SlotBits& changed, std::uint32_t* out);

/// Some pairs by their rows, the lesser slots, and the others.
struct RowPairs {
    static constexpr std::size_t kMost = 512;
    std::int32_t row[kMost + 16];
    std::int32_t value[kMost + 16];
};
/// Picks those of `count` pairs, at most RowPairs::kMost, whose rows lie in [first_row, last_row). @return how many.
std::size_t pick_rows(const std::int32_t* first, const std::int32_t* second, std::size_t count, std::size_t first_row, std::size_t last_row,
                      RowPairs& out);

/// What two sorted lists do not share. `ended` has room for all of `before`, `begun` for all of `now`. @return how many are in each.
struct PairChanges {
    std::size_t ended, begun;
};
PairChanges compare_lists(std::span<const ProxyPair> before, std::span<const ProxyPair> now, ProxyPair* ended, ProxyPair* begun);

/// Rows are read up to this far beyond their end.
inline constexpr std::size_t kRowPadding = 16;

/// Sorts rows: row k has the values from where row k-1 ends (the first: from `start`) up to ends[k]; pairs (first_row + k, value)
/// go to the same places of `out`.
void sort_rows(const std::uint32_t* values, std::uint32_t start, std::uint32_t first_row, std::span<const std::uint32_t> ends,
               ProxyPair* out);

}  // namespace carom::detail
