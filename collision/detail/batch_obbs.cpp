// Many turned boxes against one, by the fifteen axes of separating_axes.cpp, in float with a bound on its rounding.
#include <carom/core/simd_targets.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/collision/detail/batch_obbs.cpp>
#include <hwy/foreach_target.h>

#include <carom/collision/detail/batch_kernels.hpp>
#include <carom/core/lanes.hpp>

#include <carom/collision/detail/record_lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::geo::detail::HWY_NAMESPACE {
namespace {

constexpr float kEps = 0x1p-23f;

Floats3 splat(const vec3& v) { return {v.x, v.y, v.z}; }
Floats sum_of_sizes(const Floats3& v) { return (abs(v.x) + abs(v.y)) + abs(v.z); }

// What the axes say so far, lane by lane.
struct Verdicts {
    Mask apart;
    Mask unclear;
};

// Sums of products of what already carries three roundings: a gap errs by less than 12 eps of the lengths' sum, `reach`. The test in
// double finds boxes apart from a gap of 7 eps `reach` on, and is sure of an overlap from as much on.
void judge(Floats gap, Floats reach, Mask counts, Verdicts& v) {
    v.apart = v.apart | (counts & (gap > 24.0f * kEps * reach));
    v.unclear = v.unclear | (counts & (!(gap < -24.0f * kEps * reach)));
}

std::size_t box_boxes(const Obb<float>& box, std::span<const Obb<float>> boxes, std::uint8_t* hit, std::int32_t* unclear) {
    const Floats3 axes[3] = {splat(box.axes[0]), splat(box.axes[1]), splat(box.axes[2])};
    const Floats3 center = splat(box.center), half_a = splat(box.half_extents);
    const Floats ha[3] = {half_a.x, half_a.y, half_a.z};
    const bool is_void = box.half_extents.x < 0.0f || box.half_extents.y < 0.0f || box.half_extents.z < 0.0f;
    const Mask all_lanes = first_lanes(kLanes);
    std::size_t unsure = 0;
    for (std::size_t i = 0; i < boxes.size(); i += static_cast<std::size_t>(kLanes)) {
        Floats x[15];
        load_records<15>(&boxes.data()->center.x, i, boxes.size(), x);
        const Floats3 d = Floats3{x[0], x[1], x[2]} - center;
        const Floats hb[3] = {x[3], x[4], x[5]};
        const Floats t[3] = {dot(axes[0], d), dot(axes[1], d), dot(axes[2], d)};
        Floats r[3][3], s[3][3];  // [j][i]: axis i of `box` along axis j of the other; its size
        for (int j = 0; j < 3; ++j) {
            const Floats3 axis{x[6 + 3 * j], x[7 + 3 * j], x[8 + 3 * j]};
            for (int k = 0; k < 3; ++k) r[j][k] = dot(axes[k], axis), s[j][k] = abs(r[j][k]);
        }
        const Floats reach = sum_of_sizes(d) + sum_of_sizes(half_a) + ((abs(hb[0]) + abs(hb[1])) + abs(hb[2]));
        Verdicts v{!all_lanes, !all_lanes};
        for (int k = 0; k < 3; ++k) {
            judge(abs(t[k]) - (ha[k] + (hb[0] * s[0][k] + hb[1] * s[1][k] + hb[2] * s[2][k])), reach, all_lanes, v);
        }
        for (int j = 0; j < 3; ++j) {
            const Floats along = t[0] * r[j][0] + t[1] * r[j][1] + t[2] * r[j][2];
            judge(abs(along) - (hb[j] + (ha[0] * s[j][0] + ha[1] * s[j][1] + ha[2] * s[j][2])), reach, all_lanes, v);
        }
        const Mask sized = (reach < 0x1p60f) & (reach > 0x1p-28f);
        if (!all(v.apart & sized)) {
            for (int k = 0; k < 3; ++k) {
                const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
                for (int j = 0; j < 3; ++j) {
                    const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
                    const Floats beyond = (ha[k1] * s[j][k2] + ha[k2] * s[j][k1]) + (hb[j1] * s[j2][k] + hb[j2] * s[j1][k]);
                    // Parallel in double too, where the limit is 16 eps.
                    const Mask parallel = max(s[j][k1], s[j][k2]) <= 8.0f * kEps;
                    judge(abs(t[k2] * r[j][k1] - t[k1] * r[j][k2]) - beyond, reach, !parallel, v);
                }
            }
        }
        const Mask empty = (hb[0] < 0.0f) | (hb[1] < 0.0f) | (hb[2] < 0.0f) | (is_void ? all_lanes : !all_lanes);
        const Mask clear = empty | (sized & (v.apart | (!v.unclear)));
        store_truths(!(empty | v.apart), boxes.size() - i, hit + i);
        unsure += note_unclear(!clear, i, boxes.size(), unclear + unsure);
    }
    return unsure;
}

}  // namespace
}  // namespace carom::geo::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace carom::geo::detail {

HWY_EXPORT(box_boxes);

std::size_t box_boxes(const Obb<float>& box, std::span<const Obb<float>> boxes, std::uint8_t* hit, std::int32_t* unclear) {
    return HWY_DYNAMIC_DISPATCH(box_boxes)(box, boxes, hit, unclear);
}

}  // namespace carom::geo::detail

#endif
