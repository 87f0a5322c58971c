// Bodies in contact that roll about an axis of their own: a capsule, cylinder or cone looks the same however it turns about it. The gap of a contact follows the
// bodies' turns, and a point of the rim rises from the ground by r angle²/2 though the rim does not: the body would fall after it, and be pushed out again with
// friction to match. What these bodies turn by about their axis is hidden from the contacts; what the axis turns by is not.
//
// Slender bodies are left out: slender.swing() has a rule of its own.
//
//   round.list(proxies, bodies, row_of_slot, leave_out, dt);
//   each substep: round.show(rows), advance, round.hide(rows), passes;   at the end: round.show(rows), store
#pragma once

#include <carom/dynamics/detail/contact_bundle.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

class RoundRows {
public:
    /// Those of proxies.rollers that have a row and turn by more than 0.005 rad in the step: with less the rim rises by less than 1.3e-5 of the radius.
    /// @param leave_out  by row: 1 for those whose turns are not the rows' alone
    void list(const ProxySet& proxies, const BodyArrays& bodies, std::span<const std::int32_t> row_of_slot,
              std::span<const unsigned char> leave_out, double dt);

    /// Turns as they are.
    void show(SolverBodies& rows) const noexcept;
    /// Turns without what is about the axis.
    void hide(SolverBodies& rows) noexcept;
    [[nodiscard]] bool any() const noexcept { return !rollers_.empty(); }
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(rollers_); }

private:
    struct Roller {
        std::size_t row = 0;
        dvec3 axis{0.0};     // in the world, as the step begins
        float turn[4] = {};  // as it is
    };
    std::vector<Roller> rollers_;
};

}  // namespace carom::dynamics
