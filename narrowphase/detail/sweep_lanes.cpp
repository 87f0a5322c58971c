#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/sweep_lanes.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes_doubles.hpp>
#include <carom/narrowphase/detail/sweep_lanes.hpp>
#include <carom/narrowphase/detail/sweep_parts.hpp>
#include <carom/narrowphase/detail/swept_parts_lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

/// One group of columns.
struct Columns {
    SweptRows& rows;
    std::size_t first;
    Doubles3 from, motion;
    Doubles radius;
    DoubleMask sure;  ///< the input is good

    HWY_INLINE Columns(SweptRows& all, std::size_t column)
        : rows(all), first(column), from(three(0)), motion(three(SweptRows::kMotion)), radius(one(SweptRows::kRadius)), sure(usual(from)) {
        sure = sure & usual(motion) & fit(radius);
    }
    HWY_INLINE Doubles one(std::size_t row) const { return load(rows.in[row] + first); }
    HWY_INLINE Doubles3 three(std::size_t row) const { return {one(row), one(row + 1), one(row + 2)}; }
    /// B's numbers. The first three of a vector.
    HWY_INLINE Doubles number(std::size_t k) const { return one(SweptRows::kShape + k); }
    HWY_INLINE Doubles3 vector(std::size_t k) const { return three(SweptRows::kShape + k); }

    static HWY_INLINE DoubleMask usual(Doubles x) { return abs(x) <= Doubles(kLargestSwept); }
    static HWY_INLINE DoubleMask usual(const Doubles3& v) { return usual(v.x) & usual(v.y) & usual(v.z); }
    static HWY_INLINE DoubleMask fit(Doubles size) { return (size >= Doubles(0.0)) & usual(size); }

    /// As SweepFrame::path() of detail/sweep_frame.hpp.
    HWY_INLINE WidePath path(const Doubles3& way, Doubles size, Doubles radius_b) const {
        const Doubles all = size + radius + radius_b;
        return {way, radius + radius_b + (Doubles(kGrowth) * all + Doubles(kLeastGrowth)), all};
    }
    HWY_INLINE void put(std::size_t row, const Doubles3& v) const {
        store(v.x, rows.out[row] + first);
        store(v.y, rows.out[row + 1] + first);
        store(v.z, rows.out[row + 2] + first);
    }
    HWY_INLINE void answer(DoubleMask touches, DoubleMask overlaps, Doubles t, const Doubles3& point, const Doubles3& normal) const {
        const Doubles zero(0.0);
        store(select(touches, t, select(overlaps, zero, Doubles(1.0))), rows.out[SweptRows::kTime] + first);
        put(SweptRows::kPoint, select(touches, point, zero3()));
        put(SweptRows::kNormal, select(touches, normal, zero3()));
        const Doubles state = select(touches, Doubles(SweptRows::kTouching),
                                     select(overlaps, Doubles(SweptRows::kOverlapping), Doubles(SweptRows::kSeparated)));
        store(select(sure, state, Doubles(SweptRows::kUnsure)), rows.out[SweptRows::kState] + first);
    }
    /// As impact_of() of detail/sweep_frame.hpp.
    HWY_INLINE void answer(Doubles t, const Doubles3& normal) const {
        const DoubleMask overlaps = t <= Doubles(0.0), touches = (t <= Doubles(1.0)) & !overlaps;
        answer(touches, overlaps, t, (from + motion * t) + normal * radius, normal);
    }
};

struct AtPlane {
    static HWY_INLINE void sweep(Columns& c) {
        const Doubles zero(0.0), one(1.0);
        const Doubles3 given = c.vector(0);
        const Doubles scale = length(given);
        c.sure = c.sure & Columns::usual(given) & Columns::usual(c.number(3)) & (scale >= Doubles(kShortestNormal));
        const Doubles3 n = over(given, scale), low = c.from - n * c.radius;
        const Doubles offset = c.number(3) / scale, size = length(c.from) + c.radius;
        const Doubles height = dot(n, low) - offset - (Doubles(kGrowth) * (size + abs(offset)) + Doubles(kLeastGrowth));
        const DoubleMask apart = height > zero;
        const Doubles closing = -dot(n, c.motion) + Doubles(8.0 * 0x1p-52) * dot(abs(n), abs(c.motion));
        const Doubles t = height / closing * Doubles(kRounded);
        const DoubleMask touches = apart & (closing > zero) & (t <= one);
        c.answer(touches, !apart, t, low + c.motion * t, -n);
    }
};

struct AtPoint {
    static HWY_INLINE void sweep(Columns& c) {
        const Doubles3 centre = c.vector(0), q = centre - c.from;
        const Doubles radius = c.number(3);
        c.sure = c.sure & Columns::usual(centre) & Columns::fit(radius) & long_or_none(c.motion);
        const WidePath path = c.path(c.motion, length(q), radius);
        const WideMeeting met = sweep_point(path, path.radius, q, c.sure);
        c.answer(met.t, direction(met.gap, path, path.motion));
    }
};

struct AtSegment {
    static HWY_INLINE void sweep(Columns& c) {
        const Doubles3 a = c.vector(0), b = c.vector(3), q = a - c.from, u = b - a;
        const Doubles radius = c.number(6);
        c.sure = c.sure & Columns::usual(a) & Columns::usual(b) & Columns::fit(radius) & long_or_none(c.motion);
        const WidePath path = c.path(c.motion, greatest(length(q), length(q + u)), radius);
        const WideMeeting met = sweep_segment(path, path.radius, q, u, c.sure);
        c.answer(met.t, direction(met.gap, path, path.motion));
    }
};

struct BoxMeeting {
    Doubles t;
    Doubles3 normal;
};

// As sweep_box() of sweep_parts.cpp.
HWY_INLINE BoxMeeting sweep_box(const WidePath& path, const Doubles3& lower, const Doubles3& upper, DoubleMask& sure) {
    const Doubles zero(0.0), one(1.0), never(kNoContact);
    const Doubles3& d = path.motion;
    const WideSlabs slabs{{d.x, lower.x, upper.x, path.radius}, {d.y, lower.y, upper.y, path.radius}, {d.z, lower.z, upper.z, path.radius}};
    const WideSlab &x = slabs.x, &y = slabs.y, &z = slabs.z;
    const Doubles reaches = greatest(greatest(x.reaches, y.reaches), z.reaches);
    const Doubles leaves = least(least(least(one, x.leaves), y.leaves), z.leaves) * Doubles(2.0 - kRounded);
    const Doubles from = greatest(zero, reaches * Doubles(kRounded));
    const DoubleMask comes = sure & (from <= leaves);
    if (none(comes)) return {never, zero3()};
    const DoubleMask by_x = reaches == x.reaches, by_y = (!by_x) & (reaches == y.reaches), by_z = !(by_x | by_y);
    const DoubleMask in_x = x.holds(reaches), in_y = y.holds(reaches), in_z = z.holds(reaches);
    const DoubleMask straight = comes & (reaches > zero) & ((by_x & in_y & in_z) | (by_y & in_z & in_x) | (by_z & in_x & in_y));
    const auto towards = [&](DoubleMask by, const WideSlab& s) { return select(by, select(s.speed > zero, one, -one), zero); };
    const Doubles3 face{towards(by_x, x), towards(by_y, y), towards(by_z, z)};
    const DoubleMask slanted = comes & !straight;
    Doubles t = select(straight, from, never);
    if (none(slanted)) return {t, face};
    t = select(straight, t, slabs.sweep_pieces(path, from, least(leaves, one), slanted, sure));
    const Doubles3 p = d * t;
    const Doubles3 gap = Doubles3{x.clamped(p.x), y.clamped(p.y), z.clamped(p.z)} - p;
    return {t, select(straight, face, direction(gap, path, slabs.last_face()))};
}

HWY_INLINE Doubles farthest(const Doubles3& lower, const Doubles3& upper) {
    const Doubles3 a = abs(lower), b = abs(upper);
    return length(Doubles3{greatest(a.x, b.x), greatest(a.y, b.y), greatest(a.z, b.z)});
}

struct AtBox {
    static HWY_INLINE void sweep(Columns& c) {
        const Doubles3 low = c.vector(0), high = c.vector(3), lower = low - c.from, upper = high - c.from;
        c.sure = c.sure & Columns::usual(low) & Columns::usual(high) & (low.x <= high.x) & (low.y <= high.y) & (low.z <= high.z);
        const BoxMeeting met = sweep_box(c.path(c.motion, farthest(lower, upper), Doubles(0.0)), lower, upper, c.sure);
        c.answer(met.t, met.normal);
    }
};

struct AtTurnedBox {
    static HWY_INLINE void sweep(Columns& c) {
        const Doubles3 centre = c.vector(0), half = c.vector(3), x = c.vector(6), y = c.vector(9), z = c.vector(12);
        const auto in_box = [&](const Doubles3& v) { return Doubles3{dot(x, v), dot(y, v), dot(z, v)}; };
        const auto from_box = [&](const Doubles3& v) { return (x * v.x + y * v.y) + z * v.z; };
        const Doubles3 from = in_box(c.from - centre), motion = in_box(c.motion);
        c.sure = c.sure & Columns::usual(centre) & Columns::fit(half.x) & Columns::fit(half.y) & Columns::fit(half.z) & Columns::usual(x) &
                 Columns::usual(y) & Columns::usual(z) & Columns::usual(from) & Columns::usual(motion);
        const Doubles3 lower = -half - from, upper = half - from;
        const BoxMeeting met = sweep_box(c.path(motion, farthest(lower, upper), Doubles(0.0)), lower, upper, c.sure);
        const DoubleMask overlaps = met.t <= Doubles(0.0), touches = (met.t <= Doubles(1.0)) & !overlaps;
        const Doubles3 point = (from + motion * met.t) + met.normal * c.radius;
        c.answer(touches, overlaps, met.t, centre + from_box(point), from_box(met.normal));
    }
};

struct AtTriangle {
    static HWY_INLINE void sweep(Columns& c) {
        const Doubles3 at_a = c.vector(0), at_b = c.vector(3), at_c = c.vector(6);
        c.sure = c.sure & Columns::usual(at_a) & Columns::usual(at_b) & Columns::usual(at_c) & long_or_none(c.motion);
        const Doubles3 p = at_a - c.from, q = at_b - c.from, r = at_c - c.from;
        const WidePath path = c.path(c.motion, greatest(greatest(length(p), length(q)), length(r)), Doubles(0.0));
        const Doubles3 sides[3] = {q - p, r - q, p - r}, corners[3] = {p, q, r};
        const Doubles of_c = dot(sides[0], sides[0]), of_a = dot(sides[1], sides[1]), of_b = dot(sides[2], sides[2]);
        const DoubleMask from_a = (of_a >= of_b) & (of_a >= of_c), from_b = (!from_a) & (of_b >= of_c);
        const auto chosen = [&](const Doubles3& a, const Doubles3& b, const Doubles3& other) {
            return select(from_a, a, select(from_b, b, other));
        };
        const WideCorner corner(path, chosen(p, q, r), chosen(sides[0], sides[1], sides[2]), -chosen(sides[2], sides[0], sides[1]));
        const Doubles rim = path.radius + corner.rim_growth();
        Doubles3 normal = zero3();
        const Doubles on_face = corner.sweep_face(path, normal);
        WideMeeting met{on_face, zero3()};
        for (int k = 0; k < 3; ++k) met = earlier(met, sweep_segment(path, rim, corners[k], sides[k], c.sure));
        c.answer(met.t, select(met.t < on_face, direction(met.gap, path, path.motion), normal));
    }
};

template <class Core>
void run(SweptRows& rows, std::size_t count) {
    for (std::size_t first = 0; first < count; first += static_cast<std::size_t>(kDoubleLanes)) {
        Columns columns(rows, first);
        Core::sweep(columns);
    }
}

void SweepLanes(SweptCore core, SweptRows& rows, std::size_t count) {
    switch (core) {
        case SweptCore::Plane:
            return run<AtPlane>(rows, count);
        case SweptCore::Point:
            return run<AtPoint>(rows, count);
        case SweptCore::Segment:
            return run<AtSegment>(rows, count);
        case SweptCore::Box:
            return run<AtBox>(rows, count);
        case SweptCore::TurnedBox:
            return run<AtTurnedBox>(rows, count);
        case SweptCore::Triangle:
            return run<AtTriangle>(rows, count);
    }
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(SweepLanes);

void sweep_lanes(SweptCore core, SweptRows& rows, std::size_t count) noexcept { HWY_DYNAMIC_DISPATCH(SweepLanes)(core, rows, count); }
}  // namespace carom::detail
#endif
