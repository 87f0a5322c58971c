// Pairs of poses to lanes: where B lies in A's frame, in float, sixteen pairs at a time.
//
//   LaneRows<3> rows;
//   for (int lane = 0; lane < kLanes; ++lane) write_place(pairs[lane].place, lane, rows);
//   Placement p = placement_of(rows);   // p.rotation[i][j], p.offset[i], p.fit

// This guard lets the file through once for each target.
#if defined(CAROM_NARROWPHASE_PLACE_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_NARROWPHASE_PLACE_LANES_HPP
#undef CAROM_NARROWPHASE_PLACE_LANES_HPP
#else
#define CAROM_NARROWPHASE_PLACE_LANES_HPP
#endif

#include <carom/core/lanes.hpp>
#include <carom/narrowphase/detail/pair_lanes.hpp>
#include <carom/narrowphase/detail/shape_layout.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {

using namespace carom::HWY_NAMESPACE;

struct Placement {
    Floats rotation[3][3];  ///< [i][j]: component along axis i of A of axis j of B
    Floats offset[3];       ///< from A's origin to B's, along A's axes
    Mask fit;               ///< both orientations are of unit length to 2^-20.5, and the offset is finite
};

// Numbers of each lane on their way to lanes, in columns of four floats: written a lane at a time, read a column of all lanes at a time. They lie as
// transposes take them, so that a column is read by loads of whole vectors, where gather_rows() puts each together from four parts. Reads wait for the
// narrower writes before them to leave the core: write what comes next before reading what was written.
template <int columns>
struct LaneRows {
    static constexpr int kRows = kLanes < 4 ? 4 : kLanes;
    alignas(64) float block[columns * 4 * kRows];

    /// @return where the four floats of a column of a lane go, 16-byte aligned.
    HWY_INLINE float* at(int lane, int column) { return block + (4 * kRows * column + kRows * (lane & 3) + (lane & ~3)); }
    HWY_INLINE void read(int column, Floats& a, Floats& b, Floats& c, Floats& d) const {
        const float* const from = block + 4 * kRows * column;
#if HWY_TARGET == HWY_SCALAR
        a = from[0], b = from[1], c = from[2], d = from[3];
#else
        a = load(from), b = load(from + kLanes), c = load(from + 2 * kLanes), d = load(from + 3 * kLanes);
        transpose_blocks(a, b, c, d);
#endif
    }
};

#if HWY_TARGET == HWY_SCALAR
// Four doubles.
struct FourDoubles {
    double all[4];
    HWY_INLINE explicit FourDoubles(const double* from) : all{from[0], from[1], from[2], from[3]} {}
    HWY_INLINE void subtract(const FourDoubles& other) {
        for (int k = 0; k < 4; ++k) all[k] -= other.all[k];
    }
    HWY_INLINE void narrow(float* to) const {
        for (int k = 0; k < 4; ++k) to[k] = static_cast<float>(all[k]);
    }
};
#else
// Four doubles, as one vector or two.
struct FourDoubles {
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
    using Tag = hn::Simd<double, 4, 0>;
    hn::Vec<Tag> all;
    HWY_INLINE explicit FourDoubles(const double* from) : all(hn::LoadU(Tag(), from)) {}
    HWY_INLINE void subtract(const FourDoubles& other) { all = hn::Sub(all, other.all); }
    HWY_INLINE void narrow(float* to) const { hn::Store(hn::DemoteTo(BlockFloats(), all), BlockFloats(), to); }
#else
    using Tag = hn::Simd<double, 2, 0>;
    using HalfFloats = hn::Simd<float, 2, 0>;
    hn::Vec<Tag> low, high;
    HWY_INLINE explicit FourDoubles(const double* from) : low(hn::LoadU(Tag(), from)), high(hn::LoadU(Tag(), from + 2)) {}
    HWY_INLINE void subtract(const FourDoubles& other) { low = hn::Sub(low, other.low), high = hn::Sub(high, other.high); }
    HWY_INLINE void narrow(float* to) const {
        hn::Store(hn::Combine(BlockFloats(), hn::DemoteTo(HalfFloats(), high), hn::DemoteTo(HalfFloats(), low)), BlockFloats(), to);
    }
#endif
    using BlockFloats = hn::Simd<float, 4, 0>;
};
#endif

// Columns 0 to 2 of a lane: the difference of the positions and a number that means nothing, A's quaternion, B's.
template <int columns>
HWY_INLINE void write_place(const LanePlace& place, int lane, LaneRows<columns>& rows) {
    const double *const a = &place.a->position.x, *const b = &place.b->position.x;
    FourDoubles between(b);
    between.subtract(FourDoubles(a));
    between.narrow(rows.at(lane, 0));
    FourDoubles(a + 3).narrow(rows.at(lane, 1));
    FourDoubles(b + 3).narrow(rows.at(lane, 2));
}

template <int columns>
HWY_INLINE Placement placement_of(const LaneRows<columns>& rows) {
    Floats dx, dy, dz, none_, ax, ay, az, aw, bx, by, bz, bw;
    rows.read(0, dx, dy, dz, none_);
    rows.read(1, ax, ay, az, aw);
    rows.read(2, bx, by, bz, bw);
    const Floats3 u{ax, ay, az}, v{bx, by, bz}, d{dx, dy, dz};
    const Floats one(1.0f), slack(0x1p-21f);
    const Mask unit_a = abs((dot(u, u) + aw * aw) - one) < slack, unit_b = abs((dot(v, v) + bw * bw) - one) < slack;

    // The conjugate of A's orientation times B's, as a matrix.
    const Floats w = aw * bw + dot(u, v);
    const Floats3 q = aw * v - bw * u - cross(u, v);
    const Floats x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
    const Floats xx = q.x * x2, yy = q.y * y2, zz = q.z * z2, xy = q.x * y2, xz = q.x * z2, yz = q.y * z2;
    const Floats wx = w * x2, wy = w * y2, wz = w * z2;
    const Floats3 t = cross(d, u), s = t + t;  // 2 (-u) x d
    const Floats3 offset = (d + aw * s) + cross(s, u);
    const Floats far(kLargestLaneSize);
    const Mask near = (abs(dx) < far) & (abs(dy) < far) & (abs(dz) < far);
    return {{{one - (yy + zz), xy - wz, xz + wy}, {xy + wz, one - (xx + zz), yz - wx}, {xz - wy, yz + wx, one - (xx + yy)}},
            {offset.x, offset.y, offset.z},
            unit_a & unit_b & near};
}

// A box's half extents and a number that means nothing.
HWY_INLINE void write_half(const vec3* half, float* row) {
#if HWY_TARGET == HWY_SCALAR
    row[0] = half->x, row[1] = half->y, row[2] = half->z, row[3] = 0.0f;
#else
    const hn::Simd<float, 4, 0> four;
    hn::Store(hn::LoadU(four, &half->x), four, row);
#endif
}

}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
