// A moving point against a box along the axes, grown by a radius, in lanes.

// This guard lets the file through once for each target.
#if defined(CAROM_NARROWPHASE_SWEPT_BOX_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_NARROWPHASE_SWEPT_BOX_LANES_HPP
#undef CAROM_NARROWPHASE_SWEPT_BOX_LANES_HPP
#else
#define CAROM_NARROWPHASE_SWEPT_BOX_LANES_HPP
#endif

#include <carom/narrowphase/detail/swept_parts_lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {

/// When a part is first met, and the way towards it then.
struct Meeting {
    Doubles t;
    Doubles3 normal;
};

/// When a box is met, straight onto a face or at the end of a gap.
struct BoxMeeting {
    Doubles t;
    DoubleMask straight;
    Doubles3 face, gap, last;  ///< towards the box; last: the face whose plane is crossed last
};

// As sweep_box() of sweep_parts.cpp. @param before  what is met then or later need not be told.
template <bool kLimited>
HWY_INLINE BoxMeeting meet_box(const WidePath& path, const Doubles3& lower, const Doubles3& upper, Doubles before, DoubleMask& sure) {
    const Doubles zero(0.0), one(1.0), never(kNoContact);
    const Doubles3& d = path.motion;
    const WideSlabs slabs{{d.x, lower.x, upper.x, path.radius}, {d.y, lower.y, upper.y, path.radius}, {d.z, lower.z, upper.z, path.radius}};
    const WideSlab &x = slabs.x, &y = slabs.y, &z = slabs.z;
    const Doubles reaches = greatest(greatest(x.reaches, y.reaches), z.reaches);
    const Doubles leaves = least(least(least(one, x.leaves), y.leaves), z.leaves) * Doubles(2.0 - kRounded);
    const Doubles from = greatest(zero, reaches * Doubles(kRounded));
    DoubleMask comes = sure & (from <= leaves);
    Doubles to = least(leaves, one);
    if constexpr (kLimited) comes = comes & (from < before), to = least(to, before);
    if (none(comes)) return {never, comes, zero3(), zero3(), zero3()};
    const DoubleMask by_x = reaches == x.reaches, by_y = (!by_x) & (reaches == y.reaches), by_z = !(by_x | by_y);
    const DoubleMask in_x = x.holds(reaches), in_y = y.holds(reaches), in_z = z.holds(reaches);
    const DoubleMask straight = comes & (reaches > zero) & ((by_x & in_y & in_z) | (by_y & in_z & in_x) | (by_z & in_x & in_y));
    const auto towards = [&](DoubleMask by, const WideSlab& s) { return select(by, select(s.speed > zero, one, -one), zero); };
    const Doubles3 face{towards(by_x, x), towards(by_y, y), towards(by_z, z)};
    const DoubleMask slanted = comes & !straight;
    Doubles t = select(straight, from, never);
    if (none(slanted)) return {t, straight, face, face, face};
    t = select(straight, t, slabs.sweep_pieces(path, from, to, slanted, sure));
    const Doubles3 p = d * t;
    const Doubles3 gap = Doubles3{x.clamped(p.x), y.clamped(p.y), z.clamped(p.z)} - p;
    return {t, straight, face, gap, slabs.last_face()};
}
HWY_INLINE Meeting sweep_box(const WidePath& path, const Doubles3& lower, const Doubles3& upper, DoubleMask& sure) {
    const BoxMeeting met = meet_box<false>(path, lower, upper, Doubles(kNoContact), sure);
    if (none((met.t < Doubles(kNoContact)) & !met.straight)) return {met.t, met.face};
    return {met.t, select(met.straight, met.face, direction(met.gap, path, met.last))};
}

HWY_INLINE Doubles farthest(const Doubles3& lower, const Doubles3& upper) {
    const Doubles3 a = abs(lower), b = abs(upper);
    return length(Doubles3{greatest(a.x, b.x), greatest(a.y, b.y), greatest(a.z, b.z)});
}

}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
