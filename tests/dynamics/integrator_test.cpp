// Free motion against closed forms.
#include <carom/core/check.hpp>
#include <carom/dynamics/detail/integrator.hpp>

#include <carom/core/math.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <limits>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace carom::dynamics {
namespace {

BodyMass mass_with(const dvec3& moments) {
    BodyMass mass;
    mass.mass = 2.0;
    mass.inverse_mass = 0.5;
    static_cast<FreeRotation&>(mass) = classify(moments);
    return mass;
}

dvec3 world_momentum(const BodyState& state, const BodyMass& mass) { return angular_momentum(state, mass); }

TEST(Integrator, ClassifiesInertia) {
    EXPECT_EQ(mass_with({1, 1, 1}).inertia, InertiaClass::Isotropic);
    EXPECT_EQ(mass_with({2, 3, 4}).inertia, InertiaClass::Asymmetric);
    for (int axis = 0; axis < 3; ++axis) {
        dvec3 moments{2.0};
        moments[axis] = 3.0;
        const BodyMass mass = mass_with(moments);
        EXPECT_EQ(mass.inertia, InertiaClass::Symmetric);
        EXPECT_EQ(mass.axis, axis);
    }
}

TEST(Integrator, FreeFallIsExact) {
    const BodyMass mass = mass_with({1, 1, 1});
    const dvec3 gravity{0.0, -9.81, 0.0};
    BodyState state;
    state.velocity = {3.0, 4.0, 0.0};
    const double h = 1.0 / 240.0;
    for (int i = 0; i < 2400; ++i) integrate_free(state, mass, {.acceleration = gravity}, h);
    const double t = 10.0;
    const double fall = 4.0 * t - 0.5 * 9.81 * t * t;
    EXPECT_NEAR(state.pose.position.y, fall, 1e-12 * std::abs(fall));
    EXPECT_NEAR(state.pose.position.x, 3.0 * t, 1e-12 * 3.0 * t);
}

TEST(Integrator, IsotropicBodyTurnsByItsAngle) {
    const BodyMass mass = mass_with({5, 5, 5});
    BodyState state;
    state.spin = {0.0, 0.0, 2.0};
    for (int i = 0; i < 100; ++i) integrate_free(state, mass, {}, 0.01);
    const dvec3 x = rotate(state.pose.orientation, dvec3{1, 0, 0});
    const SinCos expected = sin_cos(2.0);
    EXPECT_NEAR(x.x, expected.cos, 1e-13);
    EXPECT_NEAR(x.y, expected.sin, 1e-13);
}

// A symmetric top precesses about L at |L| / I1 and keeps its angle to it; the scheme is exact whatever the step.
TEST(Integrator, SymmetricTopPrecessesExactlyAtAnyStep) {
    const BodyMass mass = mass_with({2.0, 2.0, 3.0});
    for (const int steps : {3, 7, 1000}) {
        BodyState state;
        state.spin = {0.7, 0.0, 5.0};
        const dvec3 momentum = world_momentum(state, mass);
        const dvec3 axis0{0, 0, 1};
        const double t = 4.0;
        for (int i = 0; i < steps; ++i) integrate_free(state, mass, {}, t / steps);
        const double rate = glm::length(momentum) / 2.0;
        const dvec3 expected = rotate(rotation_about(glm::normalize(momentum), rate * t), axis0);
        const dvec3 axis = rotate(state.pose.orientation, axis0);
        EXPECT_LT(glm::length(axis - expected), 1e-11) << steps;
        EXPECT_LT(glm::length(world_momentum(state, mass) - momentum), 1e-12 * glm::length(momentum)) << steps;
    }
}

/// Jacobi's elliptic functions by descending Landen (arithmetic-geometric mean); Abramowitz and Stegun 16.4.
struct Elliptic {
    double sn, cn, dn;
};
Elliptic elliptic(double u, double m) {
    double a[16] = {1.0}, c[16] = {std::sqrt(m)};
    double b = std::sqrt(1.0 - m);
    int n = 0;
    while (std::abs(c[n]) > 1e-17 && n < 14) {
        a[n + 1] = 0.5 * (a[n] + b);
        c[n + 1] = 0.5 * (a[n] - b);
        b = std::sqrt(a[n] * b);
        ++n;
    }
    double phi = std::ldexp(a[n] * u, n);
    for (; n > 0; --n) phi = 0.5 * (phi + std::asin(c[n] / a[n] * std::sin(phi)));
    const double sn = std::sin(phi);
    return {sn, std::cos(phi), std::sqrt(1.0 - m * sn * sn)};
}

// Torque-free asymmetric top with L² > 2 E I2 (Landau and Lifshitz, Mechanics, § 37).
TEST(Integrator, AsymmetricTopFollowsTheEllipticSolution) {
    const dvec3 I{2.0, 3.0, 4.0};
    const BodyMass mass = mass_with(I);
    const dvec3 start{0.4, 0.0, 1.5};  // body axes, at tau = 0: (a, 0, c)
    const double two_e = I.x * start.x * start.x + I.z * start.z * start.z;
    const double l_sq = I.x * I.x * start.x * start.x + I.z * I.z * start.z * start.z;
    ASSERT_GT(l_sq, two_e * I.y);
    const double rate = std::sqrt((I.z - I.y) * (l_sq - two_e * I.x) / (I.x * I.y * I.z));
    const double m = (I.y - I.x) * (two_e * I.z - l_sq) / ((I.z - I.y) * (l_sq - two_e * I.x));
    const double b = std::sqrt((two_e * I.z - l_sq) / (I.y * (I.z - I.y)));

    double errors[2] = {};
    for (int refinement = 0; refinement < 2; ++refinement) {
        const int steps = 600 << refinement;  // at most one cycle a step, so that the step is the knob
        BodyState state;
        state.spin = start;
        const dvec3 momentum = world_momentum(state, mass);
        const double energy = 0.5 * two_e;
        for (int i = 0; i < steps; ++i) integrate_free(state, mass, {}, 4.0 / steps);
        const dvec3 omega = rotate_inverse(state.pose.orientation, state.spin);
        const Elliptic e = elliptic(rate * 4.0, m);
        const dvec3 expected{start.x * e.cn, b * e.sn, start.z * e.dn};
        errors[refinement] = glm::length(omega - expected);
        EXPECT_LT(errors[refinement], 1e-4);
        EXPECT_LT(glm::length(world_momentum(state, mass) - momentum), 1e-11 * glm::length(momentum));
        EXPECT_NEAR(0.5 * glm::dot(state.spin, world_momentum(state, mass)), energy, 1e-4 * energy);
    }
    EXPECT_GT(errors[0] / errors[1], 3.5) << "second order";
}

// A2 as asked: 10 s at h = 1/240 s; |L| 1e-11, E 1e-4, attitude 0.2 degrees. The attitude's reference is the same motion at a far finer tolerance.
TEST(Integrator, AsymmetricTopKeepsItsTargetsForTenSeconds) {
    const BodyMass mass = mass_with({2.0, 3.0, 4.0});
    BodyState state, fine;
    state.spin = fine.spin = {0.4, 0.0, 1.5};
    const dvec3 momentum = world_momentum(state, mass);
    const double energy = 0.5 * glm::dot(state.spin, momentum);
    for (int i = 0; i < 2400; ++i) {
        integrate_free(state, mass, {}, 1.0 / 240.0);
        integrate_free(fine, mass, {.spin_tolerance = 1e-12}, 1.0 / 240.0);
    }
    EXPECT_LT(glm::length(world_momentum(state, mass) - momentum), 1e-11 * glm::length(momentum));
    EXPECT_NEAR(0.5 * glm::dot(state.spin, world_momentum(state, mass)), energy, 1e-6 * energy);
    const dquat apart = glm::conjugate(fine.pose.orientation) * state.pose.orientation;
    EXPECT_LT(2.0 * std::sqrt(apart.x * apart.x + apart.y * apart.y + apart.z * apart.z) * 180.0 / kPi, 0.2);
}

// Case 15: 10..1e4 rad/s about an axis near the unstable one.
TEST(Integrator, FastSpinKeepsMomentumAndEnergy) {
    const BodyMass mass = mass_with({2.0, 3.0, 4.0});
    for (const double speed : {10.0, 100.0, 1e3, 1e4}) {
        BodyState state;
        state.spin = speed * glm::normalize(dvec3{0.002, 1.0, 0.002});
        const dvec3 momentum = world_momentum(state, mass);
        const double energy = 0.5 * glm::dot(state.spin, momentum);
        double worst = 0.0;
        for (int i = 0; i < 240; ++i) {
            integrate_free(state, mass, {}, 1.0 / 240.0);
            worst = std::max(worst, std::abs(0.5 * glm::dot(state.spin, world_momentum(state, mass)) / energy - 1.0));
        }
        EXPECT_LT(glm::length(world_momentum(state, mass) - momentum), 1e-10 * glm::length(momentum)) << speed;
        EXPECT_LT(worst, 1e-6) << speed;
        EXPECT_GT(glm::length(state.spin), 0.5 * speed) << "no clamp";
    }
}

// Error of the spin against the finest, by cycles: slope 2 for Strang, 4 for the other.
TEST(Integrator, SchemesHaveTheirOrders) {
    const FreeRotation body = classify({2.0, 3.0, 4.0});
    const Rotation start{kIdentityRotation, {0.4, 2.0, 1.5}};
    const auto turned = [&](SpinScheme scheme, int steps, double tolerance) {
        Rotation r = start;
        for (int i = 0; i < steps; ++i) rotate_free(r, body, 2.0 / steps, {tolerance, scheme});
        return r;
    };
    const Rotation exact = turned(SpinScheme::FourthOrder, 2000, 1e-12);
    const auto error = [&](SpinScheme scheme, int steps) {
        EXPECT_EQ(count_cycles(start, body, 2.0 / steps, {1.0, scheme}), 1);
        return glm::length(turned(scheme, steps, 1.0).spin - exact.spin);
    };
    for (const auto& [scheme, steps, ratio] : {std::tuple{SpinScheme::Strang, 40, 4.0}, {SpinScheme::FourthOrder, 20, 16.0}}) {
        const double coarse = error(scheme, steps), fine = error(scheme, 2 * steps);
        EXPECT_GT(coarse / fine, 0.9 * ratio);
        EXPECT_LT(coarse / fine, 1.2 * ratio);
    }
}

// The stated bounds of a cycle hold from rods to plates; and a tolerance is kept by what Automatic chooses.
TEST(Integrator, EnergyStaysWithinTheAskedTolerance) {
    Random random(15);
    for (int i = 0; i < 300; ++i) {
        dvec3 moments{1.0, std::exp(random.range(-8.0, 0.0)), 0.0};
        moments.z = std::abs(moments.x - moments.y) + (moments.x + moments.y - std::abs(moments.x - moments.y)) * random.range(0.001, 0.999);
        const BodyMass mass = mass_with(moments);
        const double tolerance = std::exp(random.range(-20.0, -4.0));
        BodyState state;
        state.spin = {random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
        state.spin *= std::exp(random.range(-2.0, 6.0)) / glm::length(state.spin);
        const double energy = 0.5 * glm::dot(state.spin, world_momentum(state, mass));
        for (int k = 0; k < 100; ++k) integrate_free(state, mass, {.spin_tolerance = tolerance}, 1.0 / 60.0);
        EXPECT_NEAR(0.5 * glm::dot(state.spin, world_momentum(state, mass)), energy, (tolerance + 1e-11) * energy) << i;
    }
}

TEST(Integrator, GyroscopicChangeIsWhatTheFreeRotationDoes) {
    const BodyMass mass = mass_with({2.0, 3.0, 4.0});
    Random random(4);
    for (int i = 0; i < 100; ++i) {
        BodyState state;
        state.pose.orientation = rotation_from_vector({random.range(-3, 3), random.range(-3, 3), random.range(-3, 3)});
        state.spin = {random.range(-5, 5), random.range(-5, 5), random.range(-5, 5)};
        const double dt = 1e-5;
        const dvec3 omega = rotate_inverse(state.pose.orientation, state.spin);
        const dvec3 torque = -glm::cross(omega, mass.moments * omega);
        // In world axes the spin's rate is the body's rate turned: omega x omega vanishes.
        const dvec3 expected = rotate(state.pose.orientation, mass.inverse_moments * torque) * dt;
        EXPECT_LT(glm::length(gyroscopic_change(state, mass, dt) - expected), 1e-3 * glm::length(expected) + 1e-15);
    }
    EXPECT_EQ(gyroscopic_change(BodyState{{}, dvec3{0.0}, {1, 2, 3}}, mass_with({1, 1, 1}), 0.1), dvec3{0.0});
}

// Just below the turn from which on the rotation is split.
TEST(Integrator, GyroscopicChangeIsGoodToSecondOrder) {
    const BodyMass mass = mass_with({1.0, 2.0, 2.9});
    Random random(5);
    constexpr double kTurn = 0.0245;
    for (int i = 0; i < 200; ++i) {
        BodyState state;
        state.pose.orientation = rotation_from_vector({random.range(-3, 3), random.range(-3, 3), random.range(-3, 3)});
        const dvec3 direction{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
        state.spin = 3.0 / glm::length(direction) * direction;
        const double dt = kTurn / 3.0;
        BodyState exact = state;
        for (int part = 0; part < 200; ++part) integrate_free(exact, mass, {}, dt / 200.0);
        EXPECT_LT(glm::length(gyroscopic_change(state, mass, dt) - (exact.spin - state.spin)), 1.6e-5 * 3.0) << i;
    }
}

TEST(Integrator, FreeRotationRefusesWhatIsNoMotion) {
    static int reports = 0;
    const ErrorHandler before = set_error_handler([](const Error&) { ++reports; });
    const FreeRotation body = classify({1.0, 2.0, 3.0});
    const Rotation start{kIdentityRotation, {1.0, 2.0, 3.0}};
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    int asked = 0;
    const auto refuses = [&](Rotation rotation, double dt, const SpinSettings& settings) {
        const dquat kept = rotation.orientation;
        rotate_free(rotation, body, dt, settings);
        EXPECT_EQ(reports, ++asked);
        EXPECT_EQ(count_cycles(rotation, body, dt, settings), 0);
        EXPECT_EQ(reports, ++asked);
        EXPECT_EQ(rotation.orientation, kept);
    };
    refuses(start, kNan, {});
    refuses({kIdentityRotation, {kNan, 0.0, 0.0}}, 0.1, {});
    for (const double tolerance : {0.0, -1.0, 2.0, kNan}) refuses(start, 0.1, {.tolerance = tolerance});
    for (const dvec3& moments : {dvec3{0.0, 1.0, 1.0}, dvec3{-1.0, 1.0, 1.0}, dvec3{kNan, 1.0, 1.0}}) {
        EXPECT_EQ(classify(moments).moments, dvec3{1.0});
        EXPECT_EQ(reports, ++asked);
    }
    set_error_handler(before);
    EXPECT_LE(count_cycles({kIdentityRotation, {0.0, 1e3, 1.0}}, classify({1e-30, 1.0, 1.5}), 1.0, {}), 1'000'001);
}

}  // namespace
}  // namespace carom::dynamics
