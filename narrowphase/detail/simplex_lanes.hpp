// The step of GJK for many pairs: a support point joins each lane's simplex, and what is nearest to the origin stays.
//
//   WideSimplex simplex;                      // of three corners at most
//   const WideStep step = advance(simplex, point, error);
//   simplex where step.goes_on, v = step.nearest

// This guard lets the file through once for each target.
#if defined(CAROM_NARROWPHASE_SIMPLEX_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_NARROWPHASE_SIMPLEX_LANES_HPP
#undef CAROM_NARROWPHASE_SIMPLEX_LANES_HPP
#else
#define CAROM_NARROWPHASE_SIMPLEX_LANES_HPP
#endif

#include <carom/core/lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {

using namespace carom::HWY_NAMESPACE;

/// A point of the difference b - a, with the numbers of its points.
struct WideCorner {
    Floats3 w;
    Ints a, b;
    HWY_INLINE WideCorner(const Floats3& point, Ints of_a, Ints of_b) : w(point), a(of_a), b(of_b) {}
};
HWY_INLINE WideCorner select(Mask m, const WideCorner& yes, const WideCorner& no) {
    return WideCorner(select(m, yes.w, no.w), select(m, yes.a, no.a), select(m, yes.b, no.b));
}

struct WideSimplex {
    WideCorner corner[3];
    Ints count;
};

struct WideStep {
    WideSimplex simplex;  ///< the corners that hold the nearest point; the new one is the last
    Floats3 nearest;      ///< to the origin
    Floats nearest_sq;
    Mask holds;           ///< the tetrahedron holds the origin, as far as signs say
    Mask surely;          ///< and does so deeper than the error
};

namespace simplex_detail {

// The best part so far, all of them with the new corner q.
struct Best {
    Floats3 v;
    Floats sq;
    Mask keep[3];

    HWY_INLINE void offer(Mask valid, const Floats3& point, int i, int j) {
        const Floats point_sq = dot(point, point);
        const Mask better = valid & (point_sq < sq);
        v = select(better, point, v);
        sq = select(better, point_sq, sq);
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) keep[k] = k == i || k == j ? keep[k] | better : keep[k] & (!better);
    }
};

// Which side of a face the origin is on, seen from the opposite corner.
struct Sides {
    Mask holds, surely;

    /// @param n  the face's normal; `to_origin` and `to_opposite` lead there from a point of the face. `product` is that of the lengths of the
    /// face's sides and of the way to the origin, of which n . to_origin errs by 16 roundings.
    HWY_INLINE void face(const Floats3& n, const Floats3& to_origin, const Floats3& to_opposite, Floats error, Floats product) {
        const Floats origin = dot(n, to_origin), opposite = dot(n, to_opposite);
        const Floats zero(0.0f);
        holds = holds & (((origin > zero) & (opposite > zero)) | ((origin < zero) & (opposite < zero)));
        const Floats slack = error * length(n) + Floats(0x1p-20f) * product;
        surely = surely & (abs(origin) > slack) & (abs(opposite) > slack);
    }
};

}  // namespace simplex_detail

HWY_INLINE WideStep advance(const WideSimplex& s, const WideCorner& q, Floats error) {
    const Mask has[3] = {s.count > Ints(0), s.count > Ints(1), s.count > Ints(2)};
    const Floats zero(0.0f);
    const Floats3 e[3] = {s.corner[0].w - q.w, s.corner[1].w - q.w, s.corner[2].w - q.w};
    Floats m[3], d[3];
    const Mask never = s.count < Ints(0);
    simplex_detail::Best best{q.w, dot(q.w, q.w), {never, never, never}};
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        m[i] = dot(e[i], e[i]);
        d[i] = -dot(e[i], q.w);
        best.offer(has[i] & (d[i] > zero) & (d[i] < m[i]), q.w + (d[i] / m[i]) * e[i], i, i);
    }
    const Floats q_sq = dot(q.w, q.w);
    simplex_detail::Sides sides{has[2], has[2]};
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const Floats between = dot(e[i], e[j]), det = m[i] * m[j] - between * between;
        const Floats along_i = d[i] * m[j] - d[j] * between, along_j = d[j] * m[i] - d[i] * between;
        const Mask inside = (along_i > zero) & (along_j > zero) & (along_i + along_j < det);
        const Floats share = Floats(1.0f) / det;
        best.offer(has[i] & has[j] & inside, q.w + (along_i * share) * e[i] + (along_j * share) * e[j], i, j);
        sides.face(cross(e[i], e[j]), -q.w, e[k], error, sqrt(m[i] * m[j] * q_sq));
    }
    const Floats3 u = e[1] - e[0], v = e[2] - e[0], p = s.corner[0].w;
    sides.face(cross(u, v), -p, -e[0], error, sqrt(dot(u, u) * dot(v, v) * dot(p, p)));

    const Mask two = (best.keep[0] & best.keep[1]) | (best.keep[1] & best.keep[2]) | (best.keep[2] & best.keep[0]);
    const Mask one = best.keep[0] | best.keep[1] | best.keep[2];
    const WideCorner first = select(best.keep[0], s.corner[0], select(best.keep[1], s.corner[1], select(best.keep[2], s.corner[2], q)));
    const WideCorner second = select(two, select(best.keep[0] & best.keep[1], s.corner[1], s.corner[2]), q);
    return {{{first, second, q}, select(two, Ints(3), select(one, Ints(2), Ints(1)))},
            best.v,
            best.sq,
            sides.holds,
            sides.holds & sides.surely};
}

}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
