// Whether triangles bound a volume.
//
//   bool solid = is_closed_surface(vertices, triangles);
#pragma once

#include <carom/core/types.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace carom {

/// @param vertices  finite.
/// @return for each vertex, a number below their count that it shares with every vertex at exactly its position and with no other (-0
/// counts as +0).
/// Cost: O(n) for positions that differ in x and y; O(k log k) for each k that share both.
[[nodiscard]] std::vector<std::uint32_t> number_positions(std::span<const vec3> vertices);

/// @param triangles  indices in range.
/// @return true if there is a triangle, and every edge is run along exactly once in each direction, where vertices at one position are
/// one. A triangle with two corners at one position vanishes: its other two edges are one edge, and the neighbours meet there.
/// Cost: O(vertices + triangles), and O(k log k) for a vertex of k edges.
[[nodiscard]] bool is_closed_surface(std::span<const vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace carom
