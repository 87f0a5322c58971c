// Where the outlines of two faces start within each other: a square of half side 1 and a parallelogram, of each lane.
//
//   const Outline b(centre, edge_p, edge_q);       // B's face in the coordinates of A's
//   add_starts_of_b(b, [&](Floats s, Floats t, Floats separation, const Start& start, Ints corner, Ints crossing) { ... });
//   add_starts_of_a(b, ...);
//
// Clipping of a segment by slabs: Liang, Barsky, A New Concept and Method for Line Clipping (1984).

// This guard lets the file through once for each target.
#if defined(CAROM_NARROWPHASE_BOX_OUTLINE_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_NARROWPHASE_BOX_OUTLINE_LANES_HPP
#undef CAROM_NARROWPHASE_BOX_OUTLINE_LANES_HPP
#else
#define CAROM_NARROWPHASE_BOX_OUTLINE_LANES_HPP
#endif

#include <carom/core/lanes.hpp>
#include <carom/narrowphase/detail/box_lanes.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {

using namespace carom::HWY_NAMESPACE;

/// Where an edge, m from -1 to 1, starts within a square.
struct Start {
    Floats m;
    Mask any, corner;  ///< it starts at its own corner; otherwise it crosses the outline
    Mask by_x;         ///< at a side x = -1 or 1
};

/// Edges of direction (x, y), against the square of half side 1.
struct EdgeDirection {
    Floats x, y;
    Floats inverse_x, inverse_y;  ///< less the inverses
    Floats reach_x, reach_y;      ///< how far an edge through the middle stays inside

    /// @param over_x, over_y  the inverses of their sizes.
    HWY_INLINE EdgeDirection(Floats x_, Floats y_, Floats over_x, Floats over_y)
        : x(x_),
          y(y_),
          inverse_x(copy_sign(over_x, -x)),
          inverse_y(copy_sign(over_y, -y)),
          reach_x(Floats(1.0f + kWideInside) * over_x),
          reach_y(Floats(1.0f + kWideInside) * over_y) {}

    /// Of the edge whose middle is (at_x, at_y), walked forwards or backwards. No number is NaN where there is a start.
    template <bool forwards>
    HWY_INLINE Start start(Floats at_x, Floats at_y) const {
        const Floats one(1.0f), middle_x = at_x * inverse_x, middle_y = at_y * inverse_y;
        const Floats in_x = middle_x - reach_x, out_x = middle_x + reach_x, in_y = middle_y - reach_y, out_y = middle_y + reach_y;
        const Floats in = max(in_y, max(in_x, -one)), out = min(out_y, min(out_x, one));
        if constexpr (forwards) return {in, in <= out, in == -one, in_x > in_y};
        return {out, in <= out, out == one, out_x < out_y};
    }
    /// @return of sides -1 and 1 of x or y, whichever `start` is at: whether it is the one at -1.
    template <bool forwards>
    HWY_INLINE Mask starts_below(const Start& start) const {
        const Mask rises = select(start.by_x, x > Floats(0.0f), y > Floats(0.0f));
        return forwards ? rises : !rises;
    }
};

/// B's face as A's square sees it. Its corners come the same way round as the square's: its axis q is turned round where they do not.
struct Outline {
    Floats3 centre, p, q;
    Floats area;  ///< over the square's; it is not small: both faces look along the normal
    Mask turned;
    Ints q_plus, q_minus;                       ///< B's edges at q = 1 and -1; those at p = 1 and -1 are 3 and 1
    Floats over_px, over_py, over_qx, over_qy;  ///< inverses of sizes

    /// @param centre_, p_, q_  s, t and separation from A's: of the centre, and of the half edges.
    HWY_INLINE Outline(const Floats3& centre_, const Floats3& p_, const Floats3& q_)
        : centre(centre_), p(p_), q(q_), area(p.x * q.y - p.y * q.x), turned(area < Floats(0.0f)) {
        const Floats one(1.0f);
        q = select(turned, -one, one) * q;
        area = abs(area);
        q_plus = select(turned, Ints(2), Ints(0)), q_minus = select(turned, Ints(0), Ints(2));
        // One division for two. What has hardly any extent in a direction crosses nothing there.
        const Floats least(1e-12f);
        const Floats px = max(abs(p.x), least), py = max(abs(p.y), least), qx = max(abs(q.x), least), qy = max(abs(q.y), least);
        const Floats over_p = one / (px * py), over_q = one / (qx * qy);
        over_px = over_p * py, over_py = over_p * px, over_qx = over_q * qy, over_qy = over_q * qx;
    }
    HWY_INLINE Ints corner(int k) const { return select(turned, Ints(3 - k), Ints(k)); }
};

/// Calls add(s, t, separation, start, corner, crossing) for the starts of B's four edges in A's square.
template <class Add>
HWY_INLINE void add_starts_of_b(const Outline& b, const Add& add) {
    const EdgeDirection along_p(b.p.x, b.p.y, b.over_px, b.over_py), along_q(b.q.x, b.q.y, b.over_qx, b.over_qy);
    const auto walk = [&]<bool forwards>(const Floats3& middle, const Floats3& way, const EdgeDirection& along, Ints corner, Ints edge)
        __attribute__((always_inline)) {
        const Start start = along.start<forwards>(middle.x, middle.y);
        const Floats3 at = middle + start.m * way;
        const Ints side = select(along.starts_below<forwards>(start), Ints(4), Ints(0)) + select(start.by_x, Ints(0), Ints(8));
        add(at.x, at.y, at.z, start, corner, (Ints(kCrossing) + side) + edge);
    };
    walk.template operator()<false>(b.centre + b.q, b.p, along_p, b.corner(0), b.q_plus);
    walk.template operator()<false>(b.centre - b.p, b.q, along_q, b.corner(1), Ints(1));
    walk.template operator()<true>(b.centre - b.q, b.p, along_p, b.corner(2), b.q_minus);
    walk.template operator()<true>(b.centre + b.p, b.q, along_q, b.corner(3), Ints(3));
}

/// The same of A's four edges in B's face, which is a square too in its own coordinates.
template <class Add>
HWY_INLINE void add_starts_of_a(const Outline& b, const Add& add) {
    const Floats3 &c = b.centre, &p = b.p, &q = b.q;
    const Floats inverse = Floats(1.0f) / b.area;
    const EdgeDirection along_s(q.y * inverse, -p.y * inverse, b.area * b.over_qy, b.area * b.over_py);
    const EdgeDirection along_t(-q.x * inverse, p.x * inverse, b.area * b.over_qx, b.area * b.over_px);
    const Floats rise_s = along_s.x * p.z + along_s.y * q.z, rise_t = along_t.x * p.z + along_t.y * q.z;
    const auto walk = [&]<bool forwards>(float s, float t, const EdgeDirection& along, Floats rise, int corner, int side)
        __attribute__((always_inline)) {
        const Floats ds = Floats(s) - c.x, dt = Floats(t) - c.y;
        const Floats x = (ds * q.y - dt * q.x) * inverse, y = (p.x * dt - p.y * ds) * inverse;
        const Start start = along.start<forwards>(x, y);
        const Floats separation = (c.z + (x * p.z + y * q.z)) + start.m * rise;
        const Mask below = along.starts_below<forwards>(start);
        const Ints edge = select(start.by_x, select(below, Ints(1), Ints(3)), select(below, b.q_minus, b.q_plus));
        add(s == 0.0f ? start.m : Floats(s), t == 0.0f ? start.m : Floats(t), separation, start, Ints(kCornerOfA + corner),
            Ints(kCrossing + 4 * side) + edge);
    };
    walk.template operator()<false>(0.0f, 1.0f, along_s, rise_s, 0, 2);
    walk.template operator()<false>(-1.0f, 0.0f, along_t, rise_t, 1, 1);
    walk.template operator()<true>(0.0f, -1.0f, along_s, rise_s, 2, 3);
    walk.template operator()<true>(1.0f, 0.0f, along_t, rise_t, 3, 0);
}

}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
