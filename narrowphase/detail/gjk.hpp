// Distance between two convex sets: hulls of small sets of points, and truncated cones.
//
//   GjkResult r = gjk(segment, hull.vertices, radius + margin);
//   if (r.beyond) { /* apart */ }
#pragma once

#include <carom/core/types.hpp>
#include <carom/narrowphase/detail/truncated_cone.hpp>

#include <array>
#include <span>

namespace carom::detail {

struct GjkResult {
    dvec3 on_a{0.0};         ///< closest points; where the hulls overlap, without meaning
    dvec3 on_b{0.0};
    double distance = 0.0;   ///< an upper bound always; the distance where `converged`
    bool overlap = false;    ///< the hulls touch or overlap, to 1e-12 of their extent
    bool converged = true;   ///< false: stopped at the cap on iterations
    bool beyond = false;     ///< farther apart than the cutoff, which is all that is known then
};

/// The corners that hold the closest points, of either set: where the search ended.
struct GjkSimplex {
    std::array<dvec3, 4> on_a{}, on_b{};
    int count = 0;
};

/// Closest points of the convex hulls of `a` and `b`, each of at least one point, all finite, in one frame.
///
/// Method: Gilbert, Johnson, Keerthi (1988); the closest point of the simplex by Voronoi regions (Ericson 2005, sec. 9.5). Stops
/// when the bound from the support plane meets the distance, when a support point comes back, or when rounding allows no progress.
/// @param cutoff  distances above this are not looked into: a support plane that proves it ends the search, as a rule in the first
///                or second round.
/// Accuracy: distance to 1e-12 relative plus 1e-14 of the largest coordinate difference. Total: at most 64 rounds, never throws.
/// Cost: about 6 rounds of (|a| + |b|) dot products. No allocation.
[[nodiscard]] GjkResult gjk(std::span<const dvec3> a, std::span<const dvec3> b, double cutoff) noexcept;

/// The same where one or both are truncated cones, by their exact support functions.
/// Accuracy: as above where the search converges, which round shapes let it do more slowly: a direction is then known to about 1e-6.
/// Cost: about 12 rounds, at most 128.
[[nodiscard]] GjkResult gjk(const TruncatedCone& a, std::span<const dvec3> b, double cutoff) noexcept;
[[nodiscard]] GjkResult gjk(const TruncatedCone& a, const TruncatedCone& b, double cutoff) noexcept;

/// The same with the last simplex, for people and pictures.
[[nodiscard]] GjkResult gjk(std::span<const dvec3> a, std::span<const dvec3> b, double cutoff, GjkSimplex& last) noexcept;
[[nodiscard]] GjkResult gjk(const TruncatedCone& a, std::span<const dvec3> b, double cutoff, GjkSimplex& last) noexcept;
[[nodiscard]] GjkResult gjk(const TruncatedCone& a, const TruncatedCone& b, double cutoff, GjkSimplex& last) noexcept;

/// @return the number of the point that is farthest along `direction`, the first of equals. One point at least.
[[nodiscard]] std::size_t farthest_along(std::span<const dvec3> points, const dvec3& direction) noexcept;

}  // namespace carom::detail
