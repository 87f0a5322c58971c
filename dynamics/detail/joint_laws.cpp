// What each row of an island asks for: the softness and the push of ball joints and springs, and how loads stiffen the turn of bodies.
#include <carom/dynamics/detail/joint_island.hpp>
#include <carom/dynamics/detail/joint_laws.hpp>

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

/// Softness of a ball joint over the inverse mass that it feels: what a solve leaves of an error, per iteration and mass ratio. Smaller ones
/// lose the digits of the velocities in the factor.
constexpr double kSoftness = 1e-9;
/// Gaps that bodies were created with, or that were torn open, close by that share of the arms in a substep: all at once would be a blow.
constexpr double kMostClosed = 0.01;
/// Where the swing of a spring takes fewer than 2 pi substeps ((ω h)² > 1) it is damped away.
constexpr double kResolved = 1.0;
/// A spring whose anchors move against each other by more of their distance in a substep is not resolved either.
constexpr double kMostPassed = 0.25;
/// Loads that turn a body back with (ω h)² above this are taken at the end of the drift, which damps such a swing.
constexpr double kCalmTurn = 0.5;

}  // namespace

// A load f at an arm r turns its body back by r f for each radian, and explicit steps of h are stable while h² r f is below 4 times the moment. Where it
// comes near, the torque is taken at the end of the drift: what it is now less h times that stiffness and the spin, as of a stiff spring
// (Newmark 1959; the geometric stiffness of Tournier et al. 2015).
void JointIsland::stiffen() noexcept {
    for (const JointRow& row : rows) {
        const auto load = [&](std::int32_t end, const dvec3& arm, const dvec3& force) {
            if (end < 0) return;
            const double length_sq = glm::dot(arm, arm);
            const double turning = 0.5 * (glm::dot(arm, force) + std::sqrt(length_sq * glm::dot(force, force)));
            if (!(turning > 0.0)) return;
            bodies[as_index(end)].stiffening += turning * (dmat3{1.0} - glm::outerProduct(arm, arm) / length_sq);
        };
        load(row.a.body, row.arm_a, -row.force);
        load(row.b.body, row.arm_b, row.force);
    }
    for (JointBody& body : bodies) {
        const bool calm = !(h_ * h_ * trace(body.stiffening * body.inverse_turn) > kCalmTurn);
        if (calm || (body.mass->locked & kLockedTurns) != 0) {
            body.stiffening = dmat3{0.0};
            continue;
        }
        body.stiffening *= share_ * h_ * h_;
        body.inverse_turn = glm::inverse(glm::inverse(body.inverse_turn) + body.stiffening);
    }
}

void JointIsland::set_up_ball(JointRow& row) const noexcept {
    double light = 0.0;
    if (row.a.body >= 0) light += lightness(bodies[as_index(row.a.body)], row.arm_a);
    if (row.b.body >= 0) light += lightness(bodies[as_index(row.b.body)], row.arm_b);
    row.along = row.across = light > 0.0 ? 1.0 / (kSoftness * light) : 0.0;
    const double wide = glm::length(row.gap), most = kMostClosed * (glm::length(row.arm_a) + glm::length(row.arm_b));
    row.left = most > 0.0 && wide > most ? (1.0 - most / wide) * row.gap : dvec3{0.0};
}

void JointIsland::set_up_spring(JointRow& row, double share) const noexcept {
    double stiffness = 0.0, damping = 0.0;  // of all springs of the two bodies, over the masses: ω² and twice the decay rate, at most
    for (const std::int32_t end : {row.a.body, row.b.body}) {
        if (end < 0) continue;
        stiffness += bodies[as_index(end)].stiffness;
        damping += bodies[as_index(end)].damping;
    }
    // Near its middle the direction of a spring may turn over within a substep.
    const bool turns = row.rest_length > 0.0 && h_ * glm::length(velocity_of(row)) > kMostPassed * glm::length(row.gap);
    const bool resolved = h_ * h_ * stiffness <= kResolved && !turns, lightly = h_ * damping <= kResolved;
    const double length = glm::length(row.gap), stretch = length - row.rest_length;
    const double pull = length > 0.0 ? std::max(row.stiffness * stretch / length, 0.0) : 0.0;  // stiffness across
    const double weight = share > 0.0 ? 1.0 : 0.0;
    const auto inertia = [&](double k) { return weight * h_ * h_ * k * (resolved ? 1.0 / 12.0 : share); };
    row.push = share * h_ * row.stiffness * stretch * row.direction;
    row.keep = resolved ? inertia(row.stiffness) : 0.0;
    row.along = inertia(row.stiffness);
    // Across, where it must be: an impulse that is not along the line turns the two about each other.
    row.across = resolved ? 0.0 : inertia(pull);
    const double damper = share * h_ * row.damping;
    // Over the mean of the velocities before and after where that is stable, else over that after.
    row.along += lightly ? 0.5 * damper : damper;
    if (lightly) row.keep -= 0.5 * damper;
    if (row.rest_length > 0.0) return;
    // A spring of no length has no direction.
    row.direction = dvec3{0.0};
    row.push = share * h_ * row.stiffness * row.gap;
    row.across = row.along;
}

}  // namespace carom::dynamics
