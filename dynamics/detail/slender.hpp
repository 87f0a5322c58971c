// Bodies in contact that are much longer than thick. The solver keeps inertia and lever arms as they are when the step begins, and a spin that follows the axis
// of a rod, as it should, is to them a spin across it: the moment across is up to a million times the one along, so the energy grows by as much. Here the
// spin along stays where the solver's axis is, the axis swings by the spin across alone, and when the step is done spin and axis are turned on together.
//
//   slender.list(bodies, slot_of_row, is_listed, dt, substeps);
//   each substep: kick, slender.precess(rows), passes, advance, slender.swing(rows);  at the end: slender.store(rows, bodies);
#pragma once

#include <carom/dynamics/detail/contact_bundle.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

/// @return whether a body turns freely and its least moment is below 1/25 of the next: rods some six times as long as thick.
[[nodiscard]] bool is_slender(const BodyMass& mass) noexcept;

/// A slender body's motion over a step: frozen in the axes of its start, but for the angles.
struct SlenderMotion {
    dvec3 axis{0.0, 1.0, 0.0};        ///< of the least moment, in the world, at the start
    double share = 0.0;               ///< least moment over the mean of the others
    dquat swing = kIdentityRotation;  ///< what the axis has turned by, without turning about itself
    double twist = 0.0;               ///< about the axis [rad]

    SlenderMotion() = default;
    SlenderMotion(const BodyState& state, const BodyMass& mass) noexcept;

    /// @return the spin after free motion of h [s]: its part across turns about the axis by share × spin along × h (Euler's equations of a symmetric body,
    /// seen from axes that swing along). Keeps the energy.
    [[nodiscard]] dvec3 precessed(const dvec3& spin, double h) const noexcept;
    /// The spin of h [s], in the frozen axes.
    void advance(const dvec3& spin, double h) noexcept;
    /// Gives a state the orientation that its axis and twist have come to, and the spin in the axes of then. Of unlike moments across the
    /// energy does not grow.
    void finish(BodyState& state, const BodyMass& mass) const noexcept;
};

/// @return the state that a slender body has in `pose`, which is that of h [s] before `end` on the way that contacts led it: the spin along goes with the axis,
/// the spin across with it and back about it by its precession. The spin as the body sees it would not do: seen from a rod that spins it turns with the twist.
[[nodiscard]] BodyState slender_before(const BodyState& end, const BodyMass& mass, const Pose& pose, double h) noexcept;

class SlenderRows {
public:
    /// @param slender  by row: 1 for those that are; is_slender() and of no joint
    void list(const BodyArrays& bodies, std::span<const std::uint32_t> slot_of_row, std::span<const unsigned char> slender, double dt,
              int substeps);

    /// Right after kick(): what the substep starts from precesses, what the contacts' impulses add to it stays.
    void precess(SolverBodies& rows) const noexcept;
    /// After advance(): the turn by the spin across, and by the spin along where a step of it is a small angle: farther round, a point of contact is none.
    void swing(SolverBodies& rows) noexcept;
    /// After the others are stored, over what was stored.
    void store(BodyArrays& bodies) const noexcept;
    [[nodiscard]] bool any() const noexcept { return !rods_.empty(); }
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(rods_); }

private:
    struct Rod {
        std::int32_t row = 0;
        std::uint32_t slot = 0;
        dquat start = kIdentityRotation;
        bool shows_twist = false;
        SlenderMotion motion;
    };
    std::vector<Rod> rods_;
    double h_ = 0.0;
};

}  // namespace carom::dynamics
