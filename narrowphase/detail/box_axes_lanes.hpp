// Which of fifteen axes two boxes are farthest apart along, a pair a lane.
//
//   BestAxis best = best_axis(pair);   // best.apart, best.code, best.separation

// This guard lets the file through once for each target.
#if defined(CAROM_NARROWPHASE_BOX_AXES_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_NARROWPHASE_BOX_AXES_LANES_HPP
#undef CAROM_NARROWPHASE_BOX_AXES_LANES_HPP
#else
#define CAROM_NARROWPHASE_BOX_AXES_LANES_HPP
#endif

#include <carom/core/lanes.hpp>
#include <carom/narrowphase/detail/box_lanes.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <limits>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {

using namespace carom::HWY_NAMESPACE;

/// Two boxes in the frame of the first, as in BoxPairBlock.
struct WidePair {
    Floats3 half_a, half_b;
    Floats3 rotation[3];
    Floats3 offset;
    Floats margin;
};
// The same, to be counted through.
struct PairNumbers {
    Floats a[3], b[3], t[3], r[3][3], size[3][3];  // size: of r
};

struct BestAxis {
    Floats separation;
    Ints code;
    Mask apart;
};

// The best axes so far.
struct AxisSearch {
    Floats separation;  // along a normal of a face
    Ints code;
    // Square of the separation along a product of edges, with its sign, as a fraction: so one root and one division are taken for all nine.
    Floats edge_square, edge_length_sq;
    Ints edge_code;

    HWY_INLINE void face(Floats s, int number) {
        const Mask better = s > separation;
        separation = select(better, s, separation);
        code = select(better, Ints(number), code);
    }
    /// @param s  times the length of the product.
    HWY_INLINE void edge(Floats s, Floats length_sq, int number) {
        const Floats square = s * abs(s);
        const Mask is_axis = length_sq > Floats(static_cast<float>(kParallelSine * kParallelSine));
        const Mask better = is_axis & (square * edge_length_sq > edge_square * length_sq);
        edge_square = select(better, square, edge_square);
        edge_length_sq = select(better, length_sq, edge_length_sq);
        edge_code = select(better, Ints(number), edge_code);
    }
    /// Of a square beyond the range of floats nothing is known: faces decide alone.
    HWY_INLINE Floats edge_separation() const {
        const Floats square = edge_square / edge_length_sq, size = sqrt(abs(square)), never(std::numeric_limits<float>::infinity());
        return select(square < never, select(square < Floats(0.0f), -size, size), -never);
    }
};

HWY_INLINE void try_faces(const PairNumbers& p, AxisSearch& best) {
    const auto& [a, b, t, r, size] = p;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        best.face(abs(t[i]) - (a[i] + ((size[i][0] * b[0] + size[i][1] * b[1]) + size[i][2] * b[2])), i);
    }
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) {
        const Floats along = (r[0][j] * t[0] + r[1][j] * t[1]) + r[2][j] * t[2];
        best.face(abs(along) - (b[j] + ((size[0][j] * a[0] + size[1][j] * a[1]) + size[2][j] * a[2])), kFirstFaceOfB + j);
    }
}

HWY_INLINE void try_edges(const PairNumbers& p, AxisSearch& best) {
    const auto& [a, b, t, r, size] = p;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        const auto minor = [&, &rows = r](int j, int k) { return abs(rows[i1][j] * rows[i2][k] - rows[i2][j] * rows[i1][k]); };
        const Floats minors[3] = {minor(1, 2), minor(2, 0), minor(0, 1)};
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            // e_i x b_j has no component along i, and its products with the other axes of B are taken as they are, not from B being
            // square, which it is to 2e-7 only. So nothing cancels as the edges become parallel: every term below shrinks with its length
            // and is good to its own last digits.
            const Floats length_sq = r[i1][j] * r[i1][j] + r[i2][j] * r[i2][j];
            const Floats reach = (a[i1] * size[i2][j] + a[i2] * size[i1][j]) + (b[j1] * minors[j2] + b[j2] * minors[j1]);
            const Floats along = abs(t[i2] * r[i1][j] - t[i1] * r[i2][j]);
            best.edge(along - reach, length_sq, kFirstEdge + 3 * i + j);
        }
    }
}

HWY_INLINE BestAxis best_axis(const WidePair& p) {
    const auto& [r0, r1, r2] = p.rotation;
    const PairNumbers n{{p.half_a.x, p.half_a.y, p.half_a.z},
                        {p.half_b.x, p.half_b.y, p.half_b.z},
                        {p.offset.x, p.offset.y, p.offset.z},
                        {{r0.x, r0.y, r0.z}, {r1.x, r1.y, r1.z}, {r2.x, r2.y, r2.z}},
                        {{abs(r0.x), abs(r0.y), abs(r0.z)}, {abs(r1.x), abs(r1.y), abs(r1.z)}, {abs(r2.x), abs(r2.y), abs(r2.z)}}};
    const Floats most = max(max(max(n.a[0], n.a[1]), n.a[2]), max(max(n.b[0], n.b[1]), n.b[2]));
    const Floats limit = p.margin + Floats(kWideRounding) * most;
    const Floats never(-std::numeric_limits<float>::infinity());
    AxisSearch best{never, Ints(kApart), never, Floats(1.0f), Ints(kApart)};
    try_faces(n, best);
    try_edges(n, best);
    const Floats edge_separation = best.edge_separation();
    const Mask apart = max(best.separation, edge_separation) > limit;
    const Mask by_edge = edge_separation > best.separation + Floats(kWidePreference) * most;
    return {select(by_edge, edge_separation, best.separation), select(apart, Ints(kApart), select(by_edge, best.edge_code, best.code)),
            apart};
}

}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
