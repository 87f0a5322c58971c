#include <carom/broadphase/detail/pair_set.hpp>

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace carom::detail {
namespace {

constexpr std::size_t kMostShares = 8;  // of the rows; every share reads all that was found

template <class T>
void grow(std::vector<T>& v, std::size_t size) {
    if (v.size() < size) v.resize(size + size / 4);
}

void sort_run(std::vector<std::uint64_t>& keys, std::vector<std::uint32_t>& payload, RadixScratch& scratch) {
    constexpr std::size_t kFew = 64;
    if (keys.size() > kFew) {
        payload.resize(keys.size());
        radix_sort(keys, payload, scratch);
        return;
    }
    for (std::size_t i = 1; i < keys.size(); ++i) {
        const std::uint64_t key = keys[i];
        std::size_t place = i;
        for (; place > 0 && keys[place - 1] > key; --place) keys[place] = keys[place - 1];
        keys[place] = key;
    }
}

ProxyPair pair_of(std::uint64_t key) noexcept { return {static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(key)}; }

// The first place at or after `from` whose pair is not before `key`: steps of growing size, then halving.
std::size_t find_place(const ProxyPair* pairs, std::size_t from, std::size_t count, std::uint64_t key) noexcept {
    std::size_t step = 1, low = from, high = from;
    while (high < count && key_of(pairs[high]) < key) {
        low = high + 1;
        high += step;
        step *= 2;
    }
    high = std::min(high, count);
    while (low < high) {
        const std::size_t middle = low + (high - low) / 2;
        if (key_of(pairs[middle]) < key)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

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
    keep();
}

void PairSet::keep() noexcept {
    begun_ = {};
    ended_count_ = 0;
}

// Each share of the rows counts its pairs, then deals them out, sorts each row and compares it with what was there before.
void PairSet::replace(const PairPieces& found, std::size_t slots, Executor& executor) {
    const auto threads = static_cast<std::size_t>(executor.thread_count());
    const std::size_t shares = slots < 4096 ? 1 : std::min(threads, kMostShares);
    // A pair is listed with the lesser of its slots, so low rows are longer: on average row a of n has a share of (n - a) / n.
    std::array<std::size_t, kMostShares + 1> first_row{};
    for (std::size_t k = 1; k < shares; ++k) {
        const double left = 1.0 - static_cast<double>(k) / static_cast<double>(shares);
        first_row[k] = static_cast<std::size_t>(static_cast<double>(slots) * (1.0 - std::sqrt(left)));
    }
    first_row[shares] = slots;
    row_ends_.assign(slots, 0);
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
    for_rows(found, first, last, [&](std::uint32_t row, std::uint32_t) { ++count[row]; });
}

void PairSet::deal_out(const PairPieces& found, std::size_t first, std::size_t last) {
    std::uint32_t* const ends = row_ends_.data();
    std::uint32_t* const values = row_values_.data();
    for_rows(found, first, last, [&](std::uint32_t row, std::uint32_t value) { values[ends[row]++] = value; });
}

// The list before moves to next_; pairs_ has room for `count`, and what changes has room for all.
void PairSet::begin_list(std::size_t count) {
    std::swap(pairs_, next_);
    previous_count_ = std::exchange(count_, count);
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

void PairSet::list_ended(const SlotBits& changed, const Keep& keep) {
    constexpr std::size_t kAhead = 12;  // boxes are read all over memory
    grow(touched_, count_ + 16);
    const std::size_t touched = find_touched(pairs(), changed, touched_.data());
    grow(ended_, touched);
    ended_count_ = 0;
    ended_places_.clear();
    for (std::size_t i = 0; i < touched; ++i) {
        if (i + kAhead < touched) {
            const ProxyPair later = pairs_[touched_[i + kAhead]];
            hwy::Prefetch(&keep.boxes[later.a]);
            hwy::Prefetch(&keep.boxes[later.b]);
        }
        const ProxyPair pair = pairs_[touched_[i]];
        if (keep(pair)) continue;
        ended_places_.push_back(touched_[i]);
        ended_[ended_count_++] = pair;
    }
}

void PairSet::sort_candidates(const PairPieces& found) {
    candidates_.clear();
    for (std::size_t k = 0; k < found.count(); ++k) {
        const PairBuffer& piece = found[k];
        for (std::size_t i = 0; i < piece.size(); ++i) {
            candidates_.push_back(key_of(piece[i]));
        }
    }
    sort_run(candidates_, payload_, scratch_);
    candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
}

bool PairSet::patch(const PairPieces& found, const SlotBits& changed, const Keep& keep_pair, std::size_t limit) {
    sort_candidates(found);
    if (count_ + candidates_.size() > limit) {
        // Some of these may be in the list already, and some of the list may go: only the exact count decides.
        std::size_t begun = 0, place = 0;
        for (const std::uint64_t key : candidates_) {
            place = find_place(pairs_.data(), place, count_, key);
            begun += !(place < count_ && key_of(pairs_[place]) == key);
        }
        const std::size_t ended = static_cast<std::size_t>(
            std::count_if(pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(count_),
                          [&](const ProxyPair& pair) { return (changed.test(pair.a) || changed.test(pair.b)) && !keep_pair(pair); }));
        if (count_ + begun - ended > limit) return false;
    }
    list_ended(changed, keep_pair);
    grow(begun_store_, candidates_.size());
    std::size_t begun = 0;
    grow(next_, count_ + candidates_.size());
    ProxyPair* out = next_.data();
    std::size_t from = 0, gone = 0;
    const auto copy_to = [&](std::size_t place) {  // all that stays before `place`
        for (; gone < ended_places_.size() && ended_places_[gone] < place; ++gone) {
            out = std::copy(pairs_.data() + from, pairs_.data() + ended_places_[gone], out);
            from = ended_places_[gone] + 1;
        }
        if (from < place) {
            out = std::copy(pairs_.data() + from, pairs_.data() + place, out);
            from = place;
        }
    };
    std::size_t place = 0;
    for (const std::uint64_t key : candidates_) {
        place = find_place(pairs_.data(), place, count_, key);
        if (place < count_ && key_of(pairs_[place]) == key) continue;  // overlaps now as before
        copy_to(place);
        *out++ = pair_of(key);
        begun_store_[begun++] = pair_of(key);
    }
    copy_to(count_);
    count_ = static_cast<std::size_t>(out - next_.data());
    std::swap(pairs_, next_);
    begun_ = {begun_store_.data(), begun};
    return true;
}

std::size_t PairSet::memory() const noexcept {
    return sizeof(ProxyPair) * (pairs_.capacity() + next_.capacity() + begun_store_.capacity() + ended_.capacity()) +
           sizeof(std::uint32_t) * (row_values_.capacity() + row_ends_.capacity() + touched_.capacity() + ended_places_.capacity() + payload_.capacity() + scratch_.payload.capacity()) +
           sizeof(std::uint64_t) * (candidates_.capacity() + scratch_.keys.capacity());
}

}  // namespace carom::detail
