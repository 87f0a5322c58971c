#include <carom/dynamics/detail/contact_solver.hpp>

#include <carom/dynamics/detail/body_kernels.hpp>
#include <carom/dynamics/detail/integrator.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace carom::dynamics {
namespace {

constexpr std::size_t kBodyGrain = 128;
constexpr std::size_t kBundleGrain = 32;  // some 10 µs to prepare
constexpr std::size_t kPassBundleGrain = 4;
constexpr std::size_t kPointsOfAColor = 800;  // in the mean; with fewer, waiting for each other takes threads longer than they save
constexpr std::size_t kManifoldGrain = 128;

template <std::size_t n>
void set(float (&out)[n], const dvec3& v) {
    out[0] = static_cast<float>(v.x);
    out[1] = static_cast<float>(v.y);
    out[2] = static_cast<float>(v.z);
}

dvec3 as_dvec3(const float (&v)[4]) { return {v[0], v[1], v[2]}; }

/// What a substep changes the velocities of a row by, contacts apart.
void set_kick(SolverBase& base, const BodyArrays& bodies, std::uint32_t slot, const SolverSettings& settings) {
    const BodyState& state = bodies.states[slot];
    const BodyMass& mass = bodies.masses[slot];
    dvec3 turn = gyroscopic_change(state, mass, settings.dt) / static_cast<double>(settings.substeps);
    if (!bodies.traits.empty()) turn += world_inverse_inertia(state, mass) * bodies.traits[slot].torque * settings.substep();
    set(base.turn, turn);
    set(base.kick, free_moves(mass.locked) * bodies.acceleration(slot, settings.gravity) * settings.substep());
}

/// The double of what the float row held at the start: differences against it keep the low bits of the state.
dvec3 rounded(const dvec3& v) { return dvec3{vec3{v}}; }

}  // namespace

void ContactSolver::prepare(const ContactSet& contacts, std::span<const unsigned char> held, const ProxySet& proxies,
                            const BodyArrays& bodies, const SolverSettings& settings, Executor& executor) {
    settings_ = settings;
    gaps_known_ = false;
    const double h = settings.substep();
    const double frequency = settings.contact_rate / h;
    soft_ = soft_contact(frequency, settings.damping, h);
    soft_fixed_ = soft_contact(2.0 * frequency, settings.damping, h);

    assign_rows(contacts, held, bodies);
    fill_rows(bodies, executor);
    rules_.list(bodies, slot_of_row_, rows_.movable, h);
    fill_sides(proxies, bodies, executor);
    fill_manifold_rows(contacts, executor);
    coloring_.color(contact_rows_, rows_.movable);
    sort_by_points(PhaseLoop::part_count(executor));
    lay_out_bundles();
    const PrepareInput input{manifold_rows_, contacts.manifolds, contacts.impulses, rows_, soft_, soft_fixed_};
    executor.parallel_for(bundles_.size(), kBundleGrain, [&](std::size_t begin, std::size_t end) {
        prepare_bundles(std::span{bundles_}.subspan(begin, end - begin), input);
    });
    settings.resists ? rolling_.list({contacts, proxies, rows_, bundles_}, h) : rolling_.clear();
    point_count_ = contacts.summary.points;
    deep_count_ = 0;
    for (const ContactBundle& bundle : bundles_) deep_count_ += static_cast<std::size_t>(bundle.deep);
}

void ContactSolver::assign_rows(const ContactSet& contacts, std::span<const unsigned char> held, const BodyArrays& bodies) {
    constexpr std::int32_t kTouched = -2;
    row_of_slot_.assign(bodies.roles.size(), kNoRow);
    for (const ContactPair& pair : contacts.pairs) {
        if (pair.flies) continue;
        for (const std::uint32_t slot : {pair.body_a.slot, pair.body_b.slot}) {
            if (bodies.roles[slot] != Role::Static) row_of_slot_[slot] = kTouched;
        }
    }
    for (std::size_t slot = 0; slot < held.size(); ++slot) {
        if (held[slot] != 0) row_of_slot_[slot] = kNoRow;
    }
    for (const std::uint32_t slot : shared_) row_of_slot_[slot] = kTouched;
    slot_of_row_.clear();
    for (const Role role : {Role::Dynamic, Role::Kinematic}) {
        for (std::uint32_t slot = 0; slot < row_of_slot_.size(); ++slot) {
            if (row_of_slot_[slot] != kTouched || bodies.roles[slot] != role) continue;
            row_of_slot_[slot] = static_cast<std::int32_t>(slot_of_row_.size());
            slot_of_row_.push_back(slot);
        }
        if (role == Role::Dynamic) rows_.movable = static_cast<std::int32_t>(slot_of_row_.size());
    }
}

void ContactSolver::fill_rows(const BodyArrays& bodies, Executor& executor) {
    const std::size_t count = slot_of_row_.size();
    rows_.bodies.resize(count + 1);
    rows_.masses.resize(count + 1);
    rows_.bases.resize(count + 1);
    executor.parallel_for(count + 1, kBodyGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            rows_.bodies[row] = {};
            rows_.masses[row] = {};
            rows_.bases[row] = {};
            if (row == count) continue;  // what never moves
            const BodyState& state = bodies.states[slot_of_row_[row]];
            set(rows_.bodies[row].velocity, state.velocity);
            set(rows_.bodies[row].spin, state.spin);
            if (row >= static_cast<std::size_t>(rows_.movable)) continue;
            const BodyMass& mass = bodies.masses[slot_of_row_[row]];
            const SymmetricInertia inertia = symmetric_inverse_inertia(state, mass);
            SolverMass& m = rows_.masses[row];
            set(m.diagonal, inertia.diagonal);
            m.diagonal[3] = static_cast<float>(mass.inverse_mass);
            set(m.others, inertia.others);
            set_kick(rows_.bases[row], bodies, slot_of_row_[row], settings_);
        }
    });
}

// What a manifold's row needs of a shape.
void ContactSolver::fill_sides(const ProxySet& proxies, const BodyArrays& bodies, Executor& executor) {
    sides_.resize(proxies.by_slot.size());
    executor.parallel_for(sides_.size(), kBodyGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t slot = begin; slot < end; ++slot) {
            if (proxies.kinds[slot] == ProxyKind::None) continue;
            const std::uint32_t body = proxies.bodies[slot];
            if (bodies.roles[body] == Role::Asleep) continue;
            const std::int32_t row = row_of_slot_[body];
            sides_[slot] = {.origin = proxies.poses[slot].position,
                            .centre = bodies.states[body].pose.position,
                            .of = proxies.surfaces[slot],
                            .push = static_cast<float>(settings_.max_push * proxies.extents[slot] / settings_.dt),
                            .row = row == kNoRow ? static_cast<std::int32_t>(slot_of_row_.size()) : row,
                            .is_static = bodies.roles[body] == Role::Static};
        }
    });
}

void ContactSolver::fill_manifold_rows(const ContactSet& contacts, Executor& executor) {
    const std::size_t count = contacts.manifolds.size();
    contact_rows_.resize(count);
    manifold_rows_.resize(count + 1);
    manifold_rows_[count] = {.row_a = static_cast<std::int32_t>(slot_of_row_.size()),
                             .row_b = static_cast<std::int32_t>(slot_of_row_.size())};
    executor.parallel_for(count, kManifoldGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t m = begin; m < end; ++m) {
            const ContactPair& pair = contacts.pairs[contacts.manifolds[m].pair];
            manifold_rows_[m] = row_of(contacts.manifolds[m], sides_[pair.proxy_a], sides_[pair.proxy_b]);
            contact_rows_[m] = {manifold_rows_[m].row_a, manifold_rows_[m].row_b};
        }
    });
}

ManifoldRow ContactSolver::row_of(const Manifold& manifold, const Side& a, const Side& b) const {
    ManifoldRow row;
    row.normal[0] = manifold.normal.x, row.normal[1] = manifold.normal.y, row.normal[2] = manifold.normal.z;
    dvec3 origin_a = a.origin - a.centre, origin_b = a.origin - b.centre;
    // What never moves needs no lever arm of its own, which may be as long as the world and lose the contact's digits.
    if (a.is_static) origin_a = origin_b;
    if (b.is_static) origin_b = origin_a;
    set(row.origin_a, origin_a);
    set(row.origin_b, origin_b);
    row.push_limit = std::min(a.push, b.push);  // of the smaller shape
    const Surface surface_a = surface_of_part(a.of.surface, a.of.compound, manifold.part_a);
    const Surface surface_b = surface_of_part(b.of.surface, b.of.compound, manifold.part_b);
    row.friction =
        combine(surface_a.friction, surface_b.friction, surface_a.friction_rule, surface_b.friction_rule, CombineRule::GeometricMean);
    row.round = (a.of.is_ball ? 1 : 0) + (b.of.is_ball ? 2 : 0);
    row.row_a = a.row;
    row.row_b = b.row;
    row.count = static_cast<std::int32_t>(manifold.count);
    row.meets_fixed = a.row >= rows_.movable || b.row >= rows_.movable ? 1 : 0;
    return row;
}

void ContactSolver::sort_by_points(std::size_t parts) {
    const std::span<const std::uint32_t> order = coloring_.order();
    const std::span<const std::uint32_t> starts = coloring_.starts();
    lane_order_.assign(order.begin(), order.end());
    constexpr std::size_t kKinds = kMaxManifoldPoints + 1;
    const std::uint64_t parts_of_a_row = (std::uint64_t{parts} << 32) / static_cast<std::uint64_t>(std::max(1, rows_.movable));  // in 2^-32
    std::vector<std::uint32_t>& place = places_;  // of the next one of a part with so many points
    const auto kind = [&](std::uint32_t m) {
        const ManifoldRow& row = manifold_rows_[m];
        const auto body = static_cast<std::uint64_t>(std::min(row.row_a, row.row_b));
        return std::min<std::size_t>(parts - 1, body * parts_of_a_row >> 32) * kKinds + (kMaxManifoldPoints - static_cast<std::size_t>(row.count));
    };
    for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
        place.assign(parts * kKinds, 0);
        for (std::uint32_t i = starts[c]; i < starts[c + 1]; ++i) ++place[kind(order[i])];
        std::uint32_t next = starts[c];
        for (std::uint32_t& p : place) next += std::exchange(p, next);
        for (std::uint32_t i = starts[c]; i < starts[c + 1]; ++i) lane_order_[place[kind(order[i])]++] = order[i];
    }
}

void ContactSolver::lay_out_bundles() {
    colors_.clear();
    const std::span<const std::uint32_t> starts = coloring_.starts();
    std::uint32_t bundle_count = 0;
    for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
        const std::uint32_t bundles = (starts[c + 1] - starts[c] + kLanesPerBundle - 1) / kLanesPerBundle;
        colors_.push_back({bundle_count, bundles});
        bundle_count += bundles;
    }
    first_overflow_bundle_ = bundle_count;
    bundles_.resize(bundle_count + coloring_.overflow_count());
    for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
        for (std::uint32_t b = 0; b < colors_[c].count; ++b) {
            for (std::uint32_t lane = 0; lane < kLanesPerBundle; ++lane) {
                const std::uint32_t i = starts[c] + b * kLanesPerBundle + lane;
                bundles_[colors_[c].first + b].manifold[lane] = i < starts[c + 1] ? lane_order_[i] : kUnusedLane;
            }
        }
    }
    for (std::uint32_t i = 0; i < coloring_.overflow_count(); ++i) {
        ContactBundle& bundle = bundles_[first_overflow_bundle_ + i];
        bundle.manifold.fill(kUnusedLane);
        bundle.manifold[0] = lane_order_[starts.back() + i];
    }
}

void ContactSolver::list(std::size_t count, std::size_t grain, Stage stage, const Task& task) {
    phases_.push_back({.count = count, .grain = grain, .label = static_cast<int>(stage)});
    tasks_.push_back(task);
}

void ContactSolver::list_velocities(WarmStart warm_start) {
    list(static_cast<std::size_t>(rows_.movable), kBodyGrain, Stage::Velocities, {.work = Work::Kick, .warm_start = warm_start});
    if (rules_.damp_any()) list(1, 1, Stage::Velocities, {.work = Work::Damp});
}

void ContactSolver::list_contacts(Stage stage, const Task& task) {
    for (const Color& color : colors_) {
        Task of_color = task;
        of_color.first_bundle = color.first;
        list(color.count, kPassBundleGrain, stage, of_color);
    }
    Task rest = task;
    rest.work = task.work == Work::WarmStart ? Work::WarmStartRest : Work::SolveRest;
    if (first_overflow_bundle_ < bundles_.size() || !rolling_.is_empty() || rules_.lock_any()) list(1, 1, stage, rest);
}

void ContactSolver::list_warm_start() { list_contacts(Stage::WarmStart, {.work = Work::WarmStart}); }

void ContactSolver::list_pass(bool bias) {
    const SolveSettings settings{.inverse_h = static_cast<float>(1.0 / settings_.substep()), .bias = bias, .gaps_known = gaps_known_};
    list_contacts(bias ? Stage::Solve : Stage::Relax, {.work = Work::Solve, .settings = settings});
    gaps_known_ = true;
}

void ContactSolver::list_positions() {
    gaps_known_ = false;
    list(slot_of_row_.size(), kBodyGrain, Stage::Positions, {.work = Work::Advance});
}

void ContactSolver::run_listed(Executor& executor, std::span<double> milliseconds) {
    SerialExecutor alone;
    Executor& threads = point_count_ < kPointsOfAColor * std::max<std::size_t>(1, colors_.size()) ? alone : executor;
    loop_.run(
        phases_, threads, [this](std::size_t phase, std::size_t begin, std::size_t end) { run_task(tasks_[phase], begin, end); },
        milliseconds);
    phases_.clear();
    tasks_.clear();
}

void ContactSolver::run_task(const Task& task, std::size_t begin, std::size_t end) {
    const std::span<ContactBundle> all{bundles_};
    const std::span<ContactBundle> overflow = all.subspan(first_overflow_bundle_);  // these may share bodies
    const auto bundles = [&] { return all.subspan(task.first_bundle + begin, end - begin); };
    switch (task.work) {
        case Work::Kick:
            kick(rows_, begin, end, task.warm_start);
            break;
        case Work::Damp:
            rules_.damp(rows_);
            break;
        case Work::WarmStart:
            dynamics::warm_start(bundles(), rows_);
            break;
        case Work::Solve:
            dynamics::solve(bundles(), rows_, task.settings);
            break;
        case Work::WarmStartRest:
            for (std::size_t i = 0; i < overflow.size(); ++i) dynamics::warm_start(overflow.subspan(i, 1), rows_);
            rolling_.warm_start(rows_);
            rules_.lock(rows_);
            break;
        case Work::SolveRest:
            for (std::size_t i = 0; i < overflow.size(); ++i) dynamics::solve(overflow.subspan(i, 1), rows_, task.settings);
            rolling_.solve(rows_, bundles_);
            rules_.lock(rows_);
            break;
        case Work::Advance:
            advance(rows_, begin, end, static_cast<float>(settings_.substep()));
            break;
    }
}

void ContactSolver::store(BodyArrays& bodies, ContactSet& contacts, Executor& executor) const {
    executor.parallel_for(static_cast<std::size_t>(rows_.movable), kBodyGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const SolverBody& r = rows_.bodies[row];
            BodyState& state = bodies.states[slot_of_row_[row]];
            state.velocity += as_dvec3(r.velocity) - rounded(state.velocity);
            state.spin += as_dvec3(r.spin) - rounded(state.spin);
            state.pose.position += as_dvec3(r.shift);
            const dquat turn{r.turn[3], r.turn[0], r.turn[1], r.turn[2]};
            state.pose.orientation = glm::normalize(turn * state.pose.orientation);
        }
    });
    executor.parallel_for(bundles_.size(), kBundleGrain, [&](std::size_t begin, std::size_t end) {
        store_impulses(std::span{bundles_}.subspan(begin, end - begin), contacts.impulses);
    });
}

}  // namespace carom::dynamics
