#include <carom/dynamics/detail/passing.hpp>

#include <carom/dynamics/detail/room.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

constexpr std::size_t kGrain = 64;
/// What moves sideways by less until it is there meets what it would have met: of the width of a face's contact; of others of the smaller shape's extent.
constexpr double kSureOfFace = 0.25, kSureOfEdge = 1e-4;
constexpr std::uint32_t kLeastOfFace = 3;  // points
/// What is nearer than the pull brings it in a step, and comes no faster than so many of these, lies there.
constexpr double kRestingSteps = 4.0;

dvec3 pull_on(const BodyArrays& bodies, std::uint32_t slot, const dvec3& gravity) noexcept {
    return bodies.roles[slot] == Role::Dynamic ? bodies.pull(slot, gravity) : dvec3{0.0};
}

/// Two bodies and how they move by themselves.
struct TwoBodies {
    const BodyState &a, &b;
    dvec3 pull_a, pull_b;  ///< [m/s²]
    double fall = 0.0;     ///< what pulls may move one by in the step [m]

    TwoBodies(const BodyArrays& bodies, std::uint32_t slot_a, std::uint32_t slot_b, const Motion& motion) noexcept
        : a(bodies.states[slot_a]), b(bodies.states[slot_b]), pull_a(pull_on(bodies, slot_a, motion.gravity)), pull_b(pull_on(bodies, slot_b, motion.gravity)),
          fall(std::sqrt(std::max(glm::dot(pull_a, pull_a), glm::dot(pull_b, pull_b))) * motion.dt * motion.dt) {}
};

/// How far any two points of a manifold are apart.
double width_of(std::span<const ContactPoint> points) noexcept {
    float most = 0.0f;
    for (const ContactPoint& p : points) {
        for (const ContactPoint& q : points) most = std::max(most, glm::dot(p.position - q.position, p.position - q.position));
    }
    return std::sqrt(static_cast<double>(most));
}

/// What a manifold's points do in the step.
struct Ahead {
    bool lies = false;      ///< some point is as near as what rests
    bool may_miss = false;  ///< some comes to its plane, after a way along it on which it may have left what it would meet
};

Ahead look_ahead(std::span<const ContactPoint> points, const dvec3& normal, const dvec3& origin, const TwoBodies& two, double extent, double dt) noexcept {
    Ahead ahead;
    for (const ContactPoint& point : points) {
        const dvec3 at = origin + dvec3{point.position};
        const dvec3 v = point_velocity(two.b, at) - point_velocity(two.a, at) + dt * (two.pull_b - two.pull_a);
        const double approach = -glm::dot(v, normal), gap = static_cast<double>(point.separation);
        ahead.lies = ahead.lies || (gap <= two.fall && approach * dt <= kRestingSteps * two.fall);
        if (approach * dt <= gap) continue;
        const double sure = points.size() >= kLeastOfFace ? kSureOfFace * width_of(points) : kSureOfEdge * extent;
        ahead.may_miss = ahead.may_miss || glm::length(v + approach * normal) * gap > sure * approach;
    }
    return ahead;
}

MovingShape moving(const ProxySet& proxies, std::uint32_t proxy, const BodyState& state, const dvec3& pull, double dt) {
    const Pose& pose = proxies.poses[proxy];
    return {proxies.shapes[proxy],
            {pose, dt * state.velocity + (0.5 * dt * dt) * pull, dt * state.spin, inverse_transform_point(pose, state.pose.position)}};
}

}  // namespace

bool Passing::passes(const ContactPair& pair, const ContactSet& contacts, const ProxySet& proxies, const BodyArrays& bodies, const Motion& motion) {
    const TwoBodies two(bodies, pair.body_a.slot, pair.body_b.slot, motion);
    const double dt = motion.dt, extent = std::min(proxies.extents[pair.proxy_a()], proxies.extents[pair.proxy_b()]);
    bool may_miss = false;
    for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
        const Ahead ahead = look_ahead(contacts.points_of(contacts.manifolds[m]), dvec3{contacts.manifolds[m].normal}, proxies.poses[pair.proxy_a()].position, two, extent, dt);
        if (ahead.lies) return false;
        may_miss = may_miss || ahead.may_miss;
    }
    if (!may_miss) return false;
    return !may_touch(first_touch(moving(proxies, pair.proxy_a(), two.a, two.pull_a, dt), 0, moving(proxies, pair.proxy_b(), two.b, two.pull_b, dt), {}, cores_).status);
}

void Passing::find(ContactSet& contacts, const ContactChanges* changes, const ProxySet& proxies, const BodyArrays& bodies, const Motion& motion,
                   Executor& executor) {
    found_.clear();
    const auto is_mesh = [&](std::uint32_t proxy) { return type_of(*proxies.shapes[proxy]) == ShapeType::TriangleMesh; };
    const auto list = [&](std::uint32_t p) {
        const ContactPair& pair = contacts.pairs[p];
        if (pair.predicted && proxies.kinds[pair.proxy_b()] != ProxyKind::Plane && !(is_mesh(pair.proxy_a()) && is_mesh(pair.proxy_b()))) found_.push_back(p);
    };
    if (changes == nullptr) {
        for (std::uint32_t p = 0; p < contacts.pairs.size(); ++p) list(p);
    } else {
        for (const std::vector<std::uint32_t>* some : {&changes->replaced, &changes->added}) {
            for (const std::uint32_t m : *some) {
                if (const std::uint32_t p = contacts.manifolds[m].pair; m == contacts.pairs[p].first_manifold) list(p);
            }
        }
    }
    executor.parallel_for(found_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            ContactPair& pair = contacts.pairs[found_[i]];
            pair.passes = passes(pair, contacts, proxies, bodies, motion);
            if (pair.passes) contacts.clear_impulses(pair);
        }
    });
    std::erase_if(found_, [&](std::uint32_t p) { return !contacts.pairs[p].passes; });
}

void Passing::trim() { trim_scratch(found_); }

}  // namespace carom::dynamics
