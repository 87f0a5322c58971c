// Newton's method on the contact problem of an island, in blocks of 6 x 6, with an exact line search.
//
//   DirectNewton newton;
//   if (newton.analyse(problem.bodies.size(), links, 100'000)) {
//       DirectResult r = newton.solve(problem, settings);
//       if (r.converged) ...  // problem has the velocities and the impulses
//   }
#pragma once

#include <carom/dynamics/detail/block_cholesky.hpp>
#include <carom/dynamics/detail/direct_problem.hpp>
#include <carom/dynamics/detail/friction_cone.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

/// Points that follow each other, between the same two bodies; either may be kNoBody.
struct ContactLink {
    std::int32_t a = kNoBody, b = kNoBody;
    std::uint32_t points = 0;
    friend bool operator==(const ContactLink&, const ContactLink&) = default;
};

struct DirectSettings {
    double speed_tolerance = 0.0;  ///< by which no body's velocity may miss its balance of momentum [m/s] > 0
    double slip_tolerance = 0.0;   ///< by which a sliding point may be lifted too fast or too slowly [m/s] > 0
    int most_iterations = 60;
    int most_factorisations = 60;
    int most_slip_passes = 12;
    int early_look = 0;            ///< after so many iterations the solve ends without convergence where more is missing than
    double early_most = 0.0;       ///< [m/s]; 0 iterations: never
};

struct DirectResult {
    bool converged = false;
    int iterations = 0;       ///< linear solves
    int factorisations = 0;
    double residual = 0.0;    ///< the largest error of a body's velocity by its momentum [m/s]
    double slip_error = 0.0;  ///< the largest |μ |u_t| - correction| of a sliding point [m/s]
};

/// Keeps the factor from one solve to the next: where the same contacts stick and the bodies hardly moved, one back substitution is all that
/// an iteration takes. What it keeps changes how fast it converges, and the last digits.
class DirectNewton {
public:
    /// Lays out the factor, anew where another two bodies touch than the last time. No more need be known of the problem than who touches whom.
    /// @param links  of the problem's points, in their order.
    /// @return whether a factorisation takes at most `most_operations` of blocks.
    [[nodiscard]] bool analyse(std::size_t bodies, std::span<const ContactLink> links, std::size_t most_operations);
    [[nodiscard]] std::size_t operations() const noexcept { return factor_.operations(); }
    /// How often an order of elimination was looked for.
    [[nodiscard]] std::size_t orders() const noexcept { return orders_; }

    /// From the velocities that the problem comes with to those that solve it. Where it does not converge, they and the impulses mean nothing.
    /// Cost: an iteration is linear in contacts and in blocks of the factor; a factorisation takes operations() products of blocks.
    DirectResult solve(DirectProblem& problem, const DirectSettings& settings);
    [[nodiscard]] std::size_t memory() const noexcept;

private:
    struct Motion {
        dvec3 linear{0.0}, angular{0.0};
    };
    struct Point {
        double correction = 0.0;  // of the bias, for sliding [m/s]
        dvec3 y{0.0}, step{0.0};  // step: change of y over the whole Newton step
        ConePoint cone;
    };
    void evaluate(const DirectProblem& problem);
    [[nodiscard]] double residual(const DirectProblem& problem) const;
    /// @return whether the factor is of too many other states.
    [[nodiscard]] bool has_changed() const;
    [[nodiscard]] bool refactor(const DirectProblem& problem);
    void assemble(const DirectProblem& problem);
    void find_step(const DirectProblem& problem);
    [[nodiscard]] double step_length(const DirectProblem& problem);
    void take_step(DirectProblem& problem, double length);
    /// @return the largest change of a correction.
    [[nodiscard]] double correct_for_slip(const DirectProblem& problem);
    [[nodiscard]] bool minimise(DirectProblem& problem, const DirectSettings& settings, DirectResult& result);

    BlockCholesky factor_;
    std::vector<BlockEdge> edges_, before_;
    std::size_t orders_ = 0;
    std::size_t edge_bodies_ = 0;        // that the factor is laid out for, with edges_
    std::vector<std::int32_t> edge_of_;  // of each contact; -1 where one side is no body
    bool has_factor_ = false;
    std::vector<ConeState> factored_;    // states that the factor was made of
    std::vector<Motion> gradient_;
    std::vector<double> load_;           // Σ |λ| on each body [N s]
    std::vector<Vector6> step_;
    std::vector<Point> points_;
};

}  // namespace carom::dynamics
