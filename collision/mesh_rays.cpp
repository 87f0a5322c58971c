#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/collision/mesh_rays.cpp>
#include <hwy/foreach_target.h>

#include <carom/collision/detail/ray_candidates.hpp>
#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/collision/detail/wide_ray.hpp>
#include <carom/collision/detail/wide_traverse.hpp>
#include <carom/collision/mesh_rays.hpp>
#include <carom/core/check.hpp>

#include <algorithm>
#include <bit>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

/// Of kLanes triangles of a leaf: which the ray hits in its interval, where, and with what weights.
struct LeafHits {
    alignas(64) float t[kLanes];
    alignas(64) float v[kLanes];    ///< edge functions, not yet divided by their sum
    alignas(64) float w[kLanes];
    alignas(64) float sum[kLanes];
    unsigned lanes = 0;

    HWY_INLINE void find(const TriangleLanes& triangle, Mask inside, const LeafImages& images, const Picks& a, const Picks& b,
                         const Picks& c, const WideRay& ray) {
        const Floats total = (triangle.u + triangle.v) + triangle.w;
        inside = inside & (total != Floats(0.0f));  // else the ray is in the plane of the triangle
        if (none(inside)) return;
        const Floats z = (triangle.u * a(images.z) + triangle.v * b(images.z)) + triangle.w * c(images.z);
        const Floats at = z / total * Floats(ray.depth);
        lanes = bits(inside & (at >= Floats(ray.t_min)) & (at <= Floats(ray.t_max)));
        if (lanes == 0) return;
        store(at, t);
        store(triangle.v, v);
        store(triangle.w, w);
        store(total, sum);
    }
};

/// Calls `part(first_lane, triangles, images, a, b, c)` for each register of a leaf's triangles.
template <class Part>
HWY_INLINE void for_parts(const WideLeaf& leaf, const WideRay& ray, Part&& part) {
    const LeafImages images(leaf, ray);
    for (int at = 0; at < kWidth; at += kLanes) {
        if (at != 0 && static_cast<std::uint32_t>(at) >= leaf.triangle_count) break;
        const Picks a(leaf.corner[0] + at), b(leaf.corner[1] + at), c(leaf.corner[2] + at);
        part(static_cast<std::size_t>(at), TriangleLanes(images, a, b, c), images, a, b, c);
    }
}

/// Keeps the closest hit.
struct Closest {
    WideRay& ray;
    std::uint32_t triangle = MeshHit::kNone;
    float v = 0.0f, w = 0.0f, sum = 1.0f;

    HWY_INLINE bool operator()(const WideLeaf& leaf) {
        for_parts(leaf, ray, [&](std::size_t at, const TriangleLanes& lanes, const LeafImages& images, const Picks& a, const Picks& b,
                                 const Picks& c) HWY_ATTR {
            const Mask inside = lanes.inside();
            if (none(inside)) return;
            LeafHits hits;
            hits.find(lanes, inside, images, a, b, c, ray);
            for (unsigned rest = hits.lanes; rest != 0; rest &= rest - 1) {
                const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
                const std::uint32_t number = leaf.triangle[at + lane];
                if (hits.t[lane] < ray.t_max || (hits.t[lane] == ray.t_max && number < triangle)) {
                    ray.t_max = hits.t[lane];
                    triangle = number;
                    v = hits.v[lane], w = hits.w[lane], sum = hits.sum[lane];
                }
            }
        });
        return true;
    }
};

HWY_INLINE bool hits_leaf(const WideLeaf& leaf, const WideRay& ray) {
    bool hit = false;
    for_parts(leaf, ray, [&](std::size_t, const TriangleLanes& lanes, const LeafImages& images, const Picks& a, const Picks& b,
                             const Picks& c) HWY_ATTR {
        const Mask inside = lanes.inside();
        if (none(inside)) return;
        LeafHits hits;
        hits.find(lanes, inside, images, a, b, c, ray);
        hit = hit || hits.lanes != 0;
    });
    return hit;
}

/// The edge function of p and q with the ray moved aside by (e, e^2) for an infinitesimal e > 0; zero only where p = q.
HWY_INLINE Floats aside(Floats side, Floats px, Floats py, Floats qx, Floats qy) {
    const Floats zero(0.0f);
    const Floats by_y = py - qy;
    return select(side != zero, side, select(by_y != zero, by_y, qx - px));
}

HWY_INLINE Mask crossed_aside(const TriangleLanes& t) {
    const Floats zero(0.0f);
    const Floats u = aside(t.u, t.cx, t.cy, t.bx, t.by);
    const Floats v = aside(t.v, t.ax, t.ay, t.cx, t.cy);
    const Floats w = aside(t.w, t.bx, t.by, t.ax, t.ay);
    return (min(min(u, v), w) > zero) | (max(max(u, v), w) < zero);
}

MeshHit cast_closest(const WideBvh& tree, const geo::Ray<float>& from) {
    WideRay ray;
    if (!prepare_lanes(tree, from, ray)) return {};
    Closest closest{ray};
    traverse(tree, ray, closest);
    if (closest.triangle == MeshHit::kNone) return {};
    return {ray.caller_t(ray.t_max), closest.triangle, closest.v / closest.sum, closest.w / closest.sum};
}

bool cast_any(const WideBvh& tree, const geo::Ray<float>& from, LastOccluder* last) {
    WideRay ray;
    if (!prepare_lanes(tree, from, ray)) return false;
    if (last != nullptr && last->tree == tree.lines.data() && hits_leaf(tree.leaf(last->leaf), ray)) return true;
    bool hit = false;
    traverse(tree, ray, [&](const WideLeaf& leaf) HWY_ATTR {
        hit = hits_leaf(leaf, ray);
        if (hit && last != nullptr) {
            const auto line = reinterpret_cast<const WideBvh::Line*>(&leaf) - tree.lines.data();
            *last = {tree.lines.data(), ~static_cast<WideRef>(line)};
        }
        return !hit;
    });
    return hit;
}

void cast_all(const WideBvh& tree, const geo::Ray<float>& from, std::vector<MeshHit>& found) {
    WideRay ray;
    if (!prepare_lanes(tree, from, ray)) return;
    traverse(tree, ray, [&](const WideLeaf& leaf) HWY_ATTR {
        for_parts(leaf, ray, [&](std::size_t at, const TriangleLanes& lanes, const LeafImages& images, const Picks& a, const Picks& b,
                                 const Picks& c) HWY_ATTR {
            if (none(lanes.inside())) return;
            LeafHits hits;
            hits.find(lanes, crossed_aside(lanes), images, a, b, c, ray);
            for (unsigned rest = hits.lanes; rest != 0; rest &= rest - 1) {
                const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
                found.push_back({ray.caller_t(hits.t[lane]), leaf.triangle[at + lane], hits.v[lane] / hits.sum[lane],
                                 hits.w[lane] / hits.sum[lane]});
            }
        });
        return true;
    });
}

void cast_closest_range(const WideBvh& tree, const geo::Ray<float>* rays, MeshHit* hits, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) hits[i] = cast_closest(tree, rays[i]);
}

void cast_any_range(const WideBvh& tree, const geo::Ray<float>* rays, std::uint8_t* occluded, std::size_t count) {
    LastOccluder last;
    for (std::size_t i = 0; i < count; ++i) occluded[i] = cast_any(tree, rays[i], &last) ? 1 : 0;
}

/// See ray_candidates.hpp. A triangle is left out where the edge functions have both signs by more than the images' errors allow.
void visit_candidates(const WideBvh& tree, WideRay& ray, FunctionRef<float(const WideLeaf&, unsigned)> visit) {
    traverse(tree, ray, [&](const WideLeaf& leaf) HWY_ATTR {
        unsigned candidates = 0;
        for_parts(leaf, ray, [&](std::size_t at, const TriangleLanes& t, const LeafImages&, const Picks&, const Picks&,
                                 const Picks&) HWY_ATTR {
            const Floats error(ray.image_error);
            const Floats size = ((abs(t.ax) + abs(t.ay)) + (abs(t.bx) + abs(t.by))) + (abs(t.cx) + abs(t.cy));
            const Floats doubt = error * (size + (error + error));
            const Mask outside = (min(min(t.u, t.v), t.w) < -doubt) & (max(max(t.u, t.v), t.w) > doubt);
            candidates |= bits(!outside) << at;
        });
        candidates &= (1u << leaf.triangle_count) - 1u;
        if (candidates != 0) ray.t_max = visit(leaf, candidates);
        return true;
    });
}

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom {
namespace {

HWY_EXPORT(cast_closest);
HWY_EXPORT(cast_any);
HWY_EXPORT(cast_all);
HWY_EXPORT(cast_closest_range);
HWY_EXPORT(cast_any_range);
HWY_EXPORT(visit_candidates);

constexpr std::size_t kGrain = 256;  // rays; a few tens of microseconds

}  // namespace

MeshHit closest_hit(const StaticBvh& bvh, const geo::Ray<float>& ray) noexcept {
    return HWY_DYNAMIC_DISPATCH(cast_closest)(bvh.wide(), ray);
}

bool any_hit(const StaticBvh& bvh, const geo::Ray<float>& ray, LastOccluder* last) noexcept {
    return HWY_DYNAMIC_DISPATCH(cast_any)(bvh.wide(), ray, last);
}

void all_hits(const StaticBvh& bvh, const geo::Ray<float>& ray, std::vector<MeshHit>& hits) {
    hits.clear();
    HWY_DYNAMIC_DISPATCH(cast_all)(bvh.wide(), ray, hits);
    std::stable_sort(hits.begin(), hits.end(), [](const MeshHit& a, const MeshHit& b) {
        return a.t != b.t ? a.t < b.t : a.triangle < b.triangle;
    });
}

void closest_hits(const StaticBvh& bvh, std::span<const geo::Ray<float>> rays, std::span<MeshHit> hits, Executor& executor) {
    CAROM_REQUIRE(rays.size() == hits.size(), ErrorCode::InvalidArgument, "rays and hits differ in size");
    const auto cast = HWY_DYNAMIC_DISPATCH(cast_closest_range);
    executor.parallel_for(rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        cast(bvh.wide(), rays.data() + begin, hits.data() + begin, end - begin);
    });
}

void any_hits(const StaticBvh& bvh, std::span<const geo::Ray<float>> rays, std::span<std::uint8_t> occluded, Executor& executor) {
    CAROM_REQUIRE(rays.size() == occluded.size(), ErrorCode::InvalidArgument, "rays and occluded differ in size");
    const auto cast = HWY_DYNAMIC_DISPATCH(cast_any_range);
    executor.parallel_for(rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        cast(bvh.wide(), rays.data() + begin, occluded.data() + begin, end - begin);
    });
}

void visit_ray_candidates(const WideBvh& tree, WideRay& ray, FunctionRef<float(const WideLeaf& leaf, unsigned triangles)> visit) {
    HWY_DYNAMIC_DISPATCH(visit_candidates)(tree, ray, visit);
}

}  // namespace carom
#endif
