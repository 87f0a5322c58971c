#include <carom/dynamics/detail/contact_solver.hpp>

#include <carom/core/flush_to_zero.hpp>
#include <carom/dynamics/detail/body_kernels.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <utility>

namespace carom::dynamics {
namespace {

constexpr std::int32_t kTouched = -2;
constexpr std::size_t kBodyGrain = 128;
constexpr std::size_t kBundlesAtOnce = 16;
constexpr std::size_t kPointsWorthSharing = 1500;  // with fewer, waiting for each other takes threads longer than they save
constexpr std::size_t kManifoldGrain = 128;

template <std::size_t n>
void set(float (&out)[n], const dvec3& v) {
    out[0] = static_cast<float>(v.x);
    out[1] = static_cast<float>(v.y);
    out[2] = static_cast<float>(v.z);
}

dvec3 as_dvec3(const float (&v)[4]) { return {v[0], v[1], v[2]}; }

/// What a substep changes the velocities of a row by, contacts apart; without the gyroscopic change of a body that gets it otherwise.
void set_kick(SolverBase& base, const BodyArrays& bodies, std::uint32_t slot, bool precesses, const SolverSettings& settings) {
    const BodyState& state = bodies.states[slot];
    const BodyMass& mass = bodies.masses[slot];
    dvec3 turn = precesses ? dvec3{0.0} : gyroscopic_change(state, mass, settings.dt) / static_cast<double>(settings.substeps);
    if (!bodies.traits.empty()) turn += world_inverse_inertia(state, mass) * bodies.traits[slot].torque * settings.substep();
    set(base.turn, turn);
    set(base.kick, bodies.pull(slot, settings.gravity) * settings.substep());
}

/// The double of what the float row held at the start: differences against it keep the low bits of the state.
dvec3 rounded(const dvec3& v) { return dvec3{vec3{v}}; }

}  // namespace

// The bodies as the step begins, and who has rules of his own.
void ContactSolver::begin_rows(const ProxySet& proxies, const BodyArrays& bodies, Executor& executor) {
    gaps_known_ = false;
    moves_listed_ = 0;
    fill_rows(bodies, executor);
    rules_.list(bodies, slot_of_row_, rows_.movable, settings_.substep());
    slender_.list(bodies, slot_of_row_, is_slender_, settings_.dt, settings_.substeps);
    is_left_out_.assign(is_slender_.begin(), is_slender_.end());
    for (const std::uint32_t slot : shared_) is_left_out_[static_cast<std::size_t>(row_of_slot_[slot])] = 1;
    round_.list(proxies, bodies, row_of_slot_, is_left_out_, settings_.dt);
}

void ContactSolver::share(std::span<const std::uint32_t> slots) {
    if (std::ranges::equal(slots, shared_)) return;
    is_whole_ = false;
    shared_.assign(slots.begin(), slots.end());
}

void ContactSolver::prepare(const ContactSet& contacts, std::span<const unsigned char> held, const ProxySet& proxies,
                            const BodyArrays& bodies, const SolverSettings& settings, Executor& executor) {
    settings_ = settings;
    const double h = settings.substep();
    const double frequency = settings.contact_rate / h;
    soft_ = {soft_contact(frequency, settings.damping, h), soft_contact(2.0 * frequency, settings.damping, h)};

    moves_.release();
    point_count_ = contacts.summary.points;
    part_count_ = point_count_ >= kPointsWorthSharing ? std::min(PhaseLoop::part_count(executor), BodyParts::kMostParts) : 1;
    mark_rows(contacts, held, bodies);
    number_rows(contacts, bodies);
    fill_sides(proxies, bodies, executor);
    fill_contact_rows(contacts, executor);
    layouts_.note();
    coloring_.color(contact_rows_, rows_.movable);
    sort_by_points();
    lay_out_bundles();
    fill_lanes(executor);
    put_rows(contacts, proxies, executor);
    begin_rows(proxies, bodies, executor);  // where the sides were
    const PrepareInput input{contacts.points, contacts.impulses, rows_, soft_};
    deep_count_ = 0;
    for_bundles(executor, [&](std::span<ContactBundle> some) {
        prepare_bundles(some, input);
        std::size_t deep = 0;
        for (const ContactBundle& bundle : some) deep += static_cast<std::size_t>(bundle.deep);
        if (deep > 0) std::atomic_ref(deep_count_).fetch_add(deep, std::memory_order_relaxed);
    });
    turning_.finish(rows_);
    settings.resists ? rolling_.list({contacts, proxies, rows_, bundles_}, h) : rolling_.clear();
    is_whole_ = !settings.resists && coloring_.overflow_count() == 0 && std::ranges::find(held, 1) == held.end();
    places_known_ = false;
}

void ContactSolver::mark_rows(const ContactSet& contacts, std::span<const unsigned char> held, const BodyArrays& bodies) {
    row_of_slot_.assign(bodies.roles.size(), kNoRow);
    for (const ContactPair& pair : contacts.pairs) {
        if (!pair.is_solved()) continue;
        for (const std::uint32_t slot : {pair.body_a.slot, pair.body_b.slot}) {
            if (bodies.roles[slot] != Role::Static) row_of_slot_[slot] = kTouched;
        }
    }
    for (std::size_t slot = 0; slot < held.size(); ++slot) {
        if (held[slot] != 0) row_of_slot_[slot] = kNoRow;
    }
    for (const std::uint32_t slot : shared_) row_of_slot_[slot] = kTouched;
}

// Dynamic bodies by their parts, then kinematic ones.
void ContactSolver::number_rows(const ContactSet& contacts, const BodyArrays& bodies) {
    const std::size_t parts = part_count_;
    slot_of_row_.clear();
    std::array<std::uint32_t, BodyParts::kMostParts + 1> next{};
    std::size_t kinematic = 0;
    for (std::uint32_t slot = 0; slot < row_of_slot_.size(); ++slot) {
        if (row_of_slot_[slot] != kTouched) continue;
        if (bodies.roles[slot] == Role::Dynamic) slot_of_row_.push_back(slot);
        if (bodies.roles[slot] == Role::Kinematic) ++kinematic;
    }
    rows_.movable = static_cast<std::int32_t>(slot_of_row_.size());
    parts_.resize(row_of_slot_.size());
    if (parts > 1) parts_.keep_up(slot_of_row_, contacts.pairs, bodies.states, parts);
    for (const std::uint32_t slot : slot_of_row_) ++next[parts_.of(slot) + 1];
    for (std::size_t part = 0; part < BodyParts::kMostParts; ++part) next[part + 1] += next[part];
    part_rows_ = next;
    for (std::size_t part = parts; part < next.size(); ++part) part_rows_[part] = static_cast<std::uint32_t>(rows_.movable);
    slot_of_row_.resize(slot_of_row_.size() + kinematic);
    all_parts_ = part_rows_;
    all_parts_[parts] = static_cast<std::uint32_t>(slot_of_row_.size());
    auto last = static_cast<std::uint32_t>(rows_.movable);
    for (std::uint32_t slot = 0; slot < row_of_slot_.size(); ++slot) {
        if (row_of_slot_[slot] != kTouched) continue;
        const Role role = bodies.roles[slot];
        if (role != Role::Dynamic && role != Role::Kinematic) continue;
        const std::uint32_t row = role == Role::Dynamic ? next[parts_.of(slot)]++ : last++;
        row_of_slot_[slot] = static_cast<std::int32_t>(row);
        slot_of_row_[row] = slot;
    }
}

void ContactSolver::fill_rows(const BodyArrays& bodies, Executor& executor) {
    const std::size_t count = slot_of_row_.size(), movable = static_cast<std::size_t>(rows_.movable);
    is_slender_.assign(movable, 1);
    for (const std::uint32_t slot : shared_) is_slender_[static_cast<std::size_t>(row_of_slot_[slot])] = 0;  // joints turn their bodies as the rows do
    turning_.begin(bodies, slot_of_row_, rows_.turns, settings_.dt, settings_.substeps);
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
            if (part_count_ > 1) parts_.note(slot_of_row_[row], state.pose.position);  // for the next step
            const BodyMass& mass = bodies.masses[slot_of_row_[row]];
            const SymmetricInertia inertia = symmetric_inverse_inertia(state, mass);
            SolverMass& m = rows_.masses[row];
            set(m.diagonal, inertia.diagonal);
            m.diagonal[3] = static_cast<float>(mass.inverse_mass);
            set(m.others, inertia.others);
            const bool joined = is_slender_[row] == 0;
            if (joined) TurningRows::ignore(m);
            const bool turns = !joined && turning_.watch(row, m);
            if (!is_slender(mass)) is_slender_[row] = 0;
            set_kick(rows_.bases[row], bodies, slot_of_row_[row], turns || is_slender_[row] != 0, settings_);
        }
    });
}

void ContactSolver::fill_sides(const ProxySet& proxies, const BodyArrays& bodies, Executor& executor) {
    const std::size_t sides = proxies.by_slot.size();
    rows_.resize(slot_of_row_.size() + 1, bytes_of<Side>(sides));
    std::byte* next = rows_.memory.data();
    sides_ = cut<Side>(next, sides);
    executor.parallel_for(sides_.size(), kBodyGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t slot = begin; slot < end; ++slot) {
            if (proxies.kinds[slot] == ProxyKind::None || bodies.roles[proxies.bodies[slot]] == Role::Asleep) continue;
            sides_[slot] = side_of(static_cast<std::uint32_t>(slot), proxies, bodies);
        }
    });
}

ContactSolver::Side ContactSolver::side_of(std::uint32_t slot, const ProxySet& proxies, const BodyArrays& bodies) const {
    const std::uint32_t body = proxies.bodies[slot];
    const ProxySurface& surface = proxies.surfaces[slot];
    return {.origin = proxies.poses[slot].position,
            .centre = bodies.states[body].pose.position,
            .push = static_cast<float>(settings_.max_push * proxies.extents[slot] / settings_.dt),
            .row = row_or_unmoved(body),
            .friction = surface.surface.friction,
            .friction_rule = surface.surface.friction_rule,
            .is_static = bodies.roles[body] == Role::Static,
            .is_ball = surface.is_ball,
            .is_compound = surface.compound != nullptr};
}

void ContactSolver::fill_contact_rows(const ContactSet& contacts, Executor& executor) {
    const std::size_t count = contacts.manifolds.size();
    resize_scratch(contact_rows_, count);
    resize_scratch(kinds_, count);
    const auto unmoved = static_cast<std::int32_t>(slot_of_row_.size());
    executor.parallel_for(count, kManifoldGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t m = begin; m < end; ++m) {
            const std::uint32_t pair = contacts.manifolds[m].pair;
            contact_rows_[m] = pair == kNoPair ? ContactRows{unmoved, unmoved} : rows_of(contacts.pairs[pair]);
            kinds_[m] = kind_of(contact_rows_[m], pair == kNoPair ? 0 : contacts.solved_points(static_cast<std::uint32_t>(m)));
        }
    });
}

ContactRows ContactSolver::rows_of(const ContactPair& pair) const { return {row_or_unmoved(pair.body_a.slot), row_or_unmoved(pair.body_b.slot)}; }

float ContactSolver::friction_of(const Side& side, std::uint32_t proxy, std::uint16_t part, const ProxySet& proxies) const {
    return side.is_compound ? surface_of_part(proxies.surfaces[proxy], part).friction : side.friction;
}

ManifoldRow ContactSolver::unused_row() const noexcept {
    const auto unmoved = static_cast<std::int32_t>(slot_of_row_.size());
    return {.row_a = unmoved, .row_b = unmoved};
}

void ContactSolver::put_rows(const ContactSet& contacts, const ProxySet& proxies, Executor& executor) {
    executor.parallel_for(contacts.manifolds.size(), kManifoldGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t m = begin; m < end; ++m) {
            if (places_of_[m] == kNowhere) continue;
            ContactBundle& bundle = bundles_[places_of_[m] / kLanesPerBundle];
            const ContactPair& pair = contacts.pairs[contacts.manifolds[m].pair];
            const ManifoldRow row = row_of(contacts, static_cast<std::uint32_t>(m), sides_[pair.proxy_a()], sides_[pair.proxy_b()], proxies);
            put_row(bundle, places_of_[m] % kLanesPerBundle, row);
        }
    });
}

ManifoldRow ContactSolver::row_of(const ContactSet& contacts, std::uint32_t number, const Side& a, const Side& b, const ProxySet& proxies) const {
    const ContactManifold& manifold = contacts.manifolds[number];
    const ContactPair& pair = contacts.pairs[manifold.pair];
    ManifoldRow row;
    row.normal[0] = manifold.normal.x, row.normal[1] = manifold.normal.y, row.normal[2] = manifold.normal.z;
    dvec3 origin_a = a.origin - a.centre, origin_b = a.origin - b.centre;
    // What never moves needs no lever arm of its own, which may be as long as the world and lose the contact's digits.
    if (a.is_static) origin_a = origin_b;
    if (b.is_static) origin_b = origin_a;
    set(row.origin_a, origin_a);
    set(row.origin_b, origin_b);
    row.push_limit = std::min(a.push, b.push);  // of the smaller shape
    row.friction = combine(friction_of(a, pair.proxy_a(), manifold.part_a, proxies), friction_of(b, pair.proxy_b(), manifold.part_b, proxies), a.friction_rule,
                           b.friction_rule, CombineRule::GeometricMean);
    row.round = (a.is_ball ? 1 : 0) + (b.is_ball ? 2 : 0);
    if (row.round == 3) {
        const double apart = glm::length(b.centre - a.centre);  // a positive float's bits are a number above 3; concentric balls have no direction to part in
        row.round = std::bit_cast<std::int32_t>(apart > 0.0 ? static_cast<float>(std::clamp(0.5 / apart, 1e-30, 1e30)) : 1e-30f);
    }
    row.row_a = a.row;
    row.row_b = b.row;
    row.first_point = static_cast<std::int32_t>(manifold.first_point);
    row.count = static_cast<std::int32_t>(contacts.solved_points(number)) + (a.row >= rows_.movable || b.row >= rows_.movable ? ManifoldRow::kMeetsFixed : 0);
    return row;
}

// Of two parts it is the lower one's.
std::uint8_t ContactSolver::kind_of(ContactRows rows, std::uint32_t points) const {
    const auto body = static_cast<std::uint32_t>(std::min(rows.a, rows.b));
    std::size_t part = 0;
    for (std::size_t k = 1; k < part_count_; ++k) part += body >= part_rows_[k] ? 1 : 0;
    return static_cast<std::uint8_t>(part * kKinds + points);
}

void ContactSolver::sort_by_points() {
    const std::size_t parts = part_count_;
    const std::span<const std::uint32_t> order = coloring_.order();
    const std::span<const std::uint32_t> starts = coloring_.starts();
    resize_scratch(lane_order_, order.size());
    std::ranges::copy(order.subspan(starts.back()), lane_order_.begin() + starts.back());  // what found no colour
    std::vector<std::uint32_t>& place = places_;  // of the next one of a part with so many points
    color_parts_.clear();
    for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
        place.assign(parts * kKinds, 0);
        for (std::uint32_t i = starts[c]; i < starts[c + 1]; ++i) ++place[kinds_[order[i]]];
        std::uint32_t next = starts[c];
        for (std::uint32_t& p : place) next += std::exchange(p, next);
        for (std::size_t part = 0; part < parts; ++part)
            color_parts_.push_back((place[part * kKinds] - starts[c] + kLanesPerBundle / 2) / kLanesPerBundle);
        color_parts_.push_back((starts[c + 1] - starts[c] + kLanesPerBundle - 1) / kLanesPerBundle);
        for (std::uint32_t i = starts[c]; i < starts[c + 1]; ++i) lane_order_[place[kinds_[order[i]]]++] = order[i];
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
    resize_scratch(bundles_, bundle_count + coloring_.overflow_count());
    lanes_.resize(bundles_.size());
    for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
        for (std::uint32_t b = 0; b < colors_[c].count; ++b) {
            const std::uint32_t first = starts[c] + b * kLanesPerBundle;
            lanes_[colors_[c].first + b] = {first, std::min(first + kLanesPerBundle, starts[c + 1])};
        }
    }
    for (std::uint32_t i = 0; i < coloring_.overflow_count(); ++i)
        lanes_[first_overflow_bundle_ + i] = {starts.back() + i, starts.back() + i + 1};
    deal_out_points();
}

void ContactSolver::deal_out_points() {
    std::vector<std::uint32_t>& most = places_;  // of each bundle
    most.assign(bundles_.size(), 1);  // where all lanes pass by, passes still read the first
    std::size_t sum = 0;
    for (std::size_t b = 0; b < bundles_.size(); ++b) {
        for (std::uint32_t i = lanes_[b].begin; i < lanes_[b].end; ++i)
            most[b] = std::max(most[b], static_cast<std::uint32_t>(points_of(lane_order_[i])));
        sum += most[b];
    }
    resize_scratch(points_, sum);
    more_points_.resize(std::exchange(room_made_, 0));  // as many as the bundles before this had
    PointLanes* next = points_.data();
    for (std::size_t b = 0; b < bundles_.size(); ++b) next = (bundles_[b].points = next) + most[b];
}

void ContactSolver::fill_lanes(Executor& executor) {
    places_of_.assign(contact_rows_.size(), kNowhere);
    executor.parallel_for(bundles_.size(), kBundlesAtOnce, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            ContactBundle& bundle = bundles_[b];
            const std::size_t count = lanes_[b].end - lanes_[b].begin;
            for (std::size_t lane = 0; lane < count; ++lane) {
                bundle.manifold[lane] = lane_order_[lanes_[b].begin + lane];
                places_of_[bundle.manifold[lane]] = static_cast<Place>(b * kLanesPerBundle + lane);
            }
            for (std::size_t lane = count; lane < kLanesPerBundle; ++lane) {
                bundle.manifold[lane] = kUnusedLane;
                put_row(bundle, lane, unused_row());
            }
        }
    });
}

// Each thread those of its part, colour by colour. So few at a time that they are in the cache when `work` comes back to them.
void ContactSolver::for_bundles(Executor& executor, FunctionRef<void(std::span<ContactBundle> some)> work) {
    const auto work_on = [&](std::size_t first, std::size_t count) {
        for (std::size_t i = 0; i < count; i += kBundlesAtOnce)
            work(std::span{bundles_}.subspan(first + i, std::min(kBundlesAtOnce, count - i)));
    };
    SerialExecutor alone;
    Executor& threads = PhaseLoop::part_count(executor) == part_count_ ? executor : alone;
    const FlushToZero no_denormals;  // as where parts are shared
    if (part_count_ == 1) return work_on(0, bundles_.size());
    const auto work_on_parts = [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t part = begin; part < end; ++part) {
            const std::uint32_t* starts = color_parts_.data() + part;
            for (const Color& color : colors_) {
                work_on(color.first + starts[0], starts[1] - starts[0]);
                starts += part_count_ + 1;
            }
            if (part == 0) work_on(first_overflow_bundle_, bundles_.size() - first_overflow_bundle_);
        }
    };
    const std::array<Phase, 1> one{Phase{.count = part_count_}};
    loop_.run(one, threads, work_on_parts, {});
}

void ContactSolver::carry_gaps(ContactSet& contacts, Executor& executor) {
    for_bundles(executor, [&](std::span<ContactBundle> some) { dynamics::carry_gaps(some, contacts.manifolds, contacts.points, soft_); });
}

void ContactSolver::store(BodyArrays& bodies, ContactSet& contacts, Executor& executor) {
    round_.show(rows_);
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
    slender_.store(bodies);
    turning_.store(bodies);
    for_bundles(executor, [&](std::span<ContactBundle> some) { store_impulses(some, contacts.manifolds, contacts.impulses); });
    rows_.release();
}

}  // namespace carom::dynamics
