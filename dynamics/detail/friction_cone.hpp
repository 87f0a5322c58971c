// The nearest point of a Coulomb cone and its derivative.
#pragma once

#include <carom/core/types.hpp>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <cmath>

namespace carom::dynamics {

enum class ConeState : unsigned char { Apart, Sticks, Slips };

/// P(y) of the cone {λ·n >= 0, |λ_t| <= μ λ·n}, and what its derivative is made of.
struct ConePoint {
    ConeState state = ConeState::Apart;
    dvec3 impulse{0.0};
    dvec3 direction{0.0};  ///< where it slips: of the cone's edge, unit
    dvec3 across{0.0};     ///< where it slips: tangential and at right angles to the slip, unit
    double bend = 0.0;     ///< where it slips: the derivative along `across`, in [0, 1]

    /// P'(y) d: symmetric, with eigenvalues in [0, 1].
    [[nodiscard]] dvec3 derivative(const dvec3& d) const noexcept {
        if (state == ConeState::Apart) return dvec3{0.0};
        if (state == ConeState::Sticks) return d;
        return glm::dot(direction, d) * direction + bend * glm::dot(across, d) * across;
    }
    [[nodiscard]] dmat3 derivative() const noexcept {
        if (state == ConeState::Apart) return dmat3{0.0};
        if (state == ConeState::Sticks) return dmat3{1.0};
        return glm::outerProduct(direction, direction) + bend * glm::outerProduct(across, across);
    }
};

[[nodiscard]] inline ConePoint nearest_in_cone(const dvec3& y, const dvec3& n, double friction) noexcept {
    const double normal = glm::dot(y, n);
    const dvec3 tangential = y - normal * n;
    const double length = glm::length(tangential);
    if (length <= friction * normal) return {.state = ConeState::Sticks, .impulse = y};
    // In the polar cone, and on its axis below the tip, the tip is nearest.
    if (friction * length <= -normal || length == 0.0) return {};
    const dvec3 along = tangential / length;
    const double share = 1.0 / (1.0 + friction * friction);
    const double pressed = share * (normal + friction * length);
    return {.state = ConeState::Slips,
            .impulse = pressed * (n + friction * along),
            .direction = std::sqrt(share) * (n + friction * along),
            .across = glm::cross(n, along),
            .bend = friction * pressed / length};
}

}  // namespace carom::dynamics
