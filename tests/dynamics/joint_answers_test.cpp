// Springs and ball joints against problems with known answers, and stiff and extreme cases. Prints the figures of docs/stability.md.
#include "table.hpp"

#include <carom/core/math.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace carom {
namespace {

using namespace test;

constexpr double kG = 9.81;

void show(const std::string& what, double value) { std::printf("    %s: %.3g\n", what.c_str(), value); }

/// Complete elliptic integral of the first kind, by the mean of Gauss.
double elliptic_k(double modulus) {
    double a = 1.0, b = std::sqrt(1.0 - modulus * modulus);
    for (int i = 0; i < 40; ++i) {
        const double mean = 0.5 * (a + b);
        b = std::sqrt(a * b);
        a = mean;
    }
    return kPi / (2.0 * a);
}

/// Times at which a coordinate falls through zero, by the straight line between steps.
class Crossings {
public:
    explicit Crossings(double first) : last_(first) {}
    void add(double value, double time, double dt) {
        if (last_ > 0.0 && value <= 0.0) times_.push_back(time - dt + dt * last_ / (last_ - value));
        last_ = value;
    }
    [[nodiscard]] double period() const { return (times_.back() - times_.front()) / static_cast<double>(times_.size() - 1); }

private:
    double last_;
    std::vector<double> times_;
};

BodyId add_mass(World& world, double mass, const dvec3& position, double moment = 1.0) {
    const BodyId body = world.create_body({.position = position});
    world.set_mass_properties(body, {mass, dvec3{0.0}, dmat3{moment}});
    return body;
}

// With h = dt: phase to (ω h)²/12 and amplitude to 1e-3 a period while ω h < 0.3.
TEST(JointAnswers, UndampedSpringKeepsPhaseAndAmplitude) {
    const double dt = 1.0 / 240.0;
    for (const double turn : {0.01, 0.03, 0.1, 0.3}) {
        const double rate = turn / dt;
        World world({.gravity = {0, 0, 0}});
        const BodyId body = add_mass(world, 2.0, {1.1, 0, 0});
        world.create_joint(SpringDef{.body_b = body, .rest_length = 1.0, .stiffness = 2.0 * rate * rate});
        const double start = world.energy().total();
        Crossings crossings(0.1);
        const int steps = static_cast<int>(20.0 * 2.0 * kPi / turn);
        for (int i = 1; i <= steps; ++i) {
            world.step(dt);
            crossings.add(world.center_of_mass(body).x - 1.0, i * dt, dt);
        }
        const double error = crossings.period() * rate / (2.0 * kPi) - 1.0;
        show("spring, wh " + std::to_string(turn) + ", phase error", error);
        EXPECT_LT(std::abs(error), turn * turn / 12.0);
        EXPECT_LT(std::abs(world.energy().total() / start - 1.0), 1e-3);  // over all 20 periods
    }
}

TEST(JointAnswers, UndampedSpringNeverGrows) {
    for (const double turn : {0.01, 0.3, 1.0, 2.0, 4.0, 6.0, 7.9, 8.1, 10.0, 30.0, 100.0, 1e4}) {
        const double dt = 1.0 / 240.0, rate = turn / dt;
        World world({.gravity = {0, 0, 0}});
        const BodyId body = add_mass(world, 2.0, {1.1, 0.05, 0});
        world.set_linear_velocity(body, {0, 0.1 * rate, 0});
        world.create_joint(SpringDef{.body_b = body, .rest_length = 1.0, .stiffness = 2.0 * rate * rate});
        const double start = world.energy().total();
        double most = 0.0;
        for (int i = 0; i < 3000; ++i) {
            world.step(dt);
            most = std::max(most, world.energy().total() / start);
        }
        EXPECT_LT(most, 1.002) << turn;  // a stretched spring that swings round has other frequencies than the straight one
    }
}

TEST(JointAnswers, DampedSpringFallsAsItShould) {
    const double rate = 10.0, ratio = 0.2, dt = 1.0 / 240.0, fast = rate * std::sqrt(1.0 - ratio * ratio);
    World world({.gravity = {0, 0, 0}});
    const BodyId body = add_mass(world, 2.0, {1.1, 0, 0});
    const SpringDamper s = spring_damper(rate / (2.0 * kPi), ratio, 2.0);
    world.create_joint(SpringDef{.body_b = body, .rest_length = 1.0, .stiffness = s.stiffness, .damping = s.damping});
    double worst = 0.0;
    for (int i = 1; i <= 480; ++i) {
        world.step(dt);
        const double t = i * dt;
        const double exact = 0.1 * std::exp(-ratio * rate * t) * (std::cos(fast * t) + ratio * rate / fast * std::sin(fast * t));
        worst = std::max(worst, std::abs(world.center_of_mass(body).x - 1.0 - exact));
    }
    show("damped spring, error over amplitude", worst / 0.1);
    EXPECT_LT(worst, 1e-5 * 0.1);
}

// Case 7: no growth and m g / k to 0.1 % at 1/60 s, whatever the stiffness.
TEST(JointAnswers, SpringOfAnyStiffnessSagsAsItShould) {
    for (const double stiffness : {1e-3, 1.0, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9}) {
        World world;
        const BodyId body = add_mass(world, 1.0, {0, -1.0, 0});
        const double rate = std::sqrt(stiffness);
        const JointId joint = world.create_joint(SpringDef{.body_b = body, .rest_length = 1.0, .stiffness = stiffness, .damping = rate});
        const double dt = std::max(kDt, 0.02 / rate);
        const int steps = static_cast<int>(std::max(2000.0, 60.0 / (rate * dt)));
        double fastest = 0.0;
        for (int i = 0; i < steps; ++i) {
            world.step(dt);
            fastest = std::max(fastest, glm::length(world.linear_velocity(body)));
        }
        EXPECT_LT(std::abs(world.joint_state(joint).stretch * stiffness / kG - 1.0), 1e-6) << stiffness;
        EXPECT_LT(glm::length(world.linear_velocity(body)), 1e-6) << stiffness;
        EXPECT_LT(fastest, 1.01 * kG / rate + kG * kDt / 8.0) << stiffness;
    }
}

// A9: the period to 1e-4 and the anchors together to 1e-4 of the length.
TEST(JointAnswers, PendulumKeepsTime) {
    for (const double dt : {1.0 / 240.0, 1.0 / 60.0}) {
        for (const double angle : {0.1, 2.5}) {
            World world;
            const double mass = 2.0, moment = 0.1, arm = 1.0;
            const BodyId bob = add_mass(world, mass, {0, 0, 0}, moment);
            const dquat turn = rotation_about({0, 0, 1}, angle);
            world.set_pose(bob, {-rotate(turn, dvec3{0, arm, 0}), turn});
            world.create_joint(BallJointDef{.body_b = bob, .anchor_b = {0, arm, 0}});
            const double length = (moment + mass * arm * arm) / (mass * arm), period = 4.0 * std::sqrt(length / kG) * elliptic_k(std::sin(0.5 * angle));
            const double start = world.energy().total();
            double gap = 0.0, drift = 0.0;
            Crossings crossings(1.0);
            for (int i = 1; i * dt < 6.0 * period; ++i) {
                gap = std::max(gap, world.step(dt).joints.worst_gap);
                crossings.add(world.center_of_mass(bob).x, i * dt, dt);
                drift = std::max(drift, std::abs(world.energy().total() - start));
            }
            const double error = crossings.period() / period - 1.0;
            show("pendulum, " + std::to_string(angle) + " rad, dt " + std::to_string(dt) + ", period", error);
            EXPECT_LT(std::abs(error), 1e-5);
            EXPECT_LT(gap, 1e-11 * length);
            EXPECT_LT(drift, 5e-5 * mass * kG * length);
        }
    }
}

// A3: I1 Ω² cosθ - I3 ω3 Ω + m g l = 0, I1 about the pivot; to 1e-3.
TEST(JointAnswers, HeavyTopPrecesses) {
    const double mass = 1.0, arm = 0.5, along = 0.02, across = 0.03, spin = 200.0, tilt = 0.5, dt = 1.0 / 240.0;
    World world;
    const BodyId top = world.create_body();
    world.set_mass_properties(top, {mass, dvec3{0.0}, dmat3{dvec3{across, 0, 0}, dvec3{0, along, 0}, dvec3{0, 0, across}}});
    const double a = (across + mass * arm * arm) * std::cos(tilt), b = -along * spin, c = mass * kG * arm;
    const double rate = (-b - std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);  // slow precession
    const dquat turn = rotation_about({0, 0, 1}, -tilt);
    const dvec3 axis = rotate(turn, dvec3{0, 1, 0}), velocity = dvec3{0, rate, 0} + (spin - rate * std::cos(tilt)) * axis;
    world.set_pose(top, {arm * axis, turn});
    world.set_angular_velocity(top, velocity);
    world.set_linear_velocity(top, glm::cross(velocity, arm * axis));
    world.create_joint(BallJointDef{.body_b = top, .anchor_b = {0, -arm, 0}});
    double turned = 0.0, before = 0.0;
    const int steps = 2400;
    for (int i = 0; i < steps; ++i) {
        world.step(dt);
        const dvec3 at = world.center_of_mass(top);
        const double angle = std::atan2(-at.z, at.x);
        turned += std::remainder(angle - before, 2.0 * kPi);
        before = angle;
        EXPECT_NEAR(std::acos(at.y / arm), tilt, 1e-4);  // steady: it does not nod
    }
    const double error = turned / (steps * dt * rate) - 1.0;
    show("top, precession", error);
    EXPECT_LT(std::abs(error), 1e-5);
}

struct Chain {
    World world;
    std::vector<BodyId> links;
    double mass = 0.0;
    static constexpr double kLength = 0.5;

    /// Hangs from the origin along `down`; the last link is so many times as heavy.
    Chain(int count, double tip, const dvec3& down) {
        const dquat turn = down.x != 0.0 ? rotation_about({0, 0, 1}, 0.5 * kPi) : kIdentityRotation;
        for (int i = 0; i < count; ++i) {
            const BodyId link = world.create_body({.position = (kLength * (i + 0.5)) * down, .orientation = turn});
            world.add_shape(link, Capsule{0.05f, 0.15f}, {.mask = 0});
            MassProperties m = world.mass_properties(link);
            if (i + 1 == count) {
                m.mass *= tip;
                m.inertia *= tip;
                world.set_mass_properties(link, m);
            }
            mass += m.mass;
            const dvec3 end{0, -0.5 * kLength, 0};
            world.create_joint(BallJointDef{.body_a = links.empty() ? BodyId{} : links.back(),
                                            .body_b = link,
                                            .anchor_a = links.empty() ? dvec3{0.0} : end,
                                            .anchor_b = -end});
            links.push_back(link);
        }
    }
};

// Case 3: under 1 % of a link, at 50 links with 5e4 links' mass at the tip: hanging, and let go from a level line.
TEST(JointAnswers, ChainWithAHeavyTipDoesNotStretch) {
    for (const double tip : {1.0, 5e4, 1e6}) {
        for (const dvec3 down : {dvec3{0, -1, 0}, dvec3{1, 0, 0}}) {
            Chain chain(50, tip, down);
            const double start = chain.world.energy().total(), scale = chain.mass * kG * 50.0 * Chain::kLength;
            double gap = 0.0, gain = 0.0;
            for (int i = 0; i < 90; ++i) {
                const StepReport report = chain.world.step(kDt);
                ASSERT_TRUE(report.quarantined.empty());
                gap = std::max(gap, report.joints.worst_gap);
                gain = std::max(gain, chain.world.energy().total() - start);
            }
            show("chain, tip " + std::to_string(tip) + (down.x != 0.0 ? ", swings" : ", hangs") + ", worst gap over a link", gap / Chain::kLength);
            EXPECT_LT(gap, 1e-3 * Chain::kLength);
            EXPECT_LT(gain, 1e-3 * scale);
        }
    }
}

// Case 4: from 1 g to 1e6 kg the same error, to rounding.
TEST(JointAnswers, JointToTheWorldHoldsEveryMassAlike) {
    std::vector<double> ends;
    for (const double mass : {1e-3, 1.0, 1e3, 1e6}) {
        World world;
        const BodyId bob = add_mass(world, mass, {1, 0, 0}, 0.1 * mass);
        world.create_joint(BallJointDef{.body_b = bob, .anchor_b = {-1, 0, 0}});
        for (int i = 0; i < 600; ++i) EXPECT_LT(world.step(kDt).joints.worst_gap, 1e-11);
        ends.push_back(world.center_of_mass(bob).x);
    }
    for (const double x : ends) EXPECT_NEAR(x, ends[0], 1e-9);
}

// Case 8: twelve springs from a light hub to twelve weights that hang in twelve more.
TEST(JointAnswers, SpringNetworkRoundALightHubStaysBounded) {
    for (const double stiffness : {1e3, 1e6, 1e9}) {
        for (const double hub_mass : {1e-3, 1.0}) {
            World world;
            const BodyId hub = add_mass(world, hub_mass, {0.1, 0.05, 0}, 0.01 * hub_mass);
            for (int i = 0; i < 12; ++i) {
                const SinCos at = sin_cos(2.0 * kPi * i / 12.0);
                const dvec3 way{at.cos, at.sin, 0};
                const BodyId weight = add_mass(world, 1.0, way + dvec3{0, 0, 0.1 * (i % 3)}, 0.1);
                world.create_joint(SpringDef{.body_a = hub, .body_b = weight, .anchor_a = 0.1 * way, .rest_length = 0.9, .stiffness = stiffness});
                world.create_joint(SpringDef{.body_a = weight, .anchor_b = 2.0 * way, .rest_length = 0.8, .stiffness = stiffness});
            }
            const double start = world.energy().total();
            for (int i = 0; i < 600; ++i) {
                world.step(kDt);
                ASSERT_LT(world.energy().total(), start + 1e-3 * std::abs(start)) << stiffness << " " << hub_mass << " step " << i;
            }
        }
    }
}

/// A rope of links over half a drum: a force on one end, the other drawn down slowly.
struct Rope {
    World world{{.gravity = {0, 0, 0}}};
    BodyId near, far;
    JointId first, last;

    Rope(int arc, float friction) {
        constexpr int kHanging = 4;
        constexpr double kRadius = 0.5;
        const double step = kPi / arc, thick = 0.2 * kRadius * step, corner = (kRadius + thick) / std::sqrt(0.5 * (1.0 + sin_cos(step).cos));
        const double link = 2.0 * corner * sin_cos(0.5 * step).sin;
        world.add_shape(world.create_body({.type = BodyType::Static}), Cylinder{static_cast<float>(kRadius), 1.0f},
                        {.friction = friction, .friction_rule = CombineRule::Maximum, .local = {dvec3{0.0}, rotation_about({1, 0, 0}, 0.5 * kPi)}});
        std::vector<dvec3> corners;
        for (int i = kHanging; i > 0; --i) corners.push_back({-corner, -link * i, 0});
        for (int i = 0; i <= arc; ++i) {
            const SinCos at = sin_cos(kPi - step * i);
            corners.push_back({corner * at.cos, corner * at.sin, 0});
        }
        for (int i = 1; i <= kHanging; ++i) corners.push_back({corner, -link * i, 0});
        near = add_mass(world, 1.0, corners.front() - dvec3{0, 0.2, 0}, 0.1);
        far = world.create_body({.type = BodyType::Kinematic, .position = corners.back() - dvec3{0, 0.2, 0}, .linear_velocity = {0, -0.01, 0}});
        BodyId before = near;
        dvec3 end{0, 0.2, 0};
        for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
            const dvec3 way = corners[i + 1] - corners[i];
            const BodyId body = world.create_body({.position = 0.5 * (corners[i] + corners[i + 1]),
                                                   .orientation = rotation_about({0, 0, 1}, arctan2(way.y, way.x) - 0.5 * kPi),
                                                   .angular_damping = 100.0});
            world.add_shape(body, Capsule{static_cast<float>(thick), static_cast<float>(0.5 * link)}, {.density = 1e4, .friction = 0.0f, .layer = 2, .mask = 1});
            const JointId joint = world.create_joint(BallJointDef{.body_a = before, .body_b = body, .anchor_a = end, .anchor_b = {0, -0.5 * link, 0}});
            if (i == 0) first = joint;
            before = body;
            end = {0, 0.5 * link, 0};
        }
        last = world.create_joint(BallJointDef{.body_a = before, .body_b = far, .anchor_a = end, .anchor_b = {0, 0.2, 0}});
    }
};

// A18: T2 / T1 = exp(μ φ), to 2 %.
TEST(JointAnswers, RopeRoundADrumHoldsByFriction) {
    Rope rope(40, 0.3f);
    double low = 0.0, high = 0.0;
    for (int i = 0; i < 180; ++i) {
        rope.world.apply_force(rope.near, {0, -100.0, 0}, rope.world.center_of_mass(rope.near));
        rope.world.step(kDt);
        if (i < 60) continue;
        low += glm::length(rope.world.joint_state(rope.first).force);
        high += glm::length(rope.world.joint_state(rope.last).force);
    }
    const double error = high / low / std::exp(0.3 * kPi) - 1.0;
    show("rope round a drum, T2/T1", error);
    EXPECT_LT(std::abs(error), 0.02);
}

// A load that a box rests on and a spring takes a part of: contacts and joints share the substeps.
TEST(JointAnswers, SpringAndGroundShareAWeight) {
    Table table;
    const BodyId box = table.add({.position = {0, 0.5, 0}}, Box{{0.5f, 0.5f, 0.5f}}, {.density = 1.0});
    const JointId joint = table.world.create_joint(SpringDef{.body_b = box, .anchor_a = {0, 3, 0}, .anchor_b = {0, 0.5, 0}, .rest_length = 1.0, .stiffness = 5.0});
    table.run(300);
    const StepReport report = table.world.step(kDt);
    EXPECT_EQ(report.joints.in_contact, 1u);
    double pressed = 0.0;
    for (std::size_t i = 0; i < table.world.contact_count(); ++i) {
        for (const float impulse : table.world.contact(i).normal_impulse) pressed += static_cast<double>(impulse);
    }
    EXPECT_NEAR(table.world.joint_state(joint).force.y, 5.0, 0.005);
    EXPECT_NEAR(pressed * 8.0 / kDt, kG - 5.0, 0.005);
}

TEST(JointAnswers, RopeComesToRestOnTheGround) {
    Table table;
    BodyId before{};
    for (int i = 0; i < 20; ++i) {
        const BodyId link = table.add({.position = {0.5 * (i + 0.5), 1.0, 0}, .orientation = rotation_about({0, 0, 1}, 0.5 * kPi)}, Capsule{0.05f, 0.2f});
        if (i > 0) table.world.create_joint(BallJointDef{.body_a = before, .body_b = link, .anchor_a = {0, -0.25, 0}, .anchor_b = {0, 0.25, 0}});
        before = link;
    }
    const double start = table.world.energy().total();
    double gain = 0.0, gap = 0.0;
    StepReport report;
    for (int i = 0; i < 900; ++i) {
        report = table.world.step(kDt);
        gain = std::max(gain, table.world.energy().total() - start);
        gap = std::max(gap, report.joints.worst_gap);
    }
    show("rope on the ground, worst gap over a link", gap / 0.5);
    EXPECT_LT(gain, 1e-3 * start);
    EXPECT_LT(gap, 0.01 * 0.5);
    EXPECT_LT(report.joints.worst_gap, 1e-3 * 0.5);
    EXPECT_LT(table.world.energy().kinetic, 1e-3);
}

}  // namespace
}  // namespace carom
