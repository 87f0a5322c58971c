// Pairs in the frames of their first shapes, in lanes of doubles: what PairFrame and ManifoldSink are for one pair, to the bit.
//
//   PairRows rows; rows.fill(input, chosen, swapped);             // up to eight pairs
//   const WideFrame frame = frame_of(rows, lane);                 // as many as there are lanes
//   write_contact(contact, frame, swapped, lane, contacts);       // ContactRows

// This guard lets the file through once for each target.
#if defined(CAROM_NARROWPHASE_FRAME_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_NARROWPHASE_FRAME_LANES_HPP
#undef CAROM_NARROWPHASE_FRAME_LANES_HPP
#else
#define CAROM_NARROWPHASE_FRAME_LANES_HPP
#endif

#include <carom/core/lanes_doubles.hpp>
#include <carom/narrowphase/detail/pair_rows.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {

using namespace carom::HWY_NAMESPACE;

/// The columns of a matrix.
struct WideMatrix {
    Doubles3 x, y, z;

    HWY_INLINE Doubles3 operator*(const Doubles3& v) const { return (x * v.x + y * v.y) + z * v.z; }
    /// By the transpose.
    HWY_INLINE Doubles3 back(const Doubles3& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
};

struct WideRotation {
    Doubles x, y, z, w;

    HWY_INLINE WideMatrix matrix() const {
        const Doubles xx = x * x, yy = y * y, zz = z * z, xz = x * z, xy = x * y, yz = y * z, wx = w * x, wy = w * y, wz = w * z;
        const Doubles one(1.0), two(2.0);
        return {{one - two * (yy + zz), two * (xy + wz), two * (xz - wy)},
                {two * (xy - wz), one - two * (xx + zz), two * (yz + wx)},
                {two * (xz + wy), two * (yz - wx), one - two * (xx + yy)}};
    }
    /// Its conjugate times `q`.
    HWY_INLINE WideRotation to(const WideRotation& q) const {
        const Doubles a = -x, b = -y, c = -z;
        return {((w * q.x + a * q.w) + b * q.z) - c * q.y, ((w * q.y + b * q.w) + c * q.x) - a * q.z,
                ((w * q.z + c * q.w) + a * q.y) - b * q.x, ((w * q.w - a * q.x) - b * q.y) - c * q.z};
    }
};

/// Pairs in the frames of their first shapes.
struct WideFrame {
    WideMatrix to_world, rotation;
    Doubles3 between, translation;
    Doubles margin;
};

HWY_INLINE WideFrame frame_of(const PairRows& rows, int lane) {
    const auto read = [lane](const DoubleBundle& row) { return load(row.lane + lane); };
    const auto position = [&](const DoubleBundle(&pose)[7]) { return Doubles3{read(pose[0]), read(pose[1]), read(pose[2])}; };
    const auto rotation = [&](const DoubleBundle(&pose)[7]) {
        return WideRotation{read(pose[3]), read(pose[4]), read(pose[5]), read(pose[6])};
    };
    const WideRotation first = rotation(rows.first), second = rotation(rows.second);
    const WideMatrix to_world = first.matrix();
    const Doubles3 between = position(rows.second) - position(rows.first);
    return {to_world, first.to(second).matrix(), between, to_world.back(between), read(rows.margin)};
}

/// To memory as floats, rounded to nearest; aligned to as many of them as there are lanes.
HWY_INLINE void store_rounded(Doubles a, float* to) {
    const hn::Rebind<float, DoubleTag> floats;
    hn::Store(hn::DemoteTo(floats, a.raw), floats, to);
}

/// A point of contact in the frame of the first shape, in the lanes in which it is valid.
struct WideContactPoint {
    Doubles3 position;
    Doubles separation;
    Doubles feature;  ///< a whole number that a double holds, 0 to below 2^63
    DoubleMask valid;
};

/// Some of them with one normal, from the first shape to the second.
template <std::size_t Points>
struct WideContact {
    static constexpr std::size_t kPoints = Points;
    Doubles3 normal;
    WideContactPoint points[Points];
};

/// To the world, about A's origin. Differences of positions that overflow are farther apart than any margin.
template <std::size_t Points>
HWY_INLINE void write_contact(const WideContact<Points>& contact, const WideFrame& frame, bool swapped, int lane,
                              ContactRows<Points>& out) {
    const auto write = [lane](const Doubles3& v, HalfBundle(&rows)[3]) {
        store_rounded(v.x, rows[0].lane + lane), store_rounded(v.y, rows[1].lane + lane), store_rounded(v.z, rows[2].lane + lane);
    };
    const Doubles3 normal = frame.to_world * contact.normal;
    write(swapped ? -normal : normal, out.normal);
    const Doubles zero(0.0);
    const Doubles3 shift = swapped ? -frame.between : Doubles3{zero, zero, zero};
    const Doubles3& t = frame.translation;
    const DoubleMask finite = (t.x - t.x == zero) & (t.y - t.y == zero) & (t.z - t.z == zero);
    for (std::size_t k = 0; k < Points; ++k) {
        write(frame.to_world * contact.points[k].position + shift, out.points[k].position);
        store_rounded(contact.points[k].separation, out.points[k].separation.lane + lane);
        store(contact.points[k].feature, out.points[k].feature.lane + lane);
        out.points[k].valid |= bits(contact.points[k].valid & finite) << lane;
    }
}

}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
