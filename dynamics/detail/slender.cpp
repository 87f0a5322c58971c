#include <carom/dynamics/detail/slender.hpp>

#include <carom/core/math.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

constexpr double kSlenderShare = 1.0 / 25.0;  // of the moments: from a length of some six times the thickness on
constexpr double kSmallTwist = 0.5;           // [rad] in a step

int least_axis(const dvec3& moments) noexcept {
    const int xy = moments.x <= moments.y ? 0 : 1;
    return moments[xy] <= moments.z ? xy : 2;
}

double energy_of(const dquat& orientation, const dvec3& moments, const dvec3& spin) noexcept {
    const dvec3 own = rotate_inverse(orientation, spin);
    return glm::dot(moments * own, own);
}

dvec3 as_dvec3(const float (&v)[4]) { return {v[0], v[1], v[2]}; }

}  // namespace

bool is_slender(const BodyMass& mass) noexcept {
    if (mass.inertia == InertiaClass::Isotropic || (mass.locked & kLockedTurns) != 0) return false;
    const int least = least_axis(mass.moments);
    return mass.moments[least] < kSlenderShare * std::min(mass.moments[(least + 1) % 3], mass.moments[(least + 2) % 3]);
}

SlenderMotion::SlenderMotion(const BodyState& state, const BodyMass& mass) noexcept {
    const int least = least_axis(mass.moments);
    dvec3 own{0.0};
    own[least] = 1.0;
    axis = rotate(state.pose.orientation, own);
    share = 2.0 * mass.moments[least] / (mass.moments[(least + 1) % 3] + mass.moments[(least + 2) % 3]);
}

dvec3 SlenderMotion::precessed(const dvec3& spin, double h) const noexcept {
    const double along = glm::dot(axis, spin);
    const dvec3 across = spin - along * axis;
    const SinCos angle = sin_cos(share * along * h);
    return along * axis + (angle.cos * across + angle.sin * glm::cross(axis, across));
}

void SlenderMotion::advance(const dvec3& spin, double h) noexcept {
    const double along = glm::dot(axis, spin);
    twist += h * along;
    swing = glm::normalize(rotation_from_vector(h * (spin - along * axis)) * swing);
}

void SlenderMotion::finish(BodyState& state, const BodyMass& mass) const noexcept {
    const dquat start = state.pose.orientation;
    const dvec3 spin = state.spin;
    state.pose.orientation = glm::normalize(swing * rotation_from_vector(twist * axis) * start);
    state.spin = rotate(swing, spin);
    if (mass.inertia == InertiaClass::Symmetric) return;
    const double before = energy_of(start, mass.moments, spin), after = energy_of(state.pose.orientation, mass.moments, state.spin);
    if (after > before) state.spin *= std::sqrt(before / after);
}

BodyState slender_before(const BodyState& end, const BodyMass& mass, const Pose& pose, double h) noexcept {
    BodyState state{pose, end.velocity, end.spin};
    const SlenderMotion then(end, mass), now(state, mass);
    const dvec3 spin = then.precessed(end.spin, -h);
    const double along = glm::dot(then.axis, spin), cosine = glm::dot(then.axis, now.axis);
    const dvec3 across = spin - along * then.axis, arc = glm::cross(then.axis, now.axis);  // the shortest from axis to axis
    const double bend = 1.0 + cosine;
    const dvec3 carried = bend > 0.0 ? across + glm::cross(arc, across) + glm::cross(arc, glm::cross(arc, across)) / bend : -across;
    state.spin = along * now.axis + carried;
    return state;
}

void SlenderRows::list(const BodyArrays& bodies, std::span<const std::uint32_t> slot_of_row, std::span<const unsigned char> slender,
                       double dt, int substeps) {
    h_ = dt / substeps;
    rods_.clear();
    for (auto row = std::find(slender.begin(), slender.end(), 1); row != slender.end(); row = std::find(row + 1, slender.end(), 1)) {
        const auto number = static_cast<std::size_t>(row - slender.begin());
        const std::uint32_t slot = slot_of_row[number];
        const BodyState& state = bodies.states[slot];
        Rod& rod = rods_.emplace_back();
        rod = {.row = static_cast<std::int32_t>(number),
               .slot = slot,
               .start = state.pose.orientation,
               .motion = {state, bodies.masses[slot]}};
        rod.shows_twist = std::abs(glm::dot(rod.motion.axis, state.spin)) * dt < kSmallTwist;
    }
}

void SlenderRows::precess(SolverBodies& rows) const noexcept {
    for (const Rod& rod : rods_) {
        SolverBody& body = rows.bodies[static_cast<std::size_t>(rod.row)];
        SolverBase& base = rows.bases[static_cast<std::size_t>(rod.row)];
        const dvec3 from = as_dvec3(base.spin), to = rod.motion.precessed(from, h_);
        for (int i = 0; i < 3; ++i) {
            const float pushed = body.spin[i] - base.spin[i];
            base.spin[i] = static_cast<float>(to[i]);
            body.spin[i] = base.spin[i] + pushed;
        }
    }
}

void SlenderRows::swing(SolverBodies& rows) noexcept {
    for (Rod& rod : rods_) {
        SolverBody& body = rows.bodies[static_cast<std::size_t>(rod.row)];
        rod.motion.advance(as_dvec3(body.spin), h_);
        const dquat turn = rod.shows_twist ? rod.motion.swing * rotation_from_vector(rod.motion.twist * rod.motion.axis) : rod.motion.swing;
        body.turn[0] = static_cast<float>(turn.x), body.turn[1] = static_cast<float>(turn.y);
        body.turn[2] = static_cast<float>(turn.z), body.turn[3] = static_cast<float>(turn.w);
    }
}

void SlenderRows::store(BodyArrays& bodies) const noexcept {
    for (const Rod& rod : rods_) {
        BodyState& state = bodies.states[rod.slot];
        state.pose.orientation = rod.start;
        rod.motion.finish(state, bodies.masses[rod.slot]);
    }
}

}  // namespace carom::dynamics
