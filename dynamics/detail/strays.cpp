#include <carom/dynamics/detail/strays.hpp>

#include <carom/collision/aabb.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

constexpr double kRounding = 1e-12;  // far more than all of it, of the numbers that go into a box

/// Whether a ball is in its box as it stands at `end`, which is all that matters of one that does not turn. Rounding is monotone: a difference of doubles that comes
/// out above a float is not below it.
bool ball_is_inside(double radius, const dvec3& end, const dvec3& origin, const FloatAabb& box) noexcept {
    const dvec3 wide = radius * (1.0 + 0x1p-46) + 0x1p-49 * glm::abs(end);  // more than bounds() has, and its rounding
    return glm::all(glm::greaterThan((end - wide) - origin, dvec3(box.lower))) &&
           glm::all(glm::lessThan((end + wide) - origin, dvec3(box.upper)));
}

}  // namespace

bool strays(const ProxySet& proxies, std::uint32_t proxy, const BodyWay& step) {
    const Proxy& p = proxies.by_slot[proxy];
    const double turn = step.to.spin == dvec3{0.0} ? 0.0 : std::min(glm::length(step.to.spin) * step.dt, 2.0);
    const bool is_ball = type_of(p.shape) == ShapeType::Sphere && p.local.get().position == dvec3{0.0};
    Aabb ends = bounds(p.shape, is_ball ? step.to.pose : step.to.pose * p.local.get());
    // Without a turn there is no bend, and the box of the start is in the one that the broadphase made of it.
    if (turn != 0.0) ends = inflate(merge(bounds(p.shape, step.from * p.local.get()), ends), 0.5 * p.reach * turn * turn);
    return is_beyond(ends, proxies.origin, proxies.boxes[proxy]);
}

// The box that the broadphase has is that of the start, drawn along the velocity of then, and wider all round by what motion has beyond that. Against the
// origin of its body no point has moved by more than the chord of the turn at the reach. Boxes of meshes are wider than the mesh: of them nothing such is known.
bool surely_stays(const ProxySet& proxies, std::uint32_t proxy, const BodyWay& step) {
    if (proxies.surfaces[proxy].is_ball && step.to.spin == dvec3{0.0} &&
        ball_is_inside(0.5 * proxies.extents[proxy], step.to.pose.position, proxies.origin, proxies.boxes[proxy]))
        return true;
    const Proxy& p = proxies.by_slot[proxy];
    if (proxies.kinds[proxy] != ProxyKind::Bounded || type_of(p.shape) == ShapeType::TriangleMesh ||
        type_of(p.shape) == ShapeType::Compound)
        return false;
    const dvec3 path = step.velocity * step.dt, way = step.to.pose.position - step.from.position;
    const double most = proxies.motion[proxy] - kRounding * p.reach;
    if (!(most > 0.0 && most * most > (1.0 + 2.0 * kRounding) * glm::dot(path, path))) return false;  // no room at all, without a root
    const double drawn = glm::length(path), turn = std::min(glm::length(step.to.spin) * step.dt, 2.0);
    const double cosine = glm::dot(step.from.orientation, step.to.pose.orientation);
    const double chord = 2.0 * p.reach * std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), bend = 0.5 * p.reach * turn * turn;
    const double far = p.reach + glm::length(step.from.position) + drawn + glm::length(way) + glm::length(proxies.origin);
    const dvec3 room{proxies.motion[proxy] - drawn - chord - bend - kRounding * far};
    return room.x > 0.0 && glm::all(glm::greaterThanEqual(way, glm::min(path, dvec3{0.0}) - room)) &&
           glm::all(glm::lessThanEqual(way, glm::max(path, dvec3{0.0}) + room));
}

}  // namespace carom::dynamics
