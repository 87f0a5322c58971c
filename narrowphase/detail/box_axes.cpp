#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/box_axes.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes.hpp>
#include <carom/narrowphase/detail/box_lanes.hpp>
#include <carom/narrowphase/detail/narrow_lanes.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <limits>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

/// The best axis so far, and whether one separates.
struct Search {
    Floats separation;
    Ints code;
    Floats edge_separation;
    Ints edge_code;
    Mask apart;

    HWY_INLINE void face(Floats s, int number, Floats limit) {
        const Mask better = s > separation;
        separation = select(better, s, separation);
        code = select(better, Ints(number), code);
        apart = apart | (s > limit);
    }
    HWY_INLINE void edge(Floats s, Mask is_axis, int number, Floats limit) {
        const Mask better = is_axis & (s > edge_separation);
        edge_separation = select(better, s, edge_separation);
        edge_code = select(better, Ints(number), edge_code);
        apart = apart | (is_axis & (s > limit));
    }
};

void find_axes(const BoxPairBundle& pair, BoxAxisBundle& out, int lane) {
    Floats a[3], b[3], t[3], r[3][3], size[3][3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        a[i] = load(pair.half_a[i].lane + lane);
        b[i] = load(pair.half_b[i].lane + lane);
        t[i] = load(pair.offset[i].lane + lane);
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j) {
            r[i][j] = load(pair.rotation[i][j].lane + lane);
            size[i][j] = abs(r[i][j]);
        }
    }
    const Floats most = max(max(max(a[0], a[1]), a[2]), max(max(b[0], b[1]), b[2]));
    const Floats limit = load(pair.margin.lane + lane) + Floats(kWideRounding) * most;
    const Floats never(-std::numeric_limits<float>::infinity());
    Search best{never, Ints(kApart), never, Ints(kApart), t[0] != t[0]};
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        best.face(abs(t[i]) - (a[i] + ((size[i][0] * b[0] + size[i][1] * b[1]) + size[i][2] * b[2])), i, limit);
    }
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) {
        const Floats along = (r[0][j] * t[0] + r[1][j] * t[1]) + r[2][j] * t[2];
        best.face(abs(along) - (b[j] + ((size[0][j] * a[0] + size[1][j] * a[1]) + size[2][j] * a[2])), kFirstFaceOfB + j, limit);
    }
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            // e_i x b_j has no component along i, and its products with the other axes of B are taken as they are, not from B being
            // square, which it is to 2e-7 only. So nothing cancels as the edges become parallel: every term below shrinks with its length
            // and is good to its own last digits.
            const Floats length_sq = r[i1][j] * r[i1][j] + r[i2][j] * r[i2][j];
            const Floats reach_1 = abs(r[i1][j] * r[i2][j1] - r[i2][j] * r[i1][j1]),
                         reach_2 = abs(r[i1][j] * r[i2][j2] - r[i2][j] * r[i1][j2]);
            const Floats reach = (a[i1] * size[i2][j] + a[i2] * size[i1][j]) + (b[j1] * reach_1 + b[j2] * reach_2);
            const Floats along = abs(t[i2] * r[i1][j] - t[i1] * r[i2][j]);
            const Mask is_axis = length_sq > Floats(static_cast<float>(kParallelSine * kParallelSine));
            best.edge((along - reach) / sqrt(length_sq), is_axis, kFirstEdge + 3 * i + j, limit);
        }
    }
    const Mask by_edge = best.edge_separation > best.separation + Floats(kWidePreference) * most;
    store(select(by_edge, best.edge_separation, best.separation), out.separation.lane + lane);
    store(select(best.apart, Ints(kApart), select(by_edge, best.edge_code, best.code)), out.code.lane + lane);
}

void FindAxes(std::span<const BoxPairBundle> pairs, std::span<BoxAxisBundle> axes, int lanes) {
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        for (int lane = 0; lane < lanes; lane += kLanes) find_axes(pairs[k], axes[k], lane);
    }
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(FindAxes);
void find_box_axes(std::span<const BoxPairBundle> pairs, std::span<BoxAxisBundle> axes, BoxLanes lanes) {
    if (lanes == BoxLanes::First) return CAROM_NARROW_DISPATCH(FindAxes)(pairs, axes, 1);
    HWY_DYNAMIC_DISPATCH(FindAxes)(pairs, axes, kBundleWidth);
}
}  // namespace carom::detail
#endif
