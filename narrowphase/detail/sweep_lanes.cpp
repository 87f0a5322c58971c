#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/sweep_lanes.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes_doubles.hpp>
#include <carom/narrowphase/detail/sweep_lanes.hpp>
#include <carom/narrowphase/detail/sweep_parts.hpp>
#include <carom/narrowphase/detail/swept_capsule_lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

/// One group of columns.
struct Columns {
    SweptRows& rows;
    std::size_t first, shape;
    Doubles3 from, motion;
    Doubles radius;
    DoubleMask sure;  ///< the input is good

    HWY_INLINE Columns(SweptRows& all, std::size_t column, Sweeper a)
        : rows(all),
          first(column),
          shape(SweptRows::shape_row(a)),
          from(three(0)),
          motion(three(SweptRows::kMotion)),
          radius(one(SweptRows::kRadius)),
          sure(usual(from)) {
        sure = sure & usual(motion) & fit(radius);
    }
    HWY_INLINE Doubles one(std::size_t row) const { return load(rows.in[row] + first); }
    HWY_INLINE Doubles3 three(std::size_t row) const { return {one(row), one(row + 1), one(row + 2)}; }
    /// B's numbers. The first three of a vector.
    HWY_INLINE Doubles number(std::size_t k) const { return one(shape + k); }
    HWY_INLINE Doubles3 vector(std::size_t k) const { return three(shape + k); }

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
    /// Where the point on B is known.
    HWY_INLINE void answer(Doubles t, const Doubles3& point, const Doubles3& normal) const {
        const DoubleMask overlaps = t <= Doubles(0.0);
        answer((t <= Doubles(1.0)) & !overlaps, overlaps, t, point, normal);
    }
    /// As impact_of() of detail/sweep_frame.hpp.
    HWY_INLINE void answer(Doubles t, const Doubles3& normal) const {
        const DoubleMask overlaps = t <= Doubles(0.0), touches = (t <= Doubles(1.0)) & !overlaps;
        answer(touches, overlaps, t, (from + motion * t) + normal * radius, normal);
    }
};

/// The other end of a capsule's axis.
HWY_INLINE Doubles3 other_end(Columns& c) {
    const Doubles3 end = c.three(SweptRows::kEnd);
    c.sure = c.sure & Columns::usual(end);
    return end;
}

template <Sweeper kA>
struct AtPlane {
    static HWY_INLINE void sweep(Columns& c) {
        const Doubles zero(0.0), one(1.0);
        const Doubles3 given = c.vector(0);
        const Doubles scale = length(given);
        c.sure = c.sure & Columns::usual(given) & Columns::usual(c.number(3)) & (scale >= Doubles(kShortestNormal));
        const Doubles3 n = over(given, scale);
        Doubles3 core = c.from;
        Doubles size = length(c.from);
        if constexpr (kA == Sweeper::Capsule) {
            const Doubles3 end = other_end(c);
            core = select(dot(n, c.from) <= dot(n, end), c.from, end);
            size = greatest(size, length(end));
        }
        size = size + c.radius;
        const Doubles3 low = core - n * c.radius;
        const Doubles offset = c.number(3) / scale;
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

struct CapsuleAtPoint {
    static HWY_INLINE void sweep(Columns& c) {
        const Doubles3 centre = c.vector(0), q = centre - c.from, axis = other_end(c) - c.from;
        const Doubles radius = c.number(3);
        c.sure = c.sure & Columns::usual(centre) & Columns::fit(radius) & long_or_none(c.motion);
        const WidePath path = c.path(c.motion, length(q) + length(axis), radius);
        const WideMeeting met = sweep_segment(path, path.radius, q, -axis, c.sure);
        const Doubles3 normal = direction(met.gap, path, path.motion);
        const DoubleMask overlaps = met.t <= Doubles(0.0), touches = (met.t <= Doubles(1.0)) & !overlaps;
        c.answer(touches, overlaps, met.t, centre - normal * radius, normal);
    }
};

struct CapsuleAtSegment {
    static HWY_INLINE void sweep(Columns& c) {
        const Doubles3 a = c.vector(0), b = c.vector(3), q = a - c.from, u = b - a, axis = other_end(c) - c.from;
        const Doubles radius = c.number(6);
        c.sure = c.sure & Columns::usual(a) & Columns::usual(b) & Columns::fit(radius) & long_or_none(c.motion);
        const WidePath path = c.path(c.motion, greatest(length(q), length(q + u)) + length(axis), radius);
        const WideTouch met = sweep_segments(path, axis, q, u, c.sure);
        const Doubles3 normal = direction(met.gap, path, met.otherwise);
        c.answer(met.t, c.from + met.on - normal * radius, normal);
    }
};

struct AtBox {
    static HWY_INLINE void sweep(Columns& c) {
        const Doubles3 low = c.vector(0), high = c.vector(3), lower = low - c.from, upper = high - c.from;
        c.sure = c.sure & Columns::usual(low) & Columns::usual(high) & (low.x <= high.x) & (low.y <= high.y) & (low.z <= high.z);
        const Meeting met = sweep_box(c.path(c.motion, farthest(lower, upper), Doubles(0.0)), lower, upper, c.sure);
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
        const Meeting met = sweep_box(c.path(motion, farthest(lower, upper), Doubles(0.0)), lower, upper, c.sure);
        const DoubleMask overlaps = met.t <= Doubles(0.0), touches = (met.t <= Doubles(1.0)) & !overlaps;
        const Doubles3 point = (from + motion * met.t) + met.normal * c.radius;
        c.answer(touches, overlaps, met.t, centre + from_box(point), from_box(met.normal));
    }
};

struct CapsuleAtBox {
    static HWY_INLINE void sweep(Columns& c) {
        const Doubles3 low = c.vector(0), high = c.vector(3), lower = low - c.from, upper = high - c.from, axis = other_end(c) - c.from;
        c.sure = c.sure & Columns::usual(low) & Columns::usual(high) & (low.x <= high.x) & (low.y <= high.y) & (low.z <= high.z) &
                 long_or_none(c.motion);
        const WidePath path = c.path(c.motion, farthest(lower, upper) + length(axis), Doubles(0.0));
        const WideTouch met = WideRod(path, axis, lower, upper).sweep(c.sure);
        c.answer(met.t, clamped(c.from + met.on, low, high), direction(met.gap, path, met.otherwise));
    }
};

struct CapsuleAtTurnedBox {
    static HWY_INLINE void sweep(Columns& c) {
        const Doubles3 centre = c.vector(0), half = c.vector(3), x = c.vector(6), y = c.vector(9), z = c.vector(12);
        const auto in_box = [&](const Doubles3& v) { return Doubles3{dot(x, v), dot(y, v), dot(z, v)}; };
        const auto from_box = [&](const Doubles3& v) { return (x * v.x + y * v.y) + z * v.z; };
        const Doubles3 from = in_box(c.from - centre), axis = in_box(other_end(c) - centre) - from, motion = in_box(c.motion);
        c.sure = c.sure & Columns::usual(centre) & Columns::fit(half.x) & Columns::fit(half.y) & Columns::fit(half.z) & Columns::usual(x) &
                 Columns::usual(y) & Columns::usual(z) & Columns::usual(from) & Columns::usual(axis) & Columns::usual(motion) &
                 long_or_none(motion);
        const Doubles3 lower = -half - from, upper = half - from;
        const WidePath path = c.path(motion, farthest(lower, upper) + length(axis), Doubles(0.0));
        const WideTouch met = WideRod(path, axis, lower, upper).sweep(c.sure);
        const Doubles3 normal = direction(met.gap, path, met.otherwise);
        c.answer(met.t, centre + from_box(clamped(from + met.on, -half, half)), from_box(normal));
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
        const WideFace face(path, chosen(p, q, r), chosen(sides[0], sides[1], sides[2]), -chosen(sides[2], sides[0], sides[1]));
        const Doubles rim = path.radius + face.rim_growth();
        Doubles3 normal = zero3();
        const Doubles on_face = face.sweep_face<FaceKind::Triangle>(path, normal);
        WideMeeting met{on_face, zero3()};
        for (int k = 0; k < 3; ++k) met = earlier(met, sweep_segment(path, rim, corners[k], sides[k], c.sure));
        c.answer(met.t, select(met.t < on_face, direction(met.gap, path, path.motion), normal));
    }
};

struct CapsuleAtTriangle {
    static HWY_INLINE void sweep(Columns& c) {
        const Doubles3 at_a = c.vector(0), at_b = c.vector(3), at_c = c.vector(6), axis = other_end(c) - c.from;
        c.sure = c.sure & Columns::usual(at_a) & Columns::usual(at_b) & Columns::usual(at_c) & long_or_none(c.motion);
        const Doubles3 corners[3] = {at_a - c.from, at_b - c.from, at_c - c.from};
        const Doubles farthest = greatest(greatest(length(corners[0]), length(corners[1])), length(corners[2]));
        const WidePath path = c.path(c.motion, farthest + length(axis), Doubles(0.0));
        const WideTouch met = sweep_prism(path, axis, corners, c.sure);
        c.answer(met.t, c.from + met.on, direction(met.gap, path, met.otherwise));
    }
};

/// Tube of sweep_solid.cpp.
struct WideTube {
    Doubles3 centre, axis;
    Doubles half, radius;

    HWY_INLINE WideTube(const Doubles3& middle, const Doubles3& all, Doubles r) : centre(middle), axis(zero3()), half(0.0), radius(r) {
        const Doubles zero(0.0), longest = greatest_of(abs(all));
        const DoubleMask none_at_all = longest == zero;
        const Doubles3 scaled = over(all, longest);
        const Doubles whole = length(scaled);
        axis = select(none_at_all, zero3(), over(scaled, whole));
        half = select(none_at_all, zero, Doubles(0.5) * longest * whole);
    }
    HWY_INLINE Doubles3 way_to(const Doubles3& p) const {
        const Doubles zero(0.0);
        const Doubles3 from = p - centre;
        const Doubles along = dot(from, axis);
        Doubles3 across = from - axis * along;
        across = across - axis * dot(across, axis);
        const Doubles out = length(across), beside = greatest(out - radius, zero), beyond = greatest(abs(along) - half, zero);
        const Doubles signed_beyond{hn::CopySign(beyond.raw, along.raw)};
        return across * select(out > zero, beside / out, zero) + axis * signed_beyond;
    }
    HWY_INLINE Doubles reach(const Doubles3& n) const {
        const Doubles along = dot(n, axis);
        return dot(n, centre) + half * abs(along) + radius * length(n - axis * along);
    }
};

// As advance() of sweep_solid.cpp, without an axis of A's own.
struct AtTube {
    static constexpr int kMostPlanes = 8;  ///< the few that take more are left to the single call, or all would wait for them

    static HWY_INLINE void sweep(Columns& c) {
        const Doubles zero(0.0), one(1.0);
        const Doubles3 a = c.vector(0), b = c.vector(3);
        c.sure = c.sure & Columns::usual(a) & Columns::usual(b) & Columns::fit(c.number(6));
        const WideTube tube((a - c.from + (b - c.from)) * Doubles(0.5), b - a, c.number(6));
        const WidePath path = c.path(c.motion, length(tube.centre) + tube.half + tube.radius, zero);
        const Doubles slack = path.radius - c.radius, hidden = Doubles(8.0 * 0x1p-52) * length(path.motion);
        DoubleMask active = c.sure, touches = active & !active, overlaps = touches;
        Doubles t = zero, checks = zero;
        Doubles3 normal = zero3();
        for (int k = 0; k < kMostPlanes && !none(active); ++k) {
            const Doubles3 at = path.motion * t;
            const Doubles3 way = tube.way_to(at + zero3());
            const Doubles across = length(way);
            const DoubleMask inside = !(across > zero);
            const Doubles3 n = select(inside, zero3(), over(way, across));
            const Doubles gap = dot(n, at) + zero - tube.reach(n) - path.radius, closing = -dot(n, path.motion) + hidden;
            const Doubles next = t + gap / closing * Doubles(kRounded);
            checks = select(active, checks + one, checks);
            const DoubleMask met = active & (inside | !(gap > slack)), moves = active & !met & (closing > zero) & (next <= one);
            const DoubleMask stays = moves & !(next > t), now = (met & (t > zero)) | stays;
            normal = select(now, -n, normal);
            touches = touches | now;
            overlaps = overlaps | (met & !(t > zero));
            active = moves & !stays;
            t = select(active, next, t);
        }
        c.sure = c.sure & !active;
        c.answer(touches, overlaps, t, (c.from + path.motion * t) + normal * c.radius, normal);
        store(checks, c.rows.out[SweptRows::kChecks] + c.first);
    }
};

template <class Core>
void run(Sweeper a, SweptRows& rows, std::size_t count) {
    for (std::size_t first = 0; first < count; first += static_cast<std::size_t>(kDoubleLanes)) {
        Columns columns(rows, first, a);
        Core::sweep(columns);
    }
}

void SweepLanes(Sweeper a, SweptCore b, SweptRows& rows, std::size_t count) {
    const bool sphere = a == Sweeper::Sphere;
    switch (b) {
        case SweptCore::Plane:
            return sphere ? run<AtPlane<Sweeper::Sphere>>(a, rows, count) : run<AtPlane<Sweeper::Capsule>>(a, rows, count);
        case SweptCore::Point:
            return sphere ? run<AtPoint>(a, rows, count) : run<CapsuleAtPoint>(a, rows, count);
        case SweptCore::Segment:
            return sphere ? run<AtSegment>(a, rows, count) : run<CapsuleAtSegment>(a, rows, count);
        case SweptCore::Box:
            return sphere ? run<AtBox>(a, rows, count) : run<CapsuleAtBox>(a, rows, count);
        case SweptCore::TurnedBox:
            return sphere ? run<AtTurnedBox>(a, rows, count) : run<CapsuleAtTurnedBox>(a, rows, count);
        case SweptCore::Triangle:
            return sphere ? run<AtTriangle>(a, rows, count) : run<CapsuleAtTriangle>(a, rows, count);
        case SweptCore::Tube:
            return run<AtTube>(a, rows, count);
    }
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(SweepLanes);

void sweep_lanes(Sweeper a, SweptCore b, SweptRows& rows, std::size_t count) noexcept {
    if (count == 1) return HWY_STATIC_DISPATCH(SweepLanes)(a, b, rows, count);  // more lanes would only take longer
    HWY_DYNAMIC_DISPATCH(SweepLanes)(a, b, rows, count);
}
}  // namespace carom::detail
#endif
