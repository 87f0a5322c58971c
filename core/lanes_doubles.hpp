// SIMD lanes of doubles, for kernels that need them beside or instead of those of core/lanes.hpp, by the same rules.
//
//   #include <carom/core/lanes_doubles.hpp>      // where lanes.hpp would be included, which it includes
//   for (int lane = 0; lane < kDoubleBundleWidth; lane += kDoubleLanes) { Doubles x = load(bundle.lane + lane); ... }

// This guard lets the file through once for each target.
#if defined(CAROM_CORE_LANES_DOUBLES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_CORE_LANES_DOUBLES_HPP
#undef CAROM_CORE_LANES_DOUBLES_HPP
#else
#define CAROM_CORE_LANES_DOUBLES_HPP
#endif

#include <carom/core/lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {

using DoubleTag = hn::CappedTag<double, 8>;
using RawDoubles = hn::Vec<DoubleTag>;
using RawDoubleMask = hn::Mask<DoubleTag>;

/// Lanes of this target: 1, 2, 4 or 8.
constexpr int kDoubleLanes = static_cast<int>(hn::MaxLanes(DoubleTag()));

/// One truth value a lane.
struct DoubleMask {
    RawDoubleMask raw;
    HWY_INLINE explicit DoubleMask(RawDoubleMask r) : raw(r) {}
};
HWY_INLINE DoubleMask operator&(DoubleMask a, DoubleMask b) { return DoubleMask{hn::And(a.raw, b.raw)}; }
HWY_INLINE DoubleMask operator|(DoubleMask a, DoubleMask b) { return DoubleMask{hn::Or(a.raw, b.raw)}; }
HWY_INLINE DoubleMask operator!(DoubleMask a) { return DoubleMask{hn::Not(a.raw)}; }
HWY_INLINE bool none(DoubleMask m) { return hn::AllFalse(DoubleTag(), m.raw); }
/// @return lane l's truth in bit l; the bits above are zero.
HWY_INLINE unsigned bits(DoubleMask m) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(DoubleTag(), m.raw, bytes);
    return bytes[0] & ((1u << kDoubleLanes) - 1u);
}

/// One double a lane. A plain double converts to the same value in every lane.
struct Doubles {
    RawDoubles raw;
    HWY_INLINE Doubles() : raw(hn::Zero(DoubleTag())) {}
    HWY_INLINE Doubles(double everywhere) : raw(hn::Set(DoubleTag(), everywhere)) {}
    HWY_INLINE explicit Doubles(RawDoubles r) : raw(r) {}
};
HWY_INLINE Doubles operator+(Doubles a, Doubles b) { return Doubles{hn::Add(a.raw, b.raw)}; }
HWY_INLINE Doubles operator-(Doubles a, Doubles b) { return Doubles{hn::Sub(a.raw, b.raw)}; }
HWY_INLINE Doubles operator*(Doubles a, Doubles b) { return Doubles{hn::Mul(a.raw, b.raw)}; }
HWY_INLINE Doubles operator/(Doubles a, Doubles b) { return Doubles{hn::Div(a.raw, b.raw)}; }
HWY_INLINE Doubles operator-(Doubles a) { return Doubles{hn::Neg(a.raw)}; }
// False where either side is NaN.
HWY_INLINE DoubleMask operator<(Doubles a, Doubles b) { return DoubleMask{hn::Lt(a.raw, b.raw)}; }
HWY_INLINE DoubleMask operator>(Doubles a, Doubles b) { return DoubleMask{hn::Gt(a.raw, b.raw)}; }
HWY_INLINE DoubleMask operator<=(Doubles a, Doubles b) { return DoubleMask{hn::Le(a.raw, b.raw)}; }
HWY_INLINE DoubleMask operator>=(Doubles a, Doubles b) { return DoubleMask{hn::Ge(a.raw, b.raw)}; }
HWY_INLINE DoubleMask operator==(Doubles a, Doubles b) { return DoubleMask{hn::Eq(a.raw, b.raw)}; }
/// @return `yes` where the mask is true, `no` elsewhere.
HWY_INLINE Doubles select(DoubleMask m, Doubles yes, Doubles no) { return Doubles{hn::IfThenElse(m.raw, yes.raw, no.raw)}; }
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
/// @return a < b ? a : b.
HWY_INLINE Doubles min(Doubles a, Doubles b) { return Doubles{hn::Min(a.raw, b.raw)}; }  // minpd is exactly this
/// @return a > b ? a : b.
HWY_INLINE Doubles max(Doubles a, Doubles b) { return Doubles{hn::Max(a.raw, b.raw)}; }
#else
HWY_INLINE Doubles min(Doubles a, Doubles b) { return select(a < b, a, b); }
HWY_INLINE Doubles max(Doubles a, Doubles b) { return select(a > b, a, b); }
#endif
HWY_INLINE Doubles abs(Doubles a) { return Doubles{hn::Abs(a.raw)}; }
HWY_INLINE Doubles sqrt(Doubles a) { return Doubles{hn::Sqrt(a.raw)}; }

/// Memory, aligned to kDoubleLanes doubles: any multiple of kDoubleLanes in a bundle is.
HWY_INLINE Doubles load(const double* from) { return Doubles{hn::Load(DoubleTag(), from)}; }
HWY_INLINE void store(Doubles a, double* to) { hn::Store(a.raw, DoubleTag(), to); }
/// @return 0, 1, 2, ... in lane order.
HWY_INLINE Doubles double_lane_numbers() { return Doubles{hn::Iota(DoubleTag(), 0)}; }
/// @return the least and the greatest of all lanes, none of which is NaN.
HWY_INLINE double least_lane(Doubles a) { return hn::GetLane(hn::MinOfLanes(DoubleTag(), a.raw)); }
HWY_INLINE double greatest_lane(Doubles a) { return hn::GetLane(hn::MaxOfLanes(DoubleTag(), a.raw)); }

/// Three doubles a lane.
struct Doubles3 {
    Doubles x, y, z;
};
HWY_INLINE Doubles3 operator+(const Doubles3& a, const Doubles3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE Doubles3 operator-(const Doubles3& a, const Doubles3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE Doubles3 operator-(const Doubles3& a) { return {-a.x, -a.y, -a.z}; }
HWY_INLINE Doubles3 operator*(const Doubles3& a, Doubles s) { return {a.x * s, a.y * s, a.z * s}; }
HWY_INLINE Doubles3 select(DoubleMask m, const Doubles3& yes, const Doubles3& no) {
    return {select(m, yes.x, no.x), select(m, yes.y, no.y), select(m, yes.z, no.z)};
}
/// @return (a.x b.x + a.y b.y) + a.z b.z, rounded in that order.
HWY_INLINE Doubles dot(const Doubles3& a, const Doubles3& b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
HWY_INLINE Doubles3 cross(const Doubles3& a, const Doubles3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
