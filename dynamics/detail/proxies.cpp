#include <carom/dynamics/detail/proxies.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/core/bundle.hpp>
#include <carom/dynamics/detail/room.hpp>
#include <carom/dynamics/detail/swept_boxes.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace carom::dynamics {
namespace {

constexpr std::size_t kGrain = 256;
constexpr double kCurvedFirmness = 0.25;
constexpr double kLeastStay = 0.5;     // what will be out of its room in less than two steps gets none

/// What gravity may do in the step [m].
double pull_of(const Motion& motion) { return glm::length(motion.gravity) * motion.dt * motion.dt; }

/// Motion of any point of the shape beyond the straight path of the centre of mass.
double play(const Proxy& proxy, const BodyState& state, double pull, double dt) {
    const double turn = std::min(glm::length(state.spin) * dt, 2.0);
    return pull + proxy.reach * turn;
}

/// The motion of one body: where bodies have traits, its own pull stands for gravity.
Motion motion_of(const BodyArrays& bodies, std::size_t slot, const Motion& motion) {
    return bodies.traits.empty() ? motion : Motion{bodies.acceleration(slot, motion.gravity), motion.dt};
}

/// @param slack  all round: of what has room, its room, and there is no path.
void sweep_one(ProxySet& set, std::uint32_t i, const BodyState& state, bool is_static, double dt, double slack) {
    const Proxy& proxy = set.by_slot[i];
    set.poses[i] = state.pose * proxy.local.get();
    const Aabb box = bounds(proxy.shape, set.poses[i]);
    const dvec3 path = set.anchors[i].room >= 0.0 ? dvec3{0.0} : state.velocity * dt;
    const Aabb moved{box.lower + glm::min(path, dvec3{0.0}), box.upper + glm::max(path, dvec3{0.0})};
    set.boxes[i] = round_outward(inflate(moved, slack), set.origin);
    set.motion[i] = is_static ? 0.0 : glm::length(path) + slack;
}

bool is_curved(const Shape& shape) {
    switch (type_of(shape)) {
        case ShapeType::Sphere:
        case ShapeType::Capsule:
        case ShapeType::Cylinder:
        case ShapeType::Cone: return true;
        case ShapeType::Compound: return std::ranges::any_of(compound_of(shape)->parts(), [](const CompoundPart& part) { return is_curved(part.shape); });
        default: return false;
    }
}

/// How high over the half-space's surface the box's corner is that lies deepest, less `motion`.
double gap_over(const dvec3& origin, const FloatAabb& box, const Pose& pose, const Plane& plane, double motion) {
    const dvec3 normal = rotate(pose.orientation, dvec3{plane.normal});
    const dvec3 lower = origin + dvec3{box.lower};
    const dvec3 upper = origin + dvec3{box.upper};
    const dvec3 corner{normal.x > 0.0 ? lower.x : upper.x, normal.y > 0.0 ? lower.y : upper.y,
                       normal.z > 0.0 ? lower.z : upper.z};
    return glm::dot(corner - pose.position, normal) - (static_cast<double>(plane.offset) + motion);
}

/// Chooses the origin where there is none, or where the dynamic bodies have gone far from it; then every box is stale.
void keep_origin_near(ProxySet& set, const BodyArrays& bodies) {
    Aabb dynamic, all;
    bool any_listed = false;
    for (std::size_t i = 0; i < set.by_slot.size(); ++i) {
        any_listed |= set.listed[i] != 0;
        if (set.kinds[i] != ProxyKind::Bounded) continue;
        const double reach = set.by_slot[i].reach;
        const dvec3& at = bodies.states[set.bodies[i]].pose.position;
        all = merge(all, {at - reach, at + reach});
        if (has_mass(bodies.roles[set.bodies[i]])) dynamic = merge(dynamic, {at, at});
    }
    const dvec3 middle = is_empty(dynamic) ? dvec3{0.0} : 0.5 * dynamic.lower + 0.5 * dynamic.upper;
    if (any_listed && (is_empty(all) || glm::length(middle - set.origin) <= glm::length(all.upper - all.lower))) return;
    set.origin = middle;
    set.stale.assign(set.stale.size(), 1);
}

/// How far from the centre of mass points are that turning moves: a ball about it looks the same however it turns, and is as easy to turn on.
double turning_reach(const ProxySet& set, const BodyArrays& bodies, std::uint32_t i) {
    const bool alike = set.surfaces[i].is_ball && bodies.masses[set.bodies[i]].inertia == InertiaClass::Isotropic;
    return alike ? 0.0 : set.by_slot[i].reach;
}

/// How fast a point of the shape may move [m/s].
double speed_of(const ProxySet& set, const BodyArrays& bodies, std::uint32_t i) {
    const BodyState& state = bodies.states[set.bodies[i]];
    return glm::length(state.velocity) + turning_reach(set, bodies, i) * glm::length(state.spin);
}

/// How far what is calm may come in a step [m]; the other may do as much. @param pull  what forces do in the step [m]
double most_way(double pull, const CalmRule& rule) { return std::isinf(rule.most_closing) ? rule.most_closing : 0.5 * rule.most_closing * pull; }

/// Of what has a box with room: whether it stays in it through the step. Then it has its pose, drift and motion.
bool stays(ProxySet& set, std::uint32_t i, const BodyArrays& bodies, const Motion& motion, const CalmRule& rule) {
    const Anchor& anchor = set.anchors[i];
    if (anchor.room < 0.0) return false;
    const std::uint32_t body = set.bodies[i];
    const BodyState& state = bodies.states[body];
    const dquat turn = state.pose.orientation * glm::conjugate(anchor.orientation);
    const double chord = 2.0 * glm::length(dvec3{turn.x, turn.y, turn.z});  // of a point one metre from the centre
    const double drift = glm::length(state.pose.position - anchor.position) + turning_reach(set, bodies, i) * chord;
    const double way = speed_of(set, bodies, i) * motion.dt, pull = pull_of(motion_of(bodies, body, motion));
    if (!(drift + way <= anchor.room && pull <= anchor.pull && way <= most_way(pull, rule))) return false;
    set.poses[i] = state.pose * set.by_slot[i].local.get();
    set.drift[i] = drift;
    set.stay[i] = anchor.room + drift;
    set.motion[i] = set.stay[i] + anchor.pull;
    set.way[i] = way + pull;
    return true;
}

void find_calm(ProxySet& set, const BodyArrays& bodies, const Motion& motion, const CalmRule& rule, Executor& executor) {
    executor.parallel_for(set.by_slot.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t slot = begin; slot < end; ++slot) {
            const auto i = static_cast<std::uint32_t>(slot);
            set.calm[i] = 0;
            set.drift[i] = 0.0;
            if (set.kinds[i] == ProxyKind::None || set.stale[i] != 0) continue;
            const bool still = lies_still(bodies.roles[set.bodies[i]]);
            set.calm[i] = still || (rule.share > 0.0 && set.kinds[i] == ProxyKind::Bounded && stays(set, i, bodies, motion, rule)) ? 1 : 0;
        }
    });
}

/// Whether a shape moves so little that its box gets room, and how much [m].
double room_for(const ProxySet& set, const BodyArrays& bodies, std::uint32_t i, double pull, double dt, const CalmRule& rule) {
    const double room = rule.share * set.extents[i] * set.firmness[i];
    if (!std::isfinite(room)) return -1.0;  // the surface of a kinematic body, which others may touch anywhere
    const double way = speed_of(set, bodies, i) * dt;
    return way <= kLeastStay * room && way <= most_way(pull, rule) ? room : -1.0;
}

bool is_round(const Proxy& proxy) {
    const ShapeType type = type_of(proxy.shape);
    if (type != ShapeType::Capsule && type != ShapeType::Cylinder && type != ShapeType::Cone) return false;
    const dvec3 axis = rotate(proxy.local.get().orientation, dvec3{0.0, 1.0, 0.0});
    return glm::length(glm::cross(axis, proxy.local.get().position)) <= 1e-9 * proxy.reach;
}

void list_rollers(ProxySet& set, const BodyArrays& bodies) {
    set.rollers.clear();
    std::vector<std::uint32_t> shapes(bodies.roles.size(), 0);
    for (std::size_t i = 0; i < set.by_slot.size(); ++i) shapes[set.bodies[i]] += set.kinds[i] == ProxyKind::None ? 0 : 1;
    for (std::uint32_t i = 0; i < set.by_slot.size(); ++i) {
        if (set.kinds[i] == ProxyKind::Bounded && shapes[set.bodies[i]] == 1 && is_round(set.by_slot[i])) set.rollers.push_back(i);
    }
}

void list_changes(ProxySet& set) {
    set.moved.clear();
    set.removed.clear();
    for (std::uint32_t i = 0; i < set.by_slot.size(); ++i) {
        const bool bounded = set.kinds[i] == ProxyKind::Bounded;
        if (bounded && set.calm[i] == 0) set.moved.push_back(i);
        if (!bounded && set.listed[i] != 0) set.removed.push_back(i);
    }
}

}  // namespace

void put_proxy(ProxySet& set, NewProxy proxy, const ProxyFilter& filter) {
    const std::uint32_t slot = proxy.id.slot;
    drop_proxy(set, slot);
    if (set.by_slot.size() <= slot) {
        const std::size_t size = std::size_t{slot} + 1;
        set.by_slot.resize(size);
        set.kinds.resize(size, ProxyKind::None);
        set.filters.resize(size);
        set.boxes.resize(size);
        set.poses.resize(size);
        set.shapes.resize(size, nullptr);
        set.bodies.resize(size, 0);
        set.surfaces.resize(size);
        set.owners.resize(size);
        set.extents.resize(size, 0.0);
        set.motion.resize(size, 0.0);
        set.stale.resize(size, 0);
        set.listed.resize(size, 0);
        set.versions.resize(size, 0);
        set.boxlike.resize(size, 0);
        set.bounces.resize(size, 0);
        set.firmness.resize(size, 1.0);
        set.anchors.resize(size);
        set.calm.resize(size, 0);
        set.drift.resize(size, 0.0);
        set.stay.resize(size, 0.0);
        set.way.resize(size, 0.0);
    }
    const bool bounded = is_bounded(proxy.shape);
    if (!bounded) set.planes.insert(std::lower_bound(set.planes.begin(), set.planes.end(), slot), slot);
    set.kinds[slot] = bounded ? ProxyKind::Bounded : ProxyKind::Plane;
    set.filters[slot] = filter;
    set.stale[slot] = 1;
    ++set.versions[slot];
    set.boxlike[slot] = type_of(proxy.shape) == ShapeType::Box ? 1 : 0;
    set.bounces[slot] = bounces(proxy.shape, proxy.surface.restitution) ? 1 : 0;
    set.bodies[slot] = proxy.owner.slot;
    const bool is_ball = type_of(proxy.shape) == ShapeType::Sphere && proxy.local.get().position == dvec3{0.0};
    set.surfaces[slot] = {proxy.surface, compound_of(proxy.shape), is_ball};
    set.owners[slot] = {proxy.id, proxy.owner};
    set.extents[slot] = proxy.extent;
    set.firmness[slot] = is_curved(proxy.shape) ? kCurvedFirmness : 1.0;
    set.by_slot[slot] = std::move(static_cast<Proxy&>(proxy));
    set.changed = true;
}

void drop_proxy(ProxySet& set, std::uint32_t slot) {
    if (slot >= set.by_slot.size() || set.kinds[slot] == ProxyKind::None) return;
    if (set.kinds[slot] == ProxyKind::Plane) std::erase(set.planes, slot);
    set.kinds[slot] = ProxyKind::None;
    set.by_slot[slot] = Proxy{};
    set.changed = true;
}

double plane_motion(const BodyState& plane, const dvec3& point, double reach, double dt) noexcept {
    const double turn = std::min(glm::length(plane.spin) * dt, 2.0);
    return glm::length(plane.velocity) * dt + turn * (glm::length(point - plane.pose.position) + reach);
}

double motion_of_plane(const ProxySet& set, const BodyArrays& bodies, std::uint32_t plane, std::uint32_t other, double dt) noexcept {
    const dvec3& point = bodies.states[set.bodies[other]].pose.position;
    return plane_motion(bodies.states[set.bodies[plane]], point, set.by_slot[other].reach, dt);
}

double gap_over_plane(const ProxySet& set, const BodyArrays& bodies, std::uint32_t bounded, std::uint32_t plane, double dt) noexcept {
    const Plane& surface = std::get<Plane>(set.by_slot[plane].shape);
    return gap_over(set.origin, set.boxes[bounded], set.poses[plane], surface, motion_of_plane(set, bodies, plane, bounded, dt));
}

void update_swept_bounds(ProxySet& set, const BodyArrays& bodies, const Motion& motion, const CalmRule& rule, Executor& executor) {
    if (set.changed) {
        keep_origin_near(set, bodies);
        for (std::size_t i = 0; i < set.by_slot.size(); ++i) {
            set.shapes[i] = set.kinds[i] == ProxyKind::None ? nullptr : &set.by_slot[i].shape;
        }
        list_rollers(set, bodies);
    }
    set.changed = false;
    find_calm(set, bodies, motion, rule, executor);
    list_changes(set);
    executor.parallel_for(set.moved.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        std::array<SweptBox, kBundleWidth> boxes;
        std::size_t count = 0;
        for (std::size_t k = begin; k < end; ++k) {
            const std::uint32_t i = set.moved[k];
            const Proxy& proxy = set.by_slot[i];
            const std::uint32_t body = set.bodies[i];
            const BodyState& state = bodies.states[body];
            const bool is_static = lies_still(bodies.roles[body]);
            const double pull = pull_of(motion_of(bodies, body, motion));
            const double room = rule.share > 0.0 && !is_static ? room_for(set, bodies, i, pull, motion.dt, rule) : -1.0;
            const bool calms = room > 0.0;
            set.anchors[i] = {state.pose.position, state.pose.orientation, calms ? room : -1.0, pull};
            set.stay[i] = calms ? room : 0.0;
            set.way[i] = calms ? speed_of(set, bodies, i) * motion.dt + pull : 0.0;
            const Box* const box = std::get_if<Box>(&proxy.shape);
            if (box == nullptr || is_static) {
                sweep_one(set, i, state, is_static, motion.dt, calms ? room + pull : play(proxy, state, pull, motion.dt));
                continue;
            }
            boxes[count++] = {&state, &proxy.local.get(), box->half_extents, proxy.reach, calms ? room + pull : pull, calms, &set.poses[i], &set.boxes[i], &set.motion[i]};
            if (count == boxes.size()) sweep_boxes({boxes.data(), std::exchange(count, 0u)}, motion.dt, set.origin);
        }
        sweep_boxes({boxes.data(), count}, motion.dt, set.origin);
    });
    for (const std::uint32_t p : set.planes) {
        set.poses[p] = bodies.states[set.bodies[p]].pose * set.by_slot[p].local.get();
        set.stale[p] = 0;
    }
}

void note_refused(ProxySet& set) noexcept {
    for (const std::uint32_t slot : set.moved) set.anchors[slot].room = -1.0;
}

void note_cleared(ProxySet& set) noexcept {
    std::ranges::fill(set.listed, static_cast<unsigned char>(0));
    std::ranges::fill(set.stale, static_cast<unsigned char>(1));
    set.changed = true;
}

void note_listed(ProxySet& set) noexcept {
    for (const std::uint32_t slot : set.removed) set.listed[slot] = 0;
    for (const std::uint32_t slot : set.moved) {
        set.listed[slot] = 1;
        set.stale[slot] = 0;
    }
}

std::size_t ProxySet::memory() const noexcept {
    std::size_t sum = 0;
    for (const Proxy& proxy : by_slot) sum += proxy.local.memory();
    return sum + held_by(by_slot, kinds, filters, boxes, poses, shapes, bodies, surfaces, owners, extents, motion, stale, listed, versions, boxlike, bounces, firmness) +
           held_by(anchors, calm, drift, stay, way, rollers, planes, moved, removed);
}

}  // namespace carom::dynamics
