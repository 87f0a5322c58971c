// Moves the vertices of a wide hierarchy and keeps its shape.
//
//   if (Status status = refit_wide_bvh(tree, vertices, triangles); !status) rebuild();
#pragma once

#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/core/result.hpp>

#include <array>
#include <span>

namespace carom {

/// @return the power of two by which coordinates up to `largest` are scaled: 1 where they are of ordinary size.
[[nodiscard]] float wide_scale_for(float largest) noexcept;

/// @return whether scaling there and back gives every coordinate again, to the bit.
[[nodiscard]] bool scales_without_loss(std::span<const vec3> vertices, float scale) noexcept;

/// Writes new positions into the leaves and new boxes above them, and updates sah_cost and crowding. Changes nothing where it fails.
/// @param vertices   finite, as many as the triangles name.
/// @param triangles  those of which the tree was built.
/// @return WrongType where vertices that were at one position are no longer (see StaticBvh::refit), or the scale is no longer right.
/// Cost: O(m), no recursion.
[[nodiscard]] Status refit_wide_bvh(WideBvh& tree, std::span<const vec3> vertices,
                                    std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace carom
