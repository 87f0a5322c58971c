// SIMD lanes: the arithmetic of wide kernels, over Highway, compiled once for each instruction set.
//
// A kernel file, collision/scale.cpp say, is this:
//
//   #include <carom/core/simd_targets.hpp>                // first: chooses the targets
//   #undef HWY_TARGET_INCLUDE
//   #define HWY_TARGET_INCLUDE <carom/collision/scale.cpp>  // this file; a test uses "core/scale.cpp", from tests/
//   #include <hwy/foreach_target.h>                       // compiles this file once more for every other target
//   #include <carom/core/bundle.hpp>
//   #include <carom/core/lanes.hpp>                       // after foreach_target.h
//   HWY_BEFORE_NAMESPACE();                               // what follows may use the target's instructions
//   namespace carom::HWY_NAMESPACE {
//   namespace {
//   void scale(FloatBundle& bundle, float factor) {
//       for (int lane = 0; lane < kBundleWidth; lane += kLanes)
//           store(load(bundle.lane + lane) * factor, bundle.lane + lane);
//   }
//   }  // namespace
//   }  // namespace carom::HWY_NAMESPACE
//   HWY_AFTER_NAMESPACE();
//   #if HWY_ONCE                                          // the rest is compiled once
//   namespace carom {
//   HWY_EXPORT(scale);
//   void scale(FloatBundle& bundle, float factor) { HWY_DYNAMIC_DISPATCH(scale)(bundle, factor); }
//   }  // namespace carom
//   #endif
//
// Rules. Keep everything that touches lanes between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE, in carom::HWY_NAMESPACE.
// HWY_EXPORT must stand in namespace carom or one inside it that also holds the kernels' HWY_NAMESPACE (it names
// N_AVX2::scale and so on). Include every header before HWY_BEFORE_NAMESPACE: an inline function that is first seen after it
// may be compiled with wide instructions, and the linker may give that copy to everybody. Write `(!a) & b` with the brackets,
// or GCC warns. Dispatch costs a table look-up and an indirect call: once a batch, not once a bundle.
//
// Results have the same bits as scalar code at every width: there is no fused multiply-add, no approximate reciprocal and
// no sum across lanes. NaN is NaN at every width, but its sign and payload are unspecified. Denormals are honoured.

// This guard lets the file through once for each target.
#if defined(CAROM_CORE_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_CORE_LANES_HPP
#undef CAROM_CORE_LANES_HPP
#else
#define CAROM_CORE_LANES_HPP
#endif

#ifndef HIGHWAY_HWY_DETECT_TARGETS_H_
#include <carom/core/simd_targets.hpp>
#endif

#include <carom/core/compress_table.hpp>

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

#if HWY_TARGETS & HWY_SSSE3
#error "Include <carom/core/simd_targets.hpp> before any header of Highway: it chooses the targets."
#endif

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, 16>;
using IntTag = hn::Rebind<std::int32_t, FloatTag>;
using RawFloats = hn::Vec<FloatTag>;
using RawInts = hn::Vec<IntTag>;
using RawMask = hn::Mask<FloatTag>;

/// Lanes of this target: 1, 4, 8 or 16.
constexpr int kLanes = static_cast<int>(hn::MaxLanes(FloatTag()));

/// One truth value a lane.
struct Mask {
    RawMask raw;
    HWY_INLINE explicit Mask(RawMask r) : raw(r) {}
};
HWY_INLINE Mask operator&(Mask a, Mask b) { return Mask{hn::And(a.raw, b.raw)}; }
HWY_INLINE Mask operator|(Mask a, Mask b) { return Mask{hn::Or(a.raw, b.raw)}; }
HWY_INLINE Mask operator!(Mask a) { return Mask{hn::Not(a.raw)}; }
HWY_INLINE bool none(Mask m) { return hn::AllFalse(FloatTag(), m.raw); }
HWY_INLINE bool any(Mask m) { return !hn::AllFalse(FloatTag(), m.raw); }
HWY_INLINE bool all(Mask m) { return hn::AllTrue(FloatTag(), m.raw); }
/// @return lane l's truth in bit l; the bits above are zero.
HWY_INLINE unsigned bits(Mask m) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(FloatTag(), m.raw, bytes);
    std::uint32_t word = 0;
    std::memcpy(&word, bytes, sizeof(word));
    return word & ((1u << kLanes) - 1u);
}
/// @return true in lanes below `count` (>= 0).
HWY_INLINE Mask first_lanes(int count) { return Mask{hn::FirstN(FloatTag(), static_cast<std::size_t>(count))}; }

/// One float a lane. A plain float converts to the same value in every lane.
struct Floats {
    RawFloats raw;
    HWY_INLINE Floats() : raw(hn::Zero(FloatTag())) {}
    HWY_INLINE Floats(float everywhere) : raw(hn::Set(FloatTag(), everywhere)) {}
    HWY_INLINE explicit Floats(RawFloats r) : raw(r) {}
};
HWY_INLINE Floats operator+(Floats a, Floats b) { return Floats{hn::Add(a.raw, b.raw)}; }
HWY_INLINE Floats operator-(Floats a, Floats b) { return Floats{hn::Sub(a.raw, b.raw)}; }
HWY_INLINE Floats operator*(Floats a, Floats b) { return Floats{hn::Mul(a.raw, b.raw)}; }
HWY_INLINE Floats operator/(Floats a, Floats b) { return Floats{hn::Div(a.raw, b.raw)}; }
HWY_INLINE Floats operator-(Floats a) { return Floats{hn::Neg(a.raw)}; }  // flips the sign bit, of zero and NaN too
HWY_INLINE Floats& operator+=(Floats& a, Floats b) { return a = a + b; }
HWY_INLINE Floats& operator-=(Floats& a, Floats b) { return a = a - b; }
HWY_INLINE Floats& operator*=(Floats& a, Floats b) { return a = a * b; }

// Comparisons are IEEE's: false where either side is NaN, except !=, which is true there.
HWY_INLINE Mask operator<(Floats a, Floats b) { return Mask{hn::Lt(a.raw, b.raw)}; }
HWY_INLINE Mask operator<=(Floats a, Floats b) { return Mask{hn::Le(a.raw, b.raw)}; }
HWY_INLINE Mask operator>(Floats a, Floats b) { return Mask{hn::Gt(a.raw, b.raw)}; }
HWY_INLINE Mask operator>=(Floats a, Floats b) { return Mask{hn::Ge(a.raw, b.raw)}; }
HWY_INLINE Mask operator==(Floats a, Floats b) { return Mask{hn::Eq(a.raw, b.raw)}; }
HWY_INLINE Mask operator!=(Floats a, Floats b) { return !(a == b); }  // Highway's Ne is false for NaN on AVX

/// @return `yes` where the mask is true, `no` elsewhere.
HWY_INLINE Floats select(Mask m, Floats yes, Floats no) { return Floats{hn::IfThenElse(m.raw, yes.raw, no.raw)}; }
HWY_INLINE Mask select(Mask m, Mask yes, Mask no) { return (m & yes) | ((!m) & no); }

/// @return a < b ? a : b. So `b` where either is NaN, and `b` of two zeros whatever their signs.
HWY_INLINE Floats min(Floats a, Floats b) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
    return Floats{hn::Min(a.raw, b.raw)};  // minps is exactly this; other instruction sets treat NaN and -0 differently
#else
    return select(a < b, a, b);
#endif
}
/// @return a > b ? a : b. So `b` where either is NaN, and `b` of two zeros whatever their signs.
HWY_INLINE Floats max(Floats a, Floats b) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
    return Floats{hn::Max(a.raw, b.raw)};
#else
    return select(a > b, a, b);
#endif
}
/// @return min(max(x, low), high): NaN becomes `low`.
HWY_INLINE Floats clamp(Floats x, Floats low, Floats high) { return min(max(x, low), high); }
HWY_INLINE Floats abs(Floats a) { return Floats{hn::Abs(a.raw)}; }
/// IEEE square root: NaN below zero, -0 for -0.
HWY_INLINE Floats sqrt(Floats a) { return Floats{hn::Sqrt(a.raw)}; }
/// @return |magnitude| with the sign bit of `sign`.
HWY_INLINE Floats copy_sign(Floats magnitude, Floats sign) { return Floats{hn::CopySign(magnitude.raw, sign.raw)}; }

/// Memory. `load` and `store` need addresses aligned to kLanes floats: any multiple of kLanes in a bundle is.
HWY_INLINE Floats load(const float* from) { return Floats{hn::Load(FloatTag(), from)}; }
HWY_INLINE Floats load_unaligned(const float* from) { return Floats{hn::LoadU(FloatTag(), from)}; }
HWY_INLINE void store(Floats a, float* to) { hn::Store(a.raw, FloatTag(), to); }
HWY_INLINE void store_unaligned(Floats a, float* to) { hn::StoreU(a.raw, FloatTag(), to); }
HWY_INLINE Floats broadcast(float x) { return Floats{x}; }
/// @return the least and the greatest of all lanes, none of which is NaN.
HWY_INLINE float least_lane(Floats a) { return hn::GetLane(hn::MinOfLanes(FloatTag(), a.raw)); }
HWY_INLINE float greatest_lane(Floats a) { return hn::GetLane(hn::MaxOfLanes(FloatTag(), a.raw)); }

/// One 32-bit signed integer a lane. Arithmetic wraps.
struct Ints {
    RawInts raw;
    HWY_INLINE Ints() : raw(hn::Zero(IntTag())) {}
    HWY_INLINE Ints(std::int32_t everywhere) : raw(hn::Set(IntTag(), everywhere)) {}
    HWY_INLINE explicit Ints(RawInts r) : raw(r) {}
};
HWY_INLINE Ints operator+(Ints a, Ints b) { return Ints{hn::Add(a.raw, b.raw)}; }
HWY_INLINE Ints operator-(Ints a, Ints b) { return Ints{hn::Sub(a.raw, b.raw)}; }
HWY_INLINE Ints operator&(Ints a, Ints b) { return Ints{hn::And(a.raw, b.raw)}; }
HWY_INLINE Ints operator|(Ints a, Ints b) { return Ints{hn::Or(a.raw, b.raw)}; }
HWY_INLINE Ints operator^(Ints a, Ints b) { return Ints{hn::Xor(a.raw, b.raw)}; }
HWY_INLINE Mask operator==(Ints a, Ints b) { return Mask{hn::RebindMask(FloatTag(), hn::Eq(a.raw, b.raw))}; }
HWY_INLINE Mask operator!=(Ints a, Ints b) { return !(a == b); }
HWY_INLINE Mask operator<(Ints a, Ints b) { return Mask{hn::RebindMask(FloatTag(), hn::Lt(a.raw, b.raw))}; }
HWY_INLINE Mask operator>(Ints a, Ints b) { return b < a; }
HWY_INLINE Mask operator<=(Ints a, Ints b) { return !(b < a); }
HWY_INLINE Mask operator>=(Ints a, Ints b) { return !(a < b); }
HWY_INLINE Ints select(Mask m, Ints yes, Ints no) {
    return Ints{hn::IfThenElse(hn::RebindMask(IntTag(), m.raw), yes.raw, no.raw)};
}
HWY_INLINE Ints load(const std::int32_t* from) { return Ints{hn::Load(IntTag(), from)}; }
HWY_INLINE Ints load_unaligned(const std::int32_t* from) { return Ints{hn::LoadU(IntTag(), from)}; }
HWY_INLINE void store(Ints a, std::int32_t* to) { hn::Store(a.raw, IntTag(), to); }
HWY_INLINE void store_unaligned(Ints a, std::int32_t* to) { hn::StoreU(a.raw, IntTag(), to); }
/// @return 0, 1, 2, ... in lane order.
HWY_INLINE Ints lane_numbers() { return Ints{hn::Iota(IntTag(), 0)}; }
/// @return each integer as a float, rounded to nearest.
HWY_INLINE Floats to_floats(Ints a) { return Floats{hn::ConvertTo(FloatTag(), a.raw)}; }
/// @param a  within the range of Ints. @return rounded towards zero.
HWY_INLINE Ints truncate(Floats a) { return Ints{hn::ConvertTo(IntTag(), a.raw)}; }
/// @return base[index] in each lane. Slower than loads of neighbours, unless these would have to be picked apart.
HWY_INLINE Floats gather(const float* base, Ints index) { return Floats{hn::GatherIndex(FloatTag(), base, index.raw)}; }
/// @return the same 32 bits.
HWY_INLINE Ints as_ints(Floats a) { return Ints{hn::BitCast(IntTag(), a.raw)}; }
HWY_INLINE Floats as_floats(Ints a) { return Floats{hn::BitCast(FloatTag(), a.raw)}; }

/// Writes the values of the true lanes one after the other, in lane order. `to` needs room for kLanes values: what
/// follows the written ones there is overwritten with anything.
/// @return how many lanes are true.
HWY_INLINE std::size_t compress_store(Ints values, Mask m, std::int32_t* to) {
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4
    // Highway keeps its table in a local array, which GCC 12 copies to the stack in each call.
    const unsigned mask = bits(m);
    const hn::Rebind<std::uint8_t, IntTag> bytes;
    const RawInts lanes = hn::PromoteTo(IntTag(), hn::LoadU(bytes, carom::detail::kTrueLanes.of[mask]));
    hn::StoreU(hn::TableLookupLanes(values.raw, hn::IndicesFromVec(IntTag(), lanes)), IntTag(), to);
    return hwy::PopCount(mask);
#else
    const auto chosen = hn::RebindMask(IntTag(), m.raw);
    hn::StoreU(hn::Compress(values.raw, chosen), IntTag(), to);  // compressing straight to memory is slow on Zen 4
    return hn::CountTrue(IntTag(), chosen);
#endif
}

/// Three floats a lane.
struct Floats3 {
    Floats x, y, z;
};
HWY_INLINE Floats3 operator+(const Floats3& a, const Floats3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE Floats3 operator-(const Floats3& a, const Floats3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE Floats3 operator-(const Floats3& a) { return {-a.x, -a.y, -a.z}; }
HWY_INLINE Floats3 operator*(const Floats3& a, Floats s) { return {a.x * s, a.y * s, a.z * s}; }
HWY_INLINE Floats3 operator*(Floats s, const Floats3& a) { return a * s; }
HWY_INLINE Floats3& operator+=(Floats3& a, const Floats3& b) { return a = a + b; }
HWY_INLINE Floats3& operator-=(Floats3& a, const Floats3& b) { return a = a - b; }
HWY_INLINE Floats3 select(Mask m, const Floats3& yes, const Floats3& no) {
    return {select(m, yes.x, no.x), select(m, yes.y, no.y), select(m, yes.z, no.z)};
}
/// @return (a.x b.x + a.y b.y) + a.z b.z, rounded in that order.
HWY_INLINE Floats dot(const Floats3& a, const Floats3& b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
HWY_INLINE Floats3 cross(const Floats3& a, const Floats3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// @return sqrt(dot(a, a)): overflows and underflows where the square does.
HWY_INLINE Floats length(const Floats3& a) { return sqrt(dot(a, a)); }

}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#include <carom/core/lanes_rows.hpp>

#endif  // per-target guard
