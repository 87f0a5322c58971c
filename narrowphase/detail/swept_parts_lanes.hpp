// The parts of sweep_parts.cpp in lanes: a point that moves from the origin against points, segments, faces and boxes, grown by a radius.

// This guard lets the file through once for each target.
#if defined(CAROM_NARROWPHASE_SWEPT_PARTS_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_NARROWPHASE_SWEPT_PARTS_LANES_HPP
#undef CAROM_NARROWPHASE_SWEPT_PARTS_LANES_HPP
#else
#define CAROM_NARROWPHASE_SWEPT_PARTS_LANES_HPP
#endif

#include <carom/core/lanes_doubles.hpp>
#include <carom/narrowphase/detail/sweep_parts.hpp>

#include <limits>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {

using namespace carom::HWY_NAMESPACE;

HWY_INLINE Doubles3 zero3() { return {Doubles(0.0), Doubles(0.0), Doubles(0.0)}; }
HWY_INLINE Doubles3 over(const Doubles3& v, Doubles s) { return {v.x / s, v.y / s, v.z / s}; }
HWY_INLINE Doubles least(Doubles a, Doubles b) { return select(b < a, b, a); }     // as std::min
HWY_INLINE Doubles greatest(Doubles a, Doubles b) { return select(a < b, b, a); }  // as std::max
HWY_INLINE Doubles length(const Doubles3& v) { return sqrt(dot(v, v)); }
HWY_INLINE Doubles3 abs(const Doubles3& v) { return {abs(v.x), abs(v.y), abs(v.z)}; }
HWY_INLINE Doubles greatest_of(const Doubles3& v) { return greatest(greatest(v.x, v.y), v.z); }

struct WidePath {
    Doubles3 motion;
    Doubles radius, size;
};

struct WideSpan {
    Doubles from, to;
};

/// Where a part is first met: at kNoContact where it is not. @param gap  from the moving point to the part then.
struct WideMeeting {
    Doubles t;
    Doubles3 gap;
};
HWY_INLINE WideMeeting earlier(const WideMeeting& a, const WideMeeting& b) {
    const DoubleMask second = b.t < a.t;
    return {select(second, b.t, a.t), select(second, b.gap, a.gap)};
}

/// @return motions whose squares do not underflow: what within() may be asked for, and none at all.
HWY_INLINE DoubleMask long_or_none(const Doubles3& d) {
    const Doubles largest = greatest_of(abs(d));
    return (largest >= Doubles(kShortMotion)) | (largest == Doubles(0.0));
}

HWY_INLINE WideSpan within(const Doubles3& q, const Doubles3& d, Doubles radius) {
    const Doubles zero(0.0), ever(std::numeric_limits<double>::infinity());
    const Doubles dd = dot(d, d), away = length(q);
    const Doubles3 aside = cross(q, d);
    const Doubles room = radius * radius * dd - dot(aside, aside), along = dot(q, d), root = sqrt(room);
    const Doubles product = (away - radius) * (away + radius);
    const DoubleMask leaves = along < zero;
    const DoubleMask comes = along > zero;
    const Doubles sum = select(leaves, along - root, along + root), one = product / sum, other = sum / dd;
    const DoubleMask moves = dd > zero, inside = (!moves) & (away <= radius), meets = moves & (room >= zero);
    const Doubles from = select(comes, one, select(leaves, other, -other)), to = select(leaves, one, other);
    return {select(meets, from, select(inside, -ever, Doubles(kNoContact))), select(meets, to, select(inside, ever, Doubles(-1.0)))};
}

/// What within() tells of times in [0, 1]: when the ball is first met, or kNoContact. With one quotient of its two, since signs tell whether a time is
/// before 0, and what comes no nearer is met now or never. Products and quotients do not underflow, the radius being no less than kLeastGrowth.
HWY_INLINE Doubles first_within(const Doubles3& q, const Doubles3& d, Doubles radius, DoubleMask wanted) {
    const Doubles zero(0.0), dd = dot(d, d);
    const Doubles3 aside = cross(q, d);
    const Doubles room = radius * radius * dd - dot(aside, aside);
    const DoubleMask moves = dd > zero, near = wanted & ((room >= zero) | !moves);
    if (none(near)) return Doubles(kNoContact);
    const Doubles along = dot(q, d), away = length(q);
    const DoubleMask comes = along > zero, passes = moves & !(along < zero);
    const Doubles product = (away - radius) * (away + radius), from = product / (along + sqrt(room));
    const DoubleMask hit = near & (passes | (away <= radius)) & ((!comes) | (from <= Doubles(1.0)));
    return select(hit, select(comes, greatest(from * Doubles(kRounded), zero), zero), Doubles(kNoContact));
}

/// The normal that contact() of sweep_parts.cpp finds.
HWY_INLINE Doubles3 direction(const Doubles3& gap, const WidePath& path, const Doubles3& otherwise) {
    const Doubles across = length(gap), whole = length(otherwise);
    const DoubleMask clear = across > Doubles(1e-9) * path.size;
    const Doubles3 normal = over(select(clear, gap, otherwise), select(clear, across, whole));
    return select(clear | (whole > Doubles(0.0)), normal, zero3());
}

HWY_INLINE WideMeeting sweep_point(const WidePath& path, Doubles radius, const Doubles3& q, DoubleMask wanted) {
    const Doubles t = first_within(q, path.motion, radius, wanted);
    return {t, q - path.motion * t};
}

/// @param sure  set to false where the part of the motion across the segment is too short.
HWY_INLINE WideMeeting sweep_segment(const WidePath& path, Doubles radius, const Doubles3& q, const Doubles3& u, DoubleMask& sure) {
    const Doubles zero(0.0), one(1.0), never(kNoContact);
    const Doubles uu = dot(u, u), whole = sqrt(uu);
    const DoubleMask is_point = !(uu > Doubles(kShortSegment * kShortSegment));
    const Doubles3 along = over(u, whole), across = cross(path.motion, along);
    sure = sure & (is_point | long_or_none(across));
    const Doubles t = first_within(cross(q, along), across, radius, !is_point);
    const DoubleMask round = t <= one;
    if (none(round | is_point)) return {never, zero3()};
    const Doubles3 way = path.motion * t;
    const Doubles s = dot(way - q, along);
    const DoubleMask side = round & (s >= zero) & (s <= whole), at_ends = is_point | (round & !side);
    const WideMeeting first{select(side, t, never), (q + along * s) - way};
    if (none(at_ends)) return first;
    const Doubles ends = select(is_point, radius, radius + Doubles(kGrowth) * path.size);
    return earlier(first, earlier(sweep_point(path, ends, q, at_ends), sweep_point(path, ends, q + u, at_ends & !is_point)));
}

/// SweepFace of sweep_parts.hpp.
struct WideFace {
    Doubles3 q, u, v, area;
    Doubles twice, length_u, length_v, slack;
    DoubleMask needle;

    HWY_INLINE WideFace(const WidePath& path, const Doubles3& at, const Doubles3& side_u, const Doubles3& side_v)
        : q(at),
          u(side_u),
          v(side_v),
          area(cross(u, v)),
          twice(length(area)),
          length_u(length(u)),
          length_v(length(v)),
          needle(twice < twice) {
        const Doubles product = length_u * length_v, longest = greatest(length_u, length_v), growth(kGrowth);
        needle = (longest < Doubles(kShortFace)) | !(growth * path.size * product * longest < twice * twice);
        slack = growth * (product / twice) * path.size;
    }
    HWY_INLINE Doubles rim_growth() const {
        const Doubles two(2.0);
        if (none(needle)) return two * slack;
        const Doubles longest = greatest(length_u, length_v), rounding = Doubles(kGrowth) * least(length_u, length_v);
        const Doubles of_needle = select(longest > Doubles(0.0), twice / longest + rounding, Doubles(0.0));
        return select(needle, of_needle, two * slack);
    }
    /// The inside of the triangle or parallelogram. @param normal  towards it.
    template <FaceKind kKind>
    HWY_INLINE Doubles sweep_face(const WidePath& path, Doubles3& normal) const {
        const Doubles zero(0.0), radius = path.radius + Doubles(0.5) * slack;
        const Doubles3 given = over(area, twice);
        const Doubles over_face = -dot(given, q);
        const DoubleMask below = over_face < zero;
        const Doubles3 n = select(below, -given, given);
        const Doubles height = select(below, -over_face, over_face), fall = -dot(n, path.motion);
        const DoubleMask above = height > radius;
        const Doubles reached = (height - radius) / fall * Doubles(kRounded), t = select(above, reached, zero);
        const DoubleMask comes = (!above) | ((fall > zero) & (reached <= Doubles(1.0)));
        const Doubles3 p = path.motion * t - q;
        const Doubles r = dot(cross(p, v), area), s = dot(cross(u, p), area), whole = twice * twice;
        const Doubles rim_r = slack * twice * length_v, rim_s = slack * twice * length_u;
        const DoubleMask within_both =
            kKind == FaceKind::Triangle ? r + s <= whole + rim_r + rim_s : (r <= whole + rim_r) & (s <= whole + rim_s);
        const DoubleMask inside = (r >= -rim_r) & (s >= -rim_s) & within_both;
        normal = -n;
        return select((!needle) & comes & inside, t, Doubles(kNoContact));
    }
};

struct WideSlab {
    Doubles lower, upper, near, speed, in, out, reaches, leaves;

    HWY_INLINE WideSlab(Doubles d, Doubles low, Doubles high, Doubles radius) : lower(low), upper(high) {
        const Doubles zero(0.0), ever(std::numeric_limits<double>::infinity());
        const DoubleMask moves = abs(d) > Doubles(kHiddenSpeed), forward = d > zero;
        const DoubleMask inside = (low <= zero) & (high >= zero), grown = (low <= radius) & (high >= -radius);
        const Doubles inverse = Doubles(1.0) / d, first = select(forward, low, high), last = select(forward, high, low);
        const Doubles around = radius * abs(inverse), enters = first * inverse, exits = last * inverse;
        near = select(moves, first, select(low > zero, low, high));
        speed = select(moves, d, zero);
        in = select(moves, enters, select(inside, -ever, ever));
        out = select(moves, exits, ever);
        reaches = select(moves, enters - around, select(grown, -ever, ever));
        leaves = select(moves, exits + around, ever);
    }
    HWY_INLINE DoubleMask holds(Doubles t) const { return (in <= t) & (out >= t); }
    HWY_INLINE Doubles clamped(Doubles p) const { return least(greatest(p, lower), upper); }

    /// Where the point is seen from at `from`: q + along t across the box, and when that ends.
    HWY_INLINE void piece(Doubles from, Doubles& end, Doubles& q, Doubles& along) const {
        const Doubles zero(0.0);
        const DoubleMask before = in > from, inside = (!before) & (out > from);
        end = select(before, least(end, in), select(inside, least(end, out), end));
        q = select(inside, zero, select(before, near, select(speed > zero, upper, lower)));
        along = select(inside, zero, speed);
    }
};

struct WideSlabs {
    WideSlab x, y, z;

    HWY_INLINE Doubles3 last_face() const {
        const Doubles zero(0.0);
        const auto moves = [zero](const WideSlab& s) { return !(s.speed == zero); };
        const DoubleMask at_x = moves(x) & (x.in > Doubles(-1.0));
        const Doubles after_x = select(at_x, x.in, Doubles(-1.0));
        const DoubleMask at_y = moves(y) & (y.in > after_x);
        const DoubleMask at_z = moves(z) & (z.in > select(at_y, y.in, after_x));
        return {select(at_x & !(at_y | at_z), x.speed, zero), select(at_y & !at_z, y.speed, zero), select(at_z, z.speed, zero)};
    }

    /// As sweep_pieces() of sweep_parts.cpp. @return the times of the lanes in `active` that meet, else kNoContact.
    HWY_INLINE Doubles sweep_pieces(const WidePath& path, Doubles from, Doubles to, DoubleMask active, DoubleMask& sure) const {
        Doubles t(kNoContact);
        while (!none(active)) {
            Doubles end = to;
            Doubles3 q = zero3(), along = zero3();
            x.piece(from, end, q.x, along.x);
            y.piece(from, end, q.y, along.y);
            z.piece(from, end, q.z, along.z);
            const WideSpan w = within(q, along, path.radius);
            sure = sure & ((!active) | long_or_none(along));
            const DoubleMask meets = active & (w.from <= end) & (w.to >= from);
            t = select(meets, greatest(w.from, from) * Doubles(kRounded), t);
            active = active & (end < to) & !meets;
            from = select(active, end, from);
        }
        return t;
    }
};

}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
