// What few bodies in contact ask of the solver's rows: damping and locked axes. Empty, and skipped, where no body asks.
//
//   rules.list(bodies, slot_of_row, movable, h);
//   rules.damp(rows);  ... a pass over the contacts ...  rules.lock(rows);
#pragma once

#include <carom/dynamics/detail/contact_bundle.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

class RowRules {
public:
    /// @param h  the substep [s]
    void list(const BodyArrays& bodies, std::span<const std::uint32_t> slot_of_row, std::int32_t movable, double h);

    /// Right after kick(): the velocities of the substep, but not what the contacts' impulses add to them, fall by exp(-c h).
    void damp(SolverBodies& rows) const noexcept;
    /// After each pass over the contacts: takes out what they gave along locked axes. That takes energy out, never in; the passes
    /// that follow find what the contacts need beside it.
    void lock(SolverBodies& rows) const noexcept;
    [[nodiscard]] bool damp_any() const noexcept { return !damped_.empty(); }
    [[nodiscard]] bool lock_any() const noexcept { return !locked_.empty(); }
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(damped_, locked_); }

private:
    struct Damped {
        std::int32_t row;
        float linear, angular;  // what is left after a substep
    };
    struct Locked {
        std::int32_t row;
        float free[3];
    };
    std::vector<Damped> damped_;
    std::vector<Locked> locked_;
};

}  // namespace carom::dynamics
