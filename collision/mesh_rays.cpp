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
#include <array>
#include <bit>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

/// The edge function of the images p and q, exact but for one rounding: products of floats are exact in double.
double edge(double px, double py, double qx, double qy) { return px * qy - py * qx; }

/// The sign of the same with the ray moved aside by (e, e^2) for an infinitesimal e > 0; zero only where p = q.
double edge_aside(double px, double py, double qx, double qy) {
    const double side = edge(px, py, qx, qy);
    return side != 0.0 ? side : (py != qy ? py - qy : qx - px);
}

bool has_both_signs(const std::array<double, 3>& x) {
    return (x[0] < 0.0 || x[1] < 0.0 || x[2] < 0.0) && (x[0] > 0.0 || x[1] > 0.0 || x[2] > 0.0);
}

/// Which triangles count of those that the ray passes through an edge or a corner of.
enum class Seams {
    Both,    ///< all of them
    OneSide  ///< those that are still passed with the ray moved aside by an infinitesimal
};

/// Images of triangles and what a ray is to them, apart from the registers of the usual way: those stay registers only where no
/// function is given their address.
struct Images {
    alignas(64) float x[3][kLanes];
    alignas(64) float y[3][kLanes];
    alignas(64) float z[3][kLanes];
    float t[kLanes];  ///< of what is found
    float v[kLanes];
    float w[kLanes];
    float depth, t_min, t_max;

    HWY_INLINE Images(const TriangleLanes& from, const WideRay& ray) : depth(ray.depth), t_min(ray.t_min), t_max(ray.t_max) {
        store(from.ax, x[0]), store(from.bx, x[1]), store(from.cx, x[2]);
        store(from.ay, y[0]), store(from.by, y[1]), store(from.cy, y[2]);
    }

    /// `of`(p, q) for the edges opposite to each corner of triangle k.
    template <class Edge>
    std::array<double, 3> edges(std::size_t k, Edge of) const {
        return {of(x[2][k], y[2][k], x[1][k], y[1][k]), of(x[0][k], y[0][k], x[2][k], y[2][k]), of(x[1][k], y[1][k], x[0][k], y[0][k])};
    }

    /// In double, the lanes whose triangles are so small that products of their images underflow, or in a plane with the ray.
    /// @return those that are hit.
    HWY_NOINLINE unsigned find_tiny(unsigned tiny) {
        unsigned found = 0;
        for (; tiny != 0; tiny &= tiny - 1) {
            const auto k = static_cast<std::size_t>(std::countr_zero(tiny));
            const std::array<double, 3> weight = edges(k, edge);
            const double total = weight[0] + weight[1] + weight[2];
            if (has_both_signs(weight) || total == 0.0) continue;  // zero: in the plane of the triangle
            double at = 0.0;
            for (std::size_t i = 0; i < 3; ++i) at += weight[i] / total * static_cast<double>(z[i][k]);
            t[k] = static_cast<float>(at * static_cast<double>(depth));
            if (!(t[k] >= t_min && t[k] <= t_max)) continue;
            v[k] = static_cast<float>(weight[1] / total), w[k] = static_cast<float>(weight[2] / total);
            found |= 1u << k;
        }
        return found;
    }

    /// @return those that the ray, moved aside, passes by.
    HWY_NOINLINE unsigned far_sides(unsigned seams) const {
        unsigned passed = 0;
        for (; seams != 0; seams &= seams - 1) {
            const auto k = static_cast<std::size_t>(std::countr_zero(seams));
            if (has_both_signs(edges(k, edge_aside))) passed |= 1u << k;
        }
        return passed;
    }
};

/// Of kLanes triangles of a leaf: which the ray hits in its interval, where, and with what weights.
struct LeafHits {
    /// Products of images lose nothing that matters to an edge function above this: less than 2^-149 each.
    static constexpr float kLeast = 0x1p-80f;

    alignas(64) float t[kLanes];
    alignas(64) float v[kLanes];    ///< edge functions, not yet divided by their sum
    alignas(64) float w[kLanes];
    alignas(64) float sum[kLanes];
    unsigned lanes = 0;

    /// @param inside  the triangles that the line passes, edges and corners included.
    template <Seams kSeams>
    HWY_INLINE void find(const TriangleLanes& triangle, Mask inside, const LeafImages& images, const Picks& a, const Picks& b,
                         const Picks& c, const WideRay& ray) {
        const Floats total = (triangle.u + triangle.v) + triangle.w;
        const Mask plain = inside & (abs(total) >= Floats(kLeast));
        const Floats z = (triangle.u * a(images.z) + triangle.v * b(images.z)) + triangle.w * c(images.z);
        const Floats at = z / total * Floats(ray.depth);
        lanes = bits(plain & (at >= Floats(ray.t_min)) & (at <= Floats(ray.t_max)));
        store(at, t);
        store(triangle.v, v);
        store(triangle.w, w);
        store(total, sum);
        if (const Mask tiny = inside & !plain; !none(tiny)) [[unlikely]] {
            Images image(triangle, ray);
            store(a(images.z), image.z[0]), store(b(images.z), image.z[1]), store(c(images.z), image.z[2]);
            const unsigned found = image.find_tiny(bits(tiny));
            for (unsigned rest = found; rest != 0; rest &= rest - 1) {
                const auto k = static_cast<std::size_t>(std::countr_zero(rest));
                t[k] = image.t[k], v[k] = image.v[k], w[k] = image.w[k], sum[k] = 1.0f;
            }
            lanes |= found;
        }
        if constexpr (kSeams == Seams::OneSide) {
            const Floats least = min(min(abs(triangle.u), abs(triangle.v)), abs(triangle.w));
            const Mask seams = inside & (least < Floats(kLeast));
            if (!none(seams)) [[unlikely]] lanes &= ~Images(triangle, ray).far_sides(bits(seams));
        }
    }
};

/// Calls `part(first_lane, there, triangles, images, a, b, c)` for each register of a leaf's triangles; `there` are the lanes that
/// have one: the others, points, would pass for triangles in a plane with the ray.
template <class Part>
HWY_INLINE void for_parts(const WideLeaf& leaf, const WideRay& ray, Part&& part) {
    const LeafImages images(leaf, ray);
    for (int at = 0; at < kWidth; at += kLanes) {
        const auto first = static_cast<std::uint32_t>(at);
        if (at != 0 && first >= leaf.triangle_count) break;
        const Picks a(leaf.corner[0] + at), b(leaf.corner[1] + at), c(leaf.corner[2] + at);
        part(first, first_lanes(static_cast<int>(leaf.triangle_count - first)), TriangleLanes(images, a, b, c), images, a, b, c);
    }
}

/// Keeps the closest hit.
struct Closest {
    WideRay& ray;
    std::uint32_t triangle = MeshHit::kNone;
    float v = 0.0f, w = 0.0f, sum = 1.0f;

    HWY_INLINE bool operator()(const WideLeaf& leaf) {
        for_parts(leaf, ray, [&](std::uint32_t at, Mask there, const TriangleLanes& lanes, const LeafImages& images, const Picks& a,
                                 const Picks& b, const Picks& c) HWY_ATTR {
            const Mask inside = lanes.inside() & there;
            if (none(inside)) return;
            LeafHits hits;
            hits.find<Seams::Both>(lanes, inside, images, a, b, c, ray);
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
    for_parts(leaf, ray, [&](std::uint32_t, Mask there, const TriangleLanes& lanes, const LeafImages& images, const Picks& a,
                             const Picks& b, const Picks& c) HWY_ATTR {
        const Mask inside = lanes.inside() & there;
        if (none(inside)) return;
        LeafHits hits;
        hits.find<Seams::Both>(lanes, inside, images, a, b, c, ray);
        hit = hit || hits.lanes != 0;
    });
    return hit;
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
    if (last != nullptr && last->tree == tree.id && hits_leaf(tree.leaf(last->leaf), ray)) return true;
    bool hit = false;
    traverse(tree, ray, [&](const WideLeaf& leaf) HWY_ATTR {
        hit = hits_leaf(leaf, ray);
        if (hit && last != nullptr) {
            const auto line = reinterpret_cast<const WideBvh::Line*>(&leaf) - tree.lines.data();
            *last = {tree.id, ~static_cast<WideRef>(line)};
        }
        return !hit;
    });
    return hit;
}

void cast_all(const WideBvh& tree, const geo::Ray<float>& from, std::vector<MeshHit>& found) {
    WideRay ray;
    if (!prepare_lanes(tree, from, ray)) return;
    traverse(tree, ray, [&](const WideLeaf& leaf) HWY_ATTR {
        for_parts(leaf, ray, [&](std::uint32_t at, Mask there, const TriangleLanes& lanes, const LeafImages& images, const Picks& a,
                                 const Picks& b, const Picks& c) HWY_ATTR {
            const Mask inside = lanes.inside() & there;
            if (none(inside)) return;
            LeafHits hits;
            hits.find<Seams::OneSide>(lanes, inside, images, a, b, c, ray);
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
        for_parts(leaf, ray, [&](std::uint32_t at, Mask, const TriangleLanes& t, const LeafImages&, const Picks&, const Picks&,
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
