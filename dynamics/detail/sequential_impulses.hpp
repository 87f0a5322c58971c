// Sequential impulses: projected Gauss-Seidel on the contact problem of an island over the whole step. The baseline that the other methods are held against.
//
//   SequentialImpulses impulses;
//   impulses.solve(problem, 8);      // problem has the velocities and the impulses
//
// Source: Catto, Iterative Dynamics with Temporal Coherence (GDC 2005); Baumgarte's share of the overlap comes with the problem's biases. Departure: friction in a
// true circle, by the scalar step 1 / lambda_max of the tangent plane.
#pragma once

#include <carom/dynamics/detail/direct_problem.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <vector>

namespace carom::dynamics {

/// Overlap goes away by a fifth a step (Baumgarte 1972): its time is four steps beyond the one that is solved.
inline constexpr double kBaumgarteSteps = 4.0;
/// And only what is beyond this share of the smallest extent, or every push would throw the bodies off each other (Catto's slop).
inline constexpr double kSlopShare = 0.005;

class SequentialImpulses {
public:
    /// `passes` over all contacts, in their order, from the impulses that the problem comes with. Softness is not looked at: contacts are rigid, as far as the
    /// passes come; friction_guess neither.
    /// @param passes  >= 1. Cost: linear in contacts, some 100 ns each a pass.
    void solve(DirectProblem& problem, int passes);
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(rows_); }

private:
    struct Row {
        dmat3 inverse_a{0.0}, inverse_b{0.0};  // of the inertia, world axes
        double mass_a = 0.0, mass_b = 0.0;     // inverse
        double normal_mass = 0.0, tangent_mass = 0.0;
    };
    static Row row_of(const DirectProblem& problem, const DirectContact& contact);
    static void push(DirectProblem& problem, const Row& row, const DirectContact& contact, const dvec3& impulse);
    static void solve_point(DirectProblem& problem, const Row& row, DirectContact& contact);

    std::vector<Row> rows_;  // of the contacts; kept for its memory
};

}  // namespace carom::dynamics
