#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/dynamics/detail/swept_boxes.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/bundle.hpp>
#include <carom/core/lanes_doubles.hpp>
#include <carom/dynamics/detail/swept_boxes.hpp>

#include <algorithm>

#ifndef CAROM_DYNAMICS_SWEPT_BOXES_ONCE
#define CAROM_DYNAMICS_SWEPT_BOXES_ONCE
namespace carom::dynamics {
namespace {

using TwoBundles = DoubleBundle[2];

// Sixteen boxes, number by number.
struct SweptRows {
    TwoBundles position[3], rotation[4], velocity[3], spin[3];  // of the bodies; rotations are x y z w
    TwoBundles local_position[3], local_rotation[4], half[3], reach, pull;
    TwoBundles pose_position[3], pose_rotation[4], motion;
    FloatBundle bound[6];     // lower x y z, and the negatives of upper x y z, rounded to nearest
    FloatBundle too_high[6];  // 1 where that is above
};

void read_box(const SweptBox& box, std::size_t lane, SweptRows& rows) {
    const auto put = [lane](TwoBundles& row, double number) { row[lane / kDoubleBundleWidth].lane[lane % kDoubleBundleWidth] = number; };
    const auto put_three = [&](TwoBundles (&row)[3], const dvec3& v) { put(row[0], v.x), put(row[1], v.y), put(row[2], v.z); };
    const auto put_four = [&](TwoBundles (&row)[4], const dquat& q) { put(row[0], q.x), put(row[1], q.y), put(row[2], q.z), put(row[3], q.w); };
    put_three(rows.position, box.state->pose.position);
    put_four(rows.rotation, box.state->pose.orientation);
    put_three(rows.velocity, box.has_room ? dvec3{0.0} : box.state->velocity);
    put_three(rows.spin, box.has_room ? dvec3{0.0} : box.state->spin);
    put_three(rows.local_position, box.local->position);
    put_four(rows.local_rotation, box.local->orientation);
    put_three(rows.half, dvec3(box.half));
    put(rows.reach, box.reach);
    put(rows.pull, box.pull);
}

void write_box(const SweptRows& rows, std::size_t lane, const SweptBox& box) {
    const auto get = [lane](const TwoBundles& row) { return row[lane / kDoubleBundleWidth].lane[lane % kDoubleBundleWidth]; };
    box.pose->position = {get(rows.pose_position[0]), get(rows.pose_position[1]), get(rows.pose_position[2])};
    dquat& q = box.pose->orientation;
    q.x = get(rows.pose_rotation[0]), q.y = get(rows.pose_rotation[1]), q.z = get(rows.pose_rotation[2]), q.w = get(rows.pose_rotation[3]);
    *box.motion = get(rows.motion);
    for (int k = 0; k < 3; ++k) {
        box.box->lower[k] = rows.bound[k].lane[lane];
        box.box->upper[k] = -rows.bound[3 + k].lane[lane];
    }
}

}  // namespace
}  // namespace carom::dynamics
#endif

HWY_BEFORE_NAMESPACE();
namespace carom::dynamics::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

struct Rotation {
    Doubles3 u;
    Doubles w;
};
HWY_INLINE Doubles3 rotate(const Rotation& q, const Doubles3& v) {
    const Doubles3 t = cross(q.u, v) * Doubles(2.0);
    return (v + t * q.w) + cross(q.u, t);
}
HWY_INLINE Rotation product(const Rotation& p, const Rotation& q) {
    return {{((p.w * q.u.x + p.u.x * q.w) + p.u.y * q.u.z) - p.u.z * q.u.y, ((p.w * q.u.y + p.u.y * q.w) + p.u.z * q.u.x) - p.u.x * q.u.z,
             ((p.w * q.u.z + p.u.z * q.w) + p.u.x * q.u.y) - p.u.y * q.u.x},
            ((p.w * q.w - p.u.x * q.u.x) - p.u.y * q.u.y) - p.u.z * q.u.z};
}
HWY_INLINE Doubles length(const Doubles3& v) { return sqrt(dot(v, v)); }

// Rows of the matrix that rotate() applies.
struct Matrix {
    Doubles3 row[3];
};
HWY_INLINE Matrix matrix_of(const Rotation& q) {
    const Doubles &x = q.u.x, &y = q.u.y, &z = q.u.z, &w = q.w;
    const Doubles one(1.0), two(2.0);
    return {{{one - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y)},
             {two * (x * y + w * z), one - two * (x * x + z * z), two * (y * z - w * x)},
             {two * (x * z - w * y), two * (y * z + w * x), one - two * (x * x + y * y)}}};
}

using HalfTag = hn::Rebind<float, DoubleTag>;

// The float next to a - b, and whether it is above that, which rounding hides in part (Knuth 1969, vol. 2, 4.2.2, theorem B).
HWY_INLINE void round_difference(Doubles a, Doubles b, float* nearest, float* too_high) {
    const Doubles s = a - b, t = s - a, error = (a - (s - t)) + (-b - t);
    const auto rounded = hn::DemoteTo(HalfTag(), s.raw);
    const Doubles back(hn::PromoteTo(DoubleTag(), rounded));
    hn::Store(rounded, HalfTag(), nearest);
    const Doubles flag = select((back > s) | ((back == s) & (error < Doubles(0.0))), Doubles(1.0), Doubles(0.0));
    hn::Store(hn::DemoteTo(HalfTag(), flag.raw), HalfTag(), too_high);
}

HWY_INLINE void sweep(SweptRows& rows, int bundle, int lane, Doubles dt, const dvec3& origin) {
    const auto read = [&](const TwoBundles& row) { return load(row[bundle].lane + lane); };
    const auto three = [&](const TwoBundles (&row)[3]) { return Doubles3{read(row[0]), read(row[1]), read(row[2])}; };
    const auto four = [&](const TwoBundles (&row)[4]) { return Rotation{{read(row[0]), read(row[1]), read(row[2])}, read(row[3])}; };
    const auto write = [&](Doubles value, TwoBundles& row) { store(value, row[bundle].lane + lane); };

    const Rotation body = four(rows.rotation), turned = product(body, four(rows.local_rotation));
    const Doubles3 at = three(rows.position) + rotate(body, three(rows.local_position));
    write(at.x, rows.pose_position[0]), write(at.y, rows.pose_position[1]), write(at.z, rows.pose_position[2]);
    write(turned.u.x, rows.pose_rotation[0]), write(turned.u.y, rows.pose_rotation[1]);
    write(turned.u.z, rows.pose_rotation[2]), write(turned.w, rows.pose_rotation[3]);

    const Doubles zero(0.0), two(2.0), turn_limit = length(three(rows.spin)) * dt;
    const Doubles play = read(rows.pull) + read(rows.reach) * select(two < turn_limit, two, turn_limit);
    const Doubles3 velocity = three(rows.velocity), path = velocity * dt;
    write(length(velocity) * dt + play, rows.motion);

    // The widening of bounds() for the rounding of rotated points.
    constexpr double kTurnPad = 0x1p-48, kSumPad = 0x1p-51;
    const Matrix m = matrix_of(turned);
    const Doubles3 half = three(rows.half);
    const Doubles reach = (half.x + half.y) + half.z;
    const Doubles place[3] = {at.x, at.y, at.z}, way[3] = {path.x, path.y, path.z};
    for (int k = 0; k < 3; ++k) {
        const Doubles3& row = m.row[k];
        const Doubles extent = (abs(row.x) * half.x + abs(row.y) * half.y) + abs(row.z) * half.z;
        const Doubles pad = Doubles(kTurnPad) * reach + Doubles(kSumPad) * (abs(place[k]) + reach);
        const Doubles lower = (place[k] + (-extent - pad)) + select(zero < way[k], zero, way[k]);
        const Doubles upper = (place[k] + (extent + pad)) + select(way[k] < zero, zero, way[k]);
        const int first = bundle * kDoubleBundleWidth + lane;
        round_difference(lower - play, Doubles(origin[k]), rows.bound[k].lane + first, rows.too_high[k].lane + first);
        round_difference(-(upper + play), Doubles(-origin[k]), rows.bound[3 + k].lane + first, rows.too_high[3 + k].lane + first);
    }
}

// One float down where the nearest was above.
HWY_INLINE void step_down(SweptRows& rows) {
    for (std::size_t k = 0; k < 6; ++k) {
        for (int lane = 0; lane < kBundleWidth; lane += kLanes) {
            const Floats nearest = load(rows.bound[k].lane + lane), zero(0.0f);
            const Ints bits = as_ints(nearest);  // sign and magnitude
            const Ints below = select(nearest == zero, Ints(static_cast<std::int32_t>(0x80000001u)), select(bits < Ints(0), bits + Ints(1), bits - Ints(1)));
            store(select(load(rows.too_high[k].lane + lane) > zero, as_floats(below), nearest), rows.bound[k].lane + lane);
        }
    }
}

void SweepBoxes(std::span<const SweptBox> boxes, double dt, const dvec3& origin) {
    SweptRows rows;
    for (std::size_t first = 0; first < boxes.size(); first += kBundleWidth) {
        const auto some = boxes.subspan(first, std::min<std::size_t>(kBundleWidth, boxes.size() - first));
        for (std::size_t lane = 0; lane < kBundleWidth; ++lane) read_box(some[lane < some.size() ? lane : 0], lane, rows);
        for (int bundle = 0; bundle < 2; ++bundle) {
            for (int lane = 0; lane < kDoubleBundleWidth; lane += kDoubleLanes) sweep(rows, bundle, lane, Doubles(dt), origin);
        }
        step_down(rows);
        for (std::size_t lane = 0; lane < some.size(); ++lane) write_box(rows, lane, some[lane]);
    }
}

}  // namespace
}  // namespace carom::dynamics::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::dynamics {
HWY_EXPORT(SweepBoxes);
void sweep_boxes(std::span<const SweptBox> boxes, double dt, const dvec3& origin) { HWY_DYNAMIC_DISPATCH(SweepBoxes)(boxes, dt, origin); }
}  // namespace carom::dynamics
#endif
