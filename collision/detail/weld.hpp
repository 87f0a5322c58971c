// Vertices at one position.
#pragma once

#include <carom/core/types.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom {

/// @return for each vertex the first one at its position; -0 is 0. @param vertices  finite. Cost: O(n) expected, some 20 ns a vertex.
[[nodiscard]] std::vector<std::uint32_t> first_at_position(std::span<const vec3> vertices);

}  // namespace carom
