// A ray prepared for the wide hierarchy, and the proof that its boxes are wide enough.
//
//   WideRay r;
//   if (prepare(tree, ray, r)) traverse...
//
// Write u = 2^-24, o for the origin, D for the largest distance along an axis from o to the tree's box, z for the axis of the
// direction's largest component, and x for either of the others. All is in the tree's coordinates, |d_z| in [1, 2).
//
// Images. Vertex p has the image x' = fma(-s, p_z - o_z, p_x - o_x) with s = d_x (1/d_z), |s| <= 1. Both differences are wrong by
// u D at most, s by 2u, the result by u (D + D): together by 6 u D. The signs of the edge functions of images are exact, so a triangle
// that is accepted holds the origin in its image: for some weights w_i >= 0 that sum to 1, sum w_i x'_i = 0. So the ray's point Q at
// depth z* = sum w_i (p_z,i - o_z) lies within 6 u D of the point sum w_i p_i of the triangle, which is in each box round it.
//
// Depth. The computed t is (U z_a + V z_b + W z_c) / (U + V + W) / d_z with all of U, V, W of one sign and each right to 3u: the
// weights are right to 8u together with their sum, products, two sums and the division add 4u, the depths themselves are wrong by
// u D, 1/d_z and its product by 2u: t d_z is within 15 u D of z*.
//
// Slabs. near_k = fma(b, r, c), r = 1/d_k, c = -(o + e) r, and far_k with -e (signs as d_k > 0). In units of length along axis k, r
// and the last rounding change near_k by 2u |near_k d_k| <= 2 u D, c is wrong by 2u (|o| + e); where there is no fused instruction
// b r adds u |b| <= u (|o| + D). So near_k is below Q's parameter, and below the computed t, if
//     e >= 6 u D + 15 u D + 2 u D + u D + 3 u |o| + (terms of u^2),
// and far_k above them. e = 28 u (D + |o|) is that and a margin for D's own rounding. Components of d below 1e-18 count as that
// large: the ray drifts by 1e-18 D, which the margin holds too; so 0 times infinity never arises.
//
// Hence: a triangle with computed t is below boxes with near <= t <= far. Skipping boxes with near > t_max loses no hit of t <=
// t_max, and the closest hit does not depend on the tree.
//
// A ray in double is rounded to float for the boxes: that moves its points by u |o| + 2 u D, less than the images' share above.
#pragma once

#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/collision/primitives.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace carom {

struct WideRay {
    static constexpr float kPad = 28.0f * 0x1p-24f;
    static constexpr float kLeastComponent = 1e-18f;
    static constexpr float kLeastBound = 0x1p-60f;  ///< of t: smaller ones may underflow in the tree's units

    // Three floats each; lanes write a fourth.
    alignas(16) float origin[4];
    alignas(16) float inverse[4];
    alignas(16) float near[4];         ///< for the planes met first
    alignas(16) float far[4];
    alignas(16) std::int32_t back[4];  ///< 1 where the direction is negative: the upper plane is met first
    std::int32_t axis[3];        ///< x, y, z above, in the order of a rotation
    float shear[2];
    float depth;                 ///< 1 / d_z
    float t_min;                 ///< >= +0
    float t_max;
    float image_error;           ///< bound of an image's error for a ray in double
    double moved;                ///< parameter at `origin`
    double unit;                 ///< t of the caller = (moved + t) unit

    [[nodiscard]] float caller_t(float t) const noexcept {
        return static_cast<float>((moved + static_cast<double>(t)) * unit);
    }
    /// @return the parameter at the caller's `t`, rounded up.
    [[nodiscard]] float own_t(double t) const noexcept;
};

/// Prepares a ray in double whose origin need not be near; out.t_max is rounded up. Meant for ray_candidates.hpp.
/// @return false where the ray is bad input or surely misses.
[[nodiscard]] bool prepare(const WideBvh& tree, const geo::Ray<double>& ray, WideRay& out) noexcept;

/// The same for a ray in float, one number at a time. Kernels have prepare_lanes (wide_traverse.hpp), which gives the same bits.
[[nodiscard]] bool prepare(const WideBvh& tree, const geo::Ray<float>& ray, WideRay& out) noexcept;

/// The same by way of double, which has room for every case. Bounds are exact: what out.t_min <= t <= out.t_max says of a t is what
/// the ray's own bounds say of caller_t(t).
[[nodiscard]] bool prepare_unusual(const WideBvh& tree, const geo::Ray<float>& ray, WideRay& out) noexcept;

[[nodiscard]] inline std::int32_t largest_axis(float x, float y, float z) noexcept {
    const std::int32_t xy = x >= y ? 0 : 1;
    return (x >= y ? x : y) >= z ? xy : 2;
}

/// What brings a direction's largest component into [1, 2), and back.
struct UnitBinade {
    float shrink, grow;
    explicit UnitBinade(std::uint32_t exponent) noexcept
        : shrink(std::bit_cast<float>((254u - exponent) << 23)), grow(std::bit_cast<float>(exponent << 23)) {}
};

/// True where a ray needs neither moving nor scaling, but for non-finite components. @param exponent  of its largest component, biased.
[[nodiscard]] inline bool is_usual(const WideBvh& tree, const geo::Ray<float>& ray, float reach, std::uint32_t exponent) noexcept {
    return (exponent - 64u < 127u) & (reach <= tree.far_reach) & ((ray.t_min == 0.0f) | (ray.t_min >= WideRay::kLeastBound)) &
           (ray.t_max >= WideRay::kLeastBound) & (ray.t_min <= ray.t_max);
}

inline void set_bounds(const geo::Ray<float>& ray, UnitBinade binade, WideRay& out) noexcept {
    out.t_min = ray.t_min * binade.grow + 0.0f;
    out.t_max = ray.t_max * binade.grow;
    out.moved = 0.0;
    out.unit = static_cast<double>(binade.shrink);
}

}  // namespace carom
