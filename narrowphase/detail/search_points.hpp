// GJK in double for one pair of boxes, hulls, segments or points.
//
//   if (!search_points(pair, goal, known, last)) { /* goes on from the simplex `last` with the bounds that are known */ }
#pragma once

#include <carom/narrowphase/detail/proximity.hpp>

namespace carom::detail {

/// @return whether search_points() takes the pair: flat cores of up to 64 points each.
[[nodiscard]] bool is_searched_by_points(const CorePair& pair) noexcept;

/// The first rounds of find_proximity(), as a rule all. The corners of both are placed before the first, so that no round turns a direction or a
/// point, and each finds its two support points in lanes; bounds are as core_pair() derives them.
/// @param known  empty; afterwards bounds that are proved, with the points of the upper one.
/// @return whether the search is done; where it is not, rounding allows no progress, or the simplex holds the origin without proving it.
/// @param last  afterwards the simplex, where the search is not done.
[[nodiscard]] bool search_points(const CorePair& pair, const ProximityGoal& goal, Proximity& known, DistanceCache& last) noexcept;

}  // namespace carom::detail
