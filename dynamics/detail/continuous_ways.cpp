// Where what is carried can go instead, when it comes upon something that does not give way: along with that, or along both.
#include <carom/dynamics/detail/continuous.hpp>

#include <carom/dynamics/detail/least_shift.hpp>

#include <algorithm>

namespace carom::dynamics {
namespace {

constexpr int kMostWays = 8;             // of a body in a step
constexpr double kLongestWay = 4.0;      // times what is asked for: out of a wedge of 29 degrees
constexpr double kObstacleShare = 0.02;  // of the smaller one's extent: what is as near stands in the way

}  // namespace

bool Continuous::goes_on(const ContinuousScene& scene, std::uint32_t number) const {
    return movers_[number].slides || carrier_of(scene, number) != kNone;
}

// What neither has mass nor gives way, and what something drives.
bool Continuous::stands_in_the_way(const ContinuousScene& scene, std::uint32_t number) const {
    const Mover& mover = movers_[number];
    return !has_mass(scene.bodies.roles[mover.slot]) || mover.crushed || goes_on(scene, number);
}

// The plane of a contact has to be kept out of now, and where it is at the end of the step. Between the two it is, unless the plane turns back.
void Continuous::add_obstacle(const ContinuousScene& scene, std::uint32_t other, double t, const dvec3& at, const dvec3& normal) {
    const Mover& mover = movers_[other];
    const BodyState now = motion_at(scene, mover, t);
    const Pose end = motion_at(scene, mover, 1.0).pose;
    Obstacle& obstacle = obstacles_.emplace_back();
    obstacle.at = at;
    obstacle.carrier = carrier_of(scene, other);
    const dvec3 moved = transform_point(end, inverse_transform_point(now.pose, at)) - at;
    const dvec3 turned = rotate(end.orientation, rotate_inverse(now.pose.orientation, normal));
    obstacle.now = {normal, (1.0 - t) * scene.dt * glm::dot(normal, point_velocity(now, at))};
    obstacle.end = {turned, glm::dot(turned, moved)};
}

// All that is about as near as what it has come upon.
void Continuous::list_obstacles(const ContinuousScene& scene, std::uint32_t number, std::uint32_t other, double t, const BodyState& state) {
    const std::uint32_t slot = movers_[number].slot;
    shifted_.slot = slot;
    shifted_.path.go({.start = state.pose, .sway = kObstacleShare * sizes_[slot].reach});
    shifted_.course = {.at = state.pose.position, .play = 2.0 * kObstacleShare * sizes_[slot].reach};  // extents are no more than that
    std::vector<std::uint32_t>& listed = finders_.front().near;
    for (std::uint32_t k = first_proxy_[slot]; k < first_proxy_[slot + 1]; ++k) {
        const std::uint32_t p = proxies_[k];
        for_each_near(scene, shifted_, p, Ask::Everybody, t, t, listed, [&](std::uint32_t q) {
            const std::uint32_t near = mover_of(scene, scene.proxies.bodies[q]);
            if (near == other || near == number || !stands_in_the_way(scene, near)) return;
            const Proxy &proxy_p = scene.proxies.by_slot[p], &proxy_q = scene.proxies.by_slot[q];
            const Pose pose_p = state.pose * proxy_p.local.get(), pose_q = motion_at(scene, movers_[near], t).pose * proxy_q.local.get();
            const double margin = kObstacleShare * size_of(scene, order(scene, p, q));
            manifolds_.clear();
            collide({&proxy_p.shape, &proxy_q.shape, pose_p, pose_q, static_cast<float>(margin)}, 0, manifolds_);
            for (const Manifold& m : manifolds_) {
                for (const ContactPoint& point : m.used())
                    add_obstacle(scene, near, t, pose_p.position + dvec3{point.position}, -dvec3{m.normal});
            }
        });
    }
}

std::optional<Continuous::Way> Continuous::find_way(const ContinuousScene& scene, std::uint32_t number, std::uint32_t other, double t,
                                                    const BodyState& state, double side) {
    const Mover& mover = movers_[number];
    if (!mover.stopped || mover.crushed || mover.ways >= kMostWays || !has_mass(scene.bodies.roles[mover.slot])) return {};
    obstacles_.clear();
    for (const MeetingPoint& point : meeting_.points) add_obstacle(scene, other, t, point.at, side * point.normal);
    list_obstacles(scene, number, other, t, state);
    const std::uint32_t carrier = carrier_of(scene, other);
    if (carrier != kNone && carrier != mover.carrier && may_ride(scene, mover.slot)) {
        const Mover& drives = movers_[carrier];
        const BodyState now = motion_at(scene, drives, t);
        const Pose end = motion_at(scene, drives, 1.0).pose;
        const auto moved = [&](const dvec3& at) { return transform_point(end, inverse_transform_point(now.pose, at)) - at; };
        const double slow = kSlowShare * sizes_[mover.slot].extent * (1.0 - t);
        const auto is_clear = [&](const Obstacle& o) {
            return o.carrier == carrier ||
                   (glm::dot(o.now.normal, (1.0 - t) * scene.dt * point_velocity(now, o.at)) >= o.now.least - slow &&
                    glm::dot(o.end.normal, moved(o.at)) >= o.end.least - slow);
        };
        if (std::all_of(obstacles_.begin(), obstacles_.end(), is_clear)) return Way{moved(state.pose.position), carrier};
    }
    const dvec3 free = free_moves(scene.bodies.masses[mover.slot].locked);
    std::vector<ShiftBound> bounds;
    double asked = 0.0;
    for (const Obstacle& o : obstacles_) {
        for (const ShiftBound& bound : {o.now, o.end}) {
            bounds.push_back({free * bound.normal, bound.least});
            asked = std::max(asked, bound.least);
        }
    }
    const std::optional<dvec3> shift = least_shift(bounds, kLongestWay * asked);
    if (!shift) return {};
    return Way{*shift, kNone};
}

// Of the two the one that stands; or else who has the shorter way.
bool Continuous::choose_way(const ContinuousScene& scene, std::uint32_t a, std::uint32_t b, double t, Choice& choice) {
    const std::optional<Way> way_a = find_way(scene, a, b, t, state_at(scene, movers_[a], t), -1.0),
                             way_b = find_way(scene, b, a, t, state_at(scene, movers_[b], t), 1.0);
    if (!way_a && !way_b) return false;
    const auto stands = [&](std::uint32_t number) { return !goes_on(scene, number); };
    const bool shorter = way_a && way_b && glm::dot(way_a->shift, way_a->shift) <= glm::dot(way_b->shift, way_b->shift);
    const bool first = way_a && (!way_b || (stands(a) != stands(b) ? stands(a) : shorter));
    choice = {first ? a : b, first ? *way_a : *way_b};
    return true;
}

void Continuous::take_way(const ContinuousScene& scene, const Choice& choice, double t, const BodyState& state) {
    Mover& mover = movers_[choice.number];
    ++mover.ways;
    if (mover.carrier == kNone && !mover.slides) ++counts_.carried;
    Outcome outcome{state, StopCause::Partner, 0, choice.way.carrier};
    if (choice.way.carrier == kNone) outcome.slide = t < 1.0 ? choice.way.shift / (1.0 - t) : dvec3{0.0};
    strike(scene, choice.number, t, outcome);
    search_all(scene, choice.number, t, kNone);
}

}  // namespace carom::dynamics
