// From many points of one contact patch to the four that carry it.
//
//   std::array<int, 4> chosen;
//   int count = reduce_points(candidates, 1e-6 * size, start, 0.0, chosen);
#pragma once

#include <carom/narrowphase/detail/tolerances.hpp>
#include <carom/narrowphase/manifold.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

namespace carom::detail {

/// A point on its way into a patch, with coordinates u, w in the plane of contact.
struct Candidate {
    dvec3 position{0.0};
    double separation = 0.0;
    double u = 0.0;
    double w = 0.0;
    std::uint64_t feature = 0;
};

using Chosen = std::array<int, kMaxManifoldPoints>;

/// A direction in the plane of contact, in the coordinates of the points.
struct PlanarDirection {
    double u = 1.0;
    double w = 0.0;
};

/// @return where the choice of points begins, for a patch with the unit `normal`, in the frame of the normal: a direction that is parallel
/// to no edge of the usual patches, and that does not turn when the normal trembles or the other shape becomes the reference.
[[nodiscard]] inline dvec3 outline_start(const dvec3& normal) noexcept {
    const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
    constexpr double kSlant = 0.381966;  // golden section: far from the ratios that builders use
    if (y >= x && y >= z) return {1.0, 0.0, kSlant};
    return x >= z ? dvec3{0.0, 1.0, kSlant} : dvec3{1.0, kSlant, 0.0};
}
[[nodiscard]] inline PlanarDirection outline_start(const dvec3& normal, const dvec3& axis_u, const dvec3& axis_w) noexcept {
    const dvec3 start = outline_start(normal);
    return {glm::dot(start, axis_u), glm::dot(start, axis_w)};
}

[[nodiscard]] inline double planar_distance_sq(const Candidate& a, const Candidate& b) noexcept {
    return (b.u - a.u) * (b.u - a.u) + (b.w - a.w) * (b.w - a.w);
}

/// @return twice the signed area of the triangle (a, b, c).
[[nodiscard]] inline double planar_area2(const Candidate& a, const Candidate& b, const Candidate& c) noexcept {
    return (b.u - a.u) * (c.w - a.w) - (b.w - a.w) * (c.u - a.u);
}

/// @return the index with the largest score, if that is over `least`; otherwise -1. Ties go to the lower index.
template <class Score>
[[nodiscard]] int best_of(std::span<const Candidate> points, double least, const Score& score) noexcept {
    int best = -1;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double s = score(points[i]);
        if (s > least) {
            least = s;
            best = static_cast<int>(i);
        }
    }
    return best;
}

/// Chooses up to four corners of the outline of the points.
inline int choose_outline(std::span<const Candidate> points, double tolerance, const PlanarDirection& start, Chosen& chosen) noexcept {
    const auto at = [&](int i) -> const Candidate& { return points[static_cast<std::size_t>(i)]; };
    const auto along = [&](const Candidate& p) { return p.u * start.u + p.w * start.w; };
    chosen[0] = std::max(0, best_of(points, along(points[0]), along));
    const Candidate& a = at(chosen[0]);
    chosen[1] = best_of(points, tolerance * tolerance, [&](const Candidate& p) { return planar_distance_sq(a, p); });
    if (chosen[1] < 0) return 1;
    const Candidate& b = at(chosen[1]);

    // An area counts from the tolerance times the longest side on.
    const double least = tolerance * std::sqrt(planar_distance_sq(a, b));
    const int left = best_of(points, least, [&](const Candidate& p) { return planar_area2(a, b, p); });
    const int right = best_of(points, least, [&](const Candidate& p) { return -planar_area2(a, b, p); });
    if (left < 0 && right < 0) return 2;
    const bool is_left = right < 0 || (left >= 0 && planar_area2(a, b, at(left)) >= -planar_area2(a, b, at(right)));
    chosen[2] = is_left ? left : right;
    const Candidate& c = at(chosen[2]);

    // What lies outside the triangle adds the area of the triangle that it makes with the edge it sees.
    const double turn = is_left ? -1.0 : 1.0;
    chosen[3] = best_of(points, least, [&](const Candidate& p) {
        return std::max({turn * planar_area2(a, b, p), turn * planar_area2(b, c, p), turn * planar_area2(c, a, p)});
    });
    return chosen[3] < 0 ? 3 : 4;
}

/// @return what reduce_points() may overlook of a pair of that size [m].
[[nodiscard]] inline double overlook(bool steady, double size) noexcept { return steady ? kSteadyCap * size : 0.0; }

/// Chooses up to four points: the farthest in the direction `start`, the farthest from that, the one that spans the largest triangle with
/// them, and the one that adds most area to it. Where the deepest of all is deeper than these by more than `tolerance` and what is
/// overlooked, it replaces the nearest of them. So the choice hangs on the outline, which is steady, and depth changes one point at most.
/// @param overlook  how much deeper it may be, beyond the tolerance, and be left out [m], if it is no more than kSteadyShare of the depth of
/// the four; 0: never.
/// Points within `tolerance` [m] of one another are one; a flat patch gives its corners whatever points lie between them.
/// @return how many indices of `chosen` are in use, 1..4; 0 for no points. The same for the same order of points.
inline int reduce_points(std::span<const Candidate> points, double tolerance, const PlanarDirection& start, double overlook,
                         Chosen& chosen) noexcept {
    if (points.empty()) return 0;
    const auto at = [&](std::size_t i) -> const Candidate& { return points[static_cast<std::size_t>(chosen[i])]; };
    int count = choose_outline(points, tolerance, start, chosen);
    double least = at(0).separation;
    for (std::size_t i = 1; i < static_cast<std::size_t>(count); ++i) least = std::min(least, at(i).separation);
    const double overlooked = std::min(overlook, kSteadyShare * std::max(0.0, -least));
    const int deepest = best_of(points, tolerance - least + overlooked, [](const Candidate& p) { return -p.separation; });
    if (deepest < 0) return count;
    const Candidate& d = points[static_cast<std::size_t>(deepest)];
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < static_cast<std::size_t>(count); ++i) {
        if (planar_distance_sq(at(i), d) < planar_distance_sq(at(nearest), d)) nearest = i;
    }
    if (count < kMaxManifoldPoints && planar_distance_sq(at(nearest), d) > tolerance * tolerance) {
        chosen[static_cast<std::size_t>(count++)] = deepest;
    } else {
        chosen[nearest] = deepest;
    }
    return count;
}

}  // namespace carom::detail
