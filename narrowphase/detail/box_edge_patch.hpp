// The contact of two boxes that cross edges.
#pragma once

#include <carom/narrowphase/detail/box_sat.hpp>

namespace carom::detail {

/// Fills `patch` with the crossing of the two edges of `axis`, and, where the two nearest faces nearly face each other,
/// with what they share: so a box that tips from a face to an edge keeps the points it had.
void build_box_edge_patch(const PairFrame& pair, const BoxAxis& axis, Patch& patch) noexcept;

}  // namespace carom::detail
