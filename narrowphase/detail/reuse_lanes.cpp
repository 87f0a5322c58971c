#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/reuse_lanes.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes.hpp>
#include <carom/narrowphase/detail/reuse.hpp>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

constexpr std::size_t kLineStride = sizeof(MotionLine) / sizeof(float);
constexpr std::size_t kRecordStride = sizeof(PairRecord) / sizeof(float);
constexpr std::size_t kManifoldRows = sizeof(Manifold) / 16;
static_assert(sizeof(MotionLine) == 80 && sizeof(PairRecord) == 64 && sizeof(Manifold) == 128);
static_assert(offsetof(Manifold, normal) == 96 && offsetof(Manifold, pair) == 108 && offsetof(Manifold, count) == 112);
static_assert(sizeof(ContactPoint) == 24 && offsetof(ContactPoint, separation) == 12);

// How shapes move.
struct Moving {
    Floats3 row[3];      ///< of E
    Floats3 motion;
    Floats3 coarse, fine;  ///< where the origins were: the sum
    Floats radius;         ///< about the core

    HWY_INLINE Floats3 turned(const Floats3& r) const { return {dot(row[0], r), dot(row[1], r), dot(row[2], r)}; }
    HWY_INLINE Floats size_sq() const { return (dot(row[0], row[0]) + dot(row[1], row[1])) + dot(row[2], row[2]); }
};

HWY_INLINE Moving read_moving(std::span<const MotionLine> lines, const std::int32_t* numbers) {
    const float* const base = lines.data()->turn[0];
    Floats e00, e01, e02, e10, e11, e12, e20, e21, e22, dx, dy, dz, x, y, z, radius, fine_x, fine_y, fine_z, unused;
    gather_rows(base, numbers, kLineStride, 0, e00, e01, e02, dx);
    gather_rows(base, numbers, kLineStride, 4, e10, e11, e12, dy);
    gather_rows(base, numbers, kLineStride, 8, e20, e21, e22, dz);
    gather_rows(base, numbers, kLineStride, 12, x, y, z, radius);
    gather_rows(base, numbers, kLineStride, 16, fine_x, fine_y, fine_z, unused);
    return {{{e00, e01, e02}, {e10, e11, e12}, {e20, e21, e22}}, {dx, dy, dz}, {x, y, z}, {fine_x, fine_y, fine_z}, radius};
}

// From the origin of A to that of B, before.
HWY_INLINE Floats3 between(const Moving& a, const Moving& b) { return (b.coarse - a.coarse) + (b.fine - a.fine); }

// Of the turn: w where E is w x r to first order.
HWY_INLINE Floats3 axial(const Moving& m) {
    const Floats half(0.5f);
    return Floats3{m.row[2].y - m.row[1].z, m.row[0].z - m.row[2].x, m.row[1].x - m.row[0].y} * half;
}

HWY_INLINE void put(FloatBundle* to, int lane, const Floats3& v) {
    store(v.x, to[0].lane + lane);
    store(v.y, to[1].lane + lane);
    store(v.z, to[2].lane + lane);
}

std::uint32_t FindReusable(std::span<const MotionLine> lines, const ReuseBundle& pairs, std::span<const PairRecord> records,
                           DriftBundle& drift) {
    std::uint32_t found = 0;
    for (int lane = 0; lane < kBundleWidth; lane += kLanes) {
        const Moving a = read_moving(lines, pairs.a.lane + lane), b = read_moving(lines, pairs.b.lane + lane);
        const float* const record = &records.data()->shift.x;
        Floats ux, uy, uz, rest_before, wx, wy, wz, margin, reach, state_bits, unused_a, unused_b;
        gather_rows(record, pairs.last.lane + lane, kRecordStride, 0, ux, uy, uz, rest_before);
        gather_rows(record, pairs.last.lane + lane, kRecordStride, 4, wx, wy, wz, margin);
        gather_rows(record, pairs.last.lane + lane, kRecordStride, 8, reach, state_bits, unused_a, unused_b);
        const Ints state = as_ints(state_bits);
        const Floats3 shift_before{ux, uy, uz}, turn_before{wx, wy, wz};

        const Mask b_smaller = (state & Ints(kBSmaller)) != Ints(0);
        const Floats3 apart = between(a, b);
        const Floats3 carried = select(b_smaller, a.turned(apart), -b.turned(apart));  // by the larger shape
        const Floats3 relative = b.motion - a.motion;
        const Floats3 shift = shift_before + (select(b_smaller, relative, -relative) - carried);
        const Floats3 turn_ab = axial(b) - axial(a);
        const Floats3 turn = turn_before + select(b_smaller, turn_ab, -turn_ab);
        const Floats size_a = a.size_sq(), size_b = b.size_sq();
        const Floats come = length(shift_before) + length(turn_before) * reach;
        const Floats turning = length(turn_ab) * length(turn_before) * reach;  // r turns with S
        const Floats second = (Floats(0.5f) * ((size_a + size_b) * reach) + turning) + sqrt(select(b_smaller, size_a, size_b)) * come;
        const Floats swept = sqrt(select(b_smaller, size_a, size_b)) * length(apart);
        const Floats rounding = Floats(1e-6f) * (((length(a.motion) + length(b.motion)) + swept) + (sqrt(size_a) + sqrt(size_b)) * reach);
        const Floats rest = rest_before + (second + rounding);
        const Floats now = (length(shift) + length(turn) * reach) + rest;
        put(drift.shift, lane, shift);
        put(drift.turn, lane, turn);
        store(rest, drift.rest.lane + lane);

        const Floats slack = load(pairs.slack.lane + lane);
        const Mask lasts = ((state & Ints(kLeftMask)) > Ints(0)) & ((state & Ints(kRolls)) == Ints(0));
        const Mask near = (now <= slack) & (load(pairs.margin.lane + lane) + now <= margin);
        found |= bits(lasts & near) << lane;
    }
    return found;
}

struct WidePoint {
    Floats3 position;
    Floats separation;
};

// What a point needs to be carried.
struct Carrier {
    const Moving& a;
    const Moving& b;
    Floats3 normal, new_normal;
    Floats3 apart, relative;

    // The points of A and B less their radii: about A's origin, and about B's.
    HWY_INLINE Floats3 core_a(const WidePoint& point) const { return point.position - normal * (Floats(0.5f) * point.separation + a.radius); }
    HWY_INLINE Floats3 core_b(const WidePoint& point) const {
        return (point.position + normal * (Floats(0.5f) * point.separation + b.radius)) - apart;
    }
    // @param first  the first point: where both are round, a second one, of capsules along each other, has the same normal.
    HWY_INLINE Floats3 turned_normal(const WidePoint& first) const {
        const Floats zero(0.0f);
        const Mask round_a = a.radius > zero, round_b = b.radius > zero;
        const Floats size_a = a.size_sq(), size_b = b.size_sq();
        const Mask by_a = (round_b & (!round_a)) | ((size_a <= size_b) & (!(round_a & (!round_b))));
        const Floats3 change = select(by_a, a.turned(normal), b.turned(normal));
        // Between cores; where they coincide the old normal is as good as any.
        const Floats3 old_a = core_a(first), old_b = core_b(first);
        const Floats3 cores = (((apart + old_b) - old_a) + relative) + (b.turned(old_b) - a.turned(old_a));
        const Mask by_cores = round_a & round_b & (length(cores) > Floats(1e-3f) * (a.radius + b.radius));
        const Floats3 turned = select(by_cores, cores, normal + change);
        const Mask rests = (!by_cores) & (select(by_a, size_a, size_b) == zero);
        return select(rests, normal, turned * (Floats(1.0f) / length(turned)));
    }
    HWY_INLINE void carry(WidePoint& point, Mask used) const {
        const Floats3 swing = new_normal - normal;  // moves the surface of what is round
        const Floats3 from_a = a.turned(core_a(point)) + swing * a.radius;
        const Floats3 from_b = (b.turned(core_b(point)) - swing * b.radius) + relative;
        // The old separation is shorter along the new normal: by 1 - n n' = |n' - n|^2 / 2, so that nothing that rests changes by rounding.
        const Floats shorter = point.separation * (Floats(0.5f) * dot(swing, swing));
        const Floats separation = (point.separation - shorter) + dot(new_normal, from_b - from_a);
        // The contact of what is round stays below its core, wherever the other shape's point has gone.
        const Floats half(0.5f), zero(0.0f);
        const Floats3 old_half = normal * (half * point.separation), new_half = new_normal * (half * separation);
        const Floats3 by_a = ((point.position - old_half) + from_a) + new_half, by_b = ((point.position + old_half) + from_b) - new_half;
        const Floats3 middle = point.position + (from_a + from_b) * half;
        const Floats3 position = select(a.radius > zero, by_a, select(b.radius > zero, by_b, middle));
        point.position = select(used, position, point.position);
        point.separation = select(used, separation, point.separation);
    }
};

void MoveManifolds(std::span<const MotionLine> lines, std::span<const MoveBundle> moves, const Manifold* last, Manifold* out) {
    const auto* const from = reinterpret_cast<const float*>(last);
    auto* const to = reinterpret_cast<float*>(out);
    for (const MoveBundle& move : moves) {
        for (int lane = 0; lane < kBundleWidth; lane += kLanes) {
            const Moving a = read_moving(lines, move.a.lane + lane), b = read_moving(lines, move.b.lane + lane);
            Floats r[kManifoldRows][4];
#pragma GCC unroll 8
            for (std::size_t k = 0; k < kManifoldRows; ++k) {
                gather_rows(from, move.from.lane + lane, sizeof(Manifold) / sizeof(float), 4 * k, r[k][0], r[k][1], r[k][2], r[k][3]);
            }
            const Floats3 normal{r[6][0], r[6][1], r[6][2]};
            const Ints count = as_ints(r[7][0]);
            Carrier carrier{a, b, normal, normal, between(a, b), b.motion - a.motion};
            carrier.new_normal = carrier.turned_normal({{r[0][0], r[0][1], r[0][2]}, r[0][3]});
            // Points of 24 bytes in rows of 16: the second of each pair of them lies across two rows.
#pragma GCC unroll 2
            for (std::size_t k = 0; k < 2; ++k) {
                Floats(&first)[4] = r[3 * k];
                Floats(&middle)[4] = r[3 * k + 1];
                Floats(&third)[4] = r[3 * k + 2];
                WidePoint even{{first[0], first[1], first[2]}, first[3]}, odd{{middle[2], middle[3], third[0]}, third[1]};
                carrier.carry(even, count > Ints(static_cast<std::int32_t>(2 * k)));
                carrier.carry(odd, count > Ints(static_cast<std::int32_t>(2 * k + 1)));
                first[0] = even.position.x, first[1] = even.position.y, first[2] = even.position.z, first[3] = even.separation;
                middle[2] = odd.position.x, middle[3] = odd.position.y, third[0] = odd.position.z, third[1] = odd.separation;
            }
            r[6][0] = carrier.new_normal.x, r[6][1] = carrier.new_normal.y, r[6][2] = carrier.new_normal.z;
            r[6][3] = as_floats(load(move.pair.lane + lane));
#pragma GCC unroll 8
            for (std::size_t k = 0; k < kManifoldRows; ++k) {
                scatter_rows(to, move.to.lane + lane, sizeof(Manifold) / sizeof(float), 4 * k, r[k][0], r[k][1], r[k][2], r[k][3], kNoMove);
            }
        }
    }
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(FindReusable);
HWY_EXPORT(MoveManifolds);
std::uint32_t find_reusable(std::span<const MotionLine> lines, const ReuseBundle& pairs, std::span<const PairRecord> records,
                            DriftBundle& drift) noexcept {
    return HWY_DYNAMIC_DISPATCH(FindReusable)(lines, pairs, records, drift);
}
void move_manifolds(std::span<const MotionLine> lines, std::span<const MoveBundle> moves, std::span<const Manifold> last, Manifold* out) noexcept {
    HWY_DYNAMIC_DISPATCH(MoveManifolds)(lines, moves, last.data(), out);
}
}  // namespace carom::detail
#endif
