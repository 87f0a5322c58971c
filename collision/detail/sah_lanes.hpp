// Boxes of eight floats and corners of four, for the build of the tree: these widths fit the data at every target.
//
//   grow(box, lanes_of(item));
//   float area = half_area(load4(lower), load4(minus_upper));

// This guard lets the file through once for each target.
#if defined(CAROM_COLLISION_SAH_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_COLLISION_SAH_LANES_HPP
#undef CAROM_COLLISION_SAH_LANES_HPP
#else
#define CAROM_COLLISION_SAH_LANES_HPP
#endif

#include <carom/collision/detail/sah_tree.hpp>
#include <carom/core/lanes.hpp>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {

using Tag8 = hn::CappedTag<float, 8>;
constexpr std::size_t kStep8 = hn::MaxLanes(Tag8());

HWY_INLINE void grow(float* box, const float* by) {
    for (std::size_t i = 0; i < 8; i += kStep8) {
        hn::Store(hn::Min(hn::Load(Tag8(), box + i), hn::Load(Tag8(), by + i)), Tag8(), box + i);
    }
}

HWY_INLINE void set_empty(float* box) {
    for (std::size_t i = 0; i < 8; i += kStep8) {
        hn::Store(hn::Set(Tag8(), std::numeric_limits<float>::infinity()), Tag8(), box + i);
    }
}

/// The eight lanes of an item as SahBox has them.
HWY_INLINE const float* lanes_of(const SahItem& item) { return reinterpret_cast<const float*>(&item); }

constexpr float kRounder = 0x1.8p23f;

/// Four floats, of which three count.
#if HWY_TARGET == HWY_SCALAR
struct Four {
    float lane[4];
    template <class Op>
    static Four make(Op&& op) {
        return {{op(0), op(1), op(2), op(3)}};
    }
};
HWY_INLINE Four load4(const float* from) { return Four::make([&](int i) { return from[i]; }); }
HWY_INLINE Four set4(float x) { return {{x, x, x, x}}; }
HWY_INLINE void store4(Four a, float* to) { std::copy_n(a.lane, 4, to); }
HWY_INLINE Four min4(Four a, Four b) { return Four::make([&](int i) { return std::min(a.lane[i], b.lane[i]); }); }
HWY_INLINE Four sub4(Four a, Four b) { return Four::make([&](int i) { return a.lane[i] - b.lane[i]; }); }
HWY_INLINE Four mul4(Four a, Four b) { return Four::make([&](int i) { return a.lane[i] * b.lane[i]; }); }
HWY_INLINE float half_area(Four lower, Four minus_upper) {
    const Four e = sub4(sub4(set4(0.0f), minus_upper), lower);
    return (e.lane[0] * e.lane[1] + e.lane[1] * e.lane[2]) + e.lane[2] * e.lane[0];
}
HWY_INLINE void bins4(Four a, int most, std::int32_t* to) {
    for (int i = 0; i < 4; ++i) {
        to[i] = std::min(std::bit_cast<std::int32_t>(a.lane[i] + kRounder) - std::bit_cast<std::int32_t>(kRounder), most);
    }
}
#else
using Tag4 = hn::Simd<float, 4, 0>;
using Four = hn::Vec<Tag4>;
HWY_INLINE Four load4(const float* from) { return hn::Load(Tag4(), from); }
HWY_INLINE Four set4(float x) { return hn::Set(Tag4(), x); }
HWY_INLINE void store4(Four a, float* to) { hn::Store(a, Tag4(), to); }
HWY_INLINE Four min4(Four a, Four b) { return hn::Min(a, b); }
HWY_INLINE Four sub4(Four a, Four b) { return hn::Sub(a, b); }
HWY_INLINE Four mul4(Four a, Four b) { return hn::Mul(a, b); }
HWY_INLINE float half_area(Four lower, Four minus_upper) {
    const Four e = sub4(sub4(set4(0.0f), minus_upper), lower);
    const Four next = hn::Shuffle0321(e);                 // y z . .
    const Four xy_yz = mul4(e, next);
    const Four zx = mul4(e, hn::Shuffle1032(e));          // z . . .
    return (hn::GetLane(xy_yz) + hn::GetLane(hn::Shuffle0321(xy_yz))) + hn::GetLane(zx);
}
/// Rounds 0 <= a < 2^22 to the nearest integer, by an addition that leaves it in the last bits, to `most` at most.
HWY_INLINE void bins4(Four a, int most, std::int32_t* to) {
    const hn::Rebind<std::int32_t, Tag4> tag;
    const auto sum = hn::BitCast(tag, hn::Add(a, hn::Set(Tag4(), kRounder)));
    const auto bin = hn::Sub(sum, hn::Set(tag, std::bit_cast<std::int32_t>(kRounder)));
    hn::Store(hn::Min(bin, hn::Set(tag, most)), tag, to);
}
#endif

}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
