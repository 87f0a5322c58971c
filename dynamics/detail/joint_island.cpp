#include <carom/dynamics/detail/joint_island.hpp>

#include <carom/core/math.hpp>
#include <carom/dynamics/detail/block_rows.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/joint_laws.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

/// Solves for positions repeat until a gap is that small against the arms, and what rounding leaves of far positions.
constexpr double kClosed = 1e-13, kUlp = 0x1p-51;
constexpr int kMostIterations = 12, kVelocityIterations = 2;
/// Gaps beyond this, against the arms, are no solution: the rope is about to snap straight, where no impulse along the joints as they are now will do.
constexpr double kOpen = 1e-6;
/// Of islands too large to be factored.
constexpr int kSweeps = 12;
/// What is locked has so many times the mass in the matrix; the impulses themselves never move it.
constexpr double kLockedShare = 1e6;

dvec3 velocity_at(const JointBody& body, const dvec3& arm) { return body.state.velocity + glm::cross(body.state.spin, arm); }

/// G of a row: along a direction, and across it.
dmat3 softness_matrix(const JointRow& row) {
    return dmat3{row.across} + (row.along - row.across) * glm::outerProduct(row.direction, row.direction);
}

/// J M⁻¹ Jᵀ of one end.
dmat3 response(const JointBody& body, const dvec3& arm) {
    const dmat3 turn = cross_matrix(arm);
    dmat3 out = turn * body.inverse_turn * glm::transpose(turn);
    for (int i = 0; i < 3; ++i) out[i][i] += body.inverse_mass[i];
    return out;
}

}  // namespace

bool JointIsland::analyse(std::size_t most_operations) {
    edges_.clear();
    any_ball_ = false;
    for (JointRow& row : rows) {
        any_ball_ |= row.ball;
        row.edge = -1;
        if (row.a.body < 0 || row.b.body < 0) continue;
        row.edge = static_cast<std::int32_t>(edges_.size());
        edges_.push_back({row.a.body, row.b.body});
    }
    step_.resize(bodies.size());
    next_.resize(bodies.size());
    wanted_.resize(rows.size());
    ahead_.resize(rows.size());
    direct_ = factor_.analyse(static_cast<std::int32_t>(bodies.size()), edges_, most_operations);
    return direct_;
}

Pose JointIsland::pose_of(const JointEnd& end, double time) const {
    if (end.body >= 0) return bodies[as_index(end.body)].state.pose;
    if (end.velocity == dvec3{0.0} && end.spin == dvec3{0.0}) return end.start;
    return {end.start.position + time * end.velocity, glm::normalize(rotation_from_vector(time * end.spin) * end.start.orientation)};
}

dvec3 JointIsland::gap_of(const JointRow& row, const Pose& a, const Pose& b) const noexcept {
    return (b.position - a.position) + (rotate(b.orientation, row.b.local) - rotate(a.orientation, row.a.local));
}

dvec3 JointIsland::velocity_of(const JointRow& row) const noexcept {
    dvec3 u = row.fixed_velocity;
    if (row.b.body >= 0) u += velocity_at(bodies[as_index(row.b.body)], row.arm_b);
    if (row.a.body >= 0) u -= velocity_at(bodies[as_index(row.a.body)], row.arm_a);
    return u;
}

dvec3 JointIsland::velocity_before(const JointRow& row) const noexcept {
    const auto at = [](const JointBody& body, const dvec3& arm) { return body.before_velocity + glm::cross(body.before_spin, arm); };
    dvec3 u = row.fixed_velocity;
    if (row.b.body >= 0) u += at(bodies[as_index(row.b.body)], row.arm_b);
    if (row.a.body >= 0) u -= at(bodies[as_index(row.a.body)], row.arm_a);
    return u;
}

void JointIsland::look_at_bodies() {
    for (JointBody& body : bodies) {
        body.inverse_mass = body.mass->inverse_mass * free_moves(body.mass->locked);
        body.inverse_turn = world_inverse_inertia(body.state, *body.mass);
        body.stiffening = dmat3{0.0};
        body.stiffness = body.damping = 0.0;
    }
}

void JointIsland::place_rows() {
    for (JointRow& row : rows) {
        const Pose a = pose_of(row.a, time_), b = pose_of(row.b, time_);
        row.arm_a = rotate(a.orientation, row.a.local);
        row.arm_b = rotate(b.orientation, row.b.local);
        row.gap = gap_of(row, a, b);
        row.fixed_velocity = dvec3{0.0};
        if (row.b.body < 0) row.fixed_velocity += row.b.velocity + glm::cross(row.b.spin, row.arm_b);
        if (row.a.body < 0) row.fixed_velocity -= row.a.velocity + glm::cross(row.a.spin, row.arm_a);
        if (row.ball) continue;
        const double length = glm::length(row.gap);
        row.direction = length > 0.0 ? row.gap / length : dvec3{0.0};
        for (const auto& [end, arm] : {std::pair{row.a.body, row.arm_a}, std::pair{row.b.body, row.arm_b}}) {
            if (end < 0) continue;
            JointBody& body = bodies[as_index(end)];
            body.stiffness += row.stiffness * lightness(body, arm);
            body.damping += row.damping * lightness(body, arm);
        }
    }
}

void JointIsland::look(double h, double time, double share) {
    h_ = h;
    time_ = time;
    share_ = share;
    look_at_bodies();
    place_rows();
    stiffen();
    for (JointRow& row : rows) {
        if (row.ball) {
            set_up_ball(row);
        } else {
            set_up_spring(row, share);
        }
    }
    factored_ = false;
    if (!direct_) return;
    assemble();
    factored_ = factor_.factorise();
}

void JointIsland::warm_start(double h) {
    time_ = 0.0;
    look_at_bodies();
    place_rows();
    for (JointRow& row : rows) give(row, h * row.mean_force);
}

void JointIsland::assemble() {
    factor_.clear();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const JointBody& body = bodies[i];
        Block6& block = factor_.diagonal(static_cast<std::int32_t>(i));
        const dmat3 axes = glm::mat3_cast(body.state.pose.orientation);
        dmat3 scaled = axes;
        for (int k = 0; k < 3; ++k) scaled[k] *= body.mass->moments[k];
        dmat3 inertia = scaled * glm::transpose(axes) + body.stiffening;
        const double most = trace(inertia);
        for (int k = 0; k < 3; ++k) {
            const auto locked = static_cast<unsigned>(body.mass->locked);
            block.at(k, k) += body.mass->mass * ((locked >> k & 1u) != 0 ? kLockedShare : 1.0);
            if ((locked >> (k + 3) & 1u) != 0) inertia[k][k] += kLockedShare * most;
        }
        add(block, 3, 3, inertia);
    }
    for (const JointRow& row : rows) {
        const dmat3 g = softness_matrix(row);
        if (row.a.body >= 0) add_coupling(factor_.diagonal(row.a.body), g, row.arm_a, row.arm_a, 1.0);
        if (row.b.body >= 0) add_coupling(factor_.diagonal(row.b.body), g, row.arm_b, row.arm_b, 1.0);
        if (row.edge < 0) continue;
        const BlockPlace place = factor_.place(as_index(row.edge));
        Block6& block = factor_.block(place.index);
        if (place.transposed) {
            add_coupling(block, g, row.arm_b, row.arm_a, -1.0);
        } else {
            add_coupling(block, g, row.arm_a, row.arm_b, -1.0);
        }
    }
}

BodyState JointIsland::drifted(const JointBody& body) const {
    BodyState next = body.state;
    if (alone) {
        integrate_free(next, *body.mass, {.spin_tolerance = spin_tolerance}, h_);
    } else {
        next.pose.position += h_ * next.velocity;
        next.pose.orientation = glm::normalize(rotation_from_vector(h_ * next.spin) * next.pose.orientation);
    }
    return next;
}

void JointIsland::drift() {
    for (JointBody& body : bodies) body.state = drifted(body);
}

void JointIsland::predict() {
    for (std::size_t i = 0; i < bodies.size(); ++i) next_[i] = drifted(bodies[i]).pose;
    const auto next = [&](const JointEnd& end) { return end.body >= 0 ? next_[as_index(end.body)] : pose_of(end, time_ + h_); };
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i].ball) ahead_[i] = gap_of(rows[i], next(rows[i].a), next(rows[i].b)) - rows[i].left;
    }
}

bool JointIsland::has_closed(double share) const noexcept {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!rows[i].ball) continue;
        double far = 0.0;
        for (const JointEnd* end : {&rows[i].a, &rows[i].b}) far += glm::length(end->body >= 0 ? next_[as_index(end->body)].position : end->start.position);
        const double most = share * (glm::length(rows[i].arm_a) + glm::length(rows[i].arm_b)) + kUlp * far;
        if (!(glm::length(ahead_[i]) <= most)) return false;
    }
    return true;
}

void JointIsland::give(JointRow& row, const dvec3& impulse) noexcept {
    row.impulse += impulse;
    const auto push = [](JointBody& body, const dvec3& arm, const dvec3& change) {
        const dvec3 velocity = body.inverse_mass * change, spin = body.inverse_turn * glm::cross(arm, change);
        body.state.velocity += velocity;
        body.state.spin += spin;
        body.pushed_velocity += velocity;
        body.pushed_spin += spin;
    };
    if (row.b.body >= 0) push(bodies[as_index(row.b.body)], row.arm_b, impulse);
    if (row.a.body >= 0) push(bodies[as_index(row.a.body)], row.arm_a, -impulse);
}

dvec3 JointIsland::missing(const JointRow& row, JointGoal goal) const noexcept {
    const dvec3 u = velocity_of(row);
    if (!row.ball) return -(row.law + softness_matrix(row) * u) - row.impulse;
    if (goal == JointGoal::Velocities) return -row.along * u;
    return -row.along * ((row.gap - row.left) / h_ + u);
}

// One step of Newton's method: λ += Δ - G J δ with H δ = Jᵀ Δ, Δ by which λ misses its law.
void JointIsland::refine(JointGoal goal) {
    std::ranges::fill(step_, Vector6{});
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const JointRow& row = rows[i];
        const bool ahead = row.ball && goal == JointGoal::Positions;
        wanted_[i] = ahead ? -row.along * (ahead_[i] / h_) : missing(row, goal);
        const auto put = [&](std::int32_t end, const dvec3& arm, const dvec3& impulse) {
            if (end < 0) return;
            const dvec3 turn = glm::cross(arm, impulse);
            Vector6& x = step_[as_index(end)];
            for (std::size_t k = 0; k < 3; ++k) {
                x[k] += impulse[static_cast<int>(k)];
                x[k + 3] += turn[static_cast<int>(k)];
            }
        };
        put(row.b.body, row.arm_b, wanted_[i]);
        put(row.a.body, row.arm_a, -wanted_[i]);
    }
    factor_.solve(step_);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        JointRow& row = rows[i];
        const auto at = [&](std::int32_t end, const dvec3& arm) {
            if (end < 0) return dvec3{0.0};
            return linear_part(step_[as_index(end)]) + glm::cross(angular_part(step_[as_index(end)]), arm);
        };
        give(row, wanted_[i] - softness_matrix(row) * (at(row.b.body, row.arm_b) - at(row.a.body, row.arm_a)));
    }
}

void JointIsland::sweep(JointGoal goal) {
    for (JointRow& row : rows) {
        dmat3 mass{0.0};
        if (row.b.body >= 0) mass += response(bodies[as_index(row.b.body)], row.arm_b);
        if (row.a.body >= 0) mass += response(bodies[as_index(row.a.body)], row.arm_a);
        give(row, glm::inverse(dmat3{1.0} + softness_matrix(row) * mass) * missing(row, goal));
    }
}

// Spin that is left where the torque of the load goes with the turn.
void JointIsland::slow_down() noexcept {
    for (JointBody& body : bodies) {
        if (body.stiffening == dmat3{0.0}) continue;
        const dvec3 spin = body.inverse_turn * angular_momentum(body.state, *body.mass);
        body.pushed_spin += spin - body.state.spin;
        body.state.spin = spin;
    }
}

// Newton's steps. Where they do not come to a solution, what they gave is taken back, and the anchors are only kept from parting: a projection of the
// velocities, which takes energy out and adds none. The gap that the drift then opens is closed later.
void JointIsland::close_gaps() {
    before_.assign(bodies.begin(), bodies.end());
    for (int i = 0; i < kMostIterations; ++i) {
        predict();
        if (i > 0 && has_closed(kClosed)) return;
        refine(JointGoal::Positions);
    }
    predict();
    if (has_closed(kOpen)) return;
    ++given_up_;
    for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i] = before_[i];
    for (JointRow& row : rows) row.impulse = dvec3{0.0};
    for (int i = 0; i < kVelocityIterations; ++i) refine(JointGoal::Velocities);
}

void JointIsland::solve(JointGoal goal) {
    slow_down();
    for (JointRow& row : rows) {
        row.impulse = dvec3{0.0};
        if (row.ball) continue;
        const dvec3 before = velocity_before(row);
        row.law = row.push - row.keep * (row.rest_length > 0.0 ? glm::dot(before, row.direction) * row.direction : before);
    }
    const bool ahead = any_ball_ && goal == JointGoal::Positions;
    if (factored_ && ahead) {
        close_gaps();
    } else if (factored_) {
        for (int i = 0; i < (any_ball_ ? kVelocityIterations : 1); ++i) refine(goal);
    } else {
        for (int i = 0; i < kSweeps; ++i) sweep(goal);
    }
    for (JointRow& row : rows) {
        row.sum += row.impulse;
        if (goal == JointGoal::Positions) row.force = row.impulse / (share_ * h_);
    }
}

double JointIsland::worst_gap() const noexcept {
    double worst = 0.0;
    for (const JointRow& row : rows) {
        if (row.ball) worst = std::max(worst, glm::length(row.gap));
    }
    return worst;
}

std::size_t JointIsland::memory() const noexcept {
    return factor_.memory() + held_by(bodies, rows, edges_, before_, step_, wanted_, ahead_, next_);
}

}  // namespace carom::dynamics
