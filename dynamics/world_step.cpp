// The step, on one page. docs/step.md explains each stage.
#include <carom/core/check.hpp>
#include <carom/dynamics/detail/contact_writer.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/room.hpp>
#include <carom/dynamics/detail/step.hpp>
#include <carom/dynamics/detail/world_impl.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <utility>

namespace carom {

using dynamics::Role;

namespace {

constexpr std::size_t kBodyGrain = 128;

void count_contacts(StepReport& report, const dynamics::ContactSet& contacts, const dynamics::ContactSolver& solver) {
    const dynamics::ContactSummary& summary = contacts.summary;
    report.manifolds = contacts.manifold_count();
    report.contacts = summary.points;
    report.touching = summary.touching;
    report.max_penetration = summary.max_penetration;
    report.mean_penetration = summary.mean_penetration;
    report.overflow = solver.overflow_count();
    report.deep = solver.deep_count();
}

Balance balance_of(const World& world) { return {world.energy(), world.momentum()}; }

Balance operator-(const Balance& after, const Balance& before) {
    return {{after.energy.kinetic - before.energy.kinetic, after.energy.potential - before.energy.potential},
            {after.momentum.linear - before.momentum.linear, after.momentum.angular - before.momentum.angular}};
}

}  // namespace

// Moves every body that no contact and no joint holds, and the kinematic ones, over the whole step at once.
void World::Impl::integrate_free_bodies(bool contacts_found, double dt) {
    const bool follows = contacts_found && (def.continuous.enabled || def.record_paths);
    free_bodies.clear();
    for (std::uint32_t slot = 0; slot < arrays.roles.size(); ++slot) {
        const Role role = arrays.roles[slot];
        const auto held = [&] { return joint_solver.holds(slot) || (contacts_found && (solver.holds(slot) || direct.holds(slot))); };
        if (role == Role::Kinematic || (role == Role::Dynamic && !held())) free_bodies.push_back(slot);
    }
    if (follows) continuous.prepare(arrays.states.size(), free_bodies);
    threads().parallel_for(free_bodies.size(), kBodyGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::uint32_t slot = free_bodies[k];
            if (follows) continuous.depart(slot, arrays.states[slot]);
            dynamics::integrate_free(arrays.states[slot], arrays.masses[slot], free_motion(slot), dt);
            if (follows) continuous.arrive(slot, arrays.states[slot]);
        }
    });
}

void World::Impl::follow(dynamics::Step& step, double dt) {
    const auto start = [&](std::uint32_t slot) -> const Pose& { return last_valid[slot].pose; };
    const auto velocity = [&](std::uint32_t slot) -> const dvec3& { return last_valid[slot].velocity; };
    const auto motion = [&](std::uint32_t slot) { return free_motion(slot); };
    const auto parted = [&](std::uint32_t a, std::uint32_t b) { return joints.parts_any() && joints.parts(a, b); };
    const auto wake_slot = [&](std::uint32_t slot) { sleepers.wake(slot, arrays); };
    const dynamics::ContinuousScene scene{proxies, broadphase, arrays, dt, threads(), start, velocity, motion, parted, wake_slot};
    const auto write_down = [&] {
        if (!def.record_paths) return;
        continuous.record(scene, paths);
        paths.parted = joints.parted();
        paths.ids.assign(arrays.roles.size(), BodyId{});
        for (const BodyId id : body_order) paths.ids[id.slot] = id;
    };
    if (!def.continuous.enabled) return write_down();
    step.run(Stage::Continuous, [&] {
        const bool anybody = continuous.look(scene);
        write_down();
        if (anybody) continuous.run(scene);
    });
    step.report.continuous = continuous.counts();
}

void World::Impl::note_substep(double dt) noexcept {
    constexpr double kStiffening = 1.0 / 80.0;  // of the time that passes: over some ten periods of the contacts
    soft_substep = std::max(dt / def.substeps, soft_substep - kStiffening * dt);
}

// Contacts between bodies whose joint leaves them out.
void World::Impl::drop_parted() {
    candidates.erase_if([&](const NumberedPair& pair) { return joints.parts(proxies.bodies[pair.a], proxies.bodies[pair.b]); });
}

void World::Impl::forget_pushes() {
    if (!std::exchange(pushed, false)) return;
    for (dynamics::BodyTraits& traits : arrays.traits) traits.force = traits.torque = dvec3{0.0};
}

// Whether what was applied to the body leaves its speed and spin where a step can follow them.
bool World::Impl::can_be_pushed(std::uint32_t slot, double dt) const noexcept {
    if (arrays.traits.empty() || arrays.roles[slot] != Role::Dynamic) return true;
    const dynamics::BodyState& state = arrays.states[slot];
    const double pull = glm::length(arrays.acceleration(slot, def.gravity));
    const dvec3 turn = dynamics::world_inverse_inertia(state, arrays.masses[slot]) * arrays.traits[slot].torque;
    return pull * dt <= dynamics::kMostSpeed && pull * dt * dt <= dynamics::kMostDistance &&
           (glm::length(state.spin) + glm::length(turn) * dt) * dt <= dynamics::kMostTurn;
}

void World::Impl::quarantine_unusable(double dt, StepReport& report) {
    last_valid.resize(arrays.states.size());
    const auto note = [&](std::size_t begin, std::size_t end) {
        bool all_usable = true;
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint32_t slot = body_order[i].slot;
            if (arrays.roles[slot] == Role::Absent || arrays.roles[slot] == Role::Asleep) continue;
            const dynamics::BodyState& state = arrays.states[slot];
            if (dynamics::is_usable(state, dt) && can_be_pushed(slot, dt)) {
                last_valid[slot] = {state.pose, state.velocity};
            } else {
                all_usable = false;
            }
        }
        return all_usable;
    };
    std::atomic<bool> all_usable{true};
    threads().parallel_for(body_order.size(), kBodyGrain, [&](std::size_t begin, std::size_t end) {
        if (!note(begin, end)) all_usable.store(false, std::memory_order_relaxed);
    });
    if (all_usable.load(std::memory_order_relaxed)) return;
    for (const BodyId id : body_order) {
        const std::uint32_t slot = id.slot;
        if (arrays.roles[slot] == Role::Absent || arrays.roles[slot] == Role::Asleep) continue;
        dynamics::BodyState& state = arrays.states[slot];
        if (dynamics::is_usable(state, dt) && can_be_pushed(slot, dt)) continue;
        state = {last_valid[slot].pose, dvec3{0.0}, dvec3{0.0}};
        take_out(id);
        arrays.roles[slot] = Role::Absent;
        bodies.find(id)->quarantined = true;
        report.quarantined.push_back(id);
    }
}

// What lists of a step hold beyond what it needed.
void World::Impl::trim_lists() {
    constexpr std::size_t kManyPairs = 1024;
    contacts.trim();
    solver.trim();
    direct.trim();
    scratch.trim();
    if (whole_looks.take_seldom()) {
        dynamics::drop(contacts.firsts);
        if (patched && broadphase.result().pairs.size() > kManyPairs) collide_scratch = {};  // it has room for a thousand at a time, and remembers none
    }
    dynamics::trim_kept(last_manifolds);
    dynamics::trim_scratch(found_manifolds);
    dynamics::trim_kept(names.now);
    dynamics::trim_scratch(names.before);
    contact_changes.trim();
    passing.trim();
    dynamics::trim_scratch(free_bodies);
    continuous.trim();
}

// Who touches whom, with the impulses of the step before.
void World::Impl::find_contacts(dynamics::Step& step, const dynamics::Motion& motion) {
    bool reuses = false;  // contacts of the step before
    bool keeps = false;   // most contacts are
    step.run(Stage::Bounds, [&] { dynamics::update_swept_bounds(proxies, arrays, motion, calm_rule(), threads()); });
    step.run(Stage::Pairs, [&] {
        const ProxyChanges changes{proxies.boxes, proxies.filters, proxies.moved, proxies.removed};
        const std::uint64_t last = broadphase.result().number;
        const PairUpdate& update = broadphase.update(changes, threads());
        if (update.number == last) {  // refused, which was reported: the next step asks again
            dynamics::note_refused(proxies);
            pairs_complete = false;
            candidates.release();
            return names.now.clear();
        }
        dynamics::note_listed(proxies);
        step.report.boxes_given = changes.moved.size();
        step.report.boxes_removed = changes.removed.size();
        step.report.pairs_limited = update.status != PairStatus::Complete;
        pairs_complete = !step.report.pairs_limited;
        dynamics::list_candidates(proxies, arrays, update.pairs, motion.dt, threads(), candidate_parts, candidates);
        if (joints.parts_any()) drop_parted();
        if (sleepers.is_on()) dynamics::Sleepers::drop_idle(proxies, arrays, candidates);
        step.report.pairs = candidates.size();
        keeps = choose_looked(motion.dt);
        reuses = !keeps && def.contact_reuse > 0.0 && dynamics::name_candidates(proxies, def.contact_reuse, candidates, names, threads());
    });
    patched = keeps;
    if (keeps) return step.run(Stage::Collide, [&] { patch_contacts(step); });
    whole_looks.note();
    if (!std::exchange(taken_over, true)) take_over_contacts(step);
    step.run(Stage::Collide, [&] {
        const PlacedShapes placed{proxies.shapes, proxies.poses, true};
        dynamics::ContactWriter writer(contacts);
        const auto take = [&](std::size_t i, std::span<const Manifold> found) {
            for (const Manifold& manifold : found) writer.add(manifold, static_cast<std::uint32_t>(i));
        };
        CollideCounts counts;
        if (reuses) {  // these are kept whole, for the next step
            counts = collide(placed, candidates, last_manifolds, threads(), collide_scratch, found_manifolds);
            for (const Manifold& manifold : found_manifolds) writer.add(manifold, manifold.pair);
            std::swap(last_manifolds, found_manifolds);
        } else {
            counts = collide(placed, candidates, threads(), collide_scratch, take);
        }
        writer.finish();
        step.report.undecided = counts.undecided;
        step.report.reused = counts.reused;
        const auto pair_of = [&](std::uint32_t i) { return dynamics::contact_pair(proxies, candidates[i]); };
        dynamics::link_manifolds(contacts, pair_of, previous, impulse_scale(motion.dt), threads());
        candidates.release();
    });
}

void World::Impl::find_passing(dynamics::Step& step, const dynamics::Motion& motion) {
    step.run(Stage::Collide, [&] { passing.find(contacts, patched ? &contact_changes : nullptr, proxies, arrays, motion, threads()); });
    step.report.passing = passing.pairs().size();
}

// Contacts, and joints of bodies in contact, substep by substep.
void World::Impl::solve_contacts(dynamics::Step& step, double dt) {
    const bool joined = !joint_solver.shared().empty();  // to bodies in contact
    solver.share(joint_solver.shared());
    step.run(Stage::Prepare, [&] {
        const dynamics::SolverSettings settings = solver_settings(dt);
        if (patched && solver.resume(contacts, contact_changes, direct.held(), proxies, arrays, settings, threads())) return;
        solver.prepare(contacts, direct.held(), proxies, arrays, settings, threads());
    });
    const auto run = [&] { solver.run_listed(threads(), step.report.stage_ms); };  // joints come in between, or else all is run at once
    const auto joints_do = [&](const auto& work) {
        run();
        step.run(Stage::Joints, work);
    };
    const int relaxations = def.relax ? solver.relaxations() : 0;
    // In one order a Gauss-Seidel pass errs to one side, so half of the substeps go backward; of an odd number one more or less by turns. Relax takes out a push
    // from the side that it came from: where that is strong, turning round would leave half as much energy again.
    const bool turns_round = solver.deep_count() == 0;
    const bool in_turns = def.substeps % 2 == 1 && steps % 2 == 1;
    for (int k = 0; k < def.substeps; ++k) {
        const bool backward = turns_round && (2 * k >= def.substeps) != in_turns;
        solver.list_velocities(k == 0 ? dynamics::WarmStart::First : dynamics::WarmStart::Again);
        if (k == 0) solver.list_warm_start();
        if (k == 0 && joined) joints_do([&] { joint_solver.warm_start(solver, threads()); });
        solver.list_pass(true, backward);
        if (joined) joints_do([&] { joint_solver.solve(solver, k, threads()); });
        solver.list_positions();
        for (int pass = 0; pass < relaxations; ++pass) solver.list_pass(false, backward);
        if (joined && def.relax) joints_do([&] { joint_solver.relax(solver, k, threads()); });
    }
    run();
    step.run(Stage::Store, [&] { solver.store(arrays, contacts, threads()); });
    count_contacts(step.report, contacts, solver);
}

StepReport World::step(double dt) {
    CAROM_REQUIRE(is_finite(dt), ErrorCode::NotFinite, "dt must be finite", {});
    CAROM_REQUIRE(dt >= 0.0, ErrorCode::InvalidArgument, "dt must not be negative", {});
    CAROM_REQUIRE(dynamics::can_step(dt, impl_->def.gravity), ErrorCode::InvalidArgument, dynamics::kTooLong, {});
    if (dt == 0.0) return {};

    Impl& w = *impl_;
    const auto take_step = [&] {
        try {
            return w.take_step(*this, dt);
        } catch (...) {
            w.give_up_step();
            throw;
        }
    };
    if (w.executor().thread_count() == 1) return take_step();
    const bool shared = w.def.plan == PlanMode::Everything || w.share_choice.next(w.body_order.size());
    const auto begin = std::chrono::steady_clock::now();
    StepReport report;
    const auto work = [&] { report = take_step(); };
    shared ? w.team.run(w.executor(), work) : work();
    report.total_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    w.share_choice.took(report.total_ms, shared);
    return report;
}

// Memory that ran out, an executor or an error handler that threw: any list may be half written.
void World::Impl::give_up_step() noexcept {
    contacts.clear();
    previous.clear();
    last_manifolds.clear(), found_manifolds.clear();
    candidates.release();
    names.now.clear();
    broadphase.clear();
    dynamics::note_cleared(proxies);
    passing.clear();
    direct.clear();
    joint_solver.clear();
    solver.forget();
    sleepers.wake_all(arrays);
    paths.is_there = false;
    contacts_hold = looked_for_contacts = false;
}

// Bodies that others than the contact solver moved, and those that pass by each other: the next step looks at them again.
void World::Impl::mark_displaced(const dynamics::StepChoices& choices) {
    displaced.assign(arrays.roles.size(), 0);
    if (choices.contacts && choices.restitution) impacts.mark_placed(displaced);
    if (choices.continuous) {
        for (const std::uint32_t slot : continuous.displaced()) displaced[slot] = 1;
    }
    if (!choices.contacts) return;
    for (const std::uint32_t p : passing.pairs()) {
        CAROM_ASSERT(p < contacts.pairs.size());
        displaced[contacts.pairs[p].body_a.slot] = displaced[contacts.pairs[p].body_b.slot] = 1;
    }
}

StepReport World::Impl::take_step(const World& world, double dt) {
    Impl& w = *this;
    w.note_substep(dt);
    Executor& executor = w.threads();
    dynamics::Step step(dt);
    step.run(Stage::Quarantine, [&] { w.quarantine_unusable(dt, step.report); });
    if (w.sleepers.is_on()) step.run(Stage::Sleep, [&] { w.wake_before_step(dt); });
    w.contacts_held = std::exchange(w.contacts_hold, false);  // until the step is over, whatever is thrown in it
    const dynamics::StepChoices choices = w.choose();
    const dynamics::Motion motion{w.def.gravity, dt};
    const Balance before = w.def.report_balance ? balance_of(world) : Balance{};
    if (w.def.report_residual) w.residual.remember(w.arrays);
    w.taken_over = w.patched = false;
    w.carries = !w.names.now.empty();
    if (!choices.contacts) {  // otherwise each part is replaced below
        w.previous.clear();
        w.contacts.clear();
        w.names.now.clear();
        w.direct.clear();
    }

    if (choices.contacts) {
        do w.find_contacts(step, motion);
        while (w.wake_touched());  // again, with what woke
        w.previous.clear();
        w.find_passing(step, motion);
    }
    if (choices.joints) {
        step.run(Stage::Joints, [&] { w.joint_solver.gather(w.joints, w.arrays, w.def.direct_budget); });
    } else {
        w.joint_solver.clear();
    }
    if (choices.contacts) {
        if (choices.restitution) {
            step.run(Stage::Restitution, [&] { w.impacts.run(w.contacts, w.proxies, w.arrays, motion, w.joint_solver.jointed()); });
            step.report.impacts = w.impacts.count();
            step.report.impacts_left = w.impacts.left();
        }
        const dynamics::DirectStep direct_step = w.direct_step(dt);
        const dynamics::DirectWorld islands{w.contacts, w.proxies, w.arrays, w.joint_solver.jointed()};
        bool stiff = false;
        step.run(Stage::Islands, [&] { stiff = w.direct.choose(islands, direct_step, {w.def.contact_method, w.def.direct_budget}); });
        if (stiff) step.run(Stage::Direct, [&] { w.direct.solve(islands, direct_step, executor); });
        step.report.direct = w.direct.counts();
    }
    if (choices.joints) {
        step.run(Stage::Joints, [&] {
            w.joint_solver.begin(w.joints, w.arrays, {w.contacts, w.direct.held()}, w.joint_step(dt));
            w.joint_solver.run_alone(w.arrays, executor);
        });
    }
    if (choices.contacts) w.solve_contacts(step, dt);
    if (choices.joints) {
        step.run(Stage::Joints, [&] { w.joint_solver.finish(w.joints); });
        step.report.joints = w.joint_solver.counts();
    }
    step.run(Stage::Positions, [&] { w.integrate_free_bodies(choices.contacts, dt); });
    if (choices.contacts && choices.restitution) step.run(Stage::Restitution, [&] { w.impacts.place(w.arrays); });
    w.paths.is_there = false;
    if (choices.continuous || (choices.contacts && w.def.record_paths)) w.follow(step, dt);
    if (w.def.report_residual) step.report.residual = w.residual.measure(w.contacts, w.proxies, w.arrays, {w.def.gravity, dt, w.def.substeps}, w.joint_solver.jointed());
    w.forget_pushes();
    step.run(Stage::Quarantine, [&] { w.quarantine_unusable(dt, step.report); });

    w.contacts_hold = choices.contacts && w.calm_rule().share > 0.0 && w.pairs_complete && step.report.quarantined.empty();
    w.mark_displaced(choices);  // by the contacts' numbers, which are others once some fell asleep
    if (w.sleepers.is_on()) step.run(Stage::Sleep, [&] { w.fall_asleep(dt, step.report); });
    w.last_substep = dt / w.def.substeps;
    w.looked_for_contacts = choices.contacts;
    step.report.step = ++w.steps;
    if (w.steps % dynamics::kTrimEvery == 0) w.trim_lists();
    if (!step.report.quarantined.empty()) step.report.residual.reset();
    if (w.def.report_balance && step.report.quarantined.empty()) step.report.balance = balance_of(world) - before;
    return step.finish();
}

}  // namespace carom
