#include <carom/dynamics/detail/proxies.hpp>

#include <carom/collision/aabb.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::dynamics {
namespace {

constexpr std::size_t kGrain = 256;
constexpr double kMarginShare = 0.25;  // of the smallest extent

/// Motion of any point of the shape beyond the straight path of the centre of mass.
double play(const Proxy& proxy, const BodyState& state, const Motion& motion) {
    const double turn = std::min(glm::length(state.spin) * motion.dt, 2.0);
    return glm::length(motion.gravity) * motion.dt * motion.dt + proxy.reach * turn;
}

Aabb swept_box(const Proxy& proxy, const Pose& pose, const BodyState& state, const Motion& motion) {
    const Aabb box = bounds(*proxy.shape, pose);
    const dvec3 path = state.velocity * motion.dt;
    const Aabb moved{box.lower + glm::min(path, dvec3{0.0}), box.upper + glm::max(path, dvec3{0.0})};
    return inflate(moved, play(proxy, state, motion));
}

std::uint64_t pack(std::uint32_t high, std::uint32_t low) { return (std::uint64_t{high} << 32) | low; }

/// @param b  number of the second proxy: planes follow the bounded ones, and sort after them.
ContactPair make_pair(const ProxySet& proxies, std::uint32_t a, std::uint32_t b) {
    const Proxy& first = proxy_at(proxies, a);
    const Proxy& second = proxy_at(proxies, b);
    const std::uint32_t plane_bit = b < proxies.bounded.size() ? 0u : 0x80000000u;
    ContactPair pair;
    pair.key = pack(first.id.slot, second.id.slot | plane_bit);
    pair.shape_a = first.id;
    pair.shape_b = second.id;
    pair.body_a = first.owner;
    pair.body_b = second.owner;
    pair.proxy_a = a;
    pair.proxy_b = b;
    return pair;
}

bool filters_agree(const ProxyFilter& a, const ProxyFilter& b) {
    return (a.layer & b.mask) != 0 && (b.layer & a.mask) != 0;
}

/// Whether the box comes within `motion` of the half-space's surface: its corner that lies deepest.
bool reaches(const ProxySet& proxies, const FloatAabb& box, const Pose& pose, const Plane& plane, double motion) {
    const dvec3 normal = rotate(pose.orientation, dvec3{plane.normal});
    const dvec3 lower = proxies.origin + dvec3{box.lower};
    const dvec3 upper = proxies.origin + dvec3{box.upper};
    const dvec3 corner{normal.x > 0.0 ? lower.x : upper.x, normal.y > 0.0 ? lower.y : upper.y,
                       normal.z > 0.0 ? lower.z : upper.z};
    return glm::dot(corner - pose.position, normal) <= static_cast<double>(plane.offset) + motion;
}

}  // namespace

double plane_motion(const BodyState& plane, const dvec3& point, double reach, double dt) noexcept {
    const double turn = std::min(glm::length(plane.spin) * dt, 2.0);
    return glm::length(plane.velocity) * dt + turn * (glm::length(point - plane.pose.position) + reach);
}

dvec3 middle_of_motion(const ProxySet& proxies, const BodyArrays& bodies) {
    Aabb box;
    for (const Proxy& proxy : proxies.bounded) {
        const dvec3& at = bodies.states[proxy.body].pose.position;
        if (bodies.roles[proxy.body] == Role::Dynamic) box = merge(box, {at, at});
    }
    return is_empty(box) ? dvec3{0.0} : 0.5 * box.lower + 0.5 * box.upper;
}

void update_swept_bounds(ProxySet& proxies, const BodyArrays& bodies, const Motion& motion, Executor& executor) {
    const std::size_t count = proxies.bounded.size();
    proxies.boxes.resize(count);
    proxies.motion.resize(count);
    proxies.poses.resize(count);
    proxies.moved.clear();
    for (std::size_t i = 0; i < count; ++i) {
        const bool stays = bodies.roles[proxies.bounded[i].body] == Role::Static && !proxies.static_boxes_stale;
        if (!stays) proxies.moved.push_back(static_cast<std::uint32_t>(i));
    }
    executor.parallel_for(proxies.moved.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::uint32_t i = proxies.moved[k];
            const Proxy& proxy = proxies.bounded[i];
            const Role role = bodies.roles[proxy.body];
            const BodyState& state = bodies.states[proxy.body];
            proxies.poses[i] = state.pose * proxy.local;
            proxies.boxes[i] = round_outward(swept_box(proxy, proxies.poses[i], state, motion), proxies.origin);
            proxies.motion[i] = role == Role::Static
                                    ? 0.0
                                    : glm::length(state.velocity) * motion.dt + play(proxy, state, motion);
        }
    });
    proxies.static_boxes_stale = false;
}

void gather_pairs(const ProxySet& proxies, const BodyArrays& bodies, std::span<const ProxyPair> found, double dt,
                  std::vector<ContactPair>& pairs) {
    const auto count = static_cast<std::uint32_t>(proxies.bounded.size());
    std::size_t next = 0;
    pairs.clear();
    for (std::uint32_t i = 0; i < count; ++i) {
        for (; next < found.size() && found[next].a == i; ++next) {
            if (proxies.bounded[i].body == proxies.bounded[found[next].b].body) continue;
            pairs.push_back(make_pair(proxies, i, found[next].b));
        }
        if (!proxies.filters[i].movable) continue;
        for (std::uint32_t p = 0; p < proxies.unbounded.size(); ++p) {
            const Proxy& plane = proxies.unbounded[p];
            const Pose pose = bodies.states[plane.body].pose * plane.local;
            if (!filters_agree(proxies.filters[i], plane.filter)) continue;
            const Proxy& body = proxies.bounded[i];
            const double motion = plane_motion(bodies.states[plane.body], bodies.states[body.body].pose.position, body.reach, dt);
            if (!reaches(proxies, proxies.boxes[i], pose, std::get<Plane>(*plane.shape), motion)) continue;
            pairs.push_back(make_pair(proxies, i, count + p));
        }
    }
}

void list_shape_pairs(const ProxySet& proxies, const BodyArrays& bodies, std::span<const ContactPair> pairs, double dt,
                      Executor& executor, std::vector<ShapePair>& out) {
    out.resize(pairs.size());
    executor.parallel_for(pairs.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Proxy& a = proxy_at(proxies, pairs[i].proxy_a);
            const Proxy& b = proxy_at(proxies, pairs[i].proxy_b);
            // B may be a plane, which has neither box nor motion of its own here.
            const bool b_bounded = pairs[i].proxy_b < proxies.bounded.size();
            const BodyState& state_b = bodies.states[b.body];
            const double motion_b = b_bounded
                                        ? proxies.motion[pairs[i].proxy_b]
                                        : plane_motion(state_b, bodies.states[a.body].pose.position, a.reach, dt);
            const double closing = proxies.motion[pairs[i].proxy_a] + motion_b;
            out[i].a = a.shape;
            out[i].b = b.shape;
            out[i].pose_a = proxies.poses[pairs[i].proxy_a];
            out[i].pose_b = b_bounded ? proxies.poses[pairs[i].proxy_b] : state_b.pose * b.local;
            out[i].margin = static_cast<float>(std::min(closing, kMarginShare * std::min(a.extent, b.extent)));
        }
    });
}

}  // namespace carom::dynamics
