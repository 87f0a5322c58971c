#include <carom/broadphase/detail/pair_set.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

namespace carom::detail {
namespace {

constexpr std::size_t kRowsWorthSharing = 2048;
constexpr std::size_t kMostShares = 8;  // of the rows; every share reads all that was found

// Calls use(a, b) for each pair found whose row lies in [first, last).
template <class F>
void for_rows(const PairPieces& found, std::size_t first, std::size_t last, F use) {
    RowPairs pairs;
    for (std::size_t k = 0; k < found.count(); ++k) {
        const PairBuffer& piece = found[k];
        for (std::size_t i = 0; i < piece.size(); i += RowPairs::kMost) {
            const std::size_t count = std::min(RowPairs::kMost, piece.size() - i);
            const std::size_t picked = pick_rows(piece.firsts() + i, piece.seconds() + i, count, first, last, pairs);
            for (std::size_t n = 0; n < picked; ++n) use(static_cast<std::uint32_t>(pairs.row[n]), static_cast<std::uint32_t>(pairs.value[n]));
        }
    }
}

}  // namespace

void PairSet::clear() noexcept {
    count_ = 0;
    row_starts_.clear();
    keep();
}

void PairSet::keep() noexcept {
    begun_ = {};
    ended_count_ = 0;
}

// Each share of the rows counts its pairs, then deals them out, sorts each row and compares it with what was there before.
void PairSet::replace(const PairPieces& found, std::size_t slots, Executor& executor) {
    const auto threads = static_cast<std::size_t>(executor.thread_count());
    const std::size_t shares = slots < kRowsWorthSharing ? 1 : std::min(threads, kMostShares);
    // A pair is listed with the lesser of its slots, so low rows are longer: on average row a of n has a share of (n - a) / n.
    std::array<std::size_t, kMostShares + 1> first_row{};
    for (std::size_t k = 1; k < shares; ++k) {
        const double left = 1.0 - static_cast<double>(k) / static_cast<double>(shares);
        first_row[k] = static_cast<std::size_t>(static_cast<double>(slots) * (1.0 - std::sqrt(left)));
    }
    first_row[shares] = slots;
    row_ends_.resize(slots);
    executor.parallel_for(shares, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) count_rows(found, first_row[k], first_row[k + 1]);
    });
    std::uint32_t total = 0;
    for (std::uint32_t& start : row_ends_) total += std::exchange(start, total);
    begin_list(total);
    grow(row_values_, total + kRowPadding);
    std::array<std::uint32_t, kMostShares + 1> first_pair{};
    for (std::size_t k = 0; k < shares; ++k) first_pair[k] = first_row[k] < slots ? row_ends_[first_row[k]] : total;
    first_pair[shares] = total;
    std::array<ListChanges, kMostShares> changes;
    executor.parallel_for(shares, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) deal_out(found, first_row[k], first_row[k + 1]);
    });
    // Sorting reads a little beyond a row, and so what the next share dealt out.
    executor.parallel_for(shares, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            sort_rows(row_values_.data(), first_pair[k], static_cast<std::uint32_t>(first_row[k]),
                      {row_ends_.data() + first_row[k], first_row[k + 1] - first_row[k]}, pairs_.data());
            changes[k] = compare_rows(first_row[k], first_row[k + 1], first_pair[k], first_pair[k + 1]);
        }
    });
    take_changes({changes.data(), shares});
}

void PairSet::count_rows(const PairPieces& found, std::size_t first, std::size_t last) {
    std::uint32_t* const count = row_ends_.data();
    std::fill(count + first, count + last, 0u);
    for_rows(found, first, last, [&](std::uint32_t row, std::uint32_t) { ++count[row]; });
}

void PairSet::deal_out(const PairPieces& found, std::size_t first, std::size_t last) {
    std::uint32_t* const ends = row_ends_.data();
    std::uint32_t* const values = row_values_.data();
    for_rows(found, first, last, [&](std::uint32_t row, std::uint32_t value) { values[ends[row]++] = value; });
}

// The list before moves to next_; pairs_ has room for `count`, and what changes has room for all.
void PairSet::begin_list(std::size_t count) {
    row_starts_.clear();
    was_replaced_ = true;
    previous_count_ = std::exchange(count_, count);
    if (!lists_changes_) previous_count_ = 0;
    if (lists_changes_) std::swap(pairs_, next_);
    grow(pairs_, count);
    if (previous_count_ == 0) return;
    grow(ended_, previous_count_ + kRowPadding);
    grow(begun_store_, count + kRowPadding);
}

// Pairs of rows [first, last), which are pairs_[begin, end), with those before. Both kinds go where no other rows' can.
PairSet::ListChanges PairSet::compare_rows(std::size_t first, std::size_t last, std::size_t begin, std::size_t end) {
    ListChanges out{.begun_at = begin};
    if (previous_count_ == 0) return out;
    const auto before_row = [](const ProxyPair& pair, std::size_t row) { return pair.a < row; };
    const ProxyPair* const before = next_.data();
    const ProxyPair* const from = std::lower_bound(before, before + previous_count_, first, before_row);
    const ProxyPair* const to = std::lower_bound(from, before + previous_count_, last, before_row);
    out.ended_at = static_cast<std::size_t>(from - before);
    const PairChanges found = compare_lists({from, to}, {pairs_.data() + begin, end - begin}, ended_.data() + out.ended_at,
                                            begun_store_.data() + begin);
    out.ended = found.ended;
    out.begun = found.begun;
    return out;
}

// Closes the gaps between the shares.
void PairSet::take_changes(std::span<const ListChanges> shares) {
    ended_count_ = 0;
    if (previous_count_ == 0) {
        begun_ = pairs();
        return;
    }
    std::size_t begun = 0;
    for (const ListChanges& share : shares) {
        std::copy_n(ended_.data() + share.ended_at, share.ended, ended_.data() + ended_count_);
        std::copy_n(begun_store_.data() + share.begun_at, share.begun, begun_store_.data() + begun);
        ended_count_ += share.ended;
        begun += share.begun;
    }
    begun_ = {begun_store_.data(), begun};
}

void PairSet::replace(std::span<const ProxyPair> sorted) {
    begin_list(sorted.size());
    std::copy(sorted.begin(), sorted.end(), pairs_.begin());
    const ListChanges changes = compare_rows(0, std::numeric_limits<std::size_t>::max(), 0, count_);
    take_changes({&changes, 1});
}

bool PairSet::trim() {
    constexpr std::size_t kFew = 1024;
    const auto drop = [](auto&... lists) { (std::remove_reference_t<decltype(lists)>().swap(lists), ...); };
    const bool replaced = std::exchange(was_replaced_, false), looked_through = std::exchange(was_looked_through_, false);
    const bool is_long = std::max(pairs_.size(), next_.size()) > 2 * count_ + kFew;
    const bool has_second = !replaced && !row_values_.empty();
    if (!looked_through) drop(touched_);
    const std::size_t most = std::exchange(most_changes_, 0);
    if (!lists_changes_ && std::max(ended_.size(), begun_store_.size()) > 2 * most + kFew) {  // nobody has a view of these
        keep();
        drop(begun_store_, ended_, candidates_, payload_, scratch_.keys, scratch_.payload);
    }
    if (!is_long && !has_second) return false;
    keep();
    if (is_long) {
        std::vector<ProxyPair> kept;
        kept.reserve(count_ + count_ / 4);
        kept.assign(pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(count_));
        pairs_.swap(kept);
    }
    drop(next_, begun_store_, ended_, row_values_, touched_, ended_places_, begun_places_, runs_, candidates_, payload_, scratch_.keys, scratch_.payload);
    return true;
}

std::size_t PairSet::memory() const noexcept {
    const auto bytes = [](const auto&... v) { return (std::size_t{0} + ... + (v.capacity() * sizeof(v[0]))); };
    return bytes(pairs_, next_, begun_store_, ended_, row_values_, row_ends_, touched_, ended_places_, begun_places_, runs_, row_starts_,
                 candidates_, payload_, scratch_.keys, scratch_.payload);
}

}  // namespace carom::detail
