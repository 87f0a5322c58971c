// How the list of pairs changes where few boxes moved: what ends and what begins is looked up by rows, then the runs of pairs between
// them are shifted within the list.
#include <carom/broadphase/detail/pair_set.hpp>

#include <hwy/cache_control.h>

#include <algorithm>
#include <bit>
#include <utility>

namespace carom::detail {
namespace {

constexpr std::size_t kRowsAStart = 64;  // one start is kept for so many rows

ProxyPair pair_of(std::uint64_t key) noexcept { return {static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(key)}; }

std::uint64_t first_key(std::size_t block) noexcept { return static_cast<std::uint64_t>(block * kRowsAStart) << 32; }

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

bool is_before(const ProxyPair& pair, std::uint64_t key) noexcept { return key_of(pair) < key; }

}  // namespace

void PairSet::sort_candidates(const PairPieces& found) {
    for (std::size_t k = 0; k < found.count(); ++k) {
        const PairBuffer& piece = found[k];
        for (std::size_t i = 0; i < piece.size(); ++i) candidates_.push_back(key_of(piece[i]));
    }
    sort_run(candidates_, payload_, scratch_);
    candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
}

void PairSet::index_rows(std::size_t slots) {
    const std::size_t blocks = slots / kRowsAStart + 1;
    if (row_starts_.size() == blocks + 1) return;
    row_starts_.resize(blocks + 1);
    const ProxyPair* from = pairs_.data();
    const ProxyPair* const end = from + count_;
    for (std::size_t block = 0; block <= blocks; ++block) {
        std::ptrdiff_t step = 1;  // ever longer ones, then halving
        while (end - from > step && is_before(from[step], first_key(block))) {
            from += step;
            step *= 2;
        }
        from = std::lower_bound(from, end - from > step ? from + step : end, first_key(block), is_before);
        row_starts_[block] = static_cast<std::uint32_t>(from - pairs_.data());
    }
}

// Rows that share a start are about equally long, so the place is near this one.
std::size_t PairSet::guess_place(std::uint64_t key) const noexcept {
    const std::size_t row = key >> 32, start = row_starts_[row / kRowsAStart], end = row_starts_[row / kRowsAStart + 1];
    return start + (end - start) * (row % kRowsAStart) / kRowsAStart;
}

// The place of the first pair that is not before `key`: ever longer steps from the guess, then halving.
std::size_t PairSet::place_of(std::uint64_t key) const noexcept {
    const std::size_t block = (key >> 32) / kRowsAStart;
    const ProxyPair *const pairs = pairs_.data(), *low = pairs + row_starts_[block], *high = pairs + row_starts_[block + 1];
    const ProxyPair* at = pairs + guess_place(key);
    std::ptrdiff_t step = 4;
    if (at != high && is_before(*at, key)) {
        low = at + 1;
        for (; high - at > step && is_before(at[step], key); step *= 2) low = at + step + 1;
        if (high - at > step) high = at + step;
    } else {
        high = at;
        for (; at - low > step && !is_before(at[-step], key); step *= 2) high = at - step;
        if (at - low > step) low = at - step + 1;
    }
    return static_cast<std::size_t>(std::lower_bound(low, high, key, is_before) - pairs);
}

// Calls use(key, place) for each candidate; where they are going to be looked for is asked for ahead.
template <class F>
void PairSet::for_places(F use) const {
    constexpr std::size_t kAhead = 8;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        if (i + kAhead < candidates_.size()) hwy::Prefetch(pairs_.data() + guess_place(candidates_[i + kAhead]));
        use(candidates_[i], place_of(candidates_[i]));
    }
}

// Every pair with a changed slot is asked whether it stays.
void PairSet::look_through(const SlotBits& changed, const Keep& keep) {
    constexpr std::size_t kAhead = 12;  // boxes are read all over memory
    was_looked_through_ = true;
    grow(touched_, count_ + 16);
    const std::size_t touched = find_touched(pairs(), changed, touched_.data());
    most_changes_ = std::max(most_changes_, touched);
    grow(ended_, touched);
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

// Pairs of two changed slots are in the rows of changed slots; the others are named.
void PairSet::look_up_ended(const PairPieces& ended, const SlotBits& changed, const Keep& keep) {
    candidates_.clear();
    changed.for_each([&](std::uint32_t slot) {
        const std::size_t end = row_starts_[slot / kRowsAStart + 1];
        for (std::size_t k = place_of(std::uint64_t{slot} << 32); k < end && pairs_[k].a == slot; ++k) {
            if (changed.test(pairs_[k].b) && !keep(pairs_[k])) candidates_.push_back(key_of(pairs_[k]));
        }
    });
    sort_candidates(ended);
    most_changes_ = std::max(most_changes_, candidates_.size());
    grow(ended_, candidates_.size());
    for_places([&](std::uint64_t key, std::size_t place) {
        if (place == count_ || key_of(pairs_[place]) != key) return;  // was not wanted
        ended_places_.push_back(static_cast<std::uint32_t>(place));
        ended_[ended_count_++] = pairs_[place];
    });
}

void PairSet::look_up_begun(const PairPieces& found) {
    candidates_.clear();
    sort_candidates(found);
    most_changes_ = std::max(most_changes_, candidates_.size());
    grow(begun_store_, candidates_.size());
    begun_places_.clear();
    for_places([&](std::uint64_t key, std::size_t place) {
        if (place < count_ && key_of(pairs_[place]) == key) return;  // overlaps now as before
        begun_store_[begun_places_.size()] = pair_of(key);
        begun_places_.push_back(static_cast<std::uint32_t>(place));
    });
}

// What comes between the pairs that end and begin moves as a whole: first the runs that move down, in order, then those that move up, the
// last one first. So none is written where one that has yet to move is read. Then the new pairs fill the gaps.
void PairSet::splice() {
    const std::size_t begun = begun_places_.size(), count = count_ + begun - ended_count_;
    grow(pairs_, count);
    runs_.clear();
    std::size_t from = 0, i = 0, j = 0;
    std::int64_t shift = 0;
    const auto run_to = [&](std::size_t place) {
        if (from < place && shift != 0) runs_.push_back({static_cast<std::uint32_t>(from), static_cast<std::uint32_t>(place), shift});
        from = place;
    };
    while (i < ended_count_ || j < begun) {
        if (j < begun && (i == ended_count_ || begun_places_[j] <= ended_places_[i])) {
            run_to(begun_places_[j]);
            begun_places_[j] = static_cast<std::uint32_t>(static_cast<std::int64_t>(begun_places_[j]) + shift++);
            ++j;
        } else {
            run_to(ended_places_[i]);
            from = ended_places_[i++] + 1;
            --shift;
        }
    }
    run_to(count_);
    ProxyPair* const pairs = pairs_.data();
    for (const Run& run : runs_) {
        if (run.shift < 0) std::copy(pairs + run.first, pairs + run.last, pairs + run.first + run.shift);
    }
    for (std::size_t k = runs_.size(); k-- > 0;) {
        const Run& run = runs_[k];
        if (run.shift > 0) std::copy_backward(pairs + run.first, pairs + run.last, pairs + run.last + run.shift);
    }
    for (std::size_t k = 0; k < begun; ++k) pairs[begun_places_[k]] = begun_store_[k];
    count_ = count;
}

void PairSet::shift_index() {
    std::size_t ended = 0, begun = 0;
    for (std::size_t block = 0; block < row_starts_.size(); ++block) {
        while (ended < ended_count_ && is_before(ended_[ended], first_key(block))) ++ended;
        while (begun < begun_.size() && is_before(begun_[begun], first_key(block))) ++begun;
        row_starts_[block] = static_cast<std::uint32_t>(row_starts_[block] + begun - ended);
    }
}

bool PairSet::patch(const PairPieces& found, const PairPieces* ended, const SlotBits& changed, const Keep& keep_pair, std::size_t limit) {
    index_rows(keep_pair.boxes.size());
    ended_count_ = 0;
    ended_places_.clear();
    if (ended != nullptr)
        look_up_ended(*ended, changed, keep_pair);
    else
        look_through(changed, keep_pair);
    look_up_begun(found);
    if (count_ + begun_places_.size() - ended_count_ > limit) return false;
    begun_ = {begun_store_.data(), begun_places_.size()};
    splice();
    shift_index();
    return true;
}

}  // namespace carom::detail
