#include <carom/dynamics/detail/impacts.hpp>

#include <carom/core/math.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/part_surface.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace carom::dynamics {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kTouchShare = 1e-5;      // of the smaller shape's smallest extent
constexpr double kStillShare = 1e-9;      // of the fastest body's speed
constexpr double kMostMissed = 8.0;       // steps that an impact may lie back
constexpr std::int64_t kLeastBudget = 4096, kBudgetPerPoint = 32;  // 0.1 to 0.4 us each

constexpr auto comes_later = [](const auto& x, const auto& y) noexcept { return x.time != y.time ? x.time > y.time : x.bouncer > y.bouncer; };

double radius_of(const Shape& shape) noexcept {
    const Sphere* sphere = std::get_if<Sphere>(&shape);
    return sphere == nullptr ? 0.0 : static_cast<double>(sphere->radius);
}

}  // namespace

std::uint32_t Impacts::flyer_of(std::uint32_t slot, const BodyArrays& bodies) {
    if (flyer_of_slot_[slot] != kNone) return flyer_of_slot_[slot];
    flyer_of_slot_[slot] = static_cast<std::uint32_t>(flyers_.size());
    const BodyState& state = bodies.states[slot];
    const BodyMass& mass = bodies.masses[slot];
    Flyer flyer;
    flyer.slot = slot;
    flyer.dynamic = bodies.roles[slot] == Role::Dynamic;
    flyer.center = state.pose.position;
    flyer.velocity = state.velocity;
    flyer.spin = state.spin;
    if (flyer.dynamic) {
        flyer.inverse_mass = mass.inverse_mass * free_moves(mass.locked);
        flyer.inverse_inertia = world_inverse_inertia(state, mass);
        flyer.pull = bodies.pull(slot, gravity_);
    }
    flyers_.push_back(flyer);
    return flyer_of_slot_[slot];
}

Impacts::Bouncer Impacts::make_bouncer(const ContactManifold& manifold, std::span<const ContactPoint> points, const ContactPair& pair, const ProxySet& proxies, const BodyArrays& bodies) {
    const Proxy& a = proxies.by_slot[pair.proxy_a()];
    const Proxy& b = proxies.by_slot[pair.proxy_b()];
    Bouncer bouncer;
    bouncer.a = flyer_of(pair.body_a.slot, bodies);
    bouncer.b = flyer_of(pair.body_b.slot, bodies);
    bouncer.pair = manifold.pair;
    bouncer.normal = dvec3{manifold.normal};
    bouncer.touch = kTouchShare * std::min(proxies.extents[pair.proxy_a()], proxies.extents[pair.proxy_b()]);
    bouncer.radius_a = radius_of(a.shape);
    bouncer.radius_b = radius_of(b.shape);
    bouncer.count = manifold.count;
    bouncer.two_spheres = bouncer.radius_a > 0.0 && bouncer.radius_b > 0.0;
    bouncer.between = (bouncer.radius_a + bouncer.radius_b + static_cast<double>(points[0].separation)) * bouncer.normal;
    const dvec3& origin = proxies.poses[pair.proxy_a()].position;
    const dvec3 from_a = origin - flyers_[bouncer.a].center, from_b = origin - flyers_[bouncer.b].center;
    for (std::uint32_t k = 0; k < manifold.count; ++k) {
        const dvec3 position{points[k].position};
        bouncer.points[k].ra = from_a + position;
        bouncer.points[k].rb = from_b + position;
        bouncer.points[k].gap = static_cast<double>(points[k].separation);
    }
    return bouncer;
}

void Impacts::list(const ContactSet& contacts, const ProxySet& proxies, const BodyArrays& bodies) {
    flyer_of_slot_.assign(bodies.roles.size(), kNone);
    flyers_.clear();
    bouncers_.clear();
    events_.clear();
    for (const ContactPair& pair : contacts.pairs) {
        if (pair.passes || (proxies.bounces[pair.proxy_a()] | proxies.bounces[pair.proxy_b()]) == 0) continue;
        const ProxySurface &a = proxies.surfaces[pair.proxy_a()], &b = proxies.surfaces[pair.proxy_b()];
        for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
            const ContactManifold& manifold = contacts.manifolds[m];
            const Surface met = combine(surface_of_part(a, manifold.part_a), surface_of_part(b, manifold.part_b));
            if (!(met.restitution > 0.0f)) continue;
            Bouncer& bouncer = bouncers_.emplace_back(make_bouncer(manifold, contacts.points_of(manifold), pair, proxies, bodies));
            bouncer.restitution = static_cast<double>(met.restitution);
            bouncer.friction = static_cast<double>(met.friction);
        }
    }
}

// What pushed a body in the step before holds it up in this one: gravity has no hold on it.
void Impacts::note_support(const ContactSet& contacts) noexcept {
    for (const ContactPair& pair : contacts.pairs) {
        const std::uint32_t a = flyer_of_slot_[pair.body_a.slot], b = flyer_of_slot_[pair.body_b.slot];
        if (a == kNone && b == kNone) continue;
        bool pushes = false;
        for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
            for (const PointImpulse& point : contacts.impulses_of(m)) pushes |= point.normal > 0.0f;
        }
        for (const std::uint32_t flyer : {a, b}) {
            if (pushes && flyer != kNone) flyers_[flyer].pull = dvec3{0.0};
        }
    }
}

void Impacts::link_flyers() {
    for (const Bouncer& bouncer : bouncers_) ++flyers_[bouncer.a].end, ++flyers_[bouncer.b].end;
    std::uint32_t next = 0;
    for (Flyer& flyer : flyers_) {
        const std::uint32_t count = flyer.end;
        flyer.first = flyer.end = next;
        next += count;
    }
    touching_.resize(next);
    for (std::uint32_t i = 0; i < bouncers_.size(); ++i) {
        for (const std::uint32_t f : {bouncers_[i].a, bouncers_[i].b}) touching_[flyers_[f].end++] = i;
    }
}

dvec3 Impacts::between_at(const Bouncer& bouncer, double time) const noexcept {
    return bouncer.between + (flyers_[bouncer.b].path(time) - flyers_[bouncer.a].path(time));
}

double Impacts::gap_at(const Bouncer& bouncer, const Point& point, double time) const noexcept {
    if (bouncer.two_spheres) return glm::length(between_at(bouncer, time)) - (bouncer.radius_a + bouncer.radius_b);
    const Flyer& a = flyers_[bouncer.a];
    const Flyer& b = flyers_[bouncer.b];
    const dvec3 at_a = a.path(time) + glm::cross(a.turn + time * a.spin, point.ra);
    const dvec3 at_b = b.path(time) + glm::cross(b.turn + time * b.spin, point.rb);
    return point.gap + glm::dot(bouncer.normal, at_b - at_a);
}

double Impacts::rate_at(const Bouncer& bouncer, const Point& point, double time) const noexcept {
    const Flyer& a = flyers_[bouncer.a];
    const Flyer& b = flyers_[bouncer.b];
    const dvec3 drift = (b.velocity - a.velocity) + time * (b.pull - a.pull);
    if (bouncer.two_spheres) return glm::dot(glm::normalize(between_at(bouncer, time)), drift);
    return glm::dot(bouncer.normal, drift + (glm::cross(b.spin, point.rb) - glm::cross(a.spin, point.ra)));
}

// Against a fixed normal the gap is a parabola of time. That of two spheres closes no sooner than the gap along the normal: from there
// Newton's steps come to it from below, since distances along straight paths are convex.
double Impacts::time_of_hit(const Bouncer& bouncer, const Point& point, double from) const noexcept {
    const double gap = gap_at(bouncer, point, from), rate = rate_at(bouncer, point, from);
    // Balls that overlap at the start met before, where no contact was looked for. The impact goes where it was. Other shapes rest on one another:
    // moved back, they would overlap their neighbours, who would have met before then, and so on.
    const bool missed = bouncer.two_spheres && gap < -bouncer.touch && rate < -slow_ && !flyers_[bouncer.a].hit && !flyers_[bouncer.b].hit;
    if (!missed) {
        if (gap <= bouncer.touch && rate < -slow_) return from;
        if (gap <= 0.0) return kNever;
    }
    if (bouncer.two_spheres) {
        double time = missed ? std::max(-kMostMissed * dt_, from - gap / rate) : from;
        if (time == -kMostMissed * dt_) return time;
        for (int i = 0; i < 32; ++i) {
            const double left = gap_at(bouncer, point, time), closing = -rate_at(bouncer, point, time);
            if (left <= 1e-3 * bouncer.touch) return closing > slow_ ? time : kNever;
            if (!(closing > slow_)) return kNever;
            time += left / closing;
            if (time > dt_) return kNever;
        }
        return time;
    }
    const double pull = glm::dot(bouncer.normal, flyers_[bouncer.b].pull - flyers_[bouncer.a].pull);
    const double square = rate * rate - 2.0 * pull * gap;
    if (!(square > slow_ * slow_)) return kNever;
    const double closing = std::sqrt(square);  // at the hit
    if (rate > 0.0 && pull >= 0.0) return kNever;
    const double time = from + (rate > 0.0 ? -(rate + closing) / pull : 2.0 * gap / (closing - rate));
    return time <= dt_ ? time : kNever;
}

double Impacts::time_of_hit(const Bouncer& bouncer, double from) const noexcept {
    double least = kNever;
    for (std::uint32_t k = 0; k < bouncer.count; ++k) least = std::min(least, time_of_hit(bouncer, bouncer.points[k], from));
    return least;
}

void Impacts::push_event(std::uint32_t bouncer, double from) {
    const std::uint32_t version = ++bouncers_[bouncer].version;
    const double time = time_of_hit(bouncers_[bouncer], from);
    if (time > dt_) return;
    events_.push_back({time, bouncer, version});
    std::push_heap(events_.begin(), events_.end(), comes_later);
}

void Impacts::drain() {
    while (!events_.empty()) {
        const Event event = events_.front();
        std::pop_heap(events_.begin(), events_.end(), comes_later);
        events_.pop_back();
        if (bouncers_[event.bouncer].version != event.version) continue;
        if (budget_ <= 0) {
            ++left_;
            continue;
        }
        if (!bounce(event.bouncer, event.time)) continue;  // what approached has a lever arm of its own at the impact, and does not approach by it
        for (const std::uint32_t f : frontier_) {
            const Flyer& flyer = flyers_[f];
            for (std::uint32_t i = flyer.first; i < flyer.end; ++i) push_event(touching_[i], event.time);
        }
    }
}

// From the last impact of the two on, under all that pulls them: what supports a body is none of its bounces.
bool Impacts::stays_apart(const Bouncer& bouncer, const BodyArrays& bodies) const noexcept {
    const Flyer& a = flyers_[bouncer.a];
    const Flyer& b = flyers_[bouncer.b];
    const auto whole_pull = [&](const Flyer& f) {
        return f.dynamic ? bodies.pull(f.slot, gravity_) : dvec3{0.0};
    };
    const double pull = glm::dot(bouncer.normal, whole_pull(b) - whole_pull(a));
    const double more = pull - glm::dot(bouncer.normal, b.pull - a.pull);
    const double from = std::max({0.0, a.last, b.last});
    const double fall = 0.05 * glm::length(gravity_) * dt_ * dt_;
    const double least = fall > 0.0 ? -std::min(fall, bouncer.touch) : -bouncer.touch;
    for (std::uint32_t k = 0; k < bouncer.count; ++k) {
        const Point& point = bouncer.points[k];
        const auto gap = [&](double time) { return gap_at(bouncer, point, time) + 0.5 * more * time * time; };
        if (gap(from) < least || gap(dt_) < least) return false;
        const double rate = rate_at(bouncer, point, from) + more * from;
        const double lowest = pull > 0.0 ? from - rate / pull : from;
        if (lowest > from && lowest < dt_ && gap(lowest) < least) return false;
    }
    return true;
}

void Impacts::mark_flying(ContactSet& contacts, const BodyArrays& bodies, std::span<const unsigned char> jointed) {
    for (const Bouncer& bouncer : bouncers_) contacts.pairs[bouncer.pair].flies = true;
    for (const Bouncer& bouncer : bouncers_) {
        if (!stays_apart(bouncer, bodies)) contacts.pairs[bouncer.pair].flies = false;
    }
    stack_.clear();
    const auto hold = [&](std::uint32_t f) {
        if (f == kNone || !flyers_[f].dynamic || flyers_[f].held) return;
        flyers_[f].held = true;
        stack_.push_back(f);
    };
    for (std::uint32_t f = 0; f < flyers_.size() && !jointed.empty(); ++f) {
        if (jointed[flyers_[f].slot] != 0) hold(f);
    }
    std::size_t next = 0;  // bouncers come in the order of their pairs
    for (std::uint32_t p = 0; p < contacts.pairs.size(); ++p) {
        ContactPair& pair = contacts.pairs[p];
        std::uint32_t bouncing = 0;
        for (; next < bouncers_.size() && bouncers_[next].pair == p; ++next) ++bouncing;
        pair.flies = pair.flies && bouncing == pair.manifold_count;
        if (!pair.is_solved()) continue;
        hold(flyer_of_slot_[pair.body_a.slot]);
        hold(flyer_of_slot_[pair.body_b.slot]);
    }
    while (!stack_.empty()) {
        const Flyer& flyer = flyers_[stack_.back()];
        stack_.pop_back();
        for (std::uint32_t i = flyer.first; i < flyer.end; ++i) {
            const Bouncer& bouncer = bouncers_[touching_[i]];
            contacts.pairs[bouncer.pair].flies = false;
            hold(bouncer.a);
            hold(bouncer.b);
        }
    }
    for (std::uint32_t p = 0; p < contacts.pairs.size(); ++p) {
        const ContactPair& pair = contacts.pairs[p];
        if (!pair.flies) continue;
        contacts.flying.push_back(p);
        contacts.clear_impulses(pair);
    }
}

void Impacts::run(ContactSet& contacts, const ProxySet& proxies, BodyArrays& bodies, const Motion& motion, std::span<const unsigned char> jointed) {
    gravity_ = motion.gravity;
    dt_ = motion.dt;
    count_ = left_ = 0;
    contacts.flying.clear();
    list(contacts, proxies, bodies);
    if (bouncers_.empty()) return;
    note_support(contacts);
    link_flyers();
    fastest_ = 0.0;
    double pull = 0.0;
    for (const Flyer& flyer : flyers_) {
        fastest_ = std::max(fastest_, glm::length(flyer.velocity));
        if (flyer.dynamic) pull = std::max(pull, glm::length(bodies.acceleration(flyer.slot, gravity_)));
    }
    fastest_ += pull * dt_;
    slow_ = std::max(kSlowestImpact * pull * dt_, kStillShare * fastest_);
    for (std::uint32_t i = 0; i < bouncers_.size(); ++i) push_event(i, 0.0);
    budget_ = kLeastBudget;
    for (const Bouncer& bouncer : bouncers_) budget_ += kBudgetPerPoint * bouncer.count;
    drain();
    for (const Flyer& flyer : flyers_) {
        if (!flyer.hit) continue;
        bodies.states[flyer.slot].velocity = flyer.velocity;
        bodies.states[flyer.slot].spin = flyer.spin;
    }
    mark_flying(contacts, bodies, jointed);
}

void Impacts::mark_placed(std::span<unsigned char> by_slot) const noexcept {
    for (const Flyer& flyer : flyers_) {
        if (flyer.hit) by_slot[flyer.slot] = 1;
    }
}

void Impacts::place(BodyArrays& bodies) const {
    for (const Flyer& flyer : flyers_) {
        if (!flyer.hit) continue;
        BodyState& state = bodies.states[flyer.slot];
        state.pose.position += flyer.shift;
        const dquat turn = rotation_from_vector(flyer.turn);
        state.pose.orientation = glm::normalize(turn * state.pose.orientation);
        // The spin turns along, or the moments that it meets, and the energy, would be others.
        if ((bodies.masses[flyer.slot].locked & kLockedTurns) == 0) state.spin = rotate(turn, state.spin);
    }
}

}  // namespace carom::dynamics
