// From the bodies and manifolds of an island to its contact problem, and back.
#pragma once

#include <carom/dynamics/detail/direct_newton.hpp>
#include <carom/dynamics/detail/direct_problem.hpp>
#include <carom/dynamics/detail/proxies.hpp>

#include <cstdint>
#include <span>

namespace carom::dynamics {

struct DirectStep {
    dvec3 gravity{0.0};     ///< [m/s²]; not zero for what is solved directly
    double dt = 0.0;        ///< [s]
    double long_dt = 0.0;   ///< of the longest of late, >= dt: overlap that it left is pushed out as slowly as in it [s]
    int substeps = 8;       ///< of the soft solver: impulses of contacts are kept as of one
    double contact_rate = 0.1875;
    double max_push = 0.1;  ///< share of the smallest extent a step
    double sag = 1e-4;      ///< of the smallest extent, for a point that bears its manifold's load alone
    [[nodiscard]] double substep() const noexcept { return dt / substeps; }
};

/// What a step has, read and written.
struct DirectWorld {
    ContactSet& contacts;
    const ProxySet& proxies;
    BodyArrays& bodies;
    std::span<const unsigned char> jointed{};  ///< by slot: 1 for bodies with joints; empty where there are none
};

/// How an island moves and how large it is.
struct IslandShape {
    double weight = 0.0;      ///< [N]
    double extent = 0.0;      ///< the smallest of what touches [m]
    double height = 0.0;      ///< along gravity, of the centres of mass, and an extent [m]
    double top_speed = 0.0;   ///< [m/s]
    double largest = 0.0;     ///< reach of the largest body [m]
    bool impact = false;      ///< a point that bounces is approaching
};
[[nodiscard]] IslandShape look_at_island(const DirectWorld& world, std::span<const std::uint32_t> bodies, std::span<const std::uint32_t> manifolds,
                                         const DirectStep& step);

/// How stiff the contacts of an island are and how exactly it is solved.
struct IslandStiffness {
    double sag = 0.0;         ///< of a point that bears its manifold's load alone [m]
    double relaxation = 0.0;  ///< tau: overlap beyond the sag goes away in such a time [s]
    double hop = 0.0;         ///< and no faster than what lifts the island's top by a share of an extent e, over √e [√m/s]
    double height = 0.0;      ///< of the island [m]
    DirectSettings tolerances;

    /// @param extent  of the smaller of two shapes, so many of which the island is high, or as many as it has bodies
    /// @return how fast overlap of theirs may be pushed out [m/s]
    [[nodiscard]] double most_push(double extent, std::size_t bodies) const noexcept;
};
[[nodiscard]] IslandStiffness stiffness_of(const IslandShape& shape, const DirectStep& step) noexcept;

struct IslandLists {
    std::span<const std::uint32_t> bodies;        ///< slots
    std::span<const std::uint32_t> manifolds;
    std::span<const std::int32_t> local_of_slot;  ///< of those bodies: their place in `bodies`; kNoBody for all others
    std::span<const double> loads;                ///< that each manifold is made stiff for [N]
};
void fill_problem(const DirectWorld& world, const IslandLists& island, const IslandStiffness& stiffness, const DirectStep& step,
                  DirectProblem& problem);

/// Gives the contacts of a filled problem the impulses of the step before.
void guess_impulses(const DirectWorld& world, std::span<const std::uint32_t> manifolds, const DirectStep& step, DirectProblem& problem);

/// Moves the bodies and keeps the impulses.
void apply_solution(const DirectProblem& problem, std::span<const std::uint32_t> bodies, std::span<const std::uint32_t> manifolds,
                    const DirectStep& step, const DirectWorld& world);

}  // namespace carom::dynamics
