// Watertight rays in float against a static hierarchy of triangles: closest hit, any hit, all hits.
//
//   if (MeshHit hit = closest_hit(bvh, {.origin = {0, 9, 0}, .direction = {0, -1, 0}})) { hit.t; hit.triangle; hit.u; hit.v; }
//   bool shadow = any_hit(bvh, {.origin = p, .direction = light - p, .t_max = 1}, &occluder);
//
// What a ray is. The points origin + t direction with t_min <= t <= t_max; t counts lengths of `direction`, which may be any vector
// that is not zero. An interval is a query of its own: set t_min and t_max. Bad input (NaN or infinity in origin or direction, a
// zero direction, a NaN bound, t_min > t_max) hits nothing; infinite bounds are fine, negative ones too.
//
// Cut to where it hits, t_max = hit.t, a ray hits the same triangle at the same t; with t_min = hit.t too, where t_min was >= 0.
// No hit has a t outside of t_min <= t <= t_max.
//
// Watertight. Each vertex has one image on the plane across the ray, computed from ray and vertex alone, and on which side of the
// ray an edge between images passes is decided exactly; boxes are widened by what rounding may move an image. So no ray passes
// between triangles that share an edge or a vertex, by position, whatever their size, and wherever the mesh is. Edges and corners
// belong to their triangles. A ray in the plane of a triangle misses that triangle. Both sides of a triangle are hit.
//
// Accuracy. An image, and the depth of a vertex, lies within 8 u (D + |o|) of where it should be: u = 2^-24, D the largest
// distance along an axis between the origin and the mesh's box, |o| the origin's largest coordinate. So a hit or miss is right for
// the mesh with each vertex moved by no more than that, and t |direction| is right to 16 u (D + |o|) for a mesh moved like that, and
// to its own rounding, u |t direction|. An origin further than 8 sizes from the mesh, and one whose ray has t_min < 0, is moved along
// its ray to the mesh first, in double, so that D and |o| are of the mesh's own size and place.
//
// The same bits at every SIMD width. The closest hit is the one of least computed t, of the lowest triangle where several are
// least: it does not depend on the tree. No allocation but where said, thread-safe.
//
// Source: Woop, Benthin, Wald, Watertight Ray/Triangle Intersection (JCGT 2013). Departures: edge signs are exact in float without a
// second path in double, and boxes are padded by a bound that is proved (detail/wide_ray.hpp).
#pragma once

#include <carom/collision/primitives.hpp>
#include <carom/collision/static_bvh.hpp>
#include <carom/core/executor.hpp>

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace carom {

/// A point of a ray on a triangle. The tree keeps its triangles in an order of its own: what else is wanted of one, its normal or its
/// material, is the mesh's that the tree was built of, by `triangle`.
struct MeshHit {
    static constexpr std::uint32_t kNone = 0xffffffffu;
    float t = std::numeric_limits<float>::infinity();
    std::uint32_t triangle = kNone;
    float u = 0.0f;  ///< weight of the second corner, in [0, 1]
    float v = 0.0f;  ///< weight of the third; the point is (1 - u - v) a + u b + v c

    [[nodiscard]] explicit operator bool() const noexcept { return triangle != kNone; }
};

/// Where the last occluder was found. Rays that are cast one after the other at one light mostly meet the same one: keep one of
/// these for each light and thread. One that was used with another tree, or with one that is no more, only costs time.
struct LastOccluder {
    std::uint64_t tree = 0;  ///< which one, of all that this process has built or loaded; 0: none
    std::int32_t leaf = 0;
};

/// @return the hit of least t; of several triangles at one t, the lowest. Cost: O(log triangles) expected.
[[nodiscard]] MeshHit closest_hit(const StaticBvh& bvh, const geo::Ray<float>& ray) noexcept;

/// @return whether anything is hit. Cost: as closest_hit, mostly less.
/// @param last  tried first, and updated on a hit; may be null.
[[nodiscard]] bool any_hit(const StaticBvh& bvh, const geo::Ray<float>& ray, LastOccluder* last = nullptr) noexcept;

/// All crossings in ascending t, then triangle. A ray exactly through an edge or a corner crosses one of the triangles that meet
/// there on each side of the surface, not all of them (as if it were moved aside by an infinitesimal: Edelsbrunner, Muecke,
/// Simulation of Simplicity, ACM ToG 1990), so that a line crosses a closed mesh an even number of times.
/// @param hits  is cleared first; it grows where its capacity does not do.
void all_hits(const StaticBvh& bvh, const geo::Ray<float>& ray, std::vector<MeshHit>& hits);

/// The closest hit of each ray. @param hits  (n,) as rays; otherwise reports misuse and changes nothing.
void closest_hits(const StaticBvh& bvh, std::span<const geo::Ray<float>> rays, std::span<MeshHit> hits, Executor& executor);

/// Whether each ray hits anything: 1 or 0. @param occluded  (n,) as rays; otherwise reports misuse and changes nothing.
void any_hits(const StaticBvh& bvh, std::span<const geo::Ray<float>> rays, std::span<std::uint8_t> occluded, Executor& executor);

}  // namespace carom
