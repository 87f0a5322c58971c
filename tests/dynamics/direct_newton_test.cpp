// The answer of the direct solve is that of the contact problem: momentum, Signorini with the stated softness, Coulomb's cone, and friction
// against the slip; on stacks with known forces, and on random islands.
#include <carom/dynamics/detail/direct_newton.hpp>

#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace carom::dynamics {
namespace {

constexpr double kDt = 1.0 / 60.0, kG = 9.81;
const DirectSettings kSettings{.speed_tolerance = 1e-9, .slip_tolerance = 1e-4, .most_iterations = 400, .most_factorisations = 400, .most_slip_passes = 40};

DirectBody box(double mass, const dvec3& velocity = dvec3{0.0}) {
    DirectBody body;
    body.mass = mass;
    body.inertia = dmat3{mass / 6.0};
    body.velocity = velocity;
    body.free_velocity = velocity - dvec3{0.0, kG * kDt, 0.0};
    return body;
}

/// Four points between the faces of two unit boxes, b on top.
void add_face(DirectProblem& problem, std::int32_t a, std::int32_t b, double friction, double softness) {
    for (const double x : {-0.5, 0.5}) {
        for (const double z : {-0.5, 0.5}) {
            DirectContact c;
            c.a = a;
            c.b = b;
            c.arm_a = {x, 0.5, z};
            c.arm_b = {x, -0.5, z};
            c.normal = {0.0, 1.0, 0.0};
            c.friction = friction;
            c.softness = softness;
            problem.contacts.push_back(c);
        }
    }
}

struct Errors {
    double momentum = 0.0;     ///< [m/s]
    double normal = 0.0;       ///< |u_n + b + R λ_n| of points that push, or how far one that is apart approaches too fast [m/s]
    double cone = 0.0;         ///< how far outside the cone, or against the slip [share of μ λ_n]
};

Errors errors_of(const DirectProblem& problem) {
    std::vector<dvec3> linear, angular;
    for (const DirectBody& b : problem.bodies) {
        linear.push_back(b.mass * (b.velocity - b.free_velocity));
        angular.push_back(b.inertia * (b.spin - b.free_spin));
    }
    Errors e;
    for (const DirectContact& c : problem.contacts) {
        dvec3 u = c.drift;
        if (c.b != kNoBody) {
            const auto i = static_cast<std::size_t>(c.b);
            u += problem.bodies[i].velocity + glm::cross(problem.bodies[i].spin, c.arm_b);
            linear[i] -= c.impulse;
            angular[i] -= glm::cross(c.arm_b, c.impulse);
        }
        if (c.a != kNoBody) {
            const auto i = static_cast<std::size_t>(c.a);
            u -= problem.bodies[i].velocity + glm::cross(problem.bodies[i].spin, c.arm_a);
            linear[i] += c.impulse;
            angular[i] += glm::cross(c.arm_a, c.impulse);
        }
        const double un = glm::dot(u, c.normal), pressed = glm::dot(c.impulse, c.normal);
        const dvec3 slip = u - un * c.normal, rubbed = c.impulse - pressed * c.normal;
        if (pressed <= 0.0) {
            e.normal = std::max(e.normal, -(un + c.bias));
            e.cone = std::max(e.cone, glm::length(rubbed));
            continue;
        }
        const double limit = c.friction * pressed;
        e.normal = std::max(e.normal, std::abs(un + c.bias + c.softness * pressed));
        e.cone = std::max(e.cone, glm::length(rubbed) / limit - 1.0);
        // What slips is held by all of the friction, against the slip; what creeps by less than the softness allows, sticks.
        if (glm::length(slip) > 1e-3) e.cone = std::max(e.cone, glm::length(rubbed / limit + slip / glm::length(slip)));
    }
    for (std::size_t i = 0; i < linear.size(); ++i) {
        e.momentum = std::max({e.momentum, glm::length(linear[i]) / problem.bodies[i].mass, glm::length(angular[i]) / problem.bodies[i].mass});
    }
    return e;
}

DirectResult solve(DirectProblem& problem, const DirectSettings& settings = kSettings) {
    DirectNewton newton;
    std::vector<ContactLink> links;
    for (const DirectContact& c : problem.contacts) links.push_back({c.a, c.b, 1});
    EXPECT_TRUE(newton.analyse(problem.bodies.size(), links, 1'000'000));
    return newton.solve(problem, settings);
}

TEST(DirectNewton, AStackBearsItsWeightAtEveryMassRatio) {
    for (const double top : {1.0, 1e2, 1e4, 1e6}) {
        DirectProblem problem;
        problem.bodies = {box(1.0), box(0.01), box(top)};
        const double softness = 1e-4 / (kG * (top + 1.01) * kDt * 0.1);
        for (std::int32_t i = 0; i < 3; ++i) add_face(problem, i - 1, i, 0.6, softness);
        // At rest when the overlap is that of the load.
        const double loads[] = {top + 1.01, top + 0.01, top};
        for (std::size_t i = 0; i < 12; ++i) problem.contacts[i].bias = -softness * 0.25 * loads[i / 4] * kG * kDt;
        const DirectResult result = solve(problem);
        ASSERT_TRUE(result.converged) << top;
        EXPECT_LE(result.iterations, 2) << top;
        for (std::size_t i = 0; i < 12; ++i) {
            const double weight = 0.25 * loads[i / 4] * kG * kDt;
            EXPECT_NEAR(problem.contacts[i].impulse.y, weight, 1e-6 * weight) << top;
        }
        for (const DirectBody& b : problem.bodies) EXPECT_LT(glm::length(b.velocity) + glm::length(b.spin), 1e-6) << top;
    }
}

TEST(DirectNewton, ASlidingBoxIsSlowedByFrictionAndNotLifted) {
    for (const double angle : {0.0, 0.5, 0.785, 2.2}) {
        const dvec3 along{std::cos(angle), 0.0, std::sin(angle)};
        DirectProblem problem;
        problem.bodies = {box(3.0, 8.0 * along)};
        problem.bodies[0].free_spin = {0.0, 0.0, 0.0};
        add_face(problem, kNoBody, 0, 0.5, 1e-6);
        const DirectResult result = solve(problem);
        ASSERT_TRUE(result.converged);
        EXPECT_NEAR(glm::dot(problem.bodies[0].velocity, along), 8.0 - 0.5 * kG * kDt, 1e-3 * 0.5 * kG * kDt) << angle;
        EXPECT_LT(std::abs(problem.bodies[0].velocity.y), 2e-4) << "the cone alone would lift it at " << 0.5 * 8.0;
    }
}

DirectProblem random_island(std::uint64_t seed, bool moving) {
    Random random(seed);
    const auto draw = [&](double size) { return size * dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)}; };
    DirectProblem problem;
    const auto count = static_cast<std::int32_t>(random.range(2, 12));
    for (std::int32_t i = 0; i < count; ++i) {
        DirectBody b = box(random.range(0.1, 10.0), draw(moving ? 1.0 : 1e-3));
        b.spin = b.free_spin = draw(moving ? 1.0 : 1e-3);
        problem.bodies.push_back(b);
    }
    for (std::int32_t i = 0; i < count; ++i) {
        for (int k = 0; k < 2; ++k) {
            DirectContact c;
            c.b = i;
            c.a = k == 0 ? i - 1 : static_cast<std::int32_t>(random.range(0, i + 1)) - 1;
            c.normal = glm::normalize(dvec3{0.0, 1.0, 0.0} + draw(0.5));
            c.arm_b = -0.5 * c.normal + draw(0.3);
            c.arm_a = 0.5 * c.normal + draw(0.3);
            c.friction = random.range(0.0, 1.0);
            c.softness = 1e-5;
            c.bias = random.range(-0.02, 0.05);
            problem.contacts.push_back(c);
        }
    }
    return problem;
}

TEST(DirectNewton, SolvesTheContactProblemOfRandomIslands) {
    int solved = 0, pushing = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        DirectProblem problem = random_island(seed, seed % 2 == 0);
        const DirectResult result = solve(problem);
        if (!result.converged) continue;
        ++solved;
        const Errors e = errors_of(problem);
        EXPECT_LT(e.momentum, 1e-7) << seed;
        EXPECT_LT(e.normal, 2.0 * kSettings.slip_tolerance + 1e-4) << seed;
        EXPECT_LT(e.cone, 2e-3) << seed;
        for (const DirectContact& c : problem.contacts) pushing += c.impulse != dvec3{0.0} ? 1 : 0;
    }
    EXPECT_GE(solved, 180);
    EXPECT_GT(pushing, 1000);
}

TEST(DirectNewton, AnswersTheSameFromEveryFirstGuess) {
    int compared = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        DirectProblem problem = random_island(seed, false);
        DirectProblem other = problem;
        for (DirectBody& b : other.bodies) b.velocity += dvec3{0.3, 0.2, -0.1};
        DirectSettings exact = kSettings;
        exact.slip_tolerance = 1e-6;
        const DirectResult first = solve(problem, exact), second = solve(other, exact);
        if (!first.converged || !second.converged) continue;
        ++compared;
        for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
            EXPECT_LT(glm::length(problem.bodies[i].velocity - other.bodies[i].velocity), 1e-4) << seed;
        }
    }
    EXPECT_GE(compared, 20);
}

TEST(DirectNewton, GivesUpWhereItMayNotGoOn) {
    DirectProblem problem = random_island(8, true);
    DirectSettings settings = kSettings;
    settings.most_iterations = 1;
    EXPECT_FALSE(solve(problem, settings).converged);
    problem = random_island(8, true);
    settings = kSettings;
    settings.early_look = 3;
    const DirectResult early = solve(problem, settings);  // nothing misses nothing
    EXPECT_FALSE(early.converged);
    EXPECT_EQ(early.iterations, 3);
    problem = random_island(8, true);
    settings.early_most = 1.001 * early.residual;
    const DirectResult whole = solve(problem, settings);
    EXPECT_TRUE(whole.converged);
    EXPECT_GT(whole.iterations, 3);
    problem = random_island(8, true);
    problem.bodies[0].velocity.x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(solve(problem).converged);
}

}  // namespace
}  // namespace carom::dynamics
