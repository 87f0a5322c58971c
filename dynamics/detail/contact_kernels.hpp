// The passes of the contact solver over a range of bundles, through the machine's SIMD lanes.
#pragma once

#include <carom/dynamics/detail/contact_bundle.hpp>

#include <span>

namespace carom::dynamics {

/// A soft contact as an implicit spring and damper, after Catto, Soft Constraints (GDC 2011) and Solver2D (2024).
struct SoftContact {
    float bias_rate = 0.0f;      ///< velocity per overlap [1/s]
    float mass_scale = 1.0f;
    float impulse_scale = 0.0f;
};
/// @param frequency [Hz], damping ratio, substep h [s]; with w = 2 pi f: bias_rate = w / (2 z + h w), mass_scale =
/// h w (2 z + h w) / (1 + h w (2 z + h w)), impulse_scale = 1 - mass_scale.
[[nodiscard]] SoftContact soft_contact(double frequency, double damping, double h) noexcept;

/// Between two bodies that move, and with one that does not.
struct SoftContacts {
    SoftContact moving, fixed;
};

struct SolveSettings {
    SoftContacts soft;
    float inverse_h = 0.0f;  ///< 1 / substep [1/s]
    bool bias = true;        ///< false: the relax pass, rigid and without push
    bool gaps_known = false; ///< no body has moved since the last pass, which leaves the gap of each point behind
};

/// Applies the accumulated impulses to the bodies' velocities.
/// @param bundles  of one colour: no two of them share a body that can move. The same of solve().
void warm_start(std::span<ContactBundle> bundles, SolverBodies& bodies);

/// One Gauss-Seidel pass: friction of each point in turn, then the normals.
void solve(std::span<ContactBundle> bundles, SolverBodies& bodies, const SolveSettings& settings);

}  // namespace carom::dynamics
