// Who is near the way of a body: of the broadphase, of what has left the boxes that it knows, or in a crowd of a table of all.
#include <carom/dynamics/detail/continuous.hpp>

#include <carom/broadphase/queries.hpp>

#include <algorithm>

namespace carom::dynamics {
namespace {

/// A crowd: of so many shapes one is fast, and of shapes there are no more than so many for each of its extents that what is
/// fast goes in the mean. To ask a table about a shape takes a nanosecond, and boxes along a way some 0.5 µs for each extent.
constexpr std::size_t kCrowdShare = 8;
constexpr double kShapesPerExtent = 512.0, kLongWay = 64.0;

}  // namespace

bool Continuous::may_meet(const ContinuousScene& scene, std::uint32_t p, std::uint32_t q) const {
    const std::uint32_t body_p = scene.proxies.bodies[p], body_q = scene.proxies.bodies[q];
    const Role role_p = scene.bodies.roles[body_p], role_q = scene.bodies.roles[body_q];
    return body_p != body_q && role_q != Role::Absent && (has_mass(role_p) || has_mass(role_q)) &&
           filters_agree(scene.proxies.filters[p], scene.proxies.filters[q]) && !scene.parted(body_p, body_q);
}

void Continuous::note_way(const ContinuousScene& scene, std::uint32_t slot, const BodyPath& path) {
    std::uint32_t& number = number_of_stray_[slot];
    if (number == kNone) number = static_cast<std::uint32_t>(stray_boxes_.size());
    stray_boxes_.set(number, path.box(sizes_[slot].reach));
    if (!crowd_) return;
    const Course course = course_of(path);
    for (std::uint32_t k = first_proxy_[slot]; k < first_proxy_[slot + 1]; ++k)
        courses_.set(k, {&course, scene.proxies.by_slot[proxies_[k]].reach});
}

bool Continuous::may_crowd(const ContinuousScene& scene) const {
    if (fast_.size() * kCrowdShare < proxies_.size()) return false;
    double ways = 0.0;  // in extents
    for (const std::uint32_t slot : fast_) {
        ways += std::min(glm::length(scene.bodies.states[slot].pose.position - scene.start(slot).position) / sizes_[slot].extent, kLongWay);
    }
    return static_cast<double>(proxies_.size() * fast_.size()) <= kShapesPerExtent * ways;
}

// By what each takes, in nanoseconds.
bool Continuous::crowds_at_start(const ContinuousScene& scene, bool complete) const {
    constexpr std::size_t kPair = 20, kLook = 3000, kStray = 5, kListed = 100, kCourse = 1;
    std::size_t pairs = 0;
    for (const FastPairs& part : fast_pairs_) pairs += part.pairs.size();
    const std::size_t boxes = kPair * pairs + (kLook + kStray * fast_.size()) * (complete ? strays_.size() : fast_.size());
    return boxes > (kListed + kCourse * fast_.size()) * proxies_.size() && may_crowd(scene);
}

// What stands needs no mover until somebody meets it, and what is out of range meets nobody.
void Continuous::list_courses(const ContinuousScene& scene) {
    crowd_ = true;
    courses_.resize(proxies_.size());
    for (std::uint32_t slot = 0; slot < scene.bodies.roles.size(); ++slot) {
        if (first_proxy_[slot] == first_proxy_[slot + 1]) continue;
        const BodyState& state = scene.bodies.states[slot];
        const bool goes = moves(scene.bodies.roles[slot]) && is_usable(state, scene.dt);
        const Course course = goes ? movers_[mover_of(scene, slot)].course : Course{.at = state.pose.position};
        for (std::uint32_t k = first_proxy_[slot]; k < first_proxy_[slot + 1]; ++k)
            courses_.set(k, {&course, scene.proxies.by_slot[proxies_[k]].reach});
    }
}

void Continuous::for_each_near(const ContinuousScene& scene, const Mover& mover, std::uint32_t proxy, Ask ask, double from, double to,
                               std::vector<std::uint32_t>& near, FunctionRef<void(std::uint32_t q)> visit) const {
    const auto see = [&](std::uint32_t q) {
        if (may_meet(scene, proxy, q)) visit(q);
    };
    if (scene.proxies.kinds[proxy] == ProxyKind::Plane) {
        for (std::uint32_t q = 0; q < scene.proxies.by_slot.size(); ++q) {
            if (scene.proxies.kinds[q] == ProxyKind::Bounded) see(q);
        }
        return;
    }
    for (const std::uint32_t plane : scene.proxies.planes) see(plane);
    const auto is_astray = [&](std::uint32_t q) { return number_of_stray_[scene.proxies.bodies[q]] != kNone; };
    const double reach = scene.proxies.by_slot[proxy].reach;
    if (crowd_) {
        near.clear();
        courses_.list_near({&mover.course, reach}, from, to, kSweepRoomShare * scene.proxies.extents[proxy], near);
        for (const std::uint32_t k : near) {
            const std::uint32_t q = proxies_[k];
            if (scene.proxies.kinds[q] == ProxyKind::Bounded && (ask == Ask::Everybody || is_astray(q))) see(q);
        }
        return;
    }
    const PathPiece& way = mover.path.piece(BodyPath::kWhole);
    const dvec3 at = way.start.position - scene.proxies.origin, round{reach + way.sway};
    if (ask == Ask::Everybody) {
        query_swept_box(scene.broadphase, at - round, at + round, way.translation, [&](std::uint32_t q) {
            if (!is_astray(q)) see(q);
            return true;
        });
    }
    stray_boxes_.for_each_meeting(box_of(way, reach), [&](std::size_t k) {
        const std::uint32_t slot = strays_[k];
        if (slot == mover.slot) return;
        for (std::uint32_t i = first_proxy_[slot]; i < first_proxy_[slot + 1]; ++i) {
            if (scene.proxies.kinds[proxies_[i]] == ProxyKind::Bounded) see(proxies_[i]);
        }
    });
}

}  // namespace carom::dynamics
