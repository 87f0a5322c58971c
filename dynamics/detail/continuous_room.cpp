// Two that are struck while they touch are moved a little apart, as far as there is room.
#include <carom/dynamics/detail/continuous.hpp>

#include <algorithm>

namespace carom::dynamics {
namespace {

constexpr double kOpening = 0.01;  // of the smallest extent

}  // namespace

// Each by the other's share of the mass, so that they can be watched at the level that they have come to. Without it each blow would let them a level deeper.
void Continuous::part(const ContinuousScene& scene, const Event& event, Pose& a, Pose& b) {
    const std::uint32_t slot_a = scene.proxies.bodies[event.pair.a], slot_b = scene.proxies.bodies[event.pair.b];
    const BodyMass &mass_a = scene.bodies.masses[slot_a], &mass_b = scene.bodies.masses[slot_b];
    const bool b_gives_way = has_mass(scene.bodies.roles[slot_b]);
    const double share = b_gives_way ? mass_b.mass / (mass_a.mass + mass_b.mass) : 1.0;
    const dvec3 apart = (event.bend + (kSweepToleranceShare + kOpening) * size_of(scene, event.pair)) * meeting_.points.front().normal;
    const auto shift = [&](std::uint32_t slot, std::uint32_t partner, Pose& pose, const dvec3& way) {
        pose.position += room_for(scene, slot, partner, event.t, pose, way) * way;
    };
    shift(slot_a, slot_b, a, -share * apart * free_moves(mass_a.locked));
    if (b_gives_way) shift(slot_b, slot_a, b, (1.0 - share) * apart * free_moves(mass_b.locked));
}

// Where paths bend by much, the shift is nearly as long as a thin body is thick, and nobody watches it: somebody jammed at a wall was put behind it.
double Continuous::room_for(const ContinuousScene& scene, std::uint32_t slot, std::uint32_t partner, double t, const Pose& from,
                            const dvec3& shift) {
    double room = 1.0;
    std::vector<std::uint32_t>& near = finders_.front().near;
    shifted_.slot = slot;
    shifted_.path.go({.start = from, .translation = shift});
    shifted_.course = {.at = from.position, .play = glm::length(shift)};
    for (std::uint32_t k = first_proxy_[slot]; k < first_proxy_[slot + 1]; ++k) {
        const std::uint32_t p = proxies_[k];
        for_each_near(scene, shifted_, p, Ask::Everybody, t, t, near, [&](std::uint32_t q) {
            const std::uint32_t other = scene.proxies.bodies[q];
            if (other == partner) return;
            standing_.go({.start = state_at(scene, movers_[mover_of(scene, other)], t).pose});
            const Pair pair = order(scene, p, q);
            const auto moving = [&](std::uint32_t proxy) {
                const Proxy& of = scene.proxies.by_slot[proxy];
                return PathShape{proxy == p ? &shifted_.path : &standing_, &of.shape, &of.local.get(), of.reach};
            };
            PathSearch search{
                .a = moving(pair.a), .b = moving(pair.b), .level = kLevels - 1, .tolerance = kSweepToleranceShare * size_of(scene, pair)};
            if (scene.proxies.kinds[pair.b] == ProxyKind::Plane) search.still = kEverywhere;
            if (++counts_.pairs > most_pairs_) budget_ = 0;
            if (touch(search, 0.0, 1.0, cores_)) room = std::min(room, search.t);
        });
    }
    return room;
}

void Continuous::trim() {
    trim_kept(departures_);
    if (!runs_.take_seldom()) return;
    fast_pairs_.clear(), finders_.clear();  // with what they list
    drop(number_of_stray_, is_stray_, mover_of_slot_, fast_pairs_, finders_, events_, chances_, probes_, at_once_);
    courses_.drop();
    constexpr std::size_t kFewMovers = 16;
    if (movers_.size() > kFewMovers) movers_.resize(kFewMovers), movers_.shrink_to_fit();
    mover_count_ = 0;
}

std::size_t Continuous::memory() const noexcept {
    std::size_t sum = movers_.size() * sizeof(Mover) + stray_boxes_.memory() + courses_.memory();
    sum += held_by(wishes_, sizes_, first_proxy_, proxies_, departures_, departure_of_slot_, fast_, is_fast_, strays_, number_of_stray_,
                   is_stray_, mover_of_slot_);
    sum += held_by(fast_pairs_, displaced_, events_, chances_, probes_, at_once_, finders_, manifolds_, obstacles_);
    for (const FastPairs& some : fast_pairs_) sum += held_by(some.pairs);
    for (const Finder& some : finders_) sum += held_by(some.near, some.pairs);
    return sum;
}

}  // namespace carom::dynamics
