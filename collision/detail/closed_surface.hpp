// Whether triangles bound a volume, and whether neighbours are wound alike.
//
//   bool solid = surface_kind(vertices, triangles) == SurfaceKind::Closed;
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

enum class SurfaceKind : unsigned char {
    Loose,     ///< an edge is run along twice in one direction: neighbours are not wound alike, or three triangles meet in an edge
    Oriented,  ///< each edge is run along at most once in each direction
    Closed,    ///< there is a triangle, and every edge is run along exactly once in each direction
};

/// @param triangles  indices in range.
/// @return what holds where vertices at one position are one. A triangle with two corners at one position vanishes: its other two edges
/// are one edge, and the neighbours meet there. No triangle: Oriented.
/// Cost: O(vertices + triangles), and O(k log k) for a vertex of k edges.
[[nodiscard]] SurfaceKind surface_kind(std::span<const vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace carom
