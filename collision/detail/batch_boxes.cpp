// Many boxes along the axes against one ray or one sphere, in float with a bound on its rounding.
#include <carom/core/simd_targets.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/collision/detail/batch_boxes.cpp>
#include <hwy/foreach_target.h>

#include <carom/collision/detail/batch_kernels.hpp>
#include <carom/core/lanes.hpp>

#include <limits>

#include <carom/collision/detail/record_lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::geo::detail::HWY_NAMESPACE {
namespace {

constexpr float kEps = 0x1p-23f;      // twice the relative error of one operation
constexpr float kTooLarge = 0x1p60f;  // so that no product overflows
constexpr float kHuge = 0x1p125f;     // and above what two of them give

/// Whether each component is zero or such that it can be divided by, and one is not zero.
bool is_usable(const vec3& direction) {
    bool usable = true, moves = false;
    for (int k = 0; k < 3; ++k) {
        const float size = direction[k] < 0.0f ? -direction[k] : direction[k];
        usable = usable && (size == 0.0f || (size > 1.0f / kTooLarge && size < kTooLarge));
        moves = moves || size > 0.0f;
    }
    return usable && moves;
}

// A quotient of two coordinate differences errs by 2 eps of itself: the difference, the reciprocal and the product.
std::size_t ray_boxes(const Ray<float>& ray, std::span<const Aabb<float>> boxes, float* t, std::int32_t* unclear) {
    const Floats origin[3] = {ray.origin.x, ray.origin.y, ray.origin.z};
    const Floats inverse[3] = {1.0f / ray.direction.x, 1.0f / ray.direction.y, 1.0f / ray.direction.z};
    const Floats infinity = std::numeric_limits<float>::infinity();
    const bool usable = is_usable(ray.direction);
    std::size_t unsure = 0;
    for (std::size_t i = 0; i < boxes.size(); i += static_cast<std::size_t>(kLanes)) {
        Floats box[6];
        load_records<6>(&boxes.data()->lower.x, i, boxes.size(), box);
        Floats enter = ray.t_min, leave = ray.t_max, size = 0.0f;
        Mask known = first_lanes(kLanes), empty = !known;
        for (int k = 0; k < 3; ++k) {
            const Floats low = box[k] - origin[k], high = box[k + 3] - origin[k];
            const Floats t0 = low * inverse[k], t1 = high * inverse[k];
            enter = max(min(t0, t1), enter);
            leave = min(max(t0, t1), leave);
            size += abs(low) + abs(high);
            known = known & (t0 == t0) & (t1 == t1);  // an axis of no direction, from a point on a face, is 0 * infinity
            empty = empty | (box[k] > box[k + 3]);
        }
        const Floats error = 8.0f * kEps * (min(abs(enter), kHuge) + min(abs(leave), kHuge)) + 0x1p-126f;
        const Mask miss = empty | (enter > leave + error) | (enter == infinity) | (leave == -infinity);
        const Mask hit = (enter < leave - error) & (!miss);
        const Mask clear = known & (size < kTooLarge) & (hit | miss);
        store_some(select(hit, enter, infinity), boxes.size() - i, t + i);
        unsure += note_unclear(usable ? !clear : first_lanes(kLanes), i, boxes.size(), unclear + unsure);
    }
    return unsure;
}

// Each difference errs by eps/2 of itself, so the square of the distance by 4 eps of itself.
std::size_t sphere_boxes(const Sphere<float>& sphere, std::span<const Aabb<float>> boxes, std::uint8_t* hit, std::int32_t* unclear) {
    const Floats center[3] = {sphere.center.x, sphere.center.y, sphere.center.z};
    const float radius_sq = sphere.radius * sphere.radius;
    const bool usable = sphere.radius >= 0.0f && radius_sq > 0x1p-60f && radius_sq < kTooLarge;
    const Floats inner = radius_sq * (1.0f - 16.0f * kEps), outer = radius_sq * (1.0f + 16.0f * kEps);
    std::size_t unsure = 0;
    for (std::size_t i = 0; i < boxes.size(); i += static_cast<std::size_t>(kLanes)) {
        Floats box[6];
        load_records<6>(&boxes.data()->lower.x, i, boxes.size(), box);
        Floats sq = 0.0f, size = 0.0f;
        Mask empty = !first_lanes(kLanes);
        for (int k = 0; k < 3; ++k) {
            const Floats low = box[k] - center[k], high = center[k] - box[k + 3];
            const Floats outside = max(max(low, high), 0.0f);
            sq += outside * outside;
            size += abs(low) + abs(high);
            empty = empty | (box[k] > box[k + 3]);
        }
        // The answer in double allows for a gap of 2^-49 of the size.
        const Mask apart = empty | (sq > outer + 0x1p-70f * (size * size));
        const Mask clear = (size < 0x1p30f) & (apart | (sq < inner));
        store_truths(!apart, boxes.size() - i, hit + i);
        unsure += note_unclear(usable ? !clear : first_lanes(kLanes), i, boxes.size(), unclear + unsure);
    }
    return unsure;
}

}  // namespace
}  // namespace carom::geo::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace carom::geo::detail {

HWY_EXPORT(ray_boxes);
HWY_EXPORT(sphere_boxes);

std::size_t ray_boxes(const Ray<float>& ray, std::span<const Aabb<float>> boxes, float* t, std::int32_t* unclear) {
    return HWY_DYNAMIC_DISPATCH(ray_boxes)(ray, boxes, t, unclear);
}
std::size_t sphere_boxes(const Sphere<float>& sphere, std::span<const Aabb<float>> boxes, std::uint8_t* hit, std::int32_t* unclear) {
    return HWY_DYNAMIC_DISPATCH(sphere_boxes)(sphere, boxes, hit, unclear);
}

}  // namespace carom::geo::detail

#endif
