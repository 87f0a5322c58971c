// How easily the bodies of a joint give way: what its rows are made soft by.
//
//   double light = lightness(body, arm);   // [1/kg]
#pragma once

#include <carom/dynamics/detail/joint_island.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace carom::dynamics {

[[nodiscard]] inline std::size_t as_index(std::int32_t i) noexcept { return static_cast<std::size_t>(i); }

[[nodiscard]] inline double trace(const dmat3& m) { return m[0][0] + m[1][1] + m[2][2]; }

/// The inverse of the mass that a force at the end of an arm meets, at most.
[[nodiscard]] inline double lightness(const JointBody& body, const dvec3& arm) {
    const double most = std::max({body.inverse_mass.x, body.inverse_mass.y, body.inverse_mass.z});
    return most + glm::dot(arm, arm) * trace(body.inverse_turn);
}

}  // namespace carom::dynamics
