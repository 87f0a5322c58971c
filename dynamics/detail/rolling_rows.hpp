// Rows against rolling and spinning, for the few contacts that ask for them: a pass of its own after each pass over the contacts.
//
//   rolling.list({contacts, proxies, rows, bundles}, h);   // after the bundles are filled
//   rolling.warm_start(rows);                              // in the first substep
//   rolling.solve(rows, bundles);                          // after each pass
//
// A contact that bears the normal force N passes on a torque of at most rho N against the relative turning about tangents (rolling), and of at most
// tau N against that about the normal (spinning): Coulomb's laws, with lengths for coefficients.
#pragma once

#include <carom/dynamics/detail/contact_bundle.hpp>
#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

/// What the rows are made of.
struct RollingInput {
    const ContactSet& contacts;
    const ProxySet& proxies;
    const SolverBodies& rows;
    std::span<const ContactBundle> bundles;
};

class RollingRows {
public:
    /// Lists the manifolds with a resistance. They begin with the torques that they had in the step before. @param h  the substep [s]
    void list(const RollingInput& input, double h);
    void warm_start(SolverBodies& rows) const noexcept;
    void solve(SolverBodies& rows, std::span<const ContactBundle> bundles) noexcept;
    /// Of rows with a body that is 1 in `changed`, whose inverse inertia has changed.
    void renew(const SolverBodies& rows, std::span<const unsigned char> changed) noexcept;
    /// There are none, and none are remembered.
    void clear() noexcept;
    [[nodiscard]] bool is_empty() const noexcept { return rows_.empty(); }
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(rows_, before_, place_); }

private:
    struct Row {
        std::uint64_t key = 0;      // of the pair
        ShapeId shape_a, shape_b;   // slots are reused
        std::uint32_t number = 0;   // of the manifold in it
        std::uint32_t bundle = 0, lane = 0;
        std::int32_t a = 0, b = 0;
        dvec3 normal{0.0};
        double rolling = 0.0, torsion = 0.0;           // [m]
        double rolling_mass = 0.0, torsion_mass = 0.0;  // [kg m²]
        dvec3 impulse{0.0};                            // torque times time on B, of a substep [N m s]
    };
    static void weigh(Row& row, const SolverBodies& rows) noexcept;
    static void turn(SolverBodies& rows, const Row& row, const dvec3& impulse) noexcept;
    void find_lanes(const RollingInput& input);

    std::vector<Row> rows_, before_;
    double h_ = 0.0;  // of rows_
    std::vector<std::uint32_t> place_;  // by manifold: bundle and lane
};

}  // namespace carom::dynamics
