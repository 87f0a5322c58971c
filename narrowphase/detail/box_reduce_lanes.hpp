// From many points of sixteen patches to the four of each that carry it: reduce_points() for lanes.
//
//   WideCandidates candidates;
//   candidates.add(u, w, separation, valid, code);
//   WideChoice chosen = choose_points(candidates, {tolerance, overlook}, start_u, start_w);

// This guard lets the file through once for each target.
#if defined(CAROM_NARROWPHASE_BOX_REDUCE_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_NARROWPHASE_BOX_REDUCE_LANES_HPP
#undef CAROM_NARROWPHASE_BOX_REDUCE_LANES_HPP
#else
#define CAROM_NARROWPHASE_BOX_REDUCE_LANES_HPP
#endif

#include <carom/core/lanes.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <cstddef>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {

using namespace carom::HWY_NAMESPACE;

constexpr float kNever = std::numeric_limits<float>::infinity();

/// A point in the plane of contact; its code is -1 where there is none.
struct WidePoint {
    Floats u, w, separation;
    Ints code;
};
HWY_INLINE WidePoint no_point() { return {Floats(0.0f), Floats(0.0f), Floats(0.0f), Ints(-1)}; }
HWY_INLINE Mask exists(const WidePoint& p) { return p.code > Ints(-1); }
HWY_INLINE WidePoint select(Mask m, const WidePoint& yes, const WidePoint& no) {
    return {select(m, yes.u, no.u), select(m, yes.w, no.w), select(m, yes.separation, no.separation), select(m, yes.code, no.code)};
}

/// At most 9 points: starts of 4 + 4 edges, 1 pair of edges. Lanes in which a point is not valid have an infinite separation, and NaN
/// for u, so that no score of theirs is better than another.
struct WideCandidates {
    static constexpr std::size_t kRoom = 9;
    RawFloats u[kRoom], w[kRoom], separation[kRoom];
    RawInts code[kRoom];
    std::size_t count = 0;

    HWY_INLINE void add(Floats at_u, Floats at_w, Floats at_separation, Mask valid, Ints its_code) {
        u[count] = select(valid, at_u, Floats(std::numeric_limits<float>::quiet_NaN())).raw;
        w[count] = at_w.raw;
        separation[count] = select(valid, at_separation, Floats(kNever)).raw;
        code[count++] = its_code.raw;
    }
    HWY_INLINE WidePoint at(std::size_t k) const { return {Floats{u[k]}, Floats{w[k]}, Floats{separation[k]}, Ints{code[k]}}; }
};

/// The valid point with the largest score so far, if that is over what it began with. Scores that beat it by no more than rounding may are no better, so
/// of such the first is kept. Scores have a part of u, or are less the separation: NaN or -infinity for points that are not valid.
struct WideBest {
    Floats bar;  ///< what the next has to be over
    WidePoint point = no_point();

    HWY_INLINE explicit WideBest(Floats over) : bar(over) {}
    /// @param beaten_by  what a score has to be over that is better than this one.
    HWY_INLINE void offer(const WidePoint& candidate, Floats score, Floats beaten_by) {
        const Mask better = score > bar;
        bar = select(better, beaten_by, bar);
        point = select(better, candidate, point);
    }
};

/// Calls visit(candidate, its number) for each, in order.
template <class Visit>
HWY_INLINE void for_each(const WideCandidates& c, const Visit& visit) {
    for (std::size_t k = 0; k < c.count; ++k) visit(c.at(k), k);
}

HWY_INLINE Floats distance_sq(const WidePoint& a, const WidePoint& p) { return (p.u - a.u) * (p.u - a.u) + (p.w - a.w) * (p.w - a.w); }
/// Twice the area of the triangle of two points and a third.
struct WideArea {
    Floats u, w, from_u, from_w;

    /// @param turn  1 or -1, which the area is multiplied by.
    HWY_INLINE WideArea(const WidePoint& a, const WidePoint& b, Floats turn)
        : u(turn * (b.u - a.u)), w(turn * (b.w - a.w)), from_u(a.u), from_w(a.w) {}
    HWY_INLINE Floats of(const WidePoint& p) const { return u * (p.w - from_w) - w * (p.u - from_u); }
};

/// The first `count` points are in use.
struct WideChoice {
    WidePoint points[4];
    Ints count;
    Floats lowest;  ///< separation of all that there were to choose from; kNever: there were none
};

/// The limits of reduce_points().
struct WideLimits {
    Floats tolerance, overlook;
};

/// What reduce_points() (reduce.hpp) chooses, for each lane, but that depths are equal within `tolerance` / 4. Ties go to the first candidate: the
/// order is that of the edges of both faces, which rounding does not change.
HWY_INLINE WideChoice choose_points(const WideCandidates& all, const WideLimits& limits, Floats start_u, Floats start_w) {
    const Floats tolerance = limits.tolerance;
    const Floats farther(static_cast<float>(1.0 / kAsFar));
    WideBest first(Floats(-kNever));
    Floats lowest(kNever);
    for_each(all, [&](const WidePoint& p, std::size_t) {
        const Floats along = p.u * start_u + p.w * start_w;
        first.offer(p, along, along + tolerance);
        lowest = min(p.separation, lowest);
    });
    const WidePoint& a = first.point;
    WideBest farthest(tolerance * tolerance);
    for_each(all, [&](const WidePoint& p, std::size_t) {
        const Floats distance = distance_sq(a, p);
        farthest.offer(p, distance, farther * distance);
    });
    const WidePoint& b = farthest.point;
    const Mask has_b = exists(b);
    const Floats least_area = tolerance * sqrt(distance_sq(a, b));
    WideBest largest(least_area);
    RawFloats areas[WideCandidates::kRoom];
    const WideArea over_ab(a, b, Floats(1.0f));
    for_each(all, [&](const WidePoint& p, std::size_t k) {
        const Floats area = over_ab.of(p), size = abs(area);
        areas[k] = area.raw;
        largest.offer(p, size, size + least_area);
    });
    const WidePoint& c = largest.point;
    const Mask has_c = has_b & exists(c);
    const Floats turn = select(over_ab.of(c) > Floats(0.0f), Floats(-1.0f), Floats(1.0f));
    WideBest beyond(least_area);
    const WideArea over_bc(b, c, turn), over_ca(c, a, turn);
    for_each(all, [&](const WidePoint& p, std::size_t k) {
        const Floats added = max(max(turn * Floats{areas[k]}, over_bc.of(p)), over_ca.of(p));
        beyond.offer(p, added, added + least_area);
    });
    const WidePoint& d = beyond.point;
    const Mask has_d = has_c & exists(d);

    const Ints zero(0), one(1);
    const Ints count = (select(exists(a), one, zero) + select(has_b, one, zero)) + (select(has_c, one, zero) + select(has_d, one, zero));
    WideChoice out{{a, b, c, d}, count, lowest};
    const Mask used[4] = {exists(a), has_b, has_c, has_d};

    // The deepest point takes the place of the nearest, or a free one.
    Floats least(kNever);
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) least = select(used[k], min(out.points[k].separation, least), least);
    const Floats overlooked = select(has_d, min(limits.overlook, Floats(static_cast<float>(kSteadyShare)) * max(-least, Floats(0.0f))), Floats(0.0f));
    const Mask replace = exists(a) & (-lowest > (tolerance - least) + overlooked);
    if (none(replace)) return out;
    WideBest lowest_point(Floats(-kNever));
    for_each(all, [&](const WidePoint& p, std::size_t) { lowest_point.offer(p, -p.separation, Floats(0.25f) * tolerance - p.separation); });
    const WidePoint& deepest = lowest_point.point;
    Floats nearest(kNever);
    Ints slot(0);
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) {
        const Floats distance = distance_sq(deepest, out.points[k]);
        const Mask nearer = used[k] & (farther * distance < nearest);
        nearest = select(nearer, distance, nearest);
        slot = select(nearer, Ints(k), slot);
    }
    const Mask append = replace & (out.count < Ints(4)) & (nearest > tolerance * tolerance);
    slot = select(append, out.count, slot);
    out.count = select(append, out.count + one, out.count);
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) out.points[k] = select(replace & (slot == Ints(k)), deepest, out.points[k]);
    return out;
}

}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
