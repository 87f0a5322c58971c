#include <carom/dynamics/detail/sleepers.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace carom::dynamics {
namespace {

/// Islands are looked for this often in the time that they must be still for.
constexpr double kLooks = 8.0;

bool moves_others(const BodyArrays& bodies, std::uint32_t slot) noexcept {
    return bodies.roles[slot] == Role::Kinematic && stirs(bodies, slot);
}

bool pushes(const ContactPair& pair, const ContactSet& contacts) noexcept {
    for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
        for (const PointImpulse& impulse : contacts.impulses_of(m)) {
            if (impulse.normal > 0.0f) return true;
        }
    }
    return false;
}

}  // namespace

void Sleepers::begin(std::uint32_t slot, bool may_sleep, const BodyState& state) {
    if (still_.size() <= slot) {
        const std::size_t size = std::size_t{slot} + 1;
        still_.resize(size);
        sizes_.resize(size);
        may_sleep_.resize(size);
        ring_.resize(size);
    }
    may_sleep_[slot] = may_sleep ? 1 : 0;
    start_anew(still_[slot], state);
}

void Sleepers::wake(std::uint32_t slot, BodyArrays& bodies) noexcept {
    if (bodies.roles[slot] != Role::Asleep) return start_anew(still_[slot], bodies.states[slot]);
    std::uint32_t next = slot;
    do {
        bodies.roles[next] = Role::Dynamic;
        start_anew(still_[next], bodies.states[next]);
        next = ring_[next];
        --count_;
        ++woken_;
    } while (next != slot);
    roles_changed_ = contacts_wait_ = true;
}

void Sleepers::wake_all(BodyArrays& bodies) noexcept {
    for (std::uint32_t slot = 0; slot < bodies.roles.size(); ++slot) {
        if (bodies.roles[slot] == Role::Asleep) wake(slot, bodies);
    }
    asleep_.clear();
}

void Sleepers::wake_touching(std::uint32_t slot, BodyArrays& bodies) noexcept {
    for (const ContactPair& pair : asleep_.pairs) {
        const std::uint32_t a = pair.body_a.slot, b = pair.body_b.slot;
        if (a == slot && bodies.roles[b] == Role::Asleep) wake(b, bodies);
        if (b == slot && bodies.roles[a] == Role::Asleep) wake(a, bodies);
    }
}

void Sleepers::wake_by_others(const ProxySet& proxies, double dt, BodyArrays& bodies) {
    if (count_ > 0) {
        for (const std::uint32_t proxy : placed_) wake_near(proxies, proxy, dt, bodies);
        for (const std::uint32_t plane : proxies.planes) {
            if (moves_others(bodies, proxies.bodies[plane])) wake_near(proxies, plane, dt, bodies);
        }
        for (const ContactPair& pair : asleep_.pairs) {
            if (moves_others(bodies, pair.body_a.slot) && bodies.roles[pair.body_b.slot] == Role::Asleep) wake(pair.body_b.slot, bodies);
            if (moves_others(bodies, pair.body_b.slot) && bodies.roles[pair.body_a.slot] == Role::Asleep) wake(pair.body_a.slot, bodies);
        }
    }
    placed_.clear();
}

void Sleepers::wake_near(const ProxySet& proxies, std::uint32_t proxy, double dt, BodyArrays& bodies) {
    if (proxies.kinds[proxy] == ProxyKind::None) return;
    const Proxy& other = proxies.by_slot[proxy];
    const BodyState& owner = bodies.states[proxies.bodies[proxy]];
    const Pose pose = owner.pose * other.local.get();
    const bool is_plane = proxies.kinds[proxy] == ProxyKind::Plane;
    const Aabb box = is_plane ? Aabb{} : bounds(other.shape, pose);
    const dvec3 normal = is_plane ? rotate(pose.orientation, dvec3{std::get<Plane>(other.shape).normal}) : dvec3{0.0};
    for (std::uint32_t slot = 0; slot < bodies.roles.size(); ++slot) {
        if (bodies.roles[slot] != Role::Asleep) continue;
        const dvec3& at = bodies.states[slot].pose.position;
        const double reach = sizes_[slot].reach;
        const double gap = is_plane ? glm::dot(at - pose.position, normal) - static_cast<double>(std::get<Plane>(other.shape).offset) -
                                          plane_motion(owner, at, reach, dt)
                                    : glm::length(at - glm::clamp(at, box.lower, box.upper));
        if (gap <= reach) wake(slot, bodies);
    }
}

bool Sleepers::wake_touched(const ContactSet& contacts, BodyArrays& bodies) noexcept {
    bool any = false;
    for (const ContactPair& pair : contacts.pairs) {
        for (const std::uint32_t slot : {pair.body_a.slot, pair.body_b.slot}) {
            if (bodies.roles[slot] != Role::Asleep) continue;
            wake(slot, bodies);
            any = true;
        }
    }
    return any;
}

bool Sleepers::give_back(const BodyArrays& bodies, ContactSet& to) {
    if (!std::exchange(contacts_wait_, false)) return false;
    mover_.move(asleep_, to, [&](const ContactPair& pair) {
        return bodies.roles[pair.body_a.slot] != Role::Asleep && bodies.roles[pair.body_b.slot] != Role::Asleep;
    });
    return true;
}

void Sleepers::sync(const BodyArrays& bodies, ProxySet& proxies) noexcept {
    if (!std::exchange(roles_changed_, false)) return;
    for (std::size_t i = 0; i < proxies.by_slot.size(); ++i) {
        if (proxies.kinds[i] == ProxyKind::None || !has_mass(bodies.roles[proxies.bodies[i]])) continue;
        const bool movable = bodies.roles[proxies.bodies[i]] == Role::Dynamic;
        if (proxies.filters[i].movable == movable) continue;
        proxies.filters[i].movable = movable;
        proxies.stale[i] = 1;
    }
}

bool Sleepers::is_idle(const ProxySet& proxies, const BodyArrays& bodies, const NumberedPair& pair) {
    const std::uint32_t a = proxies.bodies[pair.a], b = proxies.bodies[pair.b];
    const bool meet = (has_mass(bodies.roles[a]) && stirs(bodies, b)) || (has_mass(bodies.roles[b]) && stirs(bodies, a));
    return !meet && bodies.roles[a] != Role::Dynamic && bodies.roles[b] != Role::Dynamic;
}

void Sleepers::drop_idle(const ProxySet& proxies, const BodyArrays& bodies, ScratchList<NumberedPair>& candidates) {
    candidates.erase_if([&](const NumberedPair& pair) { return is_idle(proxies, bodies, pair); });
}

bool Sleepers::fall_asleep(const SleepScene& scene) {
    if (!any_ready_ || since_look_ * kLooks < settings_.time) return false;
    since_look_ = 0.0;
    look_at_islands(scene, true);
    return take_islands(scene, 0, std::numeric_limits<std::uint32_t>::max());
}

bool Sleepers::put_to_sleep(std::uint32_t slot, const SleepScene& scene) {
    if (scene.bodies.roles[slot] != Role::Dynamic) return scene.bodies.roles[slot] == Role::Asleep;
    look_at_islands(scene, false);
    const std::uint32_t root = links_.root(slot);
    take_islands(scene, root, root);
    return scene.bodies.roles[slot] == Role::Asleep;
}

void Sleepers::look_at_islands(const SleepScene& scene, bool wait) {
    const std::vector<Role>& roles = scene.bodies.roles;
    links_.link(scene.contacts, roles);
    for (const BodyLink& link : scene.links) {
        if (link.a == BodyLink::kWorld || link.b == BodyLink::kWorld) continue;
        if (roles[link.a] == Role::Dynamic && roles[link.b] == Role::Dynamic) links_.join(link.a, link.b);
    }
    findings_.assign(roles.size(), Findings{});
    look_at_touch(scene);
    look_at_bodies(scene, wait);
}

void Sleepers::look_at_touch(const SleepScene& scene) {
    touched_.assign(scene.bodies.roles.size(), 0);
    for (const ContactPair& pair : scene.contacts.pairs) touch(scene.bodies, pair.body_a.slot, pair.body_b.slot, pushes(pair, scene.contacts));
    for (const BodyLink& link : scene.links) touch(scene.bodies, link.a, link.b, true);
}

void Sleepers::touch(const BodyArrays& bodies, std::uint32_t a, std::uint32_t b, bool holds) noexcept {
    for (const auto& [slot, other] : {std::pair{a, b}, std::pair{b, a}}) {
        if (slot == BodyLink::kWorld || bodies.roles[slot] != Role::Dynamic) continue;
        const Role held_by = other == BodyLink::kWorld ? Role::Static : bodies.roles[other];
        if (held_by == Role::Absent) continue;
        touched_[slot] |= holds ? 1 : 0;
        if (held_by == Role::Dynamic) continue;
        Findings& island = findings_[links_.root(slot)];
        island.restless |= held_by == Role::Kinematic && stirs(bodies, other);
        island.anchored |= holds;
    }
}

void Sleepers::look_at_bodies(const SleepScene& scene, bool wait) {
    for (std::uint32_t slot = 0; slot < scene.bodies.roles.size(); ++slot) {
        if (scene.bodies.roles[slot] != Role::Dynamic) continue;
        Findings& island = findings_[links_.root(slot)];
        if (island.restless) continue;
        const double pull = glm::length(free_pull(scene.bodies, slot, scene.gravity));
        const bool still = wait ? still_[slot].halves >= 2 : is_still_now(slot, pull);
        const bool held = (touched_[slot] != 0 && island.anchored) || rests_alone(slot, scene.bodies, pull);
        island.restless = !still || !held || may_sleep_[slot] == 0;
    }
}

bool Sleepers::take_islands(const SleepScene& scene, std::uint32_t first_root, std::uint32_t last_root) {
    std::vector<Role>& roles = scene.bodies.roles;
    last_.resize(roles.size());
    const std::size_t before = count_;
    for (std::uint32_t slot = 0; slot < roles.size(); ++slot) {
        if (roles[slot] != Role::Dynamic) continue;
        const std::uint32_t root = links_.root(slot);
        if (root < first_root || root > last_root || findings_[root].restless) continue;
        ring_[slot] = root;  // the lowest slot of all: it comes first
        if (slot != root) ring_[last_[root]] = slot;
        last_[root] = slot;
        roles[slot] = Role::Asleep;
        scene.bodies.states[slot].velocity = scene.bodies.states[slot].spin = dvec3{0.0};
        ++count_;
    }
    if (count_ == before) return false;
    fallen_ += count_ - before;
    roles_changed_ = true;
    mover_.move(scene.contacts, asleep_, [&](const ContactPair& pair) {
        return roles[pair.body_a.slot] == Role::Asleep || roles[pair.body_b.slot] == Role::Asleep;
    });
    return true;
}

void Sleepers::scale_impulses(float scale) noexcept {
    if (scale == 1.0f) return;
    for (PointImpulse& impulse : asleep_.impulses) impulse = {scale * impulse.normal, scale * impulse.friction};
}

std::size_t Sleepers::take_fallen() noexcept { return std::exchange(fallen_, 0u); }
std::size_t Sleepers::take_woken() noexcept { return std::exchange(woken_, 0u); }

std::size_t Sleepers::memory() const noexcept {
    return links_.memory() + asleep_.memory() + mover_.memory() + held_by(still_, sizes_, may_sleep_, ring_, last_, touched_, findings_, placed_);
}

}  // namespace carom::dynamics
