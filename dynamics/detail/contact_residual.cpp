#include <carom/dynamics/detail/contact_residual.hpp>

#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/part_surface.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

double friction_of(const ProxySet& proxies, const ContactPair& pair, const ContactManifold& manifold) {
    const Surface met = combine(surface_of_part(proxies.surfaces[pair.proxy_a()], manifold.part_a), surface_of_part(proxies.surfaces[pair.proxy_b()], manifold.part_b));
    return static_cast<double>(met.friction);
}

dvec3 velocity_at_arm(const BodyState& now, const dvec3& arm) { return now.velocity + glm::cross(now.spin, arm); }

/// By how much a point misses Signorini's law [m/s].
double speed_error(double normal_speed, double impulse, double separation) {
    if (impulse > 0.0) return std::abs(normal_speed);
    return separation <= 0.0 ? std::max(-normal_speed, 0.0) : 0.0;
}

}  // namespace

void ResidualMeter::add_impulse(const ContactPair& pair, const dvec3& impulse) {
    Load &a = loads_[pair.body_a.slot], &b = loads_[pair.body_b.slot];
    a.impulse -= impulse, b.impulse += impulse;
    a.lengths += glm::length(impulse), b.lengths += glm::length(impulse);
    a.touched = b.touched = true;
}

double ResidualMeter::imbalance(std::size_t slot, const BodyArrays& bodies, const ResidualStep& step) const {
    const BodyMass& mass = bodies.masses[slot];
    dvec3 expected = before_[slot].velocity + step.dt * bodies.acceleration(slot, step.gravity);
    if (!bodies.traits.empty() && bodies.traits[slot].linear_damping > 0.0) {
        const Decay d = decay(bodies.traits[slot].linear_damping * step.dt);
        expected = d.left * before_[slot].velocity + (d.first * step.dt) * bodies.acceleration(slot, step.gravity);
    }
    const dvec3 missing = mass.mass * (bodies.states[slot].velocity - expected) - loads_[slot].impulse;
    const double all = loads_[slot].lengths + mass.mass * step.dt * glm::length(bodies.acceleration(slot, step.gravity));
    return all > 0.0 ? glm::length(free_moves(mass.locked) * missing) / all : 0.0;
}

ContactResidual ResidualMeter::measure(const ContactSet& contacts, const ProxySet& proxies, const BodyArrays& bodies, const ResidualStep& step,
                                       std::span<const unsigned char> jointed) {
    ContactResidual out;
    loads_.assign(bodies.states.size(), {});
    double largest = 0.0, excess = 0.0;
    for (std::size_t m = 0; m < contacts.manifolds.size(); ++m) {
        const ContactManifold& manifold = contacts.manifolds[m];
        if (manifold.pair == kNoPair) continue;
        const ContactPair& pair = contacts.pairs[manifold.pair];
        if (!pair.is_solved()) continue;
        const double friction = friction_of(proxies, pair, manifold);
        const BodyState &a = bodies.states[pair.body_a.slot], &b = bodies.states[pair.body_b.slot];
        for (std::size_t k = 0; k < manifold.count; ++k) {
            const PointImpulse& point = contacts.impulses[manifold.first_point + k];
            const ContactPoint& where = contacts.points[manifold.first_point + k];
            const dvec3 normal{manifold.normal}, at = proxies.poses[pair.proxy_a()].position + dvec3{where.position};
            const auto pushed = static_cast<double>(point.normal);
            add_impulse(pair, static_cast<double>(step.substeps) * (pushed * normal + dvec3{point.friction}));
            // Arms are those of the step's start, as the solver's are.
            const dvec3 u = velocity_at_arm(b, at - before_[pair.body_b.slot].pose.position) - velocity_at_arm(a, at - before_[pair.body_a.slot].pose.position);
            out.speed = std::max(out.speed, speed_error(glm::dot(u, normal), pushed, static_cast<double>(where.separation)));
            largest = std::max(largest, pushed);
            excess = std::max(excess, glm::length(dvec3{point.friction}) - friction * pushed);
        }
    }
    if (largest > 0.0) out.cone = excess / largest;
    for (std::size_t slot = 0; slot < loads_.size(); ++slot) {
        const bool by_contacts_alone = loads_[slot].touched && (jointed.empty() || jointed[slot] == 0);
        if (by_contacts_alone && bodies.roles[slot] == Role::Dynamic) out.balance = std::max(out.balance, imbalance(slot, bodies, step));
    }
    return out;
}

}  // namespace carom::dynamics
