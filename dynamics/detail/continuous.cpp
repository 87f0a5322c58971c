#include <carom/dynamics/detail/continuous.hpp>

#include <carom/dynamics/detail/room.hpp>
#include <carom/dynamics/detail/slender.hpp>
#include <carom/dynamics/detail/strays.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace carom::dynamics {
namespace {

// By how much a piece of a path may bend: shares of the smallest extent, and of the reach.
constexpr double kBendShare = 0.01, kReachShare = 2e-4;
constexpr double kTolerance = 1e-4;  // of the energy of a free rotation

constexpr std::size_t kSlotGrain = 256;

/// Replaces `slots` by those that are marked, ascending.
void list_marked(std::span<const unsigned char> marks, std::vector<std::uint32_t>& slots) {
    slots.clear();
    for (std::uint32_t slot = 0; slot < marks.size(); ++slot) {
        if (marks[slot] != 0) slots.push_back(slot);
    }
}

/// How far a point of a body may be from where it was, at most.
double motion_of(const Pose& from, const BodyState& to, double reach, double dt) noexcept {
    return glm::length(to.pose.position - from.position) + reach * std::min(glm::length(to.spin) * dt, 2.0);
}

}  // namespace

void Continuous::begin(std::uint32_t slot, Continuity continuity) {
    if (continuity == Continuity::Automatic && slot >= wishes_.size()) return;
    if (slot >= wishes_.size()) wishes_.resize(slot + 1, Continuity::Automatic);
    wishes_[slot] = continuity;
}

void Continuous::prepare(std::size_t slots, std::span<const std::uint32_t> free) {
    departure_of_slot_.resize(slots, 0);
    departures_.resize(free.size());
    for (std::uint32_t k = 0; k < free.size(); ++k) {
        departures_[k].slot = free[k];
        departure_of_slot_[free[k]] = k;
    }
}

void Continuous::list_bodies(const ContinuousScene& scene) {
    const std::size_t slots = scene.bodies.roles.size();
    list_body_sizes(scene.proxies, slots, sizes_);
    first_proxy_.assign(slots + 1, 0);
    const auto for_each_proxy = [&](const auto& visit) {
        for (std::uint32_t i = 0; i < scene.proxies.by_slot.size(); ++i) {
            if (scene.proxies.kinds[i] != ProxyKind::None) visit(i, scene.proxies.bodies[i]);
        }
    };
    for_each_proxy([&](std::uint32_t, std::uint32_t body) { ++first_proxy_[body + 1]; });
    for (std::size_t slot = 0; slot < slots; ++slot) first_proxy_[slot + 1] += first_proxy_[slot];
    proxies_.resize(first_proxy_.back());
    std::vector<std::uint32_t> next(first_proxy_.begin(), first_proxy_.end() - 1);
    for_each_proxy([&](std::uint32_t proxy, std::uint32_t body) { proxies_[next[body]++] = proxy; });
    smallest_ = std::numeric_limits<double>::infinity();
    for (std::size_t slot = 0; slot < slots; ++slot) {
        if (has_mass(scene.bodies.roles[slot]) && sizes_[slot].extent > 0.0) smallest_ = std::min(smallest_, sizes_[slot].extent);
    }
    sizes_known_ = true;
}

bool Continuous::has_plane(const ContinuousScene& scene, std::uint32_t slot) const {
    return std::any_of(proxies_.begin() + first_proxy_[slot], proxies_.begin() + first_proxy_[slot + 1],
                       [&](std::uint32_t proxy) { return scene.proxies.kinds[proxy] == ProxyKind::Plane; });
}

double Continuous::way_of(const ContinuousScene& scene, std::uint32_t slot) const {
    const BodyState& state = scene.bodies.states[slot];
    const double reach = scene.bodies.roles[slot] == Role::Kinematic && has_plane(scene, slot) ? std::numeric_limits<double>::max() : sizes_[slot].reach;
    const double motion = motion_of(scene.start(slot), state, reach, scene.dt);
    const Departure* const departure = departure_of(slot);
    if (departure == nullptr) return motion;
    const BodyState& start = departure->start;  // there and back is far too
    const double way = std::max(glm::length(start.velocity), glm::length(state.velocity)) * scene.dt;
    return std::max(motion, way + reach * std::min(glm::length(start.spin) * scene.dt, 2.0));
}

// What is kinematic may be as large as it likes: it is fast where a small body could be passed over.
double Continuous::limit_of(const ContinuousScene& scene, std::uint32_t slot) const {
    return settings_.motion * (scene.bodies.roles[slot] == Role::Kinematic ? smallest_ : sizes_[slot].extent);
}

bool Continuous::is_fast(const ContinuousScene& scene, std::uint32_t slot) const {
    const Role role = scene.bodies.roles[slot];
    const Continuity wish = continuity(slot);
    if (!moves(role) || wish == Continuity::Never || first_proxy_[slot] == first_proxy_[slot + 1]) return false;
    const BodySize& size = sizes_[slot];
    if (role == Role::Dynamic && wish == Continuity::Automatic && departure_of(slot) == nullptr) {  // most bodies, without a root: (x + y)² <= 2 (x² + y²)
        const BodyState& state = scene.bodies.states[slot];
        const dvec3 way = state.pose.position - scene.start(slot).position;
        const double turn = size.reach * scene.dt, least = settings_.motion * size.extent;
        if (2.0 * (glm::dot(way, way) + turn * turn * glm::dot(state.spin, state.spin)) <= least * least) return false;
    }
    const double limit = wish == Continuity::Always ? 0.0 : limit_of(scene, slot);
    const dvec3 way = scene.bodies.states[slot].pose.position - scene.start(slot).position;
    if (glm::dot(way, way) > (1.0 + 0x1p-40) * limit * limit) return true;  // without a root
    return way_of(scene, slot) > limit;
}

FollowFinding Continuous::finding_of(const ContinuousScene& scene, std::uint32_t slot) const {
    FollowFinding finding{.reason = Following::OutOfStep, .continuity = continuity(slot)};
    const Role role = scene.bodies.roles[slot];
    if (role == Role::Absent) return finding;
    finding.flew = flies(scene, slot);
    finding.reason = role == Role::Static ? Following::Static : role == Role::Asleep ? Following::Asleep : Following::NoShapes;
    if (!moves(role) || first_proxy_[slot] == first_proxy_[slot + 1]) return finding;
    finding.motion = way_of(scene, slot);
    finding.limit = limit_of(scene, slot);
    const bool fast = finding.motion > finding.limit, wanted = finding.continuity == Continuity::Always || fast;
    finding.reason = finding.motion == 0.0 ? Following::Still
                     : !wanted ? Following::Slow
                     : !settings_.enabled ? Following::Off
                     : finding.continuity == Continuity::Never ? Following::Never
                                                               : Following::Followed;
    return finding;
}

void Continuous::record(const ContinuousScene& scene, StepPaths& paths) {
    if (!sizes_known_) list_bodies(scene);
    paths.is_there = true;
    paths.dt = scene.dt;
    paths.sizes = sizes_;
    paths.legs.clear(), paths.impacts.clear(), paths.deep.clear();
    paths.bodies.clear();
    for (std::uint32_t slot = 0; slot < scene.bodies.roles.size(); ++slot) {
        BodyStep& body = paths.bodies.emplace_back();
        body.role = scene.bodies.roles[slot];
        body.follow.reason = Following::OutOfStep;
        if (body.role == Role::Absent || !is_usable(scene.bodies.states[slot], scene.dt)) continue;
        body.moved = scene.bodies.states[slot];
        body.start = body.moved;
        body.start.pose = moves(body.role) ? scene.start(slot) : body.moved.pose;
        body.flies = flies(scene, slot);
        if (body.flies) body.start = departure_of(slot)->start;
        body.motion = scene.free_motion(slot);
        body.mass = scene.bodies.masses[slot];
        body.principal = scene.bodies.principal(slot);
        body.follow = finding_of(scene, slot);
    }
    paths_ = &paths;
}

bool Continuous::look(const ContinuousScene& scene) {
    counts_ = {};
    displaced_.clear();
    if (!sizes_known_) list_bodies(scene);
    is_fast_.resize(scene.bodies.roles.size());
    std::atomic<std::size_t> slowed{0};
    scene.executor.parallel_for(is_fast_.size(), kSlotGrain, [&](std::size_t begin, std::size_t end) {
        for (auto slot = static_cast<std::uint32_t>(begin); slot < end; ++slot) {
            is_fast_[slot] = is_fast(scene, slot) ? 1 : 0;
            if (is_fast_[slot] == 0 || is_usable(scene.bodies.states[slot], scene.dt)) continue;
            is_fast_[slot] = slow_down(scene, slot) ? 1 : 0;
            slowed.fetch_add(is_fast_[slot], std::memory_order_relaxed);
        }
    });
    counts_.slowed = slowed.load(std::memory_order_relaxed);
    list_marked(is_fast_, fast_);
    counts_.followed = fast_.size();
    return !fast_.empty();
}

// A kinematic body goes where its velocity takes it, and what moves less than gravity may move it stays in its boxes.
bool Continuous::goes_astray(const ContinuousScene& scene, std::uint32_t slot) const {
    if (scene.bodies.roles[slot] != Role::Dynamic) return false;
    const BodyWay step{scene.start(slot), scene.start_velocity(slot), scene.bodies.states[slot], scene.dt};
    const auto proxies = std::span{proxies_}.subspan(first_proxy_[slot], first_proxy_[slot + 1] - first_proxy_[slot]);
    const auto at_a_glance = [&](std::uint32_t proxy) { return surely_stays(scene.proxies, proxy, step); };
    const auto first = std::find_if_not(proxies.begin(), proxies.end(), at_a_glance);
    if (first == proxies.end()) return false;
    const auto is_astray = [&](std::uint32_t proxy) { return strays(scene.proxies, proxy, step); };
    if (!is_astray(*first) && std::none_of(first + 1, proxies.end(), [&](std::uint32_t proxy) { return !at_a_glance(proxy) && is_astray(proxy); })) {
        return false;
    }
    const double pulled = glm::length(scene.free_motion(slot).acceleration) * scene.dt * scene.dt;
    return is_usable(step.to, scene.dt) && motion_of(step.from, step.to, sizes_[slot].reach, scene.dt) > pulled;
}

void Continuous::list_strays(const ContinuousScene& scene) {
    is_stray_.resize(scene.bodies.roles.size());
    scene.executor.parallel_for(is_stray_.size(), kSlotGrain, [&](std::size_t begin, std::size_t end) {
        for (auto slot = static_cast<std::uint32_t>(begin); slot < end; ++slot) {
            is_stray_[slot] = goes_astray(scene, slot) ? 1 : 0;
        }
    });
    list_marked(is_stray_, strays_);
    number_of_stray_.assign(is_stray_.size(), kNone);
    stray_boxes_.clear();
    for (const std::uint32_t slot : strays_) note_way(scene, slot, movers_[mover_of(scene, slot)].path);
}

// The velocity that the solver leaves is that of the step's end: what falls has it from all of the step's gravity, what rests has none of it.
dvec3 Continuous::pull_on(const ContinuousScene& scene, std::uint32_t slot) const {
    const dvec3 pull = free_moves(scene.bodies.masses[slot].locked) * scene.free_motion(slot).acceleration, gain = scene.dt * pull;
    const double square = glm::dot(gain, gain);
    return square > 0.0 ? std::clamp(glm::dot(scene.bodies.states[slot].velocity, gain) / square, 0.0, 1.0) * pull : dvec3{0.0};
}

BodyState Continuous::state_at(const ContinuousScene& scene, const Mover& mover, double t) const {
    if (mover.carrier != kNone) return mover.ride.after(mover.flight.start, mover.since, t, scene.dt);
    if (mover.slides) return {pose_at(mover.path.piece(BodyPath::kWhole), t), mover.flight.start.velocity, mover.flight.start.spin};
    if (mover.stopped) return mover.flight.start;
    if (mover.flies) {
        if (t == 1.0 && mover.since < 1.0) return mover.path.end();
        BodyState state = mover.flight.start;
        if (t > mover.since) integrate_free(state, scene.bodies.masses[mover.slot], mover.flight.motion, (t - mover.since) * scene.dt);
        return state;
    }
    if (scene.bodies.roles[mover.slot] == Role::Static) return scene.bodies.states[mover.slot];
    BodyState state = scene.bodies.states[mover.slot];
    const BodyMass& mass = scene.bodies.masses[mover.slot];
    if (has_mass(scene.bodies.roles[mover.slot])) state.velocity -= (1.0 - t) * scene.dt * pull_on(scene, mover.slot);
    if (has_mass(scene.bodies.roles[mover.slot]) && is_slender(mass)) {
        return slender_before(state, mass, pose_at(mover.path.piece(BodyPath::kWhole), t), (1.0 - t) * scene.dt);
    }
    const dquat end = state.pose.orientation;
    state.pose = pose_at(mover.path.piece(BodyPath::kWhole), t);
    if (!has_mass(scene.bodies.roles[mover.slot]) || (mass.locked & kLockedTurns) != 0) {
        state.spin = rotate(state.pose.orientation, rotate_inverse(end, state.spin));  // in the body, with which it turns
    } else if (mass.inertia != InertiaClass::Isotropic) {
        // What it was if the body turned freely since. Carried to the attitude that it had it keeps the energy, and the angular momentum but for what contacts turned.
        Rotation then{end, state.spin};
        rotate_free(then, mass, (t - 1.0) * scene.dt, {.tolerance = kTolerance});
        state.spin = rotate(state.pose.orientation, rotate_inverse(then.orientation, then.spin));
    }
    return state;
}

// Bodies that bounced have been moved since.
bool Continuous::flies(const ContinuousScene& scene, std::uint32_t slot) const {
    const Departure* const departure = departure_of(slot);
    return departure != nullptr && moves(scene.bodies.roles[slot]) && departure->end == scene.bodies.states[slot].pose.position;
}

PathSettings path_settings(const BodySize& size, double dt) {
    const double extent = size.extent < std::numeric_limits<double>::infinity() ? size.extent : size.reach;
    return {dt, size.reach, std::max(kBendShare * extent, kReachShare * size.reach), size.out_of_round};
}

void Continuous::lay_path(const ContinuousScene& scene, Mover& mover) const {
    const BodyState& now = scene.bodies.states[mover.slot];
    if (mover.carrier != kNone) {
        mover.path.ride(mover.ride, mover.since, path_settings(sizes_[mover.slot], scene.dt));
    } else if (mover.slides) {
        mover.path.go({.begin = mover.since, .start = mover.flight.start.pose, .translation = (1.0 - mover.since) * mover.slide});
    } else if (mover.stopped) {
        mover.path.go({.begin = mover.since, .start = mover.flight.start.pose});
    } else if (mover.flies) {
        const BodyState* const arrived = mover.changed ? nullptr : &now;  // what flew and met nothing yet is where the integrator took it
        mover.path.fly(mover.flight, scene.bodies.masses[mover.slot], mover.since, path_settings(sizes_[mover.slot], scene.dt), arrived);
    } else if (moves(scene.bodies.roles[mover.slot])) {
        mover.path.go(chord(scene.start(mover.slot), now.pose, scene.dt * now.spin));
    } else {
        mover.path.go({.start = now.pose});
    }
    mover.course = course_of(mover.path);
}

std::uint32_t Continuous::mover_of(const ContinuousScene& scene, std::uint32_t slot) {
    std::uint32_t& number = mover_of_slot_[slot];
    if (number != kNone) return number;
    number = static_cast<std::uint32_t>(mover_count_++);
    if (movers_.size() < mover_count_) movers_.resize(mover_count_);
    Mover& mover = movers_[number];
    mover.slot = slot;
    mover.since = 0.0;
    mover.flies = mover.changed = mover.stopped = mover.crushed = mover.slides = false;
    mover.carrier = kNone;
    mover.impacts = mover.ways = 0;
    mover.version = 0;  // the path keeps its memory
    if (flies(scene, slot)) {
        mover.flies = true;
        mover.flight = {departure_of(slot)->start, scene.free_motion(slot)};
    } else {
        mover.flight = {};
    }
    lay_path(scene, mover);
    return number;
}

bool Continuous::keep_company(const ContinuousScene& scene, std::uint32_t slot_a, std::uint32_t slot_b) const {
    if (continuity(slot_a) == Continuity::Always || continuity(slot_b) == Continuity::Always) return false;
    const auto& roles = scene.bodies.roles;
    const BodyState &a = scene.bodies.states[slot_a], &b = scene.bodies.states[slot_b];
    const auto way = [&](std::uint32_t slot) { return moves(roles[slot]) ? scene.bodies.states[slot].pose.position - scene.start(slot).position : dvec3{0.0}; };
    double extent = std::numeric_limits<double>::infinity();
    for (const std::uint32_t slot : {slot_a, slot_b}) {
        if (has_mass(roles[slot])) extent = std::min(extent, sizes_[slot].extent);
    }
    const double limit = settings_.motion * extent;
    const dvec3 came = way(slot_a) - way(slot_b);
    if (glm::dot(came, came) > (1.0 + 0x1p-40) * limit * limit) return false;  // without a root
    double motion = std::max(glm::length(came), glm::length(a.velocity - b.velocity) * scene.dt);
    const Departure *const flew_a = departure_of(slot_a), *const flew_b = departure_of(slot_b);
    if (flew_a != nullptr || flew_b != nullptr) {
        const dvec3 from_a = flew_a != nullptr ? flew_a->start.velocity : a.velocity, from_b = flew_b != nullptr ? flew_b->start.velocity : b.velocity;
        motion = std::max(motion, glm::length(from_a - from_b) * scene.dt);
    }
    for (const std::uint32_t slot : {slot_a, slot_b}) {
        const Departure* const flew = slot == slot_a ? flew_a : flew_b;
        const double spin = std::max(glm::length(scene.bodies.states[slot].spin), flew != nullptr ? glm::length(flew->start.spin) : 0.0);
        if (spin == 0.0) continue;
        double reach = sizes_[slot].reach;
        if (roles[slot] == Role::Kinematic && has_plane(scene, slot)) {  // as far from what it turns about as the other may come
            const std::uint32_t other = slot == slot_a ? slot_b : slot_a;
            const auto at = [&](std::uint32_t s) { return moves(roles[s]) ? scene.start(s).position : scene.bodies.states[s].pose.position; };
            reach = std::max(reach, glm::length(at(slot_a) - at(slot_b)) + motion + sizes_[other].reach);
        }
        motion += reach * std::min(spin * scene.dt, 2.0);
    }
    return motion <= limit;
}

bool Continuous::stay_together(const ContinuousScene& scene, std::uint32_t slot_a, std::uint32_t slot_b) const {
    double motion = 0.0, extent = std::numeric_limits<double>::infinity();
    dvec3 velocity[2]{dvec3{0.0}, dvec3{0.0}};
    int side = 0;
    for (const std::uint32_t slot : {slot_a, slot_b}) {
        const Role role = scene.bodies.roles[slot];
        const Mover* const mover = mover_of_slot_[slot] == kNone ? nullptr : &movers_[mover_of_slot_[slot]];
        const BodyState& state = mover != nullptr && mover->flies ? mover->flight.start : scene.bodies.states[slot];
        const bool meets_kinematic = scene.bodies.roles[slot == slot_a ? slot_b : slot_a] == Role::Kinematic;
        if (mover != nullptr && mover->stopped && (mover->carrier != kNone || mover->slides || meets_kinematic)) return false;
        if (state.spin != dvec3{0.0} && role == Role::Kinematic && has_plane(scene, slot)) return false;  // seldom, so a search is no loss
        if (moves(role) && (mover == nullptr || !mover->stopped)) {
            velocity[side] = state.velocity;
            motion += sizes_[slot].reach * std::min(glm::length(state.spin) * scene.dt, 2.0);
        }
        if (has_mass(role)) extent = std::min(extent, sizes_[slot].extent);
        ++side;
    }
    return motion + glm::length(velocity[0] - velocity[1]) * scene.dt <= settings_.motion * extent;
}

}  // namespace carom::dynamics
