// find_touched: looks up a bit for either slot of many pairs at once.
#include <carom/core/simd_targets.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/broadphase/detail/touched_kernel.cpp>
#include <hwy/foreach_target.h>

#include <carom/broadphase/detail/pair_set.hpp>
#include <carom/core/lanes.hpp>

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

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace carom::detail {

HWY_EXPORT(touched_pairs);

std::size_t find_touched(std::span<const ProxyPair> pairs, const SlotBits& changed, std::uint32_t* out) {
    return HWY_DYNAMIC_DISPATCH(touched_pairs)(pairs, changed, out);
}

}  // namespace carom::detail

#endif  // HWY_ONCE
