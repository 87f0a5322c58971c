#include <carom/broadphase/detail/pair_set.hpp>

#include <hwy/cache_control.h>

#include <algorithm>
#include <utility>

namespace carom::detail {
namespace {

constexpr std::size_t kMostBuckets = 256;  // streams that are written at once

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

}  // namespace

void PairSet::clear() noexcept {
    count_ = 0;
    keep();
}

void PairSet::keep() noexcept {
    begun_ = {};
    ended_.clear();
}

// Pairs are dealt out to buckets of neighbouring rows, which then fit the cache: there each is sorted by row and then by b.
void PairSet::replace(const PairPieces& found, std::size_t slots, Executor& executor) {
    unsigned shift = 0;
    while ((slots >> shift) + 1 > kMostBuckets) ++shift;
    const std::size_t buckets = (slots >> shift) + 1;
    bucket_.assign(buckets + 1, 0);
    for (std::size_t k = 0; k < found.count(); ++k) {
        const PairBuffer& piece = found[k];
        for (std::size_t i = 0; i < piece.size(); ++i) ++bucket_[piece[i].a >> shift];
    }
    std::uint32_t total = 0;
    for (std::uint32_t& start : bucket_) total += std::exchange(start, total);
    next_in_bucket_.assign(bucket_.begin(), bucket_.end());
    std::swap(pairs_, next_);  // the list before is in next_ now
    previous_count_ = std::exchange(count_, total);
    grow(pairs_, total);
    grow(unsorted_, total);
    grow(row_values_, total + (buckets + 1) * kRowPadding);  // what one thread reads ahead, no other may write
    for (std::size_t k = 0; k < found.count(); ++k) {
        const PairBuffer& piece = found[k];
        for (std::size_t i = 0; i < piece.size(); ++i) {
            const ProxyPair pair = piece[i];
            unsorted_[next_in_bucket_[pair.a >> shift]++] = pair;
        }
    }
    const std::size_t rows = std::size_t{1} << shift;
    row_ends_.resize(buckets * rows);
    executor.parallel_for(buckets, 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::span<const ProxyPair> bucket(unsorted_.data() + bucket_[k], bucket_[k + 1] - bucket_[k]);
            sort_bucket(bucket, static_cast<std::uint32_t>(k << shift), bucket_[k], {row_ends_.data() + k * rows, rows},
                        row_values_.data() + k * kRowPadding);
        }
    });
    compare_with_before();
}

void PairSet::sort_bucket(std::span<const ProxyPair> bucket, std::uint32_t first_row, std::uint32_t start, std::span<std::uint32_t> ends,
                          std::uint32_t* values) {
    std::fill(ends.begin(), ends.end(), 0u);
    for (const ProxyPair& pair : bucket) ++ends[pair.a - first_row];
    std::uint32_t at = start;
    for (std::uint32_t& end : ends) at += std::exchange(end, at);
    for (const ProxyPair& pair : bucket) values[ends[pair.a - first_row]++] = pair.b;
    sort_rows(values, start, first_row, ends, pairs_.data());
}

void PairSet::replace(std::span<const ProxyPair> sorted) {
    std::swap(pairs_, next_);
    previous_count_ = count_;
    count_ = sorted.size();
    grow(pairs_, count_);
    std::copy(sorted.begin(), sorted.end(), pairs_.begin());
    compare_with_before();
}

void PairSet::compare_with_before() {
    const ProxyPair* const before = next_.data();
    const std::size_t before_count = previous_count_;
    ended_.clear();
    if (before_count == 0) {
        begun_ = pairs();
        return;
    }
    begun_store_.clear();
    std::size_t i = 0, j = 0;
    while (i < before_count && j < count_) {
        if (before[i] == pairs_[j]) {
            ++i;
            ++j;
        } else if (before[i] < pairs_[j]) {
            ended_.push_back(before[i++]);
        } else {
            begun_store_.push_back(pairs_[j++]);
        }
    }
    ended_.insert(ended_.end(), before + i, before + before_count);
    begun_store_.insert(begun_store_.end(), pairs_.data() + j, pairs_.data() + count_);
    begun_ = begun_store_;
}

void PairSet::list_ended(const SlotBits& changed, const Keep& keep) {
    constexpr std::size_t kAhead = 12;  // boxes are read all over memory
    grow(touched_, count_ + 16);
    const std::size_t touched = find_touched(pairs(), changed, touched_.data());
    ended_.clear();
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
        ended_.push_back(pair);
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
    begun_store_.clear();
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
        begun_store_.push_back(pair_of(key));
    }
    copy_to(count_);
    count_ = static_cast<std::size_t>(out - next_.data());
    std::swap(pairs_, next_);
    begun_ = begun_store_;
    return true;
}

std::size_t PairSet::memory() const noexcept {
    return sizeof(ProxyPair) * (pairs_.capacity() + next_.capacity() + unsorted_.capacity() + begun_store_.capacity() + ended_.capacity()) +
           sizeof(std::uint32_t) * (row_values_.capacity() + row_ends_.capacity() + bucket_.capacity() + next_in_bucket_.capacity() +
                                    touched_.capacity() + ended_places_.capacity() + payload_.capacity() + scratch_.payload.capacity()) +
           sizeof(std::uint64_t) * (candidates_.capacity() + scratch_.keys.capacity());
}

}  // namespace carom::detail
