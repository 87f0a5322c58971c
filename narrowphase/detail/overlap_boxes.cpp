// Whether two boxes overlap, sixteen pairs at a time.
#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/overlap_boxes.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/bundle.hpp>
#include <carom/core/lanes.hpp>
#include <carom/narrowphase/detail/pair_lanes.hpp>
#include <carom/narrowphase/detail/place_lanes.hpp>

#include <hwy/cache_control.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

// What decides about a pair once it lies in A's frame.
struct Pair {
    Floats r[3][3], t[3], a[3], b[3];
    Floats error;  // of a separation along a unit direction
};
struct PlacedPair {
    Pair pair;
    Mask fit;  // for floats
};

HWY_INLINE Floats square(Floats x) { return x * x; }
HWY_INLINE Floats least(const Floats (&x)[3]) { return min(min(x[0], x[1]), x[2]); }

HWY_INLINE Ints verdict(Mask apart, Mask overlapping) {
    return select(apart, Ints(int(Overlap::Apart)), select(overlapping, Ints(int(Overlap::Overlapping)), Ints(int(Overlap::Undecided))));
}

// What the six axes of faces say, whose greatest gap is `gap`, and the distance of either centre from the other box: where it is less than the radius
// of the ball that the box about that centre holds, the two overlap.
HWY_INLINE Ints judge_faces(const Pair& p, Floats& gap) {
    const Floats zero(0.0f);
    Floats gap_a[3], gap_b[3], past_a[3], past_b[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        past_a[i] = abs(p.t[i]) - p.a[i];
        gap_a[i] = past_a[i] - ((abs(p.r[i][0]) * p.b[0] + abs(p.r[i][1]) * p.b[1]) + abs(p.r[i][2]) * p.b[2]);
    }
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) {
        const Floats along = (p.r[0][j] * p.t[0] + p.r[1][j] * p.t[1]) + p.r[2][j] * p.t[2];
        past_b[j] = abs(along) - p.b[j];
        gap_b[j] = past_b[j] - ((abs(p.r[0][j]) * p.a[0] + abs(p.r[1][j]) * p.a[1]) + abs(p.r[2][j]) * p.a[2]);
    }
    gap = max(max(max(gap_a[0], gap_a[1]), gap_a[2]), max(max(gap_b[0], gap_b[1]), gap_b[2]));
    const auto reached = [&](const Floats(&past)[3], const Floats(&other)[3]) {
        const Floats room = max(least(other) - p.error, zero);
        return (square(max(past[0], zero)) + square(max(past[1], zero))) + square(max(past[2], zero)) < square(room);
    };
    return verdict(gap > p.error, reached(past_a, p.b) | reached(past_b, p.a));
}

// What the nine axes of edges say besides. Edges that are parallel have no axis: theirs is below the least error of one that is longer than 1e-12,
// and so decides nothing.
HWY_INLINE Ints judge_edges(const Pair& p, Floats face_gap) {
    const auto& r = p.r;
    const Floats nothing = p.error * Floats(1e-15f);
    Floats apart = face_gap - p.error, unclear = face_gap + p.error;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        Floats minor[3];  // without column j
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            minor[j] = abs(r[i1][j1] * r[i2][j2] - r[i2][j1] * r[i1][j2]);
        }
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            const Floats size_1 = abs(r[i1][j]), size_2 = abs(r[i2][j]);
            const Floats reach = (p.a[i1] * size_2 + p.a[i2] * size_1) + (p.b[j1] * minor[j2] + p.b[j2] * minor[j1]);
            const Floats gap = abs(p.t[i2] * r[i1][j] - p.t[i1] * r[i2][j]) - reach;
            const Floats slack = p.error * (size_1 + size_2);  // the length of the axis or more, which the gap is in units of
            apart = max(apart, gap - slack);
            unclear = max(unclear, gap + (slack - nothing));
        }
    }
    const Floats zero(0.0f);
    return verdict(apart > zero, unclear < zero);
}

// Pairs that faces leave open, side by side until there are as many as lanes.
class OpenPairs {
public:
    HWY_INLINE explicit OpenPairs(Overlap* verdicts) : verdicts_(verdicts) {}

    // Pairs from `first` on, those of `open`.
    HWY_INLINE void add(const Pair& p, Floats gap, Mask open, std::int32_t first) {
        alignas(64) std::int32_t lanes[kRoom / 2];
        const std::size_t added = compress_store(lane_numbers(), open, lanes);
        const auto order = hn::IndicesFromVec(IntTag(), load(lanes).raw);
        const auto put = [&](std::size_t k, Floats x) {
            hn::StoreU(hn::TableLookupLanes(as_ints(x).raw, order), IntTag(), number_[k] + count_);
        };
        store_unaligned(load(lanes) + Ints(first), pair_ + count_);
#pragma GCC unroll 3
        for (std::size_t i = 0; i < 3; ++i) {
            put(i, p.r[i][0]), put(3 + i, p.r[i][1]), put(6 + i, p.r[i][2]);
            put(9 + i, p.t[i]), put(12 + i, p.a[i]), put(15 + i, p.b[i]);
        }
        put(18, p.error), put(19, gap);
        count_ += added;
        if (count_ >= kRoom / 2) judge(kRoom / 2);
    }
    HWY_INLINE void finish() {
        if (count_ > 0) judge(count_);
    }

private:
    // The last `count`.
    HWY_INLINE void judge(std::size_t count) {
        count_ -= count;
        const auto get = [&](std::size_t k) { return as_floats(load_unaligned(number_[k] + count_)); };
        const Pair p{{{get(0), get(3), get(6)}, {get(1), get(4), get(7)}, {get(2), get(5), get(8)}},
                     {get(9), get(10), get(11)},
                     {get(12), get(13), get(14)},
                     {get(15), get(16), get(17)},
                     get(18)};
        alignas(64) std::int32_t found[kRoom / 2];
        store(judge_edges(p, get(19)), found);
        for (std::size_t l = 0; l < count; ++l) verdicts_[pair_[count_ + l]] = static_cast<Overlap>(found[l]);
    }

    static constexpr std::size_t kRoom = 2 * static_cast<std::size_t>(kLanes);  // fewer than kLanes wait, and as many at most are added
    Overlap* verdicts_;
    std::size_t count_ = 0;
    std::int32_t pair_[kRoom] = {};
    std::int32_t number_[20][kRoom] = {};
};

// Pairs this far ahead are fetched: poses are read once, in the order of the pairs, which need not be that of memory.
constexpr std::size_t kAhead = 40;

HWY_INLINE void fetch(const LaneBoxes& pair) {
    hwy::Prefetch(&pair.place.a->orientation);
    hwy::Prefetch(&pair.place.b->orientation);
}

// As many pairs as there are lanes.
HWY_INLINE void write_pairs(const LaneBoxes* pairs, LaneRows<5>& rows) {
    for (int block = 0; block < kLanes; block += 4) {
#pragma GCC unroll 4
        for (int lane = block; lane < block + std::min(4, kLanes); ++lane) {
            write_place(pairs[lane].place, lane, rows);
            write_half(pairs[lane].half_a, rows.at(lane, 3));
            write_half(pairs[lane].half_b, rows.at(lane, 4));
        }
    }
}

HWY_INLINE PlacedPair read_pair(const LaneRows<5>& rows) {
    Floats ax, ay, az, bx, by, bz, nothing;
    rows.read(3, ax, ay, az, nothing);
    rows.read(4, bx, by, bz, nothing);
    const Placement place = placement_of(rows);
    const auto& r = place.rotation;
    const auto& t = place.offset;
    const Floats size = ((abs(t[0]) + abs(t[1])) + abs(t[2])) + (((ax + ay) + az) + ((bx + by) + bz));
    return {{{{r[0][0], r[0][1], r[0][2]}, {r[1][0], r[1][1], r[1][2]}, {r[2][0], r[2][1], r[2][2]}},
             {t[0], t[1], t[2]},
             {ax, ay, az},
             {bx, by, bz},
             size * Floats(kLaneRounding)},
            place.fit & (size > Floats(kSmallestLaneSize)) & (size < Floats(kLargestLaneSize))};
}

HWY_INLINE void store_verdicts(Ints verdicts, Overlap* to) {
    const hn::Rebind<std::uint8_t, IntTag> bytes;
    hn::StoreU(hn::DemoteTo(bytes, verdicts.raw), bytes, reinterpret_cast<std::uint8_t*>(to));
}

void OverlapBoxes(std::span<const LaneBoxes> pairs, Overlap* verdicts) {
    constexpr auto kStep = static_cast<std::size_t>(kLanes);
    OpenPairs open(verdicts);
    LaneRows<5> rows[2];
    // Rows are written one step ahead, so that reads do not wait for narrower writes. Where there are too few pairs the last stands in.
    const auto write_ahead = [&](std::size_t first, LaneRows<5>& to) {
        if (first + kStep <= pairs.size()) {
            write_pairs(pairs.data() + first, to);
        } else if (first < pairs.size()) {
            LaneBoxes last[kStep];
            for (std::size_t l = 0; l < kStep; ++l) last[l] = pairs[std::min(first + l, pairs.size() - 1)];
            write_pairs(last, to);
        }
    };
    for (std::size_t i = 0; i < std::min(kAhead, pairs.size()); ++i) fetch(pairs[i]);
    write_ahead(0, rows[0]);
    for (std::size_t first = 0, turn = 0; first < pairs.size(); first += kStep, turn ^= 1) {
        for (std::size_t i = first + kAhead; i < std::min(first + kAhead + kStep, pairs.size()); ++i) fetch(pairs[i]);
        write_ahead(first + kStep, rows[turn ^ 1]);
        const PlacedPair p = read_pair(rows[turn]);
        Floats gap;
        const Ints undecided(static_cast<std::int32_t>(Overlap::Undecided));
        const Ints found = select(p.fit, judge_faces(p.pair, gap), undecided);
        store_verdicts(found, verdicts + first);
        const Mask left = p.fit & (found == undecided) & first_lanes(static_cast<int>(std::min(kStep, pairs.size() - first)));
        open.add(p.pair, gap, left, static_cast<std::int32_t>(first));
    }
    open.finish();
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(OverlapBoxes);
void overlap_boxes(std::span<const LaneBoxes> pairs, Overlap* verdicts) { HWY_DYNAMIC_DISPATCH(OverlapBoxes)(pairs, verdicts); }
}  // namespace carom::detail
#endif
