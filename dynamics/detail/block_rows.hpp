// Rows between points of two bodies as 6 x 6 blocks: J = [1, -[arm]] takes a body's motion to the velocity of the point at `arm`.
//
//   add_coupling(factor.diagonal(a), stiffness, arm_a, arm_a, 1.0);
#pragma once

#include <carom/core/types.hpp>
#include <carom/dynamics/detail/block_kernels.hpp>

#include <glm/matrix.hpp>

namespace carom::dynamics {

/// The matrix of r × · is [r]; glm goes by columns.
[[nodiscard]] inline dmat3 cross_matrix(const dvec3& r) noexcept { return {{0.0, r.z, -r.y}, {-r.z, 0.0, r.x}, {r.y, -r.x, 0.0}}; }

/// Rows `row`.. and columns `column`.. of the block += m.
inline void add(Block6& block, int row, int column, const dmat3& m) noexcept {
    for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) block.at(row + r, column + c) += m[c][r];
    }
}

/// block += sign * (J of a body with arm `left`)ᵀ g (J of one with arm `right`).
inline void add_coupling(Block6& block, const dmat3& g, const dvec3& left, const dvec3& right, double sign) noexcept {
    const dmat3 turned = glm::transpose(cross_matrix(right));  // -[right]
    const dmat3 upper_right = sign * (g * turned);
    const dmat3 arm = sign * cross_matrix(left);  // ([left]ᵀ)ᵀ: (-[left])ᵀ = [left]
    add(block, 0, 0, sign * g);
    add(block, 0, 3, upper_right);
    add(block, 3, 0, arm * g);
    add(block, 3, 3, arm * (g * turned));
}

[[nodiscard]] inline dvec3 linear_part(const Vector6& x) noexcept { return {x[0], x[1], x[2]}; }
[[nodiscard]] inline dvec3 angular_part(const Vector6& x) noexcept { return {x[3], x[4], x[5]}; }

}  // namespace carom::dynamics
