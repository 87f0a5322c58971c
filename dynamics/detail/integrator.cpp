#include <carom/dynamics/detail/integrator.hpp>

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

constexpr double kSmallTurn = 1.0 / 40.0;  // [rad] in one step: below it, Euler's equations to second order

/// One factor of the splitting: free rotation about body axis i for `dt`. L (body axes) turns the other way.
template <int i>
void turn_about_axis(dquat& orientation, dvec3& momentum, const dvec3& inverse_moments, double dt) noexcept {
    constexpr int j = (i + 1) % 3;
    constexpr int k = (i + 2) % 3;
    const double angle = dt * momentum[i] * inverse_moments[i];
    const SinCos half = sin_cos(0.5 * angle);
    const double c = 1.0 - 2.0 * half.sin * half.sin;
    const double s = 2.0 * half.sin * half.cos;
    const double mj = momentum[j];
    const double mk = momentum[k];
    momentum[j] = c * mj + s * mk;
    momentum[k] = c * mk - s * mj;
    dquat about{half.cos, 0.0, 0.0, 0.0};
    about[i] = half.sin;  // GLM stores x, y, z, w
    orientation = orientation * about;
}

void split_rotation(dquat& q, dvec3& momentum, const BodyMass& mass, double dt, int cycles) noexcept {
    const double h = dt / cycles;
    for (int cycle = 0; cycle < cycles; ++cycle) {
        turn_about_axis<0>(q, momentum, mass.inverse_moments, 0.5 * h);
        turn_about_axis<1>(q, momentum, mass.inverse_moments, 0.5 * h);
        turn_about_axis<2>(q, momentum, mass.inverse_moments, h);
        turn_about_axis<1>(q, momentum, mass.inverse_moments, 0.5 * h);
        turn_about_axis<0>(q, momentum, mass.inverse_moments, 0.5 * h);
    }
}

/// A symmetric top turns about L at |L| / I_equal while it spins about its own axis.
void symmetric_rotation(dquat& q, const dvec3& world_momentum, const BodyMass& mass, double dt) noexcept {
    const int axis = mass.symmetry_axis;
    const int other = (axis + 1) % 3;
    const dvec3 body_momentum = rotate_inverse(q, world_momentum);
    const double inverse_equal = mass.inverse_moments[other];
    const double own_rate = body_momentum[axis] * (mass.inverse_moments[axis] - inverse_equal);
    dvec3 own_axis{0.0};
    own_axis[axis] = 1.0;
    q = rotation_from_vector(world_momentum * (inverse_equal * dt)) * q * rotation_about(own_axis, own_rate * dt);
}

/// Turns (orientation, spin) freely by dt, in cycles of at most `cycle_angle` where the inertia needs cycles.
void rotate_free(dquat& q, dvec3& spin, const BodyMass& mass, double dt, double cycle_angle) noexcept {
    const double angle = glm::length(spin) * std::abs(dt);
    CAROM_ASSERT(angle <= kMostTurn);
    if (mass.inertia == InertiaClass::Isotropic) {
        q = glm::normalize(rotation_from_vector(spin * dt) * q);
        return;
    }
    dvec3 body_momentum = mass.moments * rotate_inverse(q, spin);
    if (mass.inertia == InertiaClass::Symmetric) {
        const dvec3 world_momentum = rotate(q, body_momentum);
        symmetric_rotation(q, world_momentum, mass, dt);
        q = glm::normalize(q);
        spin = rotate(q, mass.inverse_moments * rotate_inverse(q, world_momentum));
        return;
    }
    const int cycles = 1 + static_cast<int>(angle / cycle_angle);
    split_rotation(q, body_momentum, mass, dt, cycles);
    q = glm::normalize(q);
    spin = rotate(q, mass.inverse_moments * body_momentum);
}

}  // namespace

void classify_inertia(BodyMass& mass) noexcept {
    const dvec3& m = mass.moments;
    const double tolerance = 1e-12 * std::max({m.x, m.y, m.z});
    int equal_pairs = 0;
    for (int i = 0; i < 3; ++i) {
        if (std::abs(m[(i + 1) % 3] - m[(i + 2) % 3]) <= tolerance) {
            ++equal_pairs;
            mass.symmetry_axis = i;
        }
    }
    mass.inertia = equal_pairs == 0   ? InertiaClass::Asymmetric
                   : equal_pairs == 1 ? InertiaClass::Symmetric
                                      : InertiaClass::Isotropic;
}

void integrate_free(BodyState& state, const BodyMass& mass, const dvec3& acceleration, double dt) noexcept {
    state.pose.position += (state.velocity + acceleration * (0.5 * dt)) * dt;
    state.velocity += acceleration * dt;
    rotate_free(state.pose.orientation, state.spin, mass, dt, kMaxCycleAngle);
}

dvec3 gyroscopic_change(const BodyState& state, const BodyMass& mass, double dt) noexcept {
    if (mass.inertia == InertiaClass::Isotropic) return dvec3{0.0};
    if (glm::dot(state.spin, state.spin) * (dt * dt) <= kSmallTurn * kSmallTurn) {
        // In body axes spin' = rate, and the body turns under it: in world axes spin'' = spin x rate + rate'.
        const dvec3 spin = rotate_inverse(state.pose.orientation, state.spin), momentum = mass.moments * spin;
        const dvec3 rate = mass.inverse_moments * glm::cross(momentum, spin);
        const dvec3 rate_change = mass.inverse_moments * (glm::cross(mass.moments * rate, spin) + glm::cross(momentum, rate));
        const dvec3 second = glm::cross(spin, rate) + rate_change;
        return rotate(state.pose.orientation, dt * (rate + 0.5 * dt * second));
    }
    dquat q = state.pose.orientation;
    dvec3 spin = state.spin;
    rotate_free(q, spin, mass, dt, kMaxContactCycleAngle);
    return spin - state.spin;
}

dmat3 world_inverse_inertia(const BodyState& state, const BodyMass& mass) noexcept {
    const dmat3 r = glm::mat3_cast(state.pose.orientation);
    dmat3 scaled = r;
    for (int i = 0; i < 3; ++i) scaled[i] *= mass.inverse_moments[i];
    return scaled * glm::transpose(r);
}

dvec3 angular_momentum(const BodyState& state, const BodyMass& mass) noexcept {
    return rotate(state.pose.orientation, mass.moments * rotate_inverse(state.pose.orientation, state.spin));
}

}  // namespace carom::dynamics
