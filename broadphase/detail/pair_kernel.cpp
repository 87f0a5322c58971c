// find_touched looks up a bit for either slot of many pairs at once; sort_rows ranks each value of a row among all of them at once;
// compare_lists passes over what two lists share.
#include <carom/core/simd_targets.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/broadphase/detail/pair_kernel.cpp>
#include <hwy/foreach_target.h>

#include <carom/broadphase/detail/pair_set.hpp>
#include <carom/core/lanes.hpp>

namespace carom::detail {
void sort_long_row(ProxyPair* first, ProxyPair* last) noexcept;
}

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

std::size_t touched_pairs(std::span<const ProxyPair> pairs, const SlotBits& changed, std::uint32_t* out) {
    std::size_t count = 0, i = 0;
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
    // A lane is one slot, so pairs are neighbouring lanes; the bit words of a hundred thousand slots stay in the first cache.
    const auto* const slots = reinterpret_cast<const std::int32_t*>(pairs.data());
    const IntTag tag;
    for (; i + kLanes <= pairs.size(); i += kLanes) {
        unsigned hits = 0;
        for (int half = 0; half < 2; ++half) {
            const RawInts slot = hn::LoadU(tag, slots + 2 * i + static_cast<std::size_t>(half * kLanes));
            const RawInts word = hn::GatherIndex(tag, changed.words(), hn::ShiftRight<5>(slot));
            const RawInts bit = hn::Shl(hn::Set(tag, 1), hn::And(slot, hn::Set(tag, 31)));
            const Mask set{hn::RebindMask(FloatTag(), hn::TestBit(word, bit))};
            hits |= bits(set) << (half * kLanes);
        }
        for (hits = (hits | (hits >> 1)) & 0x55555555u; hits != 0; hits &= hits - 1) {
            out[count++] = static_cast<std::uint32_t>(i) + (static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(hits)) / 2);
        }
    }
#endif
    for (; i < pairs.size(); ++i) {
        out[count] = static_cast<std::uint32_t>(i);
        count += changed.test(pairs[i].a) | changed.test(pairs[i].b);
    }
    return count;
}

void sorted_rows(const std::uint32_t* values, std::uint32_t start, std::uint32_t first_row, std::span<const std::uint32_t> ends,
                 ProxyPair* out) {
    const auto* const row_values = reinterpret_cast<const std::int32_t*>(values);  // slots are below 2^31
    for (std::size_t k = 0; k < ends.size(); ++k) {
        const std::size_t count = ends[k] - start;
        const auto row = static_cast<std::uint32_t>(first_row + k);
        ProxyPair* const to = out + start;
        const std::int32_t* const from = row_values + start;
        start = ends[k];
        if (count <= static_cast<std::size_t>(kLanes)) {
            const Ints all_of_it = load_unaligned(from);
            const Mask there = first_lanes(static_cast<int>(count));
            for (std::size_t i = 0; i < count; ++i) {
                const std::size_t rank = hwy::PopCount(bits(there & (all_of_it < Ints{from[i]})));
                to[rank] = {row, static_cast<std::uint32_t>(from[i])};
            }
        } else {
            for (std::size_t i = 0; i < count; ++i) to[i] = {row, static_cast<std::uint32_t>(from[i])};
            sort_long_row(to, to + count);
        }
    }
}

// Without a branch on the row, which would be guessed wrong every other time.
std::size_t picked_rows(const std::int32_t* first, const std::int32_t* second, std::size_t count, std::size_t first_row, std::size_t last_row,
                        RowPairs& out) {
    const Ints from{static_cast<std::int32_t>(first_row)}, to{static_cast<std::int32_t>(last_row)};
    std::size_t picked = 0;
    for (std::size_t i = 0; i < count; i += kLanes) {
        const Ints a = load_unaligned(first + i), b = load_unaligned(second + i);
        const Mask swapped = b < a;
        const Ints row = select(swapped, b, a), value = select(swapped, a, b);
        const Mask wanted = (row >= from) & (row < to) & first_lanes(static_cast<int>(count - i < kLanes ? count - i : kLanes));
        compress_store(row, wanted, out.row + picked);
        picked += compress_store(value, wanted, out.value + picked);
    }
    return picked;
}

// Whole vectors of pairs that both lists share are passed over at once.
PairChanges changes_of(std::span<const ProxyPair> before, std::span<const ProxyPair> now, ProxyPair* ended, ProxyPair* begun) {
    std::size_t i = 0, j = 0, ended_count = 0, begun_count = 0;
    constexpr std::size_t kPairs = kLanes / 2;
    while (i < before.size() && j < now.size()) {
        if constexpr (kPairs != 0) {
            if (i + kPairs <= before.size() && j + kPairs <= now.size()) {
                const Ints was = load_unaligned(reinterpret_cast<const std::int32_t*>(before.data() + i));
                const Ints is = load_unaligned(reinterpret_cast<const std::int32_t*>(now.data() + j));
                const unsigned differ = bits(was != is);
                const std::size_t same = differ == 0 ? kPairs : hwy::Num0BitsBelowLS1Bit_Nonzero32(differ) / 2;
                i += same;
                j += same;
                if (differ == 0) continue;
            }
        }
        // Both are written; the counts say which holds.
        const std::uint64_t was = key_of(before[i]), is = key_of(now[j]);
        ended[ended_count] = before[i];
        begun[begun_count] = now[j];
        ended_count += was < is;
        begun_count += is < was;
        i += was <= is;
        j += is <= was;
    }
    for (; i < before.size(); ++i) ended[ended_count++] = before[i];
    for (; j < now.size(); ++j) begun[begun_count++] = now[j];
    return {ended_count, begun_count};
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <algorithm>

namespace carom::detail {

HWY_EXPORT(touched_pairs);
HWY_EXPORT(sorted_rows);
HWY_EXPORT(changes_of);
HWY_EXPORT(picked_rows);

// The pairs of a row differ, so the result does not depend on how they are sorted.
void sort_long_row(ProxyPair* first, ProxyPair* last) noexcept {
    std::make_heap(first, last);
    std::sort_heap(first, last);
}

void sort_rows(const std::uint32_t* values, std::uint32_t start, std::uint32_t first_row, std::span<const std::uint32_t> ends,
               ProxyPair* out) {
    HWY_DYNAMIC_DISPATCH(sorted_rows)(values, start, first_row, ends, out);
}

std::size_t pick_rows(const std::int32_t* first, const std::int32_t* second, std::size_t count, std::size_t first_row, std::size_t last_row,
                      RowPairs& out) {
    return HWY_DYNAMIC_DISPATCH(picked_rows)(first, second, count, first_row, last_row, out);
}

PairChanges compare_lists(std::span<const ProxyPair> before, std::span<const ProxyPair> now, ProxyPair* ended, ProxyPair* begun) {
    return HWY_DYNAMIC_DISPATCH(changes_of)(before, now, ended, begun);
}

std::size_t find_touched(std::span<const ProxyPair> pairs, const SlotBits& changed, std::uint32_t* out) {
    return HWY_DYNAMIC_DISPATCH(touched_pairs)(pairs, changed, out);
}

}  // namespace carom::detail

#endif  // HWY_ONCE
