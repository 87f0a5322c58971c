#include <carom/dynamics/detail/direct_newton.hpp>

#include <carom/dynamics/detail/block_rows.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace carom::dynamics {
namespace {

/// A factor made of other contacts or poses is kept while an iteration with it makes the residual this much smaller.
constexpr double kLeastGain = 5.0;
/// One point in so many may have changed between sticking, slipping and being apart since the factor was made.
constexpr std::size_t kFewChange = 20;
/// The slope at the end of a line search over that at its start.
constexpr double kSlopeShare = 1e-6;
constexpr int kMostTrials = 60;
/// What rounding leaves of a sum of impulses.
constexpr double kRounding = 1e-13;

std::size_t as_index(std::int32_t i) { return static_cast<std::size_t>(i); }

dvec3 velocity_at(const DirectBody& body, const dvec3& arm) { return body.velocity + glm::cross(body.spin, arm); }

dvec3 relative_velocity(const DirectProblem& problem, const DirectContact& c) {
    dvec3 u = c.drift;
    if (c.b != kNoBody) u += velocity_at(problem.bodies[as_index(c.b)], c.arm_b);
    if (c.a != kNoBody) u -= velocity_at(problem.bodies[as_index(c.a)], c.arm_a);
    return u;
}

double slip_speed(const DirectProblem& problem, const DirectContact& c) {
    const dvec3 u = relative_velocity(problem, c);
    return glm::length(u - glm::dot(u, c.normal) * c.normal);
}

}  // namespace

bool DirectNewton::analyse(std::size_t bodies, std::span<const ContactLink> links, std::size_t most_operations) {
    has_factor_ = false;
    const std::size_t before = std::exchange(edge_bodies_, 0);  // until it is done: nothing is known of a graph whose analysis threw
    before_.swap(edges_);
    edges_.clear();
    edge_of_.clear();
    for (const ContactLink& link : links) {
        const bool joins = link.a != kNoBody && link.b != kNoBody;
        // Links that follow each other may share their edge.
        if (joins && (edges_.empty() || !(edges_.back() == BlockEdge{link.a, link.b}))) edges_.push_back({link.a, link.b});
        edge_of_.insert(edge_of_.end(), link.points, joins ? static_cast<std::int32_t>(edges_.size()) - 1 : -1);
    }
    const bool known = before == bodies && before_ == edges_;
    if (!known) {
        ++orders_;
        if (!factor_.analyse(static_cast<std::int32_t>(bodies), edges_, most_operations)) {
            drop(edges_, before_, edge_of_);  // of a large island, which will not be asked about again soon
            return false;
        }
    }
    edge_bodies_ = bodies;
    return true;
}

void DirectNewton::evaluate(const DirectProblem& problem) {
    for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
        const DirectBody& body = problem.bodies[i];
        gradient_[i] = {body.mass * (body.velocity - body.free_velocity), body.inertia * (body.spin - body.free_spin)};
        load_[i] = 0.0;
    }
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const DirectContact& c = problem.contacts[i];
        Point& p = points_[i];
        p.y = c.friction_guess - (relative_velocity(problem, c) + (c.bias + p.correction) * c.normal) / c.softness;
        p.cone = nearest_in_cone(p.y, c.normal, c.friction);
        if (p.cone.state == ConeState::Apart) continue;
        const double size = glm::length(p.cone.impulse);
        if (c.b != kNoBody) {
            Motion& g = gradient_[as_index(c.b)];
            g.linear -= p.cone.impulse;
            g.angular -= glm::cross(c.arm_b, p.cone.impulse);
            load_[as_index(c.b)] += size;
        }
        if (c.a != kNoBody) {
            Motion& g = gradient_[as_index(c.a)];
            g.linear += p.cone.impulse;
            g.angular += glm::cross(c.arm_a, p.cone.impulse);
            load_[as_index(c.a)] += size;
        }
    }
}

double DirectNewton::residual(const DirectProblem& problem) const {
    double worst = 0.0;
    for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
        const DirectBody& body = problem.bodies[i];
        const double gyration = std::sqrt((body.inertia[0][0] + body.inertia[1][1] + body.inertia[2][2]) / (2.0 * body.mass));
        const double missing = std::max(glm::length(gradient_[i].linear), glm::length(gradient_[i].angular) / gyration);
        const double error = (missing - kRounding * load_[i]) / body.mass;
        if (!(error <= worst)) worst = error;  // NaN is worse than all
    }
    return worst;
}

void DirectNewton::assemble(const DirectProblem& problem) {
    factor_.clear();
    for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
        Block6& block = factor_.diagonal(static_cast<std::int32_t>(i));
        add(block, 0, 0, dmat3{problem.bodies[i].mass});
        add(block, 3, 3, problem.bodies[i].inertia);
    }
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const DirectContact& c = problem.contacts[i];
        factored_[i] = points_[i].cone.state;
        if (factored_[i] == ConeState::Apart) continue;
        const dmat3 g = points_[i].cone.derivative() / c.softness;
        if (c.a != kNoBody) add_coupling(factor_.diagonal(c.a), g, c.arm_a, c.arm_a, 1.0);
        if (c.b != kNoBody) add_coupling(factor_.diagonal(c.b), g, c.arm_b, c.arm_b, 1.0);
        if (edge_of_[i] < 0) continue;
        const BlockPlace place = factor_.place(as_index(edge_of_[i]));
        Block6& block = factor_.block(place.index);
        if (place.transposed) {
            add_coupling(block, g, c.arm_b, c.arm_a, -1.0);
        } else {
            add_coupling(block, g, c.arm_a, c.arm_b, -1.0);
        }
    }
}

bool DirectNewton::refactor(const DirectProblem& problem) {
    assemble(problem);
    has_factor_ = factor_.factorise();
    return has_factor_;
}

void DirectNewton::find_step(const DirectProblem& problem) {
    for (std::size_t i = 0; i < gradient_.size(); ++i) {
        const Motion& g = gradient_[i];
        step_[i] = {{-g.linear.x, -g.linear.y, -g.linear.z, -g.angular.x, -g.angular.y, -g.angular.z}};
    }
    factor_.solve(step_);
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const DirectContact& c = problem.contacts[i];
        dvec3 change{0.0};
        if (c.b != kNoBody) change += linear_part(step_[as_index(c.b)]) + glm::cross(angular_part(step_[as_index(c.b)]), c.arm_b);
        if (c.a != kNoBody) change -= linear_part(step_[as_index(c.a)]) + glm::cross(angular_part(step_[as_index(c.a)]), c.arm_a);
        points_[i].step = -change / c.softness;
    }
}

// The root of the slope along the step, which rises: Newton's method within a bracket.
double DirectNewton::step_length(const DirectProblem& problem) {
    double free_slope = 0.0, curvature = 0.0;
    for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
        const DirectBody& body = problem.bodies[i];
        const dvec3 linear = linear_part(step_[i]), angular = angular_part(step_[i]);
        free_slope += body.mass * glm::dot(linear, body.velocity - body.free_velocity) +
                      glm::dot(angular, body.inertia * (body.spin - body.free_spin));
        curvature += body.mass * glm::dot(linear, linear) + glm::dot(angular, body.inertia * angular);
    }
    struct Slope {
        double value, change;
    };
    const auto slope_at = [&](double length) {
        Slope s{free_slope + length * curvature, curvature};
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const DirectContact& c = problem.contacts[i];
            const dvec3& step = points_[i].step;
            const ConePoint cone = nearest_in_cone(points_[i].y + length * step, c.normal, c.friction);
            if (cone.state == ConeState::Apart) continue;
            s.value += c.softness * glm::dot(step, cone.impulse);
            s.change += c.softness * glm::dot(step, cone.derivative(step));
        }
        return s;
    };
    const double limit = kSlopeShare * std::abs(slope_at(0.0).value);
    double lower = 0.0, upper = 0.0, length = 1.0;  // upper 0: none yet
    for (int trial = 0; trial < kMostTrials; ++trial) {
        const Slope s = slope_at(length);
        if (std::abs(s.value) <= limit) break;
        (s.value < 0.0 ? lower : upper) = length;
        double next = length - s.value / s.change;
        if (upper == 0.0) {
            next = std::min(std::max(next, 1.5 * length), 10.0 * length);
        } else if (!(next > lower && next < upper)) {
            next = 0.5 * (lower + upper);
        }
        if (next == length) break;
        length = next;
    }
    return length;
}

void DirectNewton::take_step(DirectProblem& problem, double length) {
    for (std::size_t i = 0; i < problem.bodies.size(); ++i) {
        problem.bodies[i].velocity += length * linear_part(step_[i]);
        problem.bodies[i].spin += length * angular_part(step_[i]);
    }
    evaluate(problem);
}

double DirectNewton::correct_for_slip(const DirectProblem& problem) {
    double worst = 0.0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const DirectContact& c = problem.contacts[i];
        Point& p = points_[i];
        const bool sticks = p.cone.state == ConeState::Sticks;
        const double wanted = sticks ? 0.0 : c.friction * slip_speed(problem, c);
        // A point that is apart stays so with less of it.
        const double error = p.cone.state == ConeState::Apart ? p.correction - wanted : std::abs(p.correction - wanted);
        worst = std::max(worst, error);
        p.correction = p.cone.state == ConeState::Apart ? std::min(p.correction, wanted) : wanted;
    }
    return worst;
}

bool DirectNewton::has_changed() const {
    std::size_t changed = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) changed += factored_[i] != points_[i].cone.state ? 1 : 0;
    return changed * kFewChange > points_.size();
}

bool DirectNewton::minimise(DirectProblem& problem, const DirectSettings& settings, DirectResult& result) {
    evaluate(problem);
    result.residual = residual(problem);
    bool gained = true;
    while (!(result.residual <= settings.speed_tolerance)) {
        if (result.iterations == settings.most_iterations || !std::isfinite(result.residual)) return false;
        if (!has_factor_ || !gained || has_changed()) {
            if (result.factorisations == settings.most_factorisations) return false;
            ++result.factorisations;
            if (!refactor(problem)) return false;
        }
        ++result.iterations;
        find_step(problem);
        take_step(problem, step_length(problem));
        const double before = result.residual;
        result.residual = residual(problem);
        gained = result.residual * kLeastGain <= before;
        if (result.iterations == settings.early_look && result.residual > settings.early_most) return false;
    }
    return true;
}

DirectResult DirectNewton::solve(DirectProblem& problem, const DirectSettings& settings) {
    gradient_.resize(problem.bodies.size());
    load_.resize(problem.bodies.size());
    step_.resize(problem.bodies.size());
    points_.resize(problem.contacts.size());
    factored_.resize(problem.contacts.size(), ConeState::Apart);
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const DirectContact& c = problem.contacts[i];
        points_[i].correction = c.friction * slip_speed(problem, c);
    }
    DirectResult result;
    for (int pass = 0; pass < settings.most_slip_passes && !result.converged; ++pass) {
        if (!minimise(problem, settings, result)) return result;
        result.slip_error = correct_for_slip(problem);
        result.converged = result.slip_error <= settings.slip_tolerance;
    }
    for (std::size_t i = 0; i < points_.size(); ++i) problem.contacts[i].impulse = points_[i].cone.impulse;
    return result;
}

std::size_t DirectNewton::memory() const noexcept {
    return factor_.memory() + held_by(edges_, before_, edge_of_, factored_, gradient_, load_, step_, points_);
}

}  // namespace carom::dynamics
