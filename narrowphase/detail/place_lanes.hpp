// Pairs of poses to lanes: where B lies in A's frame, in float, sixteen pairs at a time.
//
//   Placement p = place_lanes([&](int lane) { return pairs[lane].place; });   // p.rotation[i][j], p.offset[i], p.fit

// This guard lets the file through once for each target.
#if defined(CAROM_NARROWPHASE_PLACE_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_NARROWPHASE_PLACE_LANES_HPP
#undef CAROM_NARROWPHASE_PLACE_LANES_HPP
#else
#define CAROM_NARROWPHASE_PLACE_LANES_HPP
#endif

#include <carom/core/lanes.hpp>
#include <carom/narrowphase/detail/pair_lanes.hpp>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {

using namespace carom::HWY_NAMESPACE;

static_assert(offsetof(Pose, position) == 0 && offsetof(Pose, orientation) == 24 && sizeof(Pose) == 56, "seven doubles: x y z, x y z w");

struct Placement {
    Floats rotation[3][3];  ///< [i][j]: component along axis i of A of axis j of B
    Floats offset[3];       ///< from A's origin to B's, along A's axes
    Mask fit;               ///< both orientations are of unit length to 2^-20.5, and the offset is finite
};

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void write_row(const LanePlace& place, float* row) {
    const double *const a = &place.a->position.x, *const b = &place.b->position.x;
    for (int k = 0; k < 4; ++k) {
        row[k] = static_cast<float>(b[k] - a[k]);
        row[4 + k] = static_cast<float>(a[3 + k]);
        row[8 + k] = static_cast<float>(b[3 + k]);
    }
}
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

// Of each pair twelve floats, in stores as wide as they are read: the difference of the positions and a number that means nothing, A's
// quaternion, B's.
HWY_INLINE void write_row(const LanePlace& place, float* row) {
    const double *const a = &place.a->position.x, *const b = &place.b->position.x;
    FourDoubles between(b);
    between.subtract(FourDoubles(a));
    between.narrow(row);
    FourDoubles(a + 3).narrow(row + 4);
    FourDoubles(b + 3).narrow(row + 8);
}
#endif

HWY_INLINE Placement placement_of(const float* rows) {
    alignas(64) constexpr std::int32_t kInOrder[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    Floats dx, dy, dz, none_, ax, ay, az, aw, bx, by, bz, bw;
    gather_rows(rows, kInOrder, 12, 0, dx, dy, dz, none_);
    gather_rows(rows, kInOrder, 12, 4, ax, ay, az, aw);
    gather_rows(rows, kInOrder, 12, 8, bx, by, bz, bw);
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

}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
