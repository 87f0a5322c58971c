// Bodies in contact that turn fast. The passes know a body's inertia as it is when the step begins; what a contact changes a spin by is wrong where the body has
// turned on since, and energy comes from nothing: up to a tenth of it in one blow of two capsules 1:4 at 30 rad/s. Here such a body turns as it does when free,
// its inertia with it, after each substep. A contact then changes its angular momentum by the same whatever the inertia, takes energy out as the inertia is then,
// and between contacts both are kept.
//
//   if (turning.watch(mass, spin, row, rows)) ...                        // without a gyroscopic change in its kick
//   each substep: kick, pass, turning.advance(rows, ...), renew_masses(bundles, rows, turning.renewed())
//   at the end: turning.store(states)
#pragma once

#include <carom/dynamics/detail/contact_bundle.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

/// @return the spin [rad/s] from which on a body turns with its inertia. With c = I_max/I_min - 1: where c |spin| dt, about what an inertia changes by in the step, is
/// above kMostChange, and where it is above 0.02 and |spin| dt above 0.35. Infinite for balls and cubes, and for slender bodies and those with locked axes,
/// which have rules of their own.
[[nodiscard]] double turning_limit(const BodyMass& mass, double dt) noexcept;

class TurningRows {
public:
    static constexpr double kMostChange = 0.1;

    /// Before the rows are filled.
    /// @param room  (movable,) from finish() to store()
    void begin(const BodyArrays& bodies, std::span<const std::uint32_t> slot_of_row, std::span<dquat> room, double dt, int substeps);
    /// Puts the limit of a row's spin beside its inertia. @return whether the body is above it from the start: its kick has no gyroscopic change then.
    bool watch(std::size_t row, SolverMass& mass);
    /// Of a row that is none of these.
    static void ignore(SolverMass& mass) noexcept;
    /// When the rows are filled, before the first pass.
    void finish(const SolverBodies& rows);

    /// Advances [begin, end) and turns those above their limit, and from then on to the end of the step as often as what they turn by between changes their
    /// inertia by kMostChange: all at once, after every substep, or every second, fourth, ...
    /// @param substep  1 for the first
    void advance(SolverBodies& rows, std::size_t begin, std::size_t end, int substep);
    /// After the others are stored, over what was stored.
    void store(BodyArrays& bodies) const noexcept;

    /// @return whether advance() in this substep, 1 for the first, turned any body.
    [[nodiscard]] bool renewed_any(int substep) const noexcept { return last_renewed_ == substep; }
    /// By row, and one for what never moves: 1 for those that the last advance() gave another inertia.
    [[nodiscard]] std::span<const unsigned char> renewed() const noexcept { return renewed_; }
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(renewed_, waited_, blocks_); }

private:
    struct Block {
        float least_limit = 0.0f;  // squared, of its rows
        unsigned char any = 0;     // of them turns
    };
    void turn(SolverBodies& rows, std::size_t begin, std::size_t end, int substep);
    void start(SolverBodies& rows, std::size_t row);
    void turn_row(SolverBodies& rows, std::size_t row);
    [[nodiscard]] bool is_due(const SolverBody& body, const SolverMass& mass, int substep) const noexcept;

    static constexpr std::int16_t kSlow = -1;
    static constexpr std::size_t kBlock = 64;

    const BodyArrays* bodies_ = nullptr;  // of the step
    std::span<const std::uint32_t> slot_of_row_;
    std::vector<unsigned char> renewed_;
    std::vector<std::int16_t> waited_;  // by row: substeps since the body turned last; kSlow where it does not
    std::span<dquat> orientations_;     // by row, of those that do, as they turned last
    double dt_ = 0.0, h_ = 0.0;
    int substeps_ = 0;
    std::vector<Block> blocks_;  // of kBlock rows
    int last_renewed_ = 0;       // substep
};

}  // namespace carom::dynamics
