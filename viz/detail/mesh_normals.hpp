// Shading normals of a triangle mesh: smooth where it is smooth, sharp at its creases.
#pragma once

#include <carom/core/types.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::detail {

/// @return (3m,) the unit normal of each triangle's three corners: the area-weighted mean over the triangles that share the
/// vertex and turn by less than 40 degrees against this one. A triangle without area gets the y axis.
[[nodiscard]] std::vector<vec3> corner_normals(std::span<const vec3> vertices,
                                               std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace carom::detail
