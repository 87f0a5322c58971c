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
#include <limits>
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

/// Where a name stands among names: corners of the second shape, corners of the first, crossings of edges; within these by number.
[[nodiscard]] constexpr std::uint64_t name_rank(std::uint64_t feature) noexcept { return feature ^ (std::uint64_t{3} << 62); }

/// The points with a largest score, and those that rounding keeps from it.
struct Best {
    double score = 0.0;
    int index = -1;  ///< -1: none is over what was asked for
};

/// @param least  what a score has to be over.
/// @param equal  from the largest score to the one from which on scores count as equal to it.
/// @return of all that score as much as the largest, the first by name; by its place where names are the same.
template <class Equal, class Score>
[[nodiscard]] Best best_of(std::span<const Candidate> points, double least, const Equal& equal, const Score& score) noexcept {
    Best best{least};
    double next = least;  // of all others
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double s = score(points[i]);
        next = std::max(next, std::min(best.score, s));
        if (s > best.score) best = {s, static_cast<int>(i)};
    }
    const double bar = std::max(equal(best.score), least);
    if (!(next > bar)) return best;
    for (std::size_t i = 0; i < points.size(); ++i) {  // few have their like
        if (!(score(points[i]) > bar)) continue;
        const std::uint64_t rank = name_rank(points[i].feature),
                            least_rank = name_rank(points[static_cast<std::size_t>(best.index)].feature);
        if (rank < least_rank || (rank == least_rank && static_cast<int>(i) < best.index)) best.index = static_cast<int>(i);
    }
    return best;
}

/// Chooses up to four corners of the outline of the points.
inline int choose_outline(std::span<const Candidate> points, double tolerance, const PlanarDirection& start, Chosen& chosen) noexcept {
    const auto at = [&](int i) -> const Candidate& { return points[static_cast<std::size_t>(i)]; };
    const auto along = [&](const Candidate& p) { return p.u * start.u + p.w * start.w; };
    const auto less = [](double slack) { return [slack](double best) { return best - slack; }; };
    chosen[0] = std::max(0, best_of(points, -std::numeric_limits<double>::infinity(), less(tolerance), along).index);
    const Candidate& a = at(chosen[0]);
    const Best farthest = best_of(
        points, tolerance * tolerance, [](double best) { return kAsFar * best; },
        [&](const Candidate& p) { return planar_distance_sq(a, p); });
    chosen[1] = farthest.index;
    if (chosen[1] < 0) return 1;
    const Candidate& b = at(chosen[1]);

    // An area counts from the tolerance times the longest side on, and is larger from that on.
    const double least = tolerance * std::sqrt(farthest.score);
    const Best left = best_of(points, least, less(least), [&](const Candidate& p) { return planar_area2(a, b, p); });
    const Best right = best_of(points, least, less(least), [&](const Candidate& p) { return -planar_area2(a, b, p); });
    if (left.index < 0 && right.index < 0) return 2;
    const bool is_left = right.index < 0 || (left.index >= 0 && left.score >= right.score - least);
    chosen[2] = is_left ? left.index : right.index;
    const Candidate& c = at(chosen[2]);

    // What lies outside the triangle adds the area of the triangle that it makes with the edge it sees.
    const double turn = is_left ? -1.0 : 1.0;
    const auto added = [&](const Candidate& p) {
        return std::max({turn * planar_area2(a, b, p), turn * planar_area2(b, c, p), turn * planar_area2(c, a, p)});
    };
    chosen[3] = best_of(points, least, less(least), added).index;
    return chosen[3] < 0 ? 3 : 4;
}

/// @return what reduce_points() may overlook of a pair of that size [m].
[[nodiscard]] inline double overlook(bool steady, double size) noexcept { return steady ? kSteadyCap * size : 0.0; }

/// Chooses up to four points: the farthest in the direction `start`, the farthest from that, the one that spans the largest triangle with
/// them, and the one that adds most area to it. Where the deepest of all is deeper than these by more than `tolerance` and what is
/// overlooked, it replaces the nearest of them. So the choice hangs on the outline, which is steady, and depth changes one point at most.
/// Points within `tolerance` [m] of one another are one; a flat patch gives its corners whatever points lie between them.
/// What differs by less than points do that are moved by `tolerance` is equal (squares of distances: by a share of 2^-14; depths: by
/// `tolerance` / 64). Of equals the one to the left of the first two is taken, and the first by name, so rounding changes neither which
/// points are chosen nor their order. (Which side it is rests on no names: a corner over a corner bears either's.)
/// @param overlook  how much deeper it may be, beyond the tolerance, and be left out [m], if it is no more than kSteadyShare of the depth of
/// the four; 0: never.
/// @return how many indices of `chosen` are in use, 1..4; 0 for no points. The same for the same points, in any order where names differ.
inline int reduce_points(std::span<const Candidate> points, double tolerance, const PlanarDirection& start, double overlook,
                         Chosen& chosen) noexcept {
    if (points.empty()) return 0;
    const auto at = [&](std::size_t i) -> const Candidate& { return points[static_cast<std::size_t>(chosen[i])]; };
    int count = choose_outline(points, tolerance, start, chosen);
    double least = at(0).separation;
    for (std::size_t i = 1; i < static_cast<std::size_t>(count); ++i) least = std::min(least, at(i).separation);
    const double overlooked = count < kMaxManifoldPoints ? 0.0 : std::min(overlook, kSteadyShare * std::max(0.0, -least));
    const int deepest = best_of(
                            points, tolerance - least + overlooked, [&](double best) { return best - 0x1p-6 * tolerance; },
                            [](const Candidate& p) { return -p.separation; })
                            .index;
    if (deepest < 0) return count;
    const Candidate& d = points[static_cast<std::size_t>(deepest)];
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < static_cast<std::size_t>(count); ++i) {
        if (planar_distance_sq(at(i), d) < kAsFar * planar_distance_sq(at(nearest), d)) nearest = i;
    }
    if (count < kMaxManifoldPoints && planar_distance_sq(at(nearest), d) > tolerance * tolerance) {
        chosen[static_cast<std::size_t>(count++)] = deepest;
    } else {
        chosen[nearest] = deepest;
    }
    return count;
}

}  // namespace carom::detail
