// The events of the continuous stage: who meets whom next, and what comes of it.
#include <carom/dynamics/detail/continuous.hpp>

#include <carom/collision/aabb.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

// In a step; what comes then stops where it is.
constexpr std::int64_t kLeastBudget = 1024, kBudgetPerBody = 64;     // impacts
constexpr std::int64_t kLeastPairs = 16384, kPairsPerBody = 256;     // times of impact
constexpr std::int64_t kLeastPieces = 65536, kPiecesPerBody = 1024;  // pieces of paths that are looked at for them
constexpr std::size_t kChancesPerPair = 16;                          // bounds of times of impact, for each time of impact that may be asked for
constexpr int kNoBlow = 0, kPush = 1, kImpact = 16;  // what goes to a body's account: what is kinematic goes on, and must not find it standing still
constexpr double kMarginShare = 1e-3;     // of the same: how far points of contact are looked for beyond that

}  // namespace

void Continuous::run(const ContinuousScene& scene) {
    const std::size_t slots = scene.bodies.roles.size();
    runs_.note();
    mover_of_slot_.assign(slots, kNone);
    mover_count_ = 0;
    events_.clear();
    chances_.clear();
    crowd_ = no_crowd_ = false;
    if (finders_.empty()) finders_.resize(1);
    looks_ = 0;
    const auto followed = static_cast<std::int64_t>(fast_.size());
    budget_ = kLeastBudget + kBudgetPerBody * followed;
    most_pairs_ = static_cast<std::size_t>(kLeastPairs + kPairsPerBody * followed);
    most_chances_ = kChancesPerPair * most_pairs_;
    chance_count_ = 0;
    pieces_left_ = kLeastPieces + kPiecesPerBody * followed;
    cores_.forget_unused();
    list_strays(scene);
    search_from_start(scene);
    while (!events_.empty() || !chances_.empty()) {
        if (events_.empty() || (!chances_.empty() && chances_.front().t <= events_.front().t)) {
            take_chance(scene);
            continue;
        }
        std::pop_heap(events_.begin(), events_.end(), Event::later);
        const Event event = events_.back();
        events_.pop_back();
        resolve(scene, event);
    }
    for (std::uint32_t i = 0; i < mover_count_; ++i) {
        if (!movers_[i].changed) continue;
        BodyState& state = scene.bodies.states[movers_[i].slot] = state_at(scene, movers_[i], 1.0);
        slow_at_end(scene, state);
        displaced_.push_back(movers_[i].slot);
        note_leg(i, 1.0);
    }
    paths_ = nullptr;
}

// As the shapes are, whatever their paths may bend.
bool Continuous::overlap_at_start(const ContinuousScene& scene, const Pair& pair, int level) {
    const auto still = [&](std::uint32_t proxy) {
        const Proxy& p = scene.proxies.by_slot[proxy];
        const PathPiece whole = movers_[mover_of_slot_[scene.proxies.bodies[proxy]]].path.piece(BodyPath::kWhole);
        return MovingShape{&p.shape, shape_motion(cut(whole, whole.begin, whole.begin), p.local.get())};
    };
    return first_touch(still(pair.a), level, still(pair.b), {}, cores_).status == ImpactStatus::Overlapping;
}

// What is so deep in each other that next to nothing of one is apart from the other is held by its contacts alone, if it was so from the start; what has
// come there goes no farther, nor what spins so fast that its path is not known better.
void Continuous::search_deeper(const ContinuousScene& scene, const Pair& pair, double from, int level) {
    if (level + 1 < kLevels) return search(scene, pair, from, level + 1);
    if (from == 0.0 && level < kMiddle && overlap_at_start(scene, pair, level) && !overlap_at_start(scene, pair, kMiddle)) {
        return search(scene, pair, from, kMiddle);  // what the step before stopped at the last level
    }
    if (from == 0.0 && overlap_at_start(scene, pair, level)) {
        ++counts_.overlapping;
        if (paths_ != nullptr) paths_->deep.push_back({pair.a, pair.b});
        return;
    }
    const std::uint32_t numbers[2]{mover_of_slot_[scene.proxies.bodies[pair.a]], mover_of_slot_[scene.proxies.bodies[pair.b]]};
    for (int k = 0; k < 2; ++k) {
        const std::uint32_t number = numbers[k], slot = movers_[number].slot;
        if (!has_mass(scene.bodies.roles[slot]) || movers_[number].stopped) continue;
        strike(scene, number, from, {state_at(scene, movers_[number], from), StopCause::Depth, kNoBlow, carrier_of(scene, numbers[1 - k])});
        search_all(scene, number, from, kNone);
    }
    // What is carried may be carried deeper.
    meeting_.points.clear();
    const Event event{from, pair, 0, movers_[numbers[0]].version, movers_[numbers[1]].version, {}, 0.0};
    if (!go_together(scene, numbers[0], numbers[1]) && come_nearer(scene, event)) {
        join(scene, numbers[0], numbers[1], from, state_at(scene, movers_[numbers[0]], from));
    }
}

// Where the two touch, by the narrowphase; where it finds nothing because the time is a little early, and of what is thinned, by the search.
void Continuous::find_points(const ContinuousScene& scene, const Event& event, const BodyState& a, const BodyState& b) {
    const Proxy &proxy_a = scene.proxies.by_slot[event.pair.a], &proxy_b = scene.proxies.by_slot[event.pair.b];
    const ProxySurface &surface_a = scene.proxies.surfaces[event.pair.a], &surface_b = scene.proxies.surfaces[event.pair.b];
    const bool mesh = type_of(proxy_a.shape) == ShapeType::TriangleMesh;
    meeting_.points.clear();
    if (event.level == 0 || event.impact.normal == dvec3{0.0}) {
        const Pose pose_a = a.pose * proxy_a.local.get(), pose_b = b.pose * proxy_b.local.get();
        const double margin = event.bend + (kSweepToleranceShare + kMarginShare) * size_of(scene, event.pair);
        manifolds_.clear();
        collide({&proxy_a.shape, &proxy_b.shape, pose_a, pose_b, static_cast<float>(margin)}, 0, manifolds_);
        if (mesh && manifolds_.empty()) return;  // only its hull is there
        for (const Manifold& m : manifolds_) {
            const Surface surface = combine(surface_of_part(surface_a, m.part_a), surface_of_part(surface_b, m.part_b));
            for (const ContactPoint& p : m.used()) {
                if (!mesh) meeting_.points.push_back({pose_a.position + dvec3{p.position}, dvec3{m.normal}, surface.friction, surface.restitution});
            }
        }
    }
    if (!meeting_.points.empty()) return;
    const Surface surface = combine(surface_a.surface, surface_b.surface);
    if (event.impact.normal != dvec3{0.0}) {
        meeting_.points.push_back({event.impact.point, event.impact.normal, surface.friction, surface.restitution});
    } else if (const dvec3 between = a.velocity - point_velocity(b, a.pose.position); between != dvec3{0.0}) {  // no direction is known but the one that must not be gone on
        meeting_.points.push_back({a.pose.position, glm::normalize(between), 0.0, 0.0});
    }
}

void Continuous::resolve(const ContinuousScene& scene, const Event& event) {
    const std::uint32_t slot_a = scene.proxies.bodies[event.pair.a], slot_b = scene.proxies.bodies[event.pair.b];
    const std::uint32_t number_a = mover_of_slot_[slot_a], number_b = mover_of_slot_[slot_b];
    const Mover &a = movers_[number_a], &b = movers_[number_b];
    const bool b_gives_way = has_mass(scene.bodies.roles[slot_b]);
    if (a.version != event.version_a || b.version != event.version_b ) return;
    if (a.stopped && (b.stopped || !b_gives_way)) return carry(scene, event);
    BodyState state_a = state_at(scene, a, event.t), state_b = state_at(scene, b, event.t);
    find_points(scene, event, state_a, state_b);
    meeting_.a = meeter_of(state_a, scene.bodies.masses[slot_a], true);
    meeting_.b = meeter_of(state_b, scene.bodies.masses[slot_b], b_gives_way);
    bool stop = a.stopped || b.stopped, blow = false;
    if (meeting_.approaches(kSlowShare * size_of(scene, event.pair) / scene.dt)) {
        ++counts_.impacts;
        --budget_;
        blow = true;
        meeting_.resolve();
        if (event.level > 0) {
            part(scene, event, state_a.pose, state_b.pose);
            ++counts_.parted;
        }
    } else if (stop) {  // only what comes nearer to where the other stands
        if (!come_nearer(scene, event)) return search_deeper(scene, event.pair, event.t, event.level);
    } else if (a.flies && (b.flies || !b_gives_way)) {
        return search_deeper(scene, event.pair, event.t, event.level);
    }
    state_a.velocity = meeting_.a.velocity, state_a.spin = meeting_.a.spin;
    state_b.velocity = meeting_.b.velocity, state_b.spin = meeting_.b.spin;
    if (blow || stop) note_impact(scene, event, blow);
    // A chord that is laid anew is no blow, and each is laid anew once.
    const int to_a = !blow ? kNoBlow : scene.bodies.roles[slot_b] == Role::Kinematic ? kPush : kImpact;
    const StopCause cause = stop ? StopCause::Partner : StopCause::None;
    const std::uint32_t onto_a = carrier_of(scene, number_a), onto_b = carrier_of(scene, number_b);
    strike(scene, number_a, event.t, {state_a, cause, to_a, onto_b});
    if (b_gives_way) strike(scene, number_b, event.t, {state_b, cause, blow ? kImpact : kNoBlow, onto_a});
    const Around both[]{{number_a, kNone}, {number_b, slot_a}};
    search_around(scene, std::span{both}.first(b_gives_way ? 2 : 1), event.t);
}

// The rest of the step begins anew for a body that was struck, or whose chord would go on where its velocity does not. What the solver had moved
// has had its share of gravity. What meets a body that is stopped stops as well.
void Continuous::strike(const ContinuousScene& scene, std::uint32_t number, double t, const Outcome& outcome) {
    Mover& mover = movers_[number];
    if (scene.bodies.roles[mover.slot] == Role::Asleep) scene.wake(mover.slot);
    if (!mover.flies) mover.flight.motion = {.acceleration = pull_on(scene, mover.slot), .spin_tolerance = scene.free_motion(mover.slot).spin_tolerance};
    if (!mover.stopped || mover.carrier != kNone || mover.slides || outcome.carrier != kNone || outcome.slide) {
        note_leg(number, t);
        mover.since = t;
    }
    mover.flight.start = outcome.state;
    mover.flies = mover.changed = true;
    ++mover.version;
    mover.impacts += outcome.account;
    const double turn = glm::length(outcome.state.spin) * scene.dt;
    if (turn > kMostTurn) {
        mover.flight.start.spin *= kSlowedTurn / turn;
        ++counts_.slowed;
    }
    const bool too_many = mover.impacts >= kImpact * settings_.most_impacts;
    if (!mover.stopped && (outcome.stop != StopCause::None || too_many || budget_ <= 0)) {
        mover.stopped = true;
        ++counts_.stopped;
        note_stop(mover, t, outcome.stop != StopCause::None ? outcome.stop : too_many ? StopCause::Impacts : StopCause::Budget);
    }
    if (mover.stopped && !mover.crushed && outcome.carrier != kNone && may_ride(scene, mover.slot)) {
        if (mover.carrier == kNone && !mover.slides && mover.ways == 0) ++counts_.carried;
        mover.slides = false;
        const PathPiece& way = movers_[outcome.carrier].path.piece(BodyPath::kWhole);
        mover.carrier = outcome.carrier;
        mover.ride = {way, inverse(pose_at(way, t)) * outcome.state.pose};
    } else if (outcome.slide) {
        mover.slides = true;
        mover.slide = *outcome.slide;
        mover.carrier = kNone;
    } else if (mover.carrier != kNone) {
        mover.ride.local = inverse(pose_at(mover.ride.carrier, t)) * outcome.state.pose;  // it may have been moved apart
    }
    lay_path(scene, mover);
    if (number_of_stray_[mover.slot] == kNone) strays_.push_back(mover.slot);
    note_way(scene, mover.slot, mover.path);
}

void Continuous::note_leg(std::uint32_t number, double end) {
    if (paths_ == nullptr) return;
    const Mover& mover = movers_[number];
    paths_->legs.push_back({mover.slot, mover.since, end, mover.flies && !mover.stopped, mover.carrier != kNone, mover.flight, mover.ride, mover.path.piece(BodyPath::kWhole)});
}

void Continuous::note_stop(const Mover& mover, double t, StopCause cause) {
    if (paths_ == nullptr) return;
    FollowFinding& follow = paths_->bodies[mover.slot].follow;
    follow.stopped = cause;
    follow.stopped_at = t;
}

void Continuous::note_impact(const ContinuousScene& scene, const Event& event, bool blow) {
    if (paths_ == nullptr) return;
    const std::uint32_t slot_a = scene.proxies.bodies[event.pair.a], slot_b = scene.proxies.bodies[event.pair.b];
    PathImpact& impact = paths_->impacts.emplace_back();
    impact.t = event.t;
    impact.a = event.pair.a, impact.b = event.pair.b;
    impact.id_a = scene.proxies.owners[impact.a].shape, impact.id_b = scene.proxies.owners[impact.b].shape;
    impact.level = event.level;
    impact.status = event.impact.status;
    impact.margin = event.bend + kSweepToleranceShare * size_of(scene, event.pair);
    if (!meeting_.points.empty()) impact.point = meeting_.points.front().at, impact.normal = meeting_.points.front().normal;
    impact.blow = blow;
    impact.pose_a = state_at(scene, movers_[mover_of_slot_[slot_a]], event.t).pose;
    impact.pose_b = state_at(scene, movers_[mover_of_slot_[slot_b]], event.t).pose;
    if (!blow) return;
    ++paths_->bodies[slot_a].follow.impacts;
    ++paths_->bodies[slot_b].follow.impacts;
}

}  // namespace carom::dynamics
