#include <carom/dynamics/detail/row_rules.hpp>

#include <carom/dynamics/detail/integrator.hpp>

namespace carom::dynamics {
namespace {

/// The part of the velocity that the substep began with falls; the impulses on top of it stay.
void damp_part(float (&velocity)[4], float (&base)[4], float left) noexcept {
    for (int i = 0; i < 3; ++i) {
        const float pushed = velocity[i] - base[i];
        base[i] *= left;
        velocity[i] = base[i] + pushed;
    }
}

}  // namespace

void RowRules::list(const BodyArrays& bodies, std::span<const std::uint32_t> slot_of_row, std::int32_t movable, double h) {
    damped_.clear();
    locked_.clear();
    if (bodies.traits.empty()) return;
    for (std::int32_t row = 0; row < movable; ++row) {
        const std::uint32_t slot = slot_of_row[static_cast<std::size_t>(row)];
        const unsigned char locked = bodies.masses[slot].locked;
        if ((locked & ~kLockedTurns) != 0) {
            const vec3 free{free_moves(locked)};
            locked_.push_back({row, {free.x, free.y, free.z}});
        }
        const BodyTraits& traits = bodies.traits[slot];
        if (traits.linear_damping == 0.0 && traits.angular_damping == 0.0) continue;
        damped_.push_back({row, static_cast<float>(decay(traits.linear_damping * h).left),
                           static_cast<float>(decay(traits.angular_damping * h).left)});
    }
}

void RowRules::damp(SolverBodies& rows) const noexcept {
    for (const Damped& d : damped_) {
        SolverBody& body = rows.bodies[static_cast<std::size_t>(d.row)];
        SolverBase& base = rows.bases[static_cast<std::size_t>(d.row)];
        damp_part(body.velocity, base.velocity, d.linear);
        damp_part(body.spin, base.spin, d.angular);
    }
}

void RowRules::lock(SolverBodies& rows) const noexcept {
    for (const Locked& l : locked_) {
        SolverBody& body = rows.bodies[static_cast<std::size_t>(l.row)];
        for (int i = 0; i < 3; ++i) body.velocity[i] *= l.free[i];
    }
}

}  // namespace carom::dynamics
