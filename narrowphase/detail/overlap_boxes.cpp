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

// What the axes say so far.
struct Verdicts {
    Mask apart, unclear;

    // `length` is that of the axis or more, which the gap is in units of.
    HWY_INLINE void judge(Floats gap, Floats error) {
        apart = apart | (gap > error);
        unclear = unclear | (!(gap < -error));
    }
};

HWY_INLINE Verdicts judge_axes(const Placement& p, const Floats (&a)[3], const Floats (&b)[3], Floats error) {
    const auto& r = p.rotation;
    const auto& t = p.offset;
    Floats size[3][3];
    Verdicts v{t[0] != t[0], t[0] != t[0]};
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j) size[i][j] = abs(r[i][j]);
        v.judge(abs(t[i]) - (a[i] + ((size[i][0] * b[0] + size[i][1] * b[1]) + size[i][2] * b[2])), error);
    }
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) {
        const Floats along = (r[0][j] * t[0] + r[1][j] * t[1]) + r[2][j] * t[2];
        v.judge(abs(along) - (b[j] + ((size[0][j] * a[0] + size[1][j] * a[1]) + size[2][j] * a[2])), error);
    }
    if (all(v.apart)) return v;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            const Floats reach_1 = abs(r[i1][j] * r[i2][j1] - r[i2][j] * r[i1][j1]), reach_2 = abs(r[i1][j] * r[i2][j2] - r[i2][j] * r[i1][j2]);
            const Floats reach = (a[i1] * size[i2][j] + a[i2] * size[i1][j]) + (b[j1] * reach_1 + b[j2] * reach_2);
            const Floats along = abs(t[i2] * r[i1][j] - t[i1] * r[i2][j]);
            // Edges parallel to 1e-12 have the axes of the faces, to as much.
            const Floats length = size[i1][j] + size[i2][j];
            const Mask is_axis = length > Floats(1e-12f);
            const Floats slack = error * length, gap = along - reach;
            v.apart = v.apart | (is_axis & (gap > slack));
            v.unclear = v.unclear | (is_axis & (!(gap < -slack)));
        }
    }
    return v;
}

// A box's half extents and a number that means nothing: a Box is the first member of a Shape, which is longer than four floats.
static_assert(sizeof(Shape) >= 16 && sizeof(Box) == 12);
HWY_INLINE void write_half(const vec3* half, float* row) {
#if HWY_TARGET == HWY_SCALAR
    row[0] = half->x, row[1] = half->y, row[2] = half->z, row[3] = 0.0f;
#else
    const hn::Simd<float, 4, 0> four;
    hn::Store(hn::LoadU(four, &half->x), four, row);
#endif
}

// Poses are read once, in the order of the pairs, which need not be that of memory.
HWY_INLINE void fetch(const LanePlace& place) {
    for (const Pose* const pose : {place.a, place.b}) {
        hwy::Prefetch(pose);
        hwy::Prefetch(&pose->orientation.w);
    }
}

// Pairs from `first`, as many as there are lanes; beyond the last the first stands in.
HWY_INLINE LaneVerdicts judge_pairs(std::span<const LaneBoxes> pairs, std::size_t first) {
    constexpr int kRows = kLanes < 4 ? 4 : kLanes;
    alignas(64) float rows[kRows * 12], halves[kRows * 8];
    alignas(64) constexpr std::int32_t kInOrder[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    for (int l = 0; l < kLanes; ++l) {
        const std::size_t i = first + static_cast<std::size_t>(l);
        const LaneBoxes& pair = pairs[i < pairs.size() ? i : 0];
        write_row(pair.place, rows + 12 * l);
        write_half(pair.half_a, halves + 8 * l);
        write_half(pair.half_b, halves + 8 * l + 4);
    }
    Floats a[3], b[3], nothing;
    gather_rows(halves, kInOrder, 8, 0, a[0], a[1], a[2], nothing);
    gather_rows(halves, kInOrder, 8, 4, b[0], b[1], b[2], nothing);
    const Placement p = placement_of(rows);
    const Floats size = ((abs(p.offset[0]) + abs(p.offset[1])) + abs(p.offset[2])) + (((a[0] + a[1]) + a[2]) + ((b[0] + b[1]) + b[2]));
    const Mask fit = p.fit & (size > Floats(kSmallestLaneSize)) & (size < Floats(kLargestLaneSize));
    const Verdicts v = judge_axes(p, a, b, size * Floats(kLaneRounding));
    return {bits(v.apart & fit), bits(fit & (!v.unclear))};
}

void OverlapBoxes(std::span<const LaneBoxes> pairs, LaneVerdicts* verdicts) {
    for (std::size_t first = 0; first < pairs.size(); first += kBundleWidth) {
        for (std::size_t next = first + kBundleWidth; next < std::min(first + 2 * kBundleWidth, pairs.size()); ++next) fetch(pairs[next].place);
        LaneVerdicts& all = verdicts[first / kBundleWidth] = {};
        for (int lane = 0; lane < kBundleWidth; lane += kLanes) {
            const LaneVerdicts v = judge_pairs(pairs, first + static_cast<std::size_t>(lane));
            all.apart |= v.apart << lane;
            all.overlapping |= v.overlapping << lane;
        }
    }
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(OverlapBoxes);
void overlap_boxes(std::span<const LaneBoxes> pairs, LaneVerdicts* verdicts) { HWY_DYNAMIC_DISPATCH(OverlapBoxes)(pairs, verdicts); }
}  // namespace carom::detail
#endif
