// A disc that slides and spins on a plane with Coulomb friction, against the same four support points integrated to high order. Prints the figures of docs/stability.md.
#include "table.hpp"

#include <carom/core/math.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace carom {
namespace {

using namespace test;

constexpr double kG = 9.81, kH = 1.0 / 240.0;
constexpr double kRadius = 0.5, kHalfHeight = 0.02, kFriction = 0.5;

void show(const char* name, double value) { std::printf("figure %-48s %.3g\n", name, value); }

/// Of a disc on the plane y = 0: centre, turn about y, and their rates.
struct State {
    dvec2 at{0.0}, velocity{0.0};  ///< x and z [m], [m/s]
    double angle = 0.0, spin = 0.0;
};

State along(const State& s, const State& rate, double h) {
    return {s.at + h * rate.at, s.velocity + h * rate.velocity, s.angle + h * rate.angle, s.spin + h * rate.spin};
}

/// What a disc stands on: points that turn with it, each with its share of the weight.
struct Support {
    std::vector<dvec2> points;   ///< from the centre, before the turn [m]
    std::vector<double> shares;  ///< sum 1
    double height = 0.0;         ///< of the centre above the points: friction there tips the disc, and loads the points that lead

    /// Four points on the rim, as a cylinder's manifold has them.
    static Support of_manifold(double first_angle) {
        Support s{.points = {}, .shares = std::vector<double>(4, 0.25), .height = kHalfHeight};
        for (int i = 0; i < 4; ++i)
            s.points.push_back(kRadius * dvec2{std::cos(first_angle + 0.5 * kPi * i), std::sin(first_angle + 0.5 * kPi * i)});
        return s;
    }
    /// Uniform pressure: rings of equal area, their points spread evenly.
    static Support of_uniform_pressure() {
        constexpr int kRings = 40, kAround = 96;
        Support s;
        for (int r = 0; r < kRings; ++r) {
            const double radius = kRadius * std::sqrt((r + 0.5) / kRings);
            for (int i = 0; i < kAround; ++i) {
                const double angle = 2.0 * kPi * (i + 0.5 * (r % 2)) / kAround;
                s.points.push_back(radius * dvec2{std::cos(angle), std::sin(angle)});
                s.shares.push_back(1.0 / (kRings * kAround));
            }
        }
        return s;
    }

    /// Coulomb's law at each point. The loads are those of equal springs under a flat disc: a share of the weight, and what rises in proportion to the
    /// place until friction's torque about the centre is balanced. Friction follows from the loads: found by iteration, which gains two digits a round.
    [[nodiscard]] State rate(const State& s) const {
        const dvec2 x{std::cos(s.angle), -std::sin(s.angle)}, z{std::sin(s.angle), std::cos(s.angle)};  // a turn about y takes x towards -z
        const double second_moment = 0.5 * kRadius * kRadius;  // of the four shares, along any axis
        dvec2 lean{0.0};
        State rate;
        for (int round = 0; round < (height > 0.0 ? 8 : 1); ++round) {
            dvec2 force{0.0};
            double torque = 0.0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                const dvec2 r = points[i].x * x + points[i].y * z;
                const dvec2 slip = s.velocity + s.spin * dvec2{r.y, -r.x};
                const double speed = glm::length(slip);
                const dvec2 f = -kFriction * kG * shares[i] * (1.0 + glm::dot(lean, r)) / std::max(speed, 1e-300) * slip;  // of 1 kg
                force += f;
                torque += r.y * f.x - r.x * f.y;
            }
            lean = -height / (second_moment * kG) * force;
            rate = {s.velocity, force, s.spin, torque / (0.5 * kRadius * kRadius)};
        }
        return rate;
    }
};

/// Where a disc comes to rest, and how.
struct Rest {
    State state;
    double time = 0.0;
    double last_ratio = 0.0;  ///< v / (spin R) just before
};

/// The fourth-order method of Runge and Kutta, in steps that shrink with the speed that is left.
Rest slide(const Support& support, State s, double share) {
    const auto speed = [](const State& of) { return glm::length(of.velocity) + kRadius * std::abs(of.spin); };
    const double first = speed(s);
    Rest rest;
    while (speed(s) > 1e-7 * first) {
        const double h = share * speed(s) / (kFriction * kG);
        const State a = support.rate(s), b = support.rate(along(s, a, 0.5 * h)), c = support.rate(along(s, b, 0.5 * h)),
                    d = support.rate(along(s, c, h));
        s = along(along(along(along(s, a, h / 6.0), b, h / 3.0), c, h / 3.0), d, h / 6.0);
        rest.time += h;
    }
    rest.last_ratio = glm::length(s.velocity) / (kRadius * std::abs(s.spin));
    rest.state = s;
    return rest;
}

/// The same in a world.
struct Slid {
    State end;
    double time = 0.0;
    double first_angle = 0.0;  ///< of a support point in the disc
    double parted = 0.0;       ///< between the last steps with slip and with spin [s]
};

Slid slide_in_world(const dvec2& velocity, double spin) {
    World world;
    world.add_shape(world.create_body({.type = BodyType::Static}), Plane{{0, 1, 0}, 0}, {.friction = static_cast<float>(kFriction)});
    const BodyId disc = world.create_body(
        {.position = {0, kHalfHeight, 0}, .linear_velocity = {velocity.x, 0, velocity.y}, .angular_velocity = {0, spin, 0}});
    world.add_shape(disc, Cylinder{static_cast<float>(kRadius), static_cast<float>(kHalfHeight)},
                    {.friction = static_cast<float>(kFriction)});
    Slid slid;
    double slides_until = 0.0, spins_until = 0.0, before = 0.0;
    const double first = glm::length(velocity) + kRadius * std::abs(spin);
    for (int i = 1; i <= 600; ++i) {
        const Pose start = world.pose(disc);
        world.step(kH);
        if (i == 1) {
            const ContactView contact = world.contact(0);
            EXPECT_EQ(contact.manifold.count, 4u);
            const dvec3 r =
                rotate(glm::conjugate(start.orientation), contact.origin + dvec3{contact.manifold.points[0].position} - start.position);
            slid.first_angle = std::atan2(r.z, r.x);
        }
        const dvec3 v = world.linear_velocity(disc), w = world.angular_velocity(disc);
        if (glm::length(v) > 1e-3 * first) slides_until = i * kH;
        if (std::abs(w.y) * kRadius > 1e-3 * first) spins_until = i * kH;
        const dvec3 ahead = rotate(world.pose(disc).orientation, dvec3{1, 0, 0});
        const double angle = std::atan2(-ahead.z, ahead.x);
        slid.end.angle += std::remainder(angle - before, 2.0 * kPi);
        before = angle;
    }
    const dvec3 end = world.pose(disc).position;
    slid.end.at = {end.x, end.z};
    slid.time = std::max(slides_until, spins_until) + 0.5 * kH;  // within the next step
    slid.parted = std::abs(slides_until - spins_until);
    EXPECT_LT(glm::length(world.linear_velocity(disc)), 1e-5);
    return slid;
}

constexpr double kShare = 0.01;  // of the time that is left to slide, a step

// The oracle by itself. Twice the steps change nothing above 1e-7; under uniform pressure sliding and spinning end together at v / (spin R) = 0.653, from any start
// (Farkas, Bartels, Unger, Wolf: Frictional Coupling between Sliding and Spinning Motion, Phys. Rev. Lett. 2003).
TEST(SlidingDisc, ReferenceIsExactAndHasTheKnownEnd) {
    const State start{.velocity = {3.0, 0.0}, .spin = 4.0};
    const Support four = Support::of_manifold(0.4);
    const Rest coarse = slide(four, start, kShare), fine = slide(four, start, 0.5 * kShare);
    EXPECT_LT(glm::length(coarse.state.at - fine.state.at), 1e-7 * glm::length(fine.state.at));
    EXPECT_NEAR(coarse.state.angle, fine.state.angle, 1e-7 * fine.state.angle);
    EXPECT_NEAR(coarse.time, fine.time, 1e-7 * fine.time);
    const Support pressure = Support::of_uniform_pressure();
    for (const double spin : {4.0, 30.0})
        EXPECT_NEAR(slide(pressure, {.velocity = {1.0, 0.0}, .spin = spin}, 0.02).last_ratio, 0.653, 0.01);
}

// A16: 1 % of the reference, for the way, the turn and the time; and how far four points on the rim are from a disc of uniform pressure.
TEST(SlidingDisc, StopsWhereItsSupportPointsStop) {
    const Support pressure = Support::of_uniform_pressure();
    double worst_way = 0.0, worst_turn = 0.0, worst_time = 0.0, worst_parted = 0.0;
    double model_way = 0.0, model_turn = 0.0, model_time = 0.0, low_end = 10.0, high_end = 0.0;
    for (const double ratio : {0.3, 1.0, 1.5, 4.0}) {
        for (const double heading : {0.0, 0.5, 0.25 * kPi}) {
            const double speed = 3.0, spin = speed / (ratio * kRadius);
            const State start{.velocity = speed * dvec2{std::cos(heading), std::sin(heading)}, .spin = spin};
            const Slid slid = slide_in_world(start.velocity, spin);
            const Rest wanted = slide(Support::of_manifold(slid.first_angle), start, kShare);
            const double way = glm::length(wanted.state.at);
            worst_way = std::max(worst_way, glm::length(slid.end.at - wanted.state.at) / way);
            worst_turn = std::max(worst_turn, std::abs(slid.end.angle / wanted.state.angle - 1.0));
            worst_time = std::max(worst_time, std::abs(slid.time / wanted.time - 1.0));
            worst_parted = std::max(worst_parted, slid.parted);
            const Rest disc = slide(pressure, start, 0.02);
            model_way = std::max(model_way, glm::length(slid.end.at - disc.state.at) / glm::length(disc.state.at));
            model_turn = std::max(model_turn, std::abs(slid.end.angle / disc.state.angle - 1.0));
            model_time = std::max(model_time, std::abs(slid.time / disc.time - 1.0));
            low_end = std::min(low_end, wanted.last_ratio);
            high_end = std::max(high_end, wanted.last_ratio);
        }
    }
    show("A16 way, relative error", worst_way);
    show("A16 turn, relative error", worst_turn);
    show("A16 time, relative error", worst_time);
    show("A16 between the ends of sliding and spinning [s]", worst_parted);
    show("A16 model: way, to a disc of uniform pressure", model_way);
    show("A16 model: turn", model_turn);
    show("A16 model: time", model_time);
    show("A16 model: least last v/(spin R), not 0.653", low_end);
    show("A16 model: largest last v/(spin R)", high_end);
    EXPECT_LT(worst_way, 0.01);
    EXPECT_LT(worst_turn, 0.01);
    EXPECT_LT(worst_time, 0.01);
    EXPECT_LT(worst_parted, 2.0 * kH);
}

}  // namespace
}  // namespace carom
