#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/dynamics/detail/body_kernels.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes.hpp>
#include <carom/dynamics/detail/body_kernels.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

using dynamics::SolverBase;
using dynamics::SolverBodies;
using dynamics::SolverBody;

constexpr std::size_t kBodyStride = sizeof(SolverBody) / sizeof(float);
constexpr std::size_t kBaseStride = sizeof(SolverBase) / sizeof(float);

// The rows from `first` on. Lanes beyond the last one before `end` repeat it, in what they write too: the next rows may be another thread's.
HWY_INLINE void list_rows(std::size_t first, std::size_t end, std::int32_t (&rows)[kLanes]) {
    const Ints next = lane_numbers() + Ints{static_cast<std::int32_t>(first)}, last{static_cast<std::int32_t>(end) - 1};
    store(select(next < last, next, last), rows);
}

void Kick(SolverBodies& all, std::size_t begin, std::size_t end, bool again) {
    auto* const bodies = reinterpret_cast<float*>(all.bodies.data());
    auto* const bases = reinterpret_cast<float*>(all.bases.data());
    const Mask carry = again ? first_lanes(kLanes) : first_lanes(0);
    const Floats zero(0.0f);
    for (std::size_t first = begin; first < end; first += static_cast<std::size_t>(kLanes)) {
        alignas(64) std::int32_t rows[kLanes];
        list_rows(first, end, rows);
        Floats vx, vy, vz, wx, wy, wz, bx, by, bz, cx, cy, cz, gx, gy, gz, kx, ky, kz, unused;
        gather_rows(bodies, rows, kBodyStride, 0, vx, vy, vz, unused);
        gather_rows(bodies, rows, kBodyStride, 4, wx, wy, wz, unused);
        gather_rows(bases, rows, kBaseStride, 0, bx, by, bz, kx);
        gather_rows(bases, rows, kBaseStride, 4, cx, cy, cz, ky);
        gather_rows(bases, rows, kBaseStride, 8, gx, gy, gz, kz);
        const Floats3 v{vx, vy, vz}, w{wx, wy, wz}, none{zero, zero, zero};
        const Floats3 pushed = select(carry, v - Floats3{bx, by, bz}, none), turned = select(carry, w - Floats3{cx, cy, cz}, none);
        const Floats3 base = v + Floats3{kx, ky, kz}, spin = w + Floats3{gx, gy, gz};
        scatter_rows(bases, rows, kBaseStride, 0, base.x, base.y, base.z, kx);
        scatter_rows(bases, rows, kBaseStride, 4, spin.x, spin.y, spin.z, ky);
        const Floats3 velocity = base + pushed, spun = spin + turned;
        scatter_rows(bodies, rows, kBodyStride, 0, velocity.x, velocity.y, velocity.z, zero);
        scatter_rows(bodies, rows, kBodyStride, 4, spun.x, spun.y, spun.z, zero);
    }
}

// turn += h/2 (0, spin) * turn, then back to unit length.
void Advance(SolverBodies& all, std::size_t begin, std::size_t end, float step) {
    auto* const bodies = reinterpret_cast<float*>(all.bodies.data());
    const Floats h(step), half = Floats(0.5f) * h;
    for (std::size_t first = begin; first < end; first += static_cast<std::size_t>(kLanes)) {
        alignas(64) std::int32_t rows[kLanes];
        list_rows(first, end, rows);
        Floats vx, vy, vz, wx, wy, wz, sx, sy, sz, qx, qy, qz, qw, unused;
        gather_rows(bodies, rows, kBodyStride, 0, vx, vy, vz, unused);
        gather_rows(bodies, rows, kBodyStride, 4, wx, wy, wz, unused);
        gather_rows(bodies, rows, kBodyStride, 8, sx, sy, sz, unused);
        gather_rows(bodies, rows, kBodyStride, 12, qx, qy, qz, qw);
        const Floats x = half * wx, y = half * wy, z = half * wz;
        const Floats nx = qx + ((x * qw + y * qz) - z * qy), ny = qy + ((y * qw + z * qx) - x * qz);
        const Floats nz = qz + ((z * qw + x * qy) - y * qx), nw = qw - ((x * qx + y * qy) + z * qz);
        const Floats scale = Floats(1.0f) / sqrt(((nx * nx + ny * ny) + nz * nz) + nw * nw);
        scatter_rows(bodies, rows, kBodyStride, 8, sx + h * vx, sy + h * vy, sz + h * vz, Floats(0.0f));
        scatter_rows(bodies, rows, kBodyStride, 12, scale * nx, scale * ny, scale * nz, scale * nw);
    }
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

void advance(SolverBodies& bodies, std::size_t begin, std::size_t end, float h) {
    HWY_DYNAMIC_DISPATCH(Advance)(bodies, begin, end, h);
}

}  // namespace dynamics
}  // namespace carom
#endif
