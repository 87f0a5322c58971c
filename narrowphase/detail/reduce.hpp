// From many points of one contact patch to the four that carry it.
//
//   std::array<int, 4> chosen;
//   int count = reduce_points(candidates, 1e-6 * size, chosen);
#pragma once

#include <carom/narrowphase/manifold.hpp>

#include <array>
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

/// Chooses up to four points: the farthest in a fixed direction, the farthest from that, the one that spans the largest triangle with
/// them, and the one that adds most area to it. Where the deepest of all is deeper than these by more than `tolerance`, it replaces
/// the nearest of them. So the choice hangs on the outline, which is steady, and depth changes one point at most.
/// Points within `tolerance` [m] of one another are one; a flat patch gives its corners whatever points lie between them.
/// @return how many indices of `chosen` are in use, 1..4; 0 for no candidates. The same for the same order of candidates.
int reduce_points(std::span<const Candidate> candidates, double tolerance,
                  std::array<int, kMaxManifoldPoints>& chosen) noexcept;

}  // namespace carom::detail
