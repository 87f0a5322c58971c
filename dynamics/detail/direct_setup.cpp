#include <carom/dynamics/detail/direct_setup.hpp>

#include <carom/core/math.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/part_surface.hpp>
#include <carom/dynamics/detail/slender.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::dynamics {
namespace {

/// Damping of a contact: its time over the length of a step. Six steps of 1/60 s are the 0.1 s that prototypes settled on.
constexpr double kRelaxationSteps = 6.0;
/// A column of L times its width buckles under its own weight where it sags by more than 7.84 / L² of it (Greenhill 1881); a quarter of that
/// leaves room for sway.
constexpr double kBucklingShare = 2.0;
/// Below this share of the largest body a sag drowns in the float of the separations.
constexpr double kLeastSag = 1e-6;
/// Of what gravity does to a velocity in a step: errors of momentum, and of how fast what slides is lifted, which is the error of its friction.
constexpr double kSpeedShare = 1e-6, kSlipShare = 0.005;

/// What all overlaps of an island throw its top up by, where each pushes as hard as it may: this share of the smaller shape's smallest extent.
/// There is no pass that takes out what they were pushed apart with, as the soft solver has.
constexpr double kHopShare = 0.01;

struct Surfaces {
    double friction = 0.0, restitution = 0.0;
};

Surfaces surfaces_of(const ProxySet& proxies, const ContactPair& pair, const ContactManifold& manifold) {
    const auto surface = [&](std::uint32_t slot, std::uint16_t part) {
        return surface_of_part(proxies.surfaces[slot], part);
    };
    const Surface a = surface(pair.proxy_a(), manifold.part_a), b = surface(pair.proxy_b(), manifold.part_b);
    const Surface met = combine(a, b);
    return {static_cast<double>(met.friction), static_cast<double>(met.restitution)};
}


double extent_of(const ProxySet& proxies, const ContactPair& pair) {
    return std::min(proxies.extents[pair.proxy_a()], proxies.extents[pair.proxy_b()]);
}

void fill_body(const BodyArrays& bodies, std::uint32_t slot, const DirectStep& step, DirectBody& body) {
    const BodyState& state = bodies.states[slot];
    const BodyMass& mass = bodies.masses[slot];
    const dmat3 r = glm::mat3_cast(state.pose.orientation);
    dmat3 scaled = r;
    for (int i = 0; i < 3; ++i) scaled[i] *= mass.moments[i];
    body.mass = mass.mass;
    body.inertia = scaled * glm::transpose(r);
    body.free_velocity = state.velocity + step.dt * step.gravity;
    body.free_spin =
        is_slender(mass) ? SlenderMotion(state, mass).precessed(state.spin, step.dt) : state.spin + gyroscopic_change(state, mass, step.dt);
    if (!bodies.traits.empty()) {
        const BodyTraits& traits = bodies.traits[slot];
        const Decay along = decay(traits.linear_damping * step.dt), about = decay(traits.angular_damping * step.dt);
        body.free_velocity = along.left * state.velocity + (along.first * step.dt) * bodies.acceleration(slot, step.gravity);
        body.free_spin = about.left * body.free_spin + (about.first * step.dt) * (world_inverse_inertia(state, mass) * traits.torque);
    }
    body.velocity = state.velocity;
    body.spin = state.spin;
}

}  // namespace

IslandShape look_at_island(const DirectWorld& world, std::span<const std::uint32_t> bodies, std::span<const std::uint32_t> manifolds,
                           const DirectStep& step) {
    IslandShape shape;
    shape.extent = std::numeric_limits<double>::infinity();
    const double pull = glm::length(step.gravity);
    const dvec3 down = pull > 0.0 ? step.gravity / pull : dvec3{0.0};
    double lowest = -std::numeric_limits<double>::infinity(), highest = -lowest, mass = 0.0, speed_sq = 0.0;
    for (const std::uint32_t slot : bodies) {
        const BodyState& state = world.bodies.states[slot];
        const double depth = glm::dot(down, state.pose.position);
        lowest = std::max(lowest, depth);
        highest = std::min(highest, depth);
        mass += world.bodies.masses[slot].mass;
        speed_sq = std::max(speed_sq, glm::dot(state.velocity, state.velocity));
    }
    // A body at rest falls by g dt in a step: anything up to a few times that is no impact, as in the soft solver.
    const double threshold = 4.0 * pull * step.dt;
    for (const std::uint32_t m : manifolds) {
        const ContactManifold& manifold = world.contacts.manifolds[m];
        const ContactPair& pair = world.contacts.pairs[manifold.pair];
        shape.extent = std::min(shape.extent, extent_of(world.proxies, pair));
        for (const std::uint32_t slot : {pair.proxy_a(), pair.proxy_b()}) {
            if (world.bodies.roles[world.proxies.bodies[slot]] == Role::Dynamic) shape.largest = std::max(shape.largest, world.proxies.by_slot[slot].reach);
        }
        if (shape.impact || pair.passes || surfaces_of(world.proxies, pair, manifold).restitution <= 0.0) continue;
        const BodyState& a = world.bodies.states[pair.body_a.slot];
        const BodyState& b = world.bodies.states[pair.body_b.slot];
        for (const ContactPoint& point : world.contacts.points_of(manifold)) {
            const dvec3 at = world.proxies.poses[pair.proxy_a()].position + dvec3{point.position};
            shape.impact |= glm::dot(point_velocity(b, at) - point_velocity(a, at), dvec3{manifold.normal}) < -threshold;
        }
    }
    shape.weight = mass * pull;
    shape.height = lowest - highest + shape.extent;
    shape.top_speed = std::sqrt(speed_sq);
    return shape;
}

IslandStiffness stiffness_of(const IslandShape& shape, const DirectStep& step) noexcept {
    const double slender = shape.height / shape.extent;
    const double sag = std::max(shape.extent * std::min(step.sag, kBucklingShare / (slender * slender)), kLeastSag * shape.largest);
    IslandStiffness out;
    out.sag = sag;
    out.relaxation = kRelaxationSteps * step.long_dt;
    out.hop = std::sqrt(2.0 * glm::length(step.gravity) * kHopShare);
    out.height = shape.height;
    out.tolerances.speed_tolerance = kSpeedShare * glm::length(step.gravity) * step.dt;
    out.tolerances.slip_tolerance = kSlipShare * glm::length(step.gravity) * step.dt;
    return out;
}

double IslandStiffness::most_push(double extent, std::size_t bodies) const noexcept {
    return hop * std::sqrt(extent) / std::clamp(height / extent, 1.0, static_cast<double>(std::max<std::size_t>(bodies, 1)));
}

void fill_problem(const DirectWorld& world, const IslandLists& island, const IslandStiffness& stiffness, const DirectStep& step,
                  DirectProblem& problem) {
    const std::span<const std::uint32_t> bodies = island.bodies;
    problem.bodies.resize(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) fill_body(world.bodies, bodies[i], step, problem.bodies[i]);
    problem.contacts.clear();
    const double dt = step.dt, slow = dt + stiffness.relaxation;
    for (std::size_t i = 0; i < island.manifolds.size(); ++i) {
        const std::uint32_t m = island.manifolds[i];
        const ContactManifold& manifold = world.contacts.manifolds[m];
        const ContactPair& pair = world.contacts.pairs[manifold.pair];
        const BodyState& a = world.bodies.states[pair.body_a.slot];
        const BodyState& b = world.bodies.states[pair.body_b.slot];
        DirectContact c;
        c.a = island.local_of_slot[pair.body_a.slot];
        c.b = island.local_of_slot[pair.body_b.slot];
        c.normal = glm::normalize(dvec3{manifold.normal});
        c.friction = surfaces_of(world.proxies, pair, manifold).friction;
        c.softness = stiffness.sag / (island.loads[i] * dt * slow);
        const double extent = extent_of(world.proxies, pair);
        const double push_limit = std::min(step.max_push * extent / dt, stiffness.most_push(extent, bodies.size()));
        // All points of a manifold push by as much less than they would: a difference between them is what rights a body that leans.
        double deepest = 0.0;
        for (const ContactPoint& point : world.contacts.points_of(manifold)) deepest = std::min(deepest, static_cast<double>(point.separation));
        const double held_back = std::max(-deepest / slow - push_limit, 0.0);
        for (std::size_t k = 0; k < world.contacts.solved_points(m); ++k) {
            const ContactPoint& point = world.contacts.points[manifold.first_point + k];
            const dvec3 at = world.proxies.poses[pair.proxy_a()].position + dvec3{point.position};
            const auto separation = static_cast<double>(point.separation);
            c.arm_a = at - a.pose.position;
            c.arm_b = at - b.pose.position;
            c.drift = dvec3{0.0};
            if (c.a == kNoBody) c.drift -= point_velocity(a, at);
            if (c.b == kNoBody) c.drift += point_velocity(b, at);
            c.bias = separation > 0.0 ? separation / dt : std::min(separation / slow + held_back, 0.0);
            const dvec3 friction = static_cast<double>(step.substeps) * dvec3{world.contacts.impulses_of(m)[k].friction};
            c.friction_guess = friction - glm::dot(friction, c.normal) * c.normal;
            problem.contacts.push_back(c);
        }
    }
}

void guess_impulses(const DirectWorld& world, std::span<const std::uint32_t> manifolds, const DirectStep& step, DirectProblem& problem) {
    std::size_t next = 0;
    for (const std::uint32_t m : manifolds) {
        for (std::size_t k = 0; k < world.contacts.solved_points(m); ++k) {
            DirectContact& c = problem.contacts[next++];
            c.impulse = step.substeps * static_cast<double>(world.contacts.impulses_of(m)[k].normal) * c.normal + c.friction_guess;
        }
    }
}

void apply_solution(const DirectProblem& problem, std::span<const std::uint32_t> bodies, std::span<const std::uint32_t> manifolds,
                    const DirectStep& step, const DirectWorld& world) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const DirectBody& body = problem.bodies[i];
        BodyState& state = world.bodies.states[bodies[i]];
        const BodyMass& mass = world.bodies.masses[bodies[i]];
        state.velocity = body.velocity;
        state.spin = body.spin;
        state.pose.position += step.dt * body.velocity;
        if (is_slender(mass)) {
            SlenderMotion motion(state, mass);
            motion.advance(body.spin, step.dt);
            motion.finish(state, mass);
            continue;
        }
        state.pose.orientation = glm::normalize(rotation_from_vector(step.dt * body.spin) * state.pose.orientation);
    }
    const double share = 1.0 / step.substeps;
    std::size_t next = 0;
    for (const std::uint32_t m : manifolds) {
        for (std::size_t k = 0; k < world.contacts.solved_points(m); ++k) {
            const DirectContact& c = problem.contacts[next++];
            const double normal = glm::dot(c.impulse, c.normal);
            world.contacts.impulses_of(m)[k] = {static_cast<float>(share * normal), vec3{share * (c.impulse - normal * c.normal)}};
        }
    }
}

}  // namespace carom::dynamics
