// Follows energy and momentum through a run and says how far they drift.
//
//   EnergyLedger ledger(world);
//   for (...) { run.before_step(i); ledger.bodies_changed(world); world.step(dt); ledger.stepped(world); }
//   double drift = ledger.drift();
#pragma once

#include <carom/dynamics/world.hpp>

#include <optional>
#include <vector>

namespace carom::oracle {

/// Energy that a run gains. Contact and friction may only take energy away, so a gain is an error; what bodies bring or
/// take that are created or removed, or changed by the user, is no gain. Kinematic bodies do work and are not accounted
/// for.
class EnergyLedger {
public:
    explicit EnergyLedger(const World& world);

    /// Call before each step, or at least after the user created, removed or moved bodies. Cheap where nothing changed.
    void bodies_changed(const World& world);
    /// Call after each step.
    void stepped(const World& world);

    /// @return energy now less energy at the start, less what the user brought [J]; negative: lost.
    [[nodiscard]] double change() const noexcept { return last_.total() - start_ - brought_; }
    /// @return the largest kinetic energy so far + Σ m g L, with L the smallest extent of any dynamic body's shape [J].
    [[nodiscard]] double reference() const noexcept { return largest_kinetic_ + lift_; }
    /// @return the largest change() / reference() over the run, so never negative; 0 if nothing was gained. Over 1e-3 the
    /// run is faulty.
    [[nodiscard]] double drift() const noexcept { return drift_; }

private:
    void measure(const World& world);
    void look_at_bodies(const World& world);

    std::vector<BodyId> bodies_;  ///< those that lift_ is about
    Energy last_;
    double start_ = 0.0;
    double brought_ = 0.0;
    double largest_kinetic_ = 0.0;
    double lift_ = 0.0;
    double drift_ = 0.0;
};

/// Relative errors of what a free system keeps.
struct MomentumDrift {
    double linear = 0.0;             ///< |Δp| over the largest Σ m |v| so far
    double angular = 0.0;            ///< |ΔL| over |L| at the start, L about the world's origin, as a vector
    double angular_magnitude = 0.0;  ///< ||L| - |L0|| over |L0|
};

/// Momentum of a world without gravity in which every body is dynamic; elsewhere the ground takes part, and there is no
/// drift to speak of.
class MomentumLedger {
public:
    explicit MomentumLedger(const World& world);

    /// Call after the user created, removed or changed bodies, before the next step: what they brought is no drift.
    void bodies_changed(const World& world);
    /// Call after each step.
    void stepped(const World& world);

    /// @return the largest errors over the run; nothing where the world is not free. A quantity that is and stays zero
    /// has no error.
    [[nodiscard]] std::optional<MomentumDrift> drift() const noexcept;

private:
    bool free_ = false;
    Momentum start_;
    Momentum last_;
    double largest_sum_ = 0.0;
    MomentumDrift drift_;
};

}  // namespace carom::oracle
