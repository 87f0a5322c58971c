#include <carom/dynamics/detail/turning_rows.hpp>

#include <carom/core/math.hpp>
#include <carom/dynamics/detail/body_kernels.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/slender.hpp>

#include <algorithm>
#include <atomic>
#include <limits>

namespace carom::dynamics {
namespace {

constexpr double kTolerance = 1e-4;                     // of the energy of a free rotation, in a substep
constexpr double kFarTurn = 0.35, kLeastChange = 0.02;  // [rad] in a step, and the change from which on that matters
constexpr float kMostAngle = 0.2f;                      // [rad] at once: attitude and spin part by its square
constexpr float kNever = std::numeric_limits<float>::infinity();

dvec3 as_dvec3(const float (&v)[4]) { return {v[0], v[1], v[2]}; }

void set(float (&out)[4], const dvec3& v) {
    out[0] = static_cast<float>(v.x), out[1] = static_cast<float>(v.y), out[2] = static_cast<float>(v.z);
}

float square(const float (&v)[4]) { return (v[0] * v[0] + v[1] * v[1]) + v[2] * v[2]; }

dquat turn_of(const SolverBody& body) { return {body.turn[3], body.turn[0], body.turn[1], body.turn[2]}; }

/// A spin scaled in the body's axes: by the moments it is an angular momentum.
dvec3 scaled(const dquat& orientation, const dvec3& by, const dvec3& spin) {
    return rotate(orientation, by * rotate_inverse(orientation, spin));
}

}  // namespace

double turning_limit(const BodyMass& mass, double dt) noexcept {
    if (mass.inertia == InertiaClass::Isotropic || (mass.locked & kLockedTurns) != 0 || is_slender(mass))
        return static_cast<double>(kNever);
    const dvec3& m = mass.moments;
    const double least = std::min({m.x, m.y, m.z}), most = std::max({m.x, m.y, m.z});
    const double change = most / least - 1.0;  // of an inertia, in a radian
    return std::min(TurningRows::kMostChange / change, std::max(kFarTurn, kLeastChange / change)) / dt;
}

void TurningRows::begin(const BodyArrays& bodies, std::span<const std::uint32_t> slot_of_row, std::span<dquat> room, double dt, int substeps) {
    bodies_ = &bodies;
    slot_of_row_ = slot_of_row;
    dt_ = dt;
    substeps_ = substeps;
    h_ = dt / substeps;
    last_renewed_ = 0;
    renewed_.assign(slot_of_row.size() + 1, 0);
    waited_.assign(room.size(), kSlow);
    orientations_ = room;
}

void TurningRows::ignore(SolverMass& mass) noexcept { mass.others[3] = kNever; }

bool TurningRows::watch(std::size_t row, SolverMass& mass) {
    const std::uint32_t slot = slot_of_row_[row];
    const auto limit = static_cast<float>(turning_limit(bodies_->masses[slot], dt_));
    mass.others[3] = limit * limit;
    const vec3 spin{bodies_->states[slot].spin};
    if (glm::dot(spin, spin) <= mass.others[3]) return false;
    waited_[row] = 0;
    return true;
}

void TurningRows::finish(const SolverBodies& rows) {
    const auto movable = static_cast<std::size_t>(rows.movable);
    blocks_.assign(rows.bodies.size() / kBlock + 1, {kNever});
    for (std::size_t row = 0; row < movable; ++row) {
        Block& block = blocks_[row / kBlock];
        block.least_limit = std::min(block.least_limit, rows.masses[row].others[3]);
        if (waited_[row] == kSlow) continue;
        block.any = 1;
        orientations_[row] = bodies_->states[slot_of_row_[row]].pose.orientation;
    }
}

// Two threads may share a block at the border of their parts, but no row.
void TurningRows::advance(SolverBodies& rows, std::size_t begin, std::size_t end, int substep) {
    while (begin < end) {
        Block& block = blocks_[begin / kBlock];
        const std::size_t stop = std::min(end, (begin / kBlock + 1) * kBlock);
        const float fastest = dynamics::advance(rows, begin, stop, static_cast<float>(h_));
        if (fastest > block.least_limit || std::atomic_ref(block.any).load(std::memory_order_relaxed) != 0) {
            turn(rows, begin, std::min(stop, waited_.size()), substep);
        }
        begin = stop;
    }
}

// At the end of the step, and where the body turns too far in twice as many substeps as the greatest power of two that divides the number of this one: to wait
// for the next such number would be too long.
bool TurningRows::is_due(const SolverBody& body, const SolverMass& mass, int substep) const noexcept {
    if (substep == substeps_) return true;
    const float share = static_cast<float>(2 * (substep & -substep)) / static_cast<float>(substeps_),
                angle = share * static_cast<float>(dt_);
    return square(body.spin) * (share * share) > mass.others[3] || square(body.spin) * (angle * angle) > kMostAngle * kMostAngle;
}

void TurningRows::turn(SolverBodies& rows, std::size_t begin, std::size_t end, int substep) {
    bool some = false, renews = false;
    for (std::size_t row = begin; row < end; ++row) {
        std::int16_t& waited = waited_[row];
        renewed_[row] = 0;
        if (waited == kSlow) {
            if (square(rows.bodies[row].spin) <= rows.masses[row].others[3]) continue;
            start(rows, row);
        }
        ++waited;
        some = true;
        if (!is_due(rows.bodies[row], rows.masses[row], substep)) continue;
        turn_row(rows, row);
        waited = 0;
        renewed_[row] = 1;
        renews = true;
    }
    if (some) std::atomic_ref(blocks_[begin / kBlock].any).store(1, std::memory_order_relaxed);
    if (renews) std::atomic_ref(last_renewed_).store(substep, std::memory_order_relaxed);
}

// Where the substep found the body. Its gyroscopic change is not spread over the step any more.
void TurningRows::start(SolverBodies& rows, std::size_t row) {
    SolverBody& body = rows.bodies[row];
    SolverBase& base = rows.bases[row];
    const std::uint32_t slot = slot_of_row_[row];
    const BodyState& state = bodies_->states[slot];
    orientations_[row] = glm::normalize(rotation_from_vector(-h_ * as_dvec3(body.spin)) * (turn_of(body) * state.pose.orientation));
    waited_[row] = 0;
    dvec3 torque{0.0};
    if (!bodies_->traits.empty()) torque = world_inverse_inertia(state, bodies_->masses[slot]) * bodies_->traits[slot].torque * h_;
    const dvec3 gyroscopic = as_dvec3(base.turn) - torque;
    set(base.turn, torque);
    set(base.spin, as_dvec3(base.spin) - gyroscopic);
    set(body.spin, as_dvec3(body.spin) - gyroscopic);
}

// Contacts have given the body an angular momentum in this substep: that is what it starts the next one with, whatever spin that is by then. Over several substeps
// its attitude is what these led to, and the spin is that of the free rotation as the body sees it, which keeps the energy.
void TurningRows::turn_row(SolverBodies& rows, std::size_t row) {
    SolverBody& body = rows.bodies[row];
    SolverBase& base = rows.bases[row];
    const std::uint32_t slot = slot_of_row_[row];
    const BodyMass& mass = bodies_->masses[slot];
    const dquat& first = bodies_->states[slot].pose.orientation;
    Rotation now{orientations_[row], as_dvec3(body.spin)};
    const dvec3 given = scaled(now.orientation, mass.moments, now.spin - as_dvec3(base.spin));
    rotate_free(now, mass, waited_[row] * h_, {.tolerance = kTolerance});
    if (waited_[row] > 1) {
        const dquat there = glm::normalize(turn_of(body) * first);
        now = {there, rotate(there, rotate_inverse(now.orientation, now.spin))};
    }
    orientations_[row] = now.orientation;
    set(body.spin, now.spin);
    set(base.spin, now.spin - scaled(now.orientation, mass.inverse_moments, given));
    const BodyState turned{.pose = {dvec3{0.0}, now.orientation}};
    const SymmetricInertia inertia = symmetric_inverse_inertia(turned, mass);
    SolverMass& m = rows.masses[row];
    for (int i = 0; i < 3; ++i)
        m.diagonal[i] = static_cast<float>(inertia.diagonal[i]), m.others[i] = static_cast<float>(inertia.others[i]);
    const dquat turn = now.orientation * glm::conjugate(first);
    body.turn[0] = static_cast<float>(turn.x), body.turn[1] = static_cast<float>(turn.y);
    body.turn[2] = static_cast<float>(turn.z), body.turn[3] = static_cast<float>(turn.w);
}

void TurningRows::store(BodyArrays& bodies) const noexcept {
    if (last_renewed_ == 0) return;  // or else it is the last substep
    for (std::size_t row = 0; row < orientations_.size(); ++row) {
        if (waited_[row] != kSlow) bodies.states[slot_of_row_[row]].pose.orientation = orientations_[row];
    }
}

}  // namespace carom::dynamics
