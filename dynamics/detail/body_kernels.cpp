#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/dynamics/detail/body_kernels.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes.hpp>
#include <carom/dynamics/detail/body_kernels.hpp>
#include <carom/dynamics/detail/body_rows.hpp>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

using dynamics::SolverBodies;
using dynamics::SolverBody;

constexpr std::size_t kBodyStride = sizeof(SolverBody) / sizeof(float);
static_assert(offsetof(SolverBody, spin) == 16 && offsetof(dynamics::SolverBase, spin) == 16 && offsetof(dynamics::SolverBase, turn) == 48);

// The rows from `first` on. Lanes beyond the last one before `end` repeat it, in what they write too: the next rows may be another thread's.
HWY_INLINE void list_rows(std::size_t first, std::size_t end, std::int32_t (&rows)[kLanes]) {
    const Ints next = lane_numbers() + Ints{static_cast<std::int32_t>(first)}, last{static_cast<std::int32_t>(end) - 1};
    store(select(next < last, next, last), rows);
}

// Velocity and spin of a row are eight floats, and so are base and kick: there is nothing to transpose.
void Kick(SolverBodies& all, std::size_t begin, std::size_t end, bool again) {
    const hn::CappedTag<float, 8> part;
    for (std::size_t row = begin; row < end; ++row) {
        float* const motion = all.bodies[row].velocity;
        float* const base = all.bases[row].velocity;
        const float* const kick = all.bases[row].kick;
        for (std::size_t k = 0; k < 8; k += hn::MaxLanes(part)) {
            const auto now = hn::Load(part, motion + k);
            const auto pushed = again ? hn::Sub(now, hn::Load(part, base + k)) : hn::Zero(part);
            const auto next = hn::Add(now, hn::Load(part, kick + k));
            hn::Store(next, part, base + k);
            hn::Store(hn::Add(next, pushed), part, motion + k);
        }
    }
}

// turn += h/2 (0, spin) * turn, then back to unit length.
float Advance(SolverBodies& all, std::size_t begin, std::size_t end, float step) {
    auto* const bodies = reinterpret_cast<float*>(all.bodies.data());
    const Floats h(step), half = Floats(0.5f) * h;
    Floats fastest(0.0f);
    for (std::size_t first = begin; first < end; first += static_cast<std::size_t>(kLanes)) {
        alignas(64) std::int32_t rows[kLanes];
        list_rows(first, end, rows);
        const TwoRows motion = gather_two_rows(bodies, rows, kBodyStride, 0), place = gather_two_rows(bodies, rows, kBodyStride, 8);
        fastest = max(fastest, (motion.e * motion.e + motion.f * motion.f) + motion.g * motion.g);
        const Floats &qx = place.e, &qy = place.f, &qz = place.g, &qw = place.h;
        const Floats x = half * motion.e, y = half * motion.f, z = half * motion.g;
        const Floats nx = qx + ((x * qw + y * qz) - z * qy), ny = qy + ((y * qw + z * qx) - x * qz);
        const Floats nz = qz + ((z * qw + x * qy) - y * qx), nw = qw - ((x * qx + y * qy) + z * qz);
        const Floats scale = Floats(1.0f) / sqrt(((nx * nx + ny * ny) + nz * nz) + nw * nw);
        scatter_rows(bodies, rows, kBodyStride, 8, place.a + h * motion.a, place.b + h * motion.b, place.c + h * motion.c, Floats(0.0f));
        scatter_rows(bodies, rows, kBodyStride, 12, scale * nx, scale * ny, scale * nz, scale * nw);
    }
    return greatest_lane(fastest);
}

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom {
HWY_EXPORT(Kick);
HWY_EXPORT(Advance);

namespace dynamics {

void kick(SolverBodies& bodies, std::size_t begin, std::size_t end, WarmStart warm_start) {
    HWY_DYNAMIC_DISPATCH(Kick)(bodies, begin, end, warm_start == WarmStart::Again);
}

float advance(SolverBodies& bodies, std::size_t begin, std::size_t end, float h) {
    return HWY_DYNAMIC_DISPATCH(Advance)(bodies, begin, end, h);
}

}  // namespace dynamics
}  // namespace carom
#endif
