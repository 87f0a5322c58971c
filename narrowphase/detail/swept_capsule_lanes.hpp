// A moving capsule against a box along the axes, in lanes: its centre line's start, a point, against the box swept along the line backward, grown by the radius.
// That solid's boundary is of the box at either end of the line, of parallelograms that the box's edges sweep, one of four for each of the three
// directions on either side, and of segments that its corners sweep.

// This guard lets the file through once for each target.
#if defined(CAROM_NARROWPHASE_SWEPT_CAPSULE_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_NARROWPHASE_SWEPT_CAPSULE_LANES_HPP
#undef CAROM_NARROWPHASE_SWEPT_CAPSULE_LANES_HPP
#else
#define CAROM_NARROWPHASE_SWEPT_CAPSULE_LANES_HPP
#endif

#include <carom/narrowphase/detail/swept_box_lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {

HWY_INLINE DoubleMask select_mask(DoubleMask m, DoubleMask yes, DoubleMask no) { return (m & yes) | ((!m) & no); }

/// When a part is met. @param gap  towards it, of a length that direction() takes for one; @param otherwise  what is taken where it has none;
/// @param on  B's point.
struct WideTouch {
    Doubles t;
    Doubles3 gap, otherwise, on;
};
HWY_INLINE WideTouch earlier(const WideTouch& a, const WideTouch& b) {
    const DoubleMask second = b.t < a.t;
    return {select(second, b.t, a.t), select(second, b.gap, a.gap), select(second, b.otherwise, a.otherwise), select(second, b.on, a.on)};
}

/// Lines of one direction as the moving point sees them, by what is square to it. A line through q is met at the root of a quadratic whose numbers are
/// q . across and q . back: exact for lines that are off by eps |q|.
struct WideDirection {
    Doubles3 along, across, back;
    Doubles whole, speed_sq, inverse, falls;
    DoubleMask has, moves;  ///< it has a length; the motion is not along it

    HWY_INLINE WideDirection(const WidePath& path, const Doubles3& u)
        : along(zero3()), across(zero3()), back(zero3()), whole(length(u)), has(whole > Doubles(kShortSegment)), moves(has) {
        along = u * (Doubles(1.0) / whole);
        across = cross(path.motion, along);
        across = across - along * dot(across, along);  // what rounding left along it would tell as a distance
        back = cross(along, across);
        speed_sq = dot(across, across);
        moves = speed_sq > Doubles(0.0);
        inverse = Doubles(1.0) / speed_sq;
        falls = dot(path.motion, along);
    }
    HWY_INLINE DoubleMask sure() const { return (!has) | long_or_none(across); }
};

/// The first of the segments and points that a moving point comes to within a radius.
struct WideRims {
    Doubles t;
    Doubles3 at, on;  ///< the point of the rim, and B's: the two differ by what of A's line is before it

    HWY_INLINE WideRims() : t(kNoContact), at(zero3()), on(zero3()) {}

    /// q + s along, 0 <= s <= its length; what goes past an end inside of the radius is the ends'.
    /// @param start, kMoves  B's point: start, or start + s along.
    template <bool kMoves>
    HWY_INLINE void segment(const WideDirection& e, const Doubles3& q, Doubles radius, const Doubles3& start) {
        const Doubles zero(0.0), turn = dot(q, e.across), away = dot(q, e.back), square = radius * radius;
        const Doubles room = square * e.speed_sq - turn * turn, root = sqrt(room);
        Doubles when = greatest((away - root) * e.inverse * Doubles(kRounded), zero);
        DoubleMask meets = e.has & (room >= zero) & (away + root >= zero) & (when <= Doubles(1.0));
        const DoubleMask stands = e.has & !e.moves;
        if (!none(stands)) {
            const Doubles3 beside = cross(q, e.along);
            meets = meets | (stands & (dot(beside, beside) <= square));
            when = select(stands, zero, when);
        }
        const Doubles s = when * e.falls - dot(q, e.along);
        const DoubleMask first = meets & (s >= zero) & (s <= e.whole) & (when < t);
        if (none(first)) return;
        const Doubles3 way = e.along * s;
        t = select(first, when, t);
        at = select(first, q + way, at);
        on = select(first, kMoves ? start + way : start, on);
    }
    /// @param dd, inverse  the motion's square, and one over it.
    HWY_INLINE void point(const WidePath& path, Doubles dd, Doubles inverse, const Doubles3& q, Doubles radius, const Doubles3& of_b) {
        const Doubles zero(0.0), square = radius * radius;
        const Doubles3 aside = cross(q, path.motion);
        const Doubles room = square * dd - dot(aside, aside), along = dot(q, path.motion), root = sqrt(room);
        const DoubleMask moves = dd > zero;
        const Doubles when = select(moves, greatest((along - root) * inverse * Doubles(kRounded), zero), zero);
        const DoubleMask meets = (moves & (room >= zero) & (along + root >= zero)) | ((!moves) & (dot(q, q) <= square));
        const DoubleMask first = meets & (when <= Doubles(1.0)) & (when < t);
        if (none(first)) return;
        t = select(first, when, t);
        at = select(first, q, at);
        on = select(first, of_b, on);
    }
};

/// WideFace with two quotients in all, which are what faces cost here. What is met is told by the shares of its sides, both times the square of its area.
struct WideSide {
    Doubles3 q, u, v, area, normal;
    Doubles twice, slack, rim, rim_u, rim_v;
    DoubleMask needle;

    HWY_INLINE WideSide(const WidePath& path, const Doubles3& at, const Doubles3& side_u, const Doubles3& side_v)
        : q(at), u(side_u), v(side_v), area(cross(u, v)), normal(zero3()), twice(length(area)), needle(twice < twice) {
        const Doubles zero(0.0), length_u = length(u), length_v = length(v), inverse = Doubles(1.0) / twice, growth(kGrowth);
        const Doubles product = length_u * length_v, longest = greatest(length_u, length_v);
        needle = (longest < Doubles(kShortFace)) | !(growth * path.size * product * longest < twice * twice);
        normal = area * inverse;
        slack = growth * (product * inverse) * path.size;
        rim = Doubles(2.0) * slack;
        if (!none(needle)) {  // as SweepFace::rim_growth()
            const Doubles width = select(longest > zero, twice / longest + growth * least(length_u, length_v), zero);
            rim = select(needle, width, rim);
        }
        rim_u = slack * twice * length_u, rim_v = slack * twice * length_v;
    }
    /// As WideFace::sweep_face(). @param by  from the face to where it is swept; @param r  the share of u, times the square of the area.
    template <FaceKind kKind>
    HWY_INLINE Doubles sweep(const WidePath& path, const Doubles3& at, Doubles3& towards, Doubles& r) const {
        const Doubles zero(0.0), radius = path.radius + Doubles(0.5) * slack, over_face = -dot(normal, at);
        const DoubleMask below = over_face < zero;
        towards = select(below, normal, -normal);
        const Doubles height = select(below, -over_face, over_face), fall = dot(towards, path.motion);
        const DoubleMask above = height > radius;
        const Doubles reached = (height - radius) / fall * Doubles(kRounded), t = select(above, reached, zero);
        const DoubleMask comes = (!above) | ((fall > zero) & (reached <= Doubles(1.0)));
        const Doubles3 p = path.motion * t - at;
        r = dot(cross(p, v), area);
        const Doubles s = dot(cross(u, p), area), whole = twice * twice;
        const DoubleMask within_both =
            kKind == FaceKind::Triangle ? r + s <= whole + rim_v + rim_u : (r <= whole + rim_v) & (s <= whole + rim_u);
        const DoubleMask inside = (r >= -rim_v) & (s >= -rim_u) & within_both;
        return select((!needle) & comes & inside, t, Doubles(kNoContact));
    }
};

/// The first of the faces that A's line sweeps with edges of B.
struct WideSides {
    Doubles t, share, whole;
    Doubles3 towards, q, u;

    HWY_INLINE WideSides() : t(kNoContact), share(0.0), whole(1.0), towards(zero3()), q(zero3()), u(zero3()) {}
    HWY_INLINE void sweep(const WidePath& path, const WideSide& side) {
        Doubles3 normal = zero3();
        Doubles r(0.0);
        const Doubles when = side.sweep<FaceKind::Parallelogram>(path, side.q, normal, r);
        const DoubleMask first = when < t;
        t = select(first, when, t), share = select(first, r, share), whole = select(first, side.twice * side.twice, whole);
        towards = select(first, normal, towards), q = select(first, side.q, q), u = select(first, side.u, u);
    }
    HWY_INLINE WideTouch touch(const WidePath& path) const {
        const Doubles of_u = least(greatest(share / whole, Doubles(0.0)), Doubles(1.0));
        return {t, towards * path.size, path.motion, q + u * of_u};
    }
};

HWY_INLINE WideTouch first_of(const WidePath& path, const WideTouch& faces, const WideRims& rims) {
    return earlier(faces, {rims.t, rims.at - path.motion * rims.t, path.motion, rims.on});
}

/// A capsule against the segment q, q + u.
HWY_INLINE WideTouch sweep_segments(const WidePath& path, const Doubles3& axis, const Doubles3& q, const Doubles3& u, DoubleMask& sure) {
    const WideSide side(path, q, u, -axis);
    WideSides sides;
    sides.sweep(path, side);
    const WideDirection along_u(path, u), along_axis(path, -axis);
    sure = sure & along_u.sure() & along_axis.sure();
    const Doubles rim = path.radius + side.rim, ends = rim + Doubles(kGrowth) * path.size;
    const Doubles dd = dot(path.motion, path.motion), inverse = Doubles(1.0) / dd;
    const Doubles3 far = q + u;
    WideRims rims;
    rims.segment<true>(along_u, q, rim, q);
    rims.segment<true>(along_u, q - axis, rim, q);
    rims.segment<false>(along_axis, q, rim, q);
    rims.segment<false>(along_axis, far, rim, far);
    rims.point(path, dd, inverse, q, ends, q);
    rims.point(path, dd, inverse, q - axis, ends, q);
    rims.point(path, dd, inverse, far, ends, far);
    rims.point(path, dd, inverse, far - axis, ends, far);
    return first_of(path, sides.touch(path), rims);
}

/// A capsule against a triangle: the prism of the triangle and A's line.
HWY_INLINE WideTouch sweep_prism(const WidePath& path, const Doubles3& axis, const Doubles3 (&corners)[3], DoubleMask& sure) {
    const Doubles zero(0.0);
    const Doubles3 &p = corners[0], &q = corners[1], &r = corners[2], sides[3] = {q - p, r - q, p - r};
    const Doubles of_c = dot(sides[0], sides[0]), of_a = dot(sides[1], sides[1]), of_b = dot(sides[2], sides[2]);
    const DoubleMask from_a = (of_a >= of_b) & (of_a >= of_c), from_b = (!from_a) & (of_b >= of_c);
    const auto chosen = [&](const Doubles3& a, const Doubles3& b, const Doubles3& other) {
        return select(from_a, a, select(from_b, b, other));
    };
    const WideSide cap(path, chosen(p, q, r), chosen(sides[0], sides[1], sides[2]), -chosen(sides[2], sides[0], sides[1]));
    const Doubles3& n = cap.normal;
    const Doubles height = -dot(n, cap.q), depth = dot(n, axis);  // of the start over one end, and how far below is the other
    const DoubleMask thick = abs(depth) > cap.slack;
    sure = sure & !cap.needle;
    DoubleMask inside =
        thick & select_mask(depth > zero, (height <= zero) & (height + depth >= zero), (height >= zero) & (height + depth <= zero));
    const WideSide walls[3] = {{path, p, sides[0], -axis}, {path, q, sides[1], -axis}, {path, r, sides[2], -axis}};
    Doubles rim_all = cap.rim;
    WideSides faces;
    for (int k = 0; k < 3; ++k) {
        const WideSide& wall = walls[k];
        sure = sure & !(wall.needle & thick);  // what a needle tells of the inside is nothing to go by
        const Doubles start = -dot(wall.area, wall.q), third = dot(wall.area, corners[(k + 2) % 3] - wall.q);
        inside = inside & select_mask(third > zero, start >= zero, start <= zero);
        rim_all = greatest(rim_all, wall.rim);
        faces.sweep(path, wall);
    }
    // The nearer end. Where they lie in one plane, what one of them leaves out of the other an edge sweeps.
    const Doubles3 by = select(abs(height + depth) < abs(height), -axis, zero3());
    Doubles3 towards = zero3();
    Doubles share(0.0);
    const Doubles on_cap = cap.sweep<FaceKind::Triangle>(path, cap.q + by, towards, share);
    const Doubles3 below = path.motion * on_cap - by;
    WideTouch first = earlier(faces.touch(path), {on_cap, towards * path.size, path.motion, below - n * dot(n, below - cap.q)});
    const WideDirection along_axis(path, -axis);
    sure = sure & along_axis.sure();
    const Doubles rim_axis = path.radius + rim_all, ends = rim_axis + Doubles(kGrowth) * path.size;
    const Doubles dd = dot(path.motion, path.motion), inverse = Doubles(1.0) / dd;
    WideRims rims;
    for (int k = 0; k < 3; ++k) {
        const Doubles3 &at = corners[k], other = at - axis;
        const WideDirection side(path, sides[k]);
        sure = sure & side.sure();
        const Doubles rim = path.radius + greatest(cap.rim, walls[k].rim);
        rims.segment<true>(side, at, rim, at);
        rims.segment<true>(side, other, rim, at);
        rims.segment<false>(along_axis, at, rim_axis, at);
        rims.point(path, dd, inverse, at, ends, at);
        rims.point(path, dd, inverse, other, ends, at);
    }
    first = first_of(path, first, rims);
    first.t = select(inside, zero, first.t);
    return first;
}

/// Segments of one direction from all corners of a box: sums of what each of the three coordinates adds.
struct WideEdges : WideDirection {
    Doubles3 turns[2], backs[2], shares[2];  ///< turns[0].x: of lower.x, and so on

    HWY_INLINE WideEdges(const WidePath& path, const Doubles3& axis, const Doubles3& lower, const Doubles3& upper)
        : WideDirection(path, axis), turns{zero3(), zero3()}, backs{zero3(), zero3()}, shares{zero3(), zero3()} {
        const auto times = [](const Doubles3& a, const Doubles3& b) { return Doubles3{a.x * b.x, a.y * b.y, a.z * b.z}; };
        turns[0] = times(across, lower), turns[1] = times(across, upper);
        backs[0] = times(back, lower), backs[1] = times(back, upper);
        shares[0] = times(along, lower), shares[1] = times(along, upper);
    }
    static HWY_INLINE Doubles sum(const Doubles3 (&of)[2], unsigned corner) {
        return (of[corner & 1u].x + of[corner >> 1 & 1u].y) + of[corner >> 2].z;
    }
};

HWY_INLINE Doubles3 clamped(const Doubles3& p, const Doubles3& low, const Doubles3& high) {
    return {least(greatest(p.x, low.x), high.x), least(greatest(p.y, low.y), high.y), least(greatest(p.z, low.z), high.z)};
}

/// A capsule against a box.
struct WideRod {
    WidePath path;
    Doubles3 axis, lower, upper;
    Doubles slack;  ///< by how much a parallelogram may be off

    HWY_INLINE WideRod(const WidePath& p, const Doubles3& a, const Doubles3& low, const Doubles3& high)
        : path(p), axis(a), lower(low), upper(high), slack(Doubles(kGrowth) * p.size) {}

    /// The segments corner - s axis.
    HWY_INLINE WideTouch sweep_corners(DoubleMask& sure) const {
        const Doubles zero(0.0), one(1.0), never(kNoContact), radius = path.radius + Doubles(2.0) * slack, square = radius * radius;
        const WideEdges edges(path, axis, lower, upper);
        sure = sure & edges.sure();
        const Doubles reach = square * edges.speed_sq;
        Doubles t = never;
        Doubles3 on = zero3();
        const DoubleMask stands = edges.has & !edges.moves;
        const bool any_stands = !none(stands);
        for (unsigned corner = 0; corner < 8; ++corner) {
            const Doubles turn = WideEdges::sum(edges.turns, corner), away = WideEdges::sum(edges.backs, corner);
            const Doubles share = WideEdges::sum(edges.shares, corner);
            const Doubles room = reach - turn * turn;
            const Doubles3 q{corner & 1u ? upper.x : lower.x, corner & 2u ? upper.y : lower.y, corner & 4u ? upper.z : lower.z};
            const Doubles root = sqrt(room), at = greatest((away - root) * edges.inverse * Doubles(kRounded), zero);
            DoubleMask meets = edges.has & (room >= zero) & (away + root >= zero) & (at <= one);
            Doubles when = at;
            if (any_stands) {
                const Doubles3 beside = cross(q, edges.along);
                meets = meets | (stands & (dot(beside, beside) <= square));
                when = select(stands, zero, at);
            }
            const Doubles s = share - when * edges.falls;
            const DoubleMask first = meets & (s >= zero) & (s <= edges.whole) & (when < t);
            t = select(first, when, t);
            on = select(first, q, on);
        }
        const Doubles3 gap = on - path.motion * t;
        return {t, gap - edges.along * dot(gap, edges.along), path.motion, on};
    }

    /// Numbers in the order of an edge's direction and the two others.
    struct Turned {
        Doubles k, i, j;
    };
    template <int kAxis>
    static HWY_INLINE Turned turned(const Doubles3& v) {
        if constexpr (kAxis == 0) return {v.x, v.y, v.z};
        if constexpr (kAxis == 1) return {v.y, v.z, v.x};
        return {v.z, v.x, v.y};
    }
    template <int kAxis>
    static HWY_INLINE Doubles3 back(const Turned& v) {
        if constexpr (kAxis == 0) return {v.k, v.i, v.j};
        if constexpr (kAxis == 1) return {v.j, v.k, v.i};
        return {v.i, v.j, v.k};
    }

    /// The parallelogram of the edges along one axis that is towards the start. Its normal is square to an axis, so a turned line without rounding.
    /// @param inside  set to false where the start is before it.
    template <int kAxis>
    HWY_INLINE WideTouch sweep_side(DoubleMask& inside, Doubles whole) const {
        const Doubles zero(0.0), one(1.0), never(kNoContact);
        const Turned a = turned<kAxis>(axis), d = turned<kAxis>(path.motion), low = turned<kAxis>(lower), high = turned<kAxis>(upper);
        const Doubles wide = sqrt(a.i * a.i + a.j * a.j), inverse = one / wide;
        const DoubleMask has = wide > Doubles(kShortSegment);
        Doubles n_i = -(a.j * inverse), n_j = a.i * inverse;
        const DoubleMask under = n_i * (low.i + high.i) + n_j * (low.j + high.j) > zero;
        n_i = select(under, -n_i, n_i), n_j = select(under, -n_j, n_j);
        // Where two edges are as far out, the foremost: of all parallelograms in one plane, so that the two ends of the box and they leave nothing out.
        const DoubleMask far_i = (n_i > zero) | ((n_i == zero) & (a.i < zero)), far_j = (n_j > zero) | ((n_j == zero) & (a.j < zero));
        const Doubles q_i = select(far_i, high.i, low.i), q_j = select(far_j, high.j, low.j);
        const Doubles height = -(n_i * q_i + n_j * q_j), fall = -(n_i * d.i + n_j * d.j);
        inside = inside & ((!has) | (height <= zero));
        const Doubles radius = path.radius + Doubles(0.5) * slack;
        const DoubleMask above = height > radius;
        const Doubles reached = (height - radius) / fall * Doubles(kRounded), t = select(above, reached, zero);
        const DoubleMask comes = select_mask(above, (fall > zero) & (reached <= one), height >= -radius);
        const Doubles p_i = d.i * t - q_i, p_j = d.j * t - q_j, p_k = d.k * t - low.k;
        const Doubles y = -(p_i * a.i + p_j * a.j) * inverse, x = p_k * wide + y * a.k, width = high.k - low.k;
        const Doubles margin = slack * whole;
        const DoubleMask within = (y >= -slack) & (y <= wide + slack) & (x >= -margin) & (x <= width * wide + margin);
        const Doubles on_k = low.k + least(greatest(x * inverse, zero), width);
        return {select(has & comes & within, t, never), back<kAxis>({zero, -n_i * path.size, -n_j * path.size}), path.motion,
                back<kAxis>({on_k, q_i, q_j})};
    }

    HWY_INLINE WideTouch sweep_end(const Doubles3& by, Doubles before, DoubleMask& sure) const {
        WidePath grown = path;
        grown.radius = path.radius + Doubles(3.0) * slack;
        const Doubles3 low = lower + by, high = upper + by;
        const BoxMeeting met = meet_box<true>(grown, low, high, before, sure);
        const Doubles3 p = path.motion * met.t - by;
        return {met.t, select(met.straight, met.face * path.size, met.gap), met.last, clamped(p, lower, upper)};
    }

    HWY_INLINE WideTouch sweep(DoubleMask& sure) const {
        const Doubles zero(0.0), whole = length(axis);
        DoubleMask inside = sure & (lower.x - greatest(axis.x, zero) <= zero) & (upper.x - least(axis.x, zero) >= zero) &
                            (lower.y - greatest(axis.y, zero) <= zero) & (upper.y - least(axis.y, zero) >= zero) &
                            (lower.z - greatest(axis.z, zero) <= zero) & (upper.z - least(axis.z, zero) >= zero);
        WideTouch first = sweep_side<0>(inside, whole);
        first = earlier(first, sweep_side<1>(inside, whole));
        first = earlier(first, sweep_side<2>(inside, whole));
        first = earlier(first, sweep_corners(sure));
        first.t = select(inside, zero, first.t);
        first = earlier(first, sweep_end(zero3(), first.t, sure));
        first = earlier(first, sweep_end(-axis, first.t, sure));
        return first;
    }
};

}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
