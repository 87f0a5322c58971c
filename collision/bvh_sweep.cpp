#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/collision/bvh_sweep.cpp>
#include <hwy/foreach_target.h>

#include <carom/collision/bvh_sweep.hpp>
#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/collision/detail/wide_ray.hpp>
#include <carom/collision/detail/wide_traverse.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

/// @return as bits, the triangles of a leaf whose boxes the ray meets: slabs as for nodes.
HWY_INLINE unsigned meet_triangles(const WideLeaf& leaf, const WideRay& ray, const SlabLanes& slabs) {
    Table16 table[3];
    for (int k = 0; k < 3; ++k) {
        for (int part = 0; part < kParts; ++part) table[k].set(part, load(leaf.vertex[k] + part * kLanes));
    }
    unsigned met = 0;
    for (int at = 0; at < kWidth && static_cast<std::uint32_t>(at) < leaf.triangle_count; at += kLanes) {
        const Picks a(leaf.corner[0] + at), b(leaf.corner[1] + at), c(leaf.corner[2] + at);
        Floats near(ray.t_min), far(ray.t_max);
        for (int k = 0; k < 3; ++k) {
            const Floats pa = a(table[k]), pb = b(table[k]), pc = c(table[k]);
            const Floats low = min(min(pa, pb), pc), high = max(max(pa, pb), pc);
            const bool back = slabs.back[k] != 0;
            near = max(near, multiply_add(back ? high : low, slabs.inverse[k], slabs.near[k]));
            far = min(far, multiply_add(back ? low : high, slabs.inverse[k], slabs.far[k]));
        }
        met |= bits(near <= far) << at;
    }
    return met & ((1u << leaf.triangle_count) - 1u);
}

void visit_along(const WideBvh& tree, WideRay& ray, SweepVisit visit) {
    const SlabLanes slabs(ray);
    traverse(tree, ray, [&](const WideLeaf& leaf) HWY_ATTR {
        for (unsigned rest = meet_triangles(leaf, ray, slabs); rest != 0; rest &= rest - 1) {
            const float t = ray.own_t(visit(leaf.triangle[std::countr_zero(rest)]));
            ray.t_max = t < ray.t_max ? t : ray.t_max;
        }
        return ray.t_max >= 0.0f;
    });
}

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom {
namespace {

HWY_EXPORT(visit_along);

/// Sets what slabs read. As in wide_ray.hpp, with the pads larger by the box, and what rounding then does to them.
/// @return false where a float of the tree's coordinates cannot hold the path.
bool prepare_box(const WideBvh& tree, const geo::Ray<double>& ray, const dvec3& half, WideRay& out) noexcept {
    const double scale = static_cast<double>(tree.scale);
    const double largest = std::max({std::abs(ray.direction.x), std::abs(ray.direction.y), std::abs(ray.direction.z)});
    const int exponent = largest > 0.0 ? std::ilogb(largest) : 0;
    out.unit = std::ldexp(1.0 / scale, -exponent);
    out.moved = 0.0;
    const double widest = std::max({half.x, half.y, half.z}) * scale;
    double reach = 0.0, distance = 0.0;
    for (int k = 0; k < 3; ++k) {
        const double from = ray.origin[k] * scale;
        reach = std::max({reach, std::abs(static_cast<double>(tree.lower[k]) - from), std::abs(static_cast<double>(tree.upper[k]) - from)});
        distance = std::max(distance, std::abs(from));
    }
    const double rounding = 2.0 * static_cast<double>(WideRay::kPad) * (reach + distance + widest);
    if (!(rounding < 1e18)) return false;
    for (int k = 0; k < 3; ++k) {
        const float origin = static_cast<float>(ray.origin[k] * scale);
        const float d = static_cast<float>(std::ldexp(ray.direction[k], -exponent));
        const float component = std::copysign(std::max(std::abs(d), WideRay::kLeastComponent), d);
        const float side = std::copysign(static_cast<float>(half[k] * scale + rounding), component);
        out.origin[k] = origin;
        out.inverse[k] = 1.0f / component;
        out.near[k] = -(origin + side) * out.inverse[k];
        out.far[k] = -(origin - side) * out.inverse[k];
        out.back[k] = std::signbit(component) ? 1 : 0;
    }
    out.t_min = 0.0f;
    out.t_max = largest > 0.0 ? out.own_t(ray.t_max) : 0.0f;
    return true;
}

}  // namespace

void triangles_along(const StaticBvh& bvh, const geo::Ray<double>& ray, const dvec3& half, SweepVisit visit) {
    if (!is_finite(ray.origin) || !is_finite(ray.direction) || !is_finite(half) || !(ray.t_max >= 0.0)) return;
    if (!(half.x >= 0.0 && half.y >= 0.0 && half.z >= 0.0)) return;
    WideRay wide;
    if (prepare_box(bvh.wide(), ray, half, wide)) {
        HWY_DYNAMIC_DISPATCH(visit_along)(bvh.wide(), wide, visit);
        return;
    }
    for (std::uint32_t i = 0; i < bvh.triangle_count(); ++i) visit(i);  // so far away or so large that floats cannot tell
}

}  // namespace carom
#endif
