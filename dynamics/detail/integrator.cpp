#include <carom/dynamics/detail/integrator.hpp>

#include <carom/core/math.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace carom::dynamics {
namespace {

constexpr double kSmallTurn = 1.0 / 40.0;     // [rad] in one step: below it, Euler's equations to second order
constexpr double kContactTolerance = 1e-3;

bool turns_freely(const BodyMass& mass) noexcept { return (mass.locked & kLockedTurns) == 0; }

/// What can turn about one axis of the world, or is as heavy about each, keeps its spin.
bool turns_evenly_locked(const BodyMass& mass) noexcept {
    return mass.inertia == InertiaClass::Isotropic || std::popcount(static_cast<unsigned>(mass.locked & kLockedTurns)) == 2;
}

/// The implicit midpoint rule about the axes that are not locked, whose angular momentum stays: it runs backwards as it runs forwards, so that energy
/// sways and does not grow (Hairer, Lubich, Wanner 2006, V.1).
void rotate_locked(BodyState& state, const BodyMass& mass, double dt) noexcept {
    if (turns_evenly_locked(mass)) {
        state.pose.orientation = glm::normalize(rotation_from_vector(state.spin * dt) * state.pose.orientation);
        return;
    }
    constexpr double kMostAngle = 0.05;  // of a cycle [rad]
    const dvec3 momentum = angular_momentum(state, mass);
    const double cycles = std::ceil(glm::length(state.spin) * std::abs(dt) / kMostAngle), h = dt / std::max(cycles, 1.0);
    for (double k = 0.0; k < cycles; ++k) {
        const dquat from = state.pose.orientation;
        for (int round = 0; round < 6; ++round) {  // each leaves a fraction of the angle of the error before
            state.pose.orientation = glm::normalize(rotation_from_vector(state.spin * (0.5 * h)) * from);
            state.spin = world_inverse_inertia(state, mass) * momentum;
        }
        state.pose.orientation = glm::normalize(rotation_from_vector(state.spin * h) * from);
        state.spin = world_inverse_inertia(state, mass) * momentum;
    }
}

/// Whether a step can turn a body so far. What cannot be turned keeps its spin, by which the step's end puts it into quarantine.
bool can_turn(const dvec3& spin, double dt) noexcept { return glm::length(spin) * std::abs(dt) <= kMostTurn; }

void turn(BodyState& state, const BodyMass& mass, double dt, double tolerance) noexcept {
    if (!turns_freely(mass)) return rotate_locked(state, mass, dt);
    Rotation turning{state.pose.orientation, state.spin};
    rotate_free(turning, mass, dt, {.tolerance = tolerance});
    state.pose.orientation = turning.orientation;
    state.spin = turning.spin;
}

/// The inverse of S' I S over the free axes, zero elsewhere: constraint torques act about locked axes alone.
dmat3 inverse_over_free(const dmat3& inertia, unsigned char locked) noexcept {
    std::array<int, 3> axes{};
    int count = 0;
    for (int i = 0; i < 3; ++i) {
        if ((locked & (LockedAxes::TurnX << i)) == 0) axes[static_cast<std::size_t>(count++)] = i;
    }
    dmat3 out{0.0};
    const int i = axes[0], j = axes[1];
    if (count == 1) out[i][i] = 1.0 / inertia[i][i];
    if (count == 2) {
        const double determinant = inertia[i][i] * inertia[j][j] - inertia[i][j] * inertia[j][i];
        out[i][i] = inertia[j][j] / determinant;
        out[j][j] = inertia[i][i] / determinant;
        out[i][j] = out[j][i] = -inertia[i][j] / determinant;
    }
    return out;
}

dmat3 in_world(const dquat& orientation, const dvec3& diagonal) noexcept {
    const dmat3 r = glm::mat3_cast(orientation);
    dmat3 scaled = r;
    for (int i = 0; i < 3; ++i) scaled[i] *= diagonal[i];
    return scaled * glm::transpose(r);
}

}  // namespace

Decay decay(double x) noexcept {
    const int halvings = x > 0.5 ? std::ilogb(x) + 2 : 0;
    if (halvings > 16) return {0.0, 1.0 / x, (1.0 - 1.0 / x) / x};  // exp(-x) is below the least double
    const double y = std::ldexp(x, -halvings);
    double second = 0.0;  // Horner over sum (-y)^k / (k + 2)!
    for (int k = 16; k >= 0; --k) second = (1.0 - y * second) / (k + 2);
    Decay d;
    d.second = second;
    d.first = 1.0 - y * second;
    d.left = 1.0 - y * d.first;
    if (halvings == 0) return d;
    for (int i = 0; i < halvings; ++i) d.left *= d.left;
    d.first = (1.0 - d.left) / x;
    d.second = (1.0 - d.first) / x;
    return d;
}

void integrate_free(BodyState& state, const BodyMass& mass, const FreeMotion& motion, double dt) noexcept {
    const dvec3 free = free_moves(mass.locked), pull = free * motion.acceleration;
    if (mass.locked != 0) state.velocity *= free;
    if (motion.linear_damping == 0.0) {
        state.pose.position += (state.velocity + pull * (0.5 * dt)) * dt;
        state.velocity += pull * dt;
    } else {
        const Decay d = decay(motion.linear_damping * dt);
        state.pose.position += (d.first * state.velocity + d.second * dt * pull) * dt;
        state.velocity = d.left * state.velocity + d.first * dt * pull;
    }
    const bool twisted = motion.torque != dvec3{0.0};
    const Decay d = motion.angular_damping == 0.0 ? Decay{} : decay(motion.angular_damping * dt);
    const auto kick = [&] { state.spin += world_inverse_inertia(state, mass) * motion.torque * (0.5 * dt); };
    if (!turns_freely(mass)) state.spin = world_inverse_inertia(state, mass) * angular_momentum(state, mass);
    if (twisted) kick();
    if (!can_turn(state.spin, d.first * dt)) return;
    turn(state, mass, d.first * dt, motion.spin_tolerance);
    if (motion.angular_damping != 0.0) state.spin *= d.left;
    if (twisted) kick();
}

dvec3 gyroscopic_change(const BodyState& state, const BodyMass& mass, double dt) noexcept {
    if (mass.inertia == InertiaClass::Isotropic || !can_turn(state.spin, dt)) return dvec3{0.0};
    if (!turns_freely(mass)) {
        BodyState turned = state;
        rotate_locked(turned, mass, dt);
        return turned.spin - state.spin;
    }
    if (glm::dot(state.spin, state.spin) * (dt * dt) <= kSmallTurn * kSmallTurn) {
        // In body axes spin' = rate, and the body turns under it: in world axes spin'' = spin x rate + rate'.
        const dvec3 spin = rotate_inverse(state.pose.orientation, state.spin), momentum = mass.moments * spin;
        const dvec3 rate = mass.inverse_moments * glm::cross(momentum, spin);
        const dvec3 rate_change = mass.inverse_moments * (glm::cross(mass.moments * rate, spin) + glm::cross(momentum, rate));
        const dvec3 second = glm::cross(spin, rate) + rate_change;
        return rotate(state.pose.orientation, dt * (rate + 0.5 * dt * second));
    }
    Rotation turning{state.pose.orientation, state.spin};
    rotate_free(turning, mass, dt, {.tolerance = kContactTolerance});
    return turning.spin - state.spin;
}

dmat3 world_inverse_inertia(const BodyState& state, const BodyMass& mass) noexcept {
    if (turns_freely(mass)) return in_world(state.pose.orientation, mass.inverse_moments);
    return inverse_over_free(in_world(state.pose.orientation, mass.moments), mass.locked);
}

SymmetricInertia symmetric_inverse_inertia(const BodyState& state, const BodyMass& mass) noexcept {
    if (!turns_freely(mass)) {
        const dmat3 all = world_inverse_inertia(state, mass);
        return {{all[0][0], all[1][1], all[2][2]}, {all[0][1], all[0][2], all[1][2]}};
    }
    // The sums of in_world(), in its order: the same bits.
    const dmat3 r = glm::mat3_cast(state.pose.orientation);
    const dvec3& d = mass.inverse_moments;
    const dvec3 x = r[0] * d.x, y = r[1] * d.y, z = r[2] * d.z;
    const auto entry = [&](int column, int row) { return x[row] * r[0][column] + y[row] * r[1][column] + z[row] * r[2][column]; };
    return {{entry(0, 0), entry(1, 1), entry(2, 2)}, {entry(0, 1), entry(0, 2), entry(1, 2)}};
}

dvec3 angular_momentum(const BodyState& state, const BodyMass& mass) noexcept {
    return rotate(state.pose.orientation, mass.moments * rotate_inverse(state.pose.orientation, state.spin));
}

}  // namespace carom::dynamics
