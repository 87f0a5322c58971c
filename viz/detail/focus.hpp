// The part of a point cloud worth looking at: all of it but the few that flew away.
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/core/types.hpp>

#include <vector>

namespace carom::detail {

/// Removes the points farther from the component-wise median than three times the distance that holds nine tenths of them.
/// Order is kept. Fewer than ten points are all kept.
void remove_outliers(std::vector<dvec3>& points);

/// @return the box of the points; empty for none.
[[nodiscard]] Aabb box_of(const std::vector<dvec3>& points) noexcept;

}  // namespace carom::detail
