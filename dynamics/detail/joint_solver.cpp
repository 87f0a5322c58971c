#include <carom/dynamics/detail/joint_solver.hpp>

#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <algorithm>
#include <utility>

namespace carom::dynamics {
namespace {

constexpr std::int32_t kNowhere = -1;

dvec3 as_dvec3(const float (&v)[4]) { return {v[0], v[1], v[2]}; }

void set(float (&out)[4], const dvec3& v) {
    for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(v[i]);
}

struct Anchors {
    dvec3 a{0.0}, b{0.0};
};
Anchors anchors_of(const JointDef& def) {
    return std::visit([](const auto& joint) { return Anchors{joint.anchor_a, joint.anchor_b}; }, def);
}

dvec3 mean_force(const JointRecord& record) { return record.dt > 0.0 ? record.impulse / record.dt : dvec3{0.0}; }

}  // namespace

bool JointSolver::is_active(const JointDef& def, const BodyArrays& bodies) const noexcept {
    const JoinedBodies joined = bodies_of(def);
    bool movable = false;
    for (const BodyId body : {joined.a, joined.b}) {
        if (!body) continue;
        if (bodies.roles[body.slot] == Role::Absent) return false;
        movable |= bodies.roles[body.slot] == Role::Dynamic;
    }
    return movable;
}

void JointSolver::gather(const JointSet& joints, const BodyArrays& bodies, std::size_t budget) {
    bool same = version_ == joints.version() && active_.size() == joints.order().size() && jointed_.size() == bodies.roles.size();
    active_.resize(joints.order().size());
    for (std::size_t i = 0; i < active_.size(); ++i) {
        const unsigned char active = is_active(joints.find(joints.order()[i])->def, bodies) ? 1 : 0;
        same = same && active_[i] == active;
        active_[i] = active;
    }
    if (same) return;
    version_ = joints.version();
    rebuild(joints, bodies, budget);
}

void JointSolver::rebuild(const JointSet& joints, const BodyArrays& bodies, std::size_t budget) {
    const std::size_t slots = bodies.roles.size();
    islands_.clear();
    jointed_.assign(slots, 0);
    local_.assign(slots, kNowhere);
    sets_.reset(slots);
    const auto is_dynamic = [&](BodyId body) { return body && bodies.roles[body.slot] == Role::Dynamic; };
    const auto each_active = [&](const auto& act) {
        for (std::size_t i = 0; i < active_.size(); ++i) {
            if (active_[i] != 0) act(joints.order()[i], *joints.find(joints.order()[i]));
        }
    };
    each_active([&](JointId, const JointRecord& record) {
        const JoinedBodies joined = bodies_of(record.def);
        for (const BodyId body : {joined.a, joined.b}) {
            if (is_dynamic(body)) jointed_[body.slot] = 1;
        }
        if (is_dynamic(joined.a) && is_dynamic(joined.b)) sets_.unite(joined.a.slot, joined.b.slot);
    });
    std::vector<std::int32_t> island_of(slots, kNowhere);  // by root
    for (std::uint32_t slot = 0; slot < slots; ++slot) {
        if (jointed_[slot] == 0) continue;
        std::int32_t& island = island_of[sets_.root(slot)];
        if (island == kNowhere) {
            island = static_cast<std::int32_t>(islands_.size());
            islands_.emplace_back();
        }
        std::vector<JointBody>& members = islands_[static_cast<std::size_t>(island)].bodies;
        local_[slot] = static_cast<std::int32_t>(members.size());
        members.emplace_back().slot = slot;
    }
    each_active([&](JointId id, const JointRecord& record) {
        const JoinedBodies joined = bodies_of(record.def);
        const std::uint32_t member = is_dynamic(joined.a) ? joined.a.slot : joined.b.slot;
        JointRow row;
        row.id = id;
        row.force = mean_force(record);
        if (const SpringDef* spring = std::get_if<SpringDef>(&record.def)) {
            row.rest_length = spring->rest_length;
            row.stiffness = spring->stiffness;
            row.damping = spring->damping;
        } else {
            row.ball = true;
        }
        row.a.body = is_dynamic(joined.a) ? local_[joined.a.slot] : JointEnd::kFixed;
        row.b.body = is_dynamic(joined.b) ? local_[joined.b.slot] : JointEnd::kFixed;
        islands_[static_cast<std::size_t>(island_of[sets_.root(member)])].rows.push_back(row);
    });
    for (JointIsland& island : islands_) island.analyse(budget);
}

JointEnd JointSolver::end_of(BodyId body, const dvec3& anchor, const BodyArrays& bodies) const {
    JointEnd end;
    end.local = anchor;
    if (!body) return end;
    end.local = inverse_transform_point(bodies.principal(body.slot), anchor);
    if (bodies.roles[body.slot] == Role::Dynamic) {
        end.body = local_[body.slot];
        return end;
    }
    const BodyState& state = bodies.states[body.slot];
    end.start = state.pose;
    end.velocity = state.velocity;
    end.spin = state.spin;
    return end;
}

void JointSolver::fill(JointIsland& island, const JointSet& joints, const BodyArrays& bodies) const {
    island.spin_tolerance = step_.spin_tolerance;
    for (JointBody& body : island.bodies) {
        body.mass = &bodies.masses[body.slot];
        body.state = bodies.states[body.slot];
        body.pushed_velocity = body.pushed_spin = dvec3{0.0};
    }
    for (JointRow& row : island.rows) {
        const JointRecord& record = *joints.find(row.id);
        const JointDef& def = record.def;
        const JoinedBodies joined = bodies_of(def);
        row.mean_force = mean_force(record);
        const Anchors anchors = anchors_of(def);
        row.a = end_of(joined.a, anchors.a, bodies);
        row.b = end_of(joined.b, anchors.b, bodies);
        row.sum = dvec3{0.0};
    }
}

void JointSolver::begin(const JointSet& joints, const BodyArrays& bodies, const OtherHolds& others, const JointStep& step) {
    step_ = step;
    bodies_ = &bodies;
    counts_ = {};
    shared_.clear();
    alone_.assign(bodies.roles.size(), 0);
    std::vector<unsigned char>& touched = alone_;  // until the islands are known
    for (const ContactPair& pair : others.contacts.pairs) {
        if (pair.is_solved()) touched[pair.body_a.slot] = touched[pair.body_b.slot] = 1;
    }
    for (JointIsland& island : islands_) {
        island.alone = std::ranges::none_of(island.bodies, [&](const JointBody& body) { return touched[body.slot] != 0; });
        counts_.joints += island.rows.size();
        counts_.in_contact += island.alone ? 0 : 1;
        counts_.swept += island.is_direct() ? 0 : 1;
        fill(island, joints, bodies);
    }
    counts_.islands = islands_.size();
    std::ranges::fill(alone_, static_cast<unsigned char>(0));
    for (const JointIsland& island : islands_) {
        for (const JointBody& body : island.bodies) {
            if (island.alone) {
                alone_[body.slot] = 1;
            } else {
                shared_.push_back(body.slot);
            }
        }
    }
}

void JointSolver::kick(JointIsland& island, const BodyArrays& bodies, double h) const {
    for (JointBody& body : island.bodies) {
        body.before_velocity = body.state.velocity;
        body.before_spin = body.state.spin;
        const dvec3 pull = bodies.pull(body.slot, step_.gravity);
        if (bodies.traits.empty()) {
            body.state.velocity += h * pull;
            continue;
        }
        const BodyTraits& traits = bodies.traits[body.slot];
        const Decay along = decay(traits.linear_damping * h), about = decay(traits.angular_damping * h);
        body.state.velocity = along.left * body.state.velocity + (along.first * h) * pull;
        body.state.spin = about.left * body.state.spin + (about.first * h) * (world_inverse_inertia(body.state, *body.mass) * traits.torque);
    }
}

// Half a kick and impulses with which the joints hold after the drift, the drift, half a kick and impulses that stop what parts them there: the method RATTLE
// (Andersen 1983), symmetric in time, so second order and without drift of the energy.
void JointSolver::run_alone(JointIsland& island, BodyArrays& bodies) const {
    const double h = step_.substep();
    island.look(h, 0.0, 0.5);
    for (int k = 1; k <= step_.substeps; ++k) {
        kick(island, bodies, 0.5 * h);
        island.solve(JointGoal::Positions);
        island.drift();
        island.look(h, k * h, 0.5);
        kick(island, bodies, 0.5 * h);
        island.solve(JointGoal::Velocities);
    }
    for (const JointBody& body : island.bodies) bodies.states[body.slot] = body.state;
}

void JointSolver::run_alone(BodyArrays& bodies, Executor& executor) {
    executor.parallel_for(islands_.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (islands_[i].alone) run_alone(islands_[i], bodies);
        }
    });
}

void JointSolver::read_rows(JointIsland& island, const ContactSolver& contacts, bool kicked) const {
    for (JointBody& body : island.bodies) {
        const SolverBody& row = contacts.body(body.slot);
        const Pose& start = bodies_->states[body.slot].pose;
        body.state.pose.position = start.position + as_dvec3(row.shift);
        body.state.pose.orientation = glm::normalize(dquat{row.turn[3], row.turn[0], row.turn[1], row.turn[2]} * start.orientation);
        body.state.velocity = as_dvec3(row.velocity);
        body.state.spin = as_dvec3(row.spin);
        if (!kicked) continue;
        const dvec3 pull = bodies_->pull(body.slot, step_.gravity);
        body.before_velocity = body.state.velocity - step_.substep() * pull;
        body.before_spin = body.state.spin;
        // The kick brings the joints' impulses of the substep before along, at lever arms of then.
        body.state.velocity -= std::exchange(body.pushed_velocity, dvec3{0.0});
        body.state.spin -= std::exchange(body.pushed_spin, dvec3{0.0});
    }
}

void JointSolver::write_rows(const JointIsland& island, ContactSolver& contacts) {
    for (const JointBody& body : island.bodies) {
        SolverBody& row = contacts.body(body.slot);
        set(row.velocity, body.state.velocity);
        set(row.spin, body.state.spin);
    }
}

template <class Act>
void JointSolver::for_each_shared(Executor& executor, const Act& act) {
    executor.parallel_for(islands_.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (!islands_[i].alone) act(islands_[i]);
        }
    });
}

void JointSolver::warm_start(ContactSolver& contacts, Executor& executor) {
    for_each_shared(executor, [&](JointIsland& island) {
        read_rows(island, contacts, false);
        island.warm_start(step_.substep());
        write_rows(island, contacts);
    });
}

void JointSolver::solve(ContactSolver& contacts, int substep, Executor& executor) {
    for_each_shared(executor, [&](JointIsland& island) {
        read_rows(island, contacts, true);
        island.look(step_.substep(), substep * step_.substep(), 1.0);
        island.solve(JointGoal::Positions);
        write_rows(island, contacts);
    });
}

void JointSolver::relax(ContactSolver& contacts, int substep, Executor& executor) {
    for_each_shared(executor, [&](JointIsland& island) {
        read_rows(island, contacts, false);
        island.look(step_.substep(), (substep + 1) * step_.substep(), 0.0);
        island.solve(JointGoal::Velocities);
        write_rows(island, contacts);
    });
}

void JointSolver::finish(JointSet& joints) {
    for (const JointId id : joints.order()) {
        JointRecord& record = *joints.find(id);
        const auto [a, b] = bodies_of(record.def);
        const auto sleeps = [&](BodyId body) { return body && bodies_->roles[body.slot] == Role::Asleep; };
        if (sleeps(a) || sleeps(b)) continue;  // it wakes with what it had
        record.impulse = dvec3{0.0};
        record.dt = step_.dt;
    }
    for (JointIsland& island : islands_) {
        counts_.given_up += island.take_given_up();
        for (const JointRow& row : island.rows) joints.find(row.id)->impulse = row.sum;
        counts_.worst_gap = std::max(counts_.worst_gap, island.worst_gap());
    }
}

void JointSolver::clear() noexcept {
    islands_.clear();
    shared_.clear();
    std::ranges::fill(alone_, static_cast<unsigned char>(0));
    version_ = 0;
    active_.clear();
    counts_ = {};
}

std::size_t JointSolver::memory() const noexcept {
    std::size_t sum = sets_.memory() + held_by(active_, islands_, jointed_, alone_, local_, shared_);
    for (const JointIsland& island : islands_) sum += island.memory();
    return sum;
}

}  // namespace carom::dynamics
