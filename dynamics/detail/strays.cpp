#include <carom/dynamics/detail/strays.hpp>

#include <carom/collision/aabb.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

constexpr double kRounding = 1e-12;  // far more than all of it, of the numbers that go into a box

}  // namespace

bool strays(const ProxySet& proxies, std::uint32_t proxy, const BodyWay& step) {
    const Proxy& p = proxies.by_slot[proxy];
    const double turn = std::min(glm::length(step.to.spin) * step.dt, 2.0);
    const Aabb ends = merge(bounds(p.shape, step.from * p.local), bounds(p.shape, step.to.pose * p.local));
    const FloatAabb way = round_outward(inflate(ends, 0.5 * p.reach * turn * turn), proxies.origin);
    const FloatAabb& known = proxies.boxes[proxy];
    return glm::any(glm::lessThan(way.lower, known.lower)) || glm::any(glm::greaterThan(way.upper, known.upper));
}

// The box that the broadphase has is that of the start, drawn along the velocity of then, and wider all round by what motion has beyond that. Against the
// origin of its body no point has moved by more than the chord of the turn at the reach. Boxes of meshes are wider than the mesh: of them nothing such is known.
bool surely_stays(const ProxySet& proxies, std::uint32_t proxy, const BodyWay& step) {
    const Proxy& p = proxies.by_slot[proxy];
    if (proxies.kinds[proxy] != ProxyKind::Bounded || type_of(p.shape) == ShapeType::TriangleMesh ||
        type_of(p.shape) == ShapeType::Compound)
        return false;
    const dvec3 path = step.velocity * step.dt, way = step.to.pose.position - step.from.position;
    const double drawn = glm::length(path), turn = std::min(glm::length(step.to.spin) * step.dt, 2.0);
    const double cosine = glm::dot(step.from.orientation, step.to.pose.orientation);
    const double chord = 2.0 * p.reach * std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), bend = 0.5 * p.reach * turn * turn;
    const double far = p.reach + glm::length(step.from.position) + drawn + glm::length(way) + glm::length(proxies.origin);
    const dvec3 room{proxies.motion[proxy] - drawn - chord - bend - kRounding * far};
    return room.x > 0.0 && glm::all(glm::greaterThanEqual(way, glm::min(path, dvec3{0.0}) - room)) &&
           glm::all(glm::lessThanEqual(way, glm::max(path, dvec3{0.0}) + room));
}

}  // namespace carom::dynamics
