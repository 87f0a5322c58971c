#include <carom/dynamics/detail/sequential_impulses.hpp>

#include <carom/dynamics/detail/block_rows.hpp>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

dvec3 slip(const DirectProblem& problem, const DirectContact& c) {
    dvec3 u = c.drift;
    if (c.a != kNoBody) {
        const DirectBody& body = problem.bodies[static_cast<std::size_t>(c.a)];
        u -= body.velocity + glm::cross(body.spin, c.arm_a);
    }
    if (c.b != kNoBody) {
        const DirectBody& body = problem.bodies[static_cast<std::size_t>(c.b)];
        u += body.velocity + glm::cross(body.spin, c.arm_b);
    }
    return u;
}

}  // namespace

SequentialImpulses::Row SequentialImpulses::row_of(const DirectProblem& problem, const DirectContact& c) {
    Row row;
    if (c.a != kNoBody) {
        const DirectBody& body = problem.bodies[static_cast<std::size_t>(c.a)];
        row.mass_a = 1.0 / body.mass, row.inverse_a = glm::inverse(body.inertia);
    }
    if (c.b != kNoBody) {
        const DirectBody& body = problem.bodies[static_cast<std::size_t>(c.b)];
        row.mass_b = 1.0 / body.mass, row.inverse_b = glm::inverse(body.inertia);
    }
    const dmat3 arm_a = cross_matrix(c.arm_a), arm_b = cross_matrix(c.arm_b);
    // K: velocity of the point per impulse there.
    const dmat3 k = dmat3{row.mass_a + row.mass_b} - arm_a * row.inverse_a * arm_a - arm_b * row.inverse_b * arm_b;
    const dvec3 side = std::abs(c.normal.x) < 0.5 ? dvec3{1.0, 0.0, 0.0} : dvec3{0.0, 1.0, 0.0};
    const dvec3 t1 = glm::normalize(glm::cross(c.normal, side)), t2 = glm::cross(c.normal, t1);
    const double k11 = glm::dot(t1, k * t1), k22 = glm::dot(t2, k * t2), k12 = glm::dot(t1, k * t2);
    const double half = 0.5 * (k11 - k22);
    row.normal_mass = 1.0 / glm::dot(c.normal, k * c.normal);
    row.tangent_mass = 1.0 / (0.5 * (k11 + k22) + std::sqrt(half * half + k12 * k12));
    return row;
}

void SequentialImpulses::push(DirectProblem& problem, const Row& row, const DirectContact& c, const dvec3& impulse) {
    if (c.a != kNoBody) {
        DirectBody& body = problem.bodies[static_cast<std::size_t>(c.a)];
        body.velocity -= row.mass_a * impulse;
        body.spin -= row.inverse_a * glm::cross(c.arm_a, impulse);
    }
    if (c.b != kNoBody) {
        DirectBody& body = problem.bodies[static_cast<std::size_t>(c.b)];
        body.velocity += row.mass_b * impulse;
        body.spin += row.inverse_b * glm::cross(c.arm_b, impulse);
    }
}

// Friction first, then the normal, which so has the last word.
void SequentialImpulses::solve_point(DirectProblem& problem, const Row& row, DirectContact& c) {
    double normal = glm::dot(c.impulse, c.normal);
    const dvec3 u = slip(problem, c), before = c.impulse - normal * c.normal;
    dvec3 friction = before - row.tangent_mass * (u - glm::dot(u, c.normal) * c.normal);
    const double most = c.friction * normal, length = glm::length(friction);
    if (length > most) friction *= most / length;
    push(problem, row, c, friction - before);
    const double approach = glm::dot(slip(problem, c), c.normal) + c.bias;
    const double next = std::max(normal - row.normal_mass * approach, 0.0);
    push(problem, row, c, (next - normal) * c.normal);
    c.impulse = friction + next * c.normal;
}

void SequentialImpulses::solve(DirectProblem& problem, int passes) {
    for (DirectBody& body : problem.bodies) body.velocity = body.free_velocity, body.spin = body.free_spin;
    rows_.clear();
    for (const DirectContact& c : problem.contacts) {
        rows_.push_back(row_of(problem, c));
        push(problem, rows_.back(), c, c.impulse);
    }
    for (int pass = 0; pass < passes; ++pass) {
        for (std::size_t i = 0; i < rows_.size(); ++i) solve_point(problem, rows_[i], problem.contacts[i]);
    }
}

}  // namespace carom::dynamics
