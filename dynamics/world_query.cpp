// Rays, energy, momentum, the hash and the contacts of a world.
#include <carom/core/check.hpp>
#include <carom/core/hash.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/world_impl.hpp>

namespace carom {

std::uint64_t World::state_hash() const {
    StateHash hash;
    for (const BodyId body : impl_->body_order) {
        const dynamics::BodyState& state = impl_->arrays.states[body.slot];
        hash.add(state.pose);
        hash.add(state.velocity);
        hash.add(state.spin);
        if (!impl_->sleepers.is_on()) continue;
        hash.add(static_cast<std::uint64_t>(impl_->arrays.roles[body.slot]));
        impl_->sleepers.add_to(hash, body.slot);
    }
    return hash.digest();
}

Energy World::energy() const {
    Energy sum;
    for (const BodyId body : impl_->body_order) {
        if (!dynamics::has_mass(impl_->arrays.roles[body.slot])) continue;
        const dynamics::BodyState& state = impl_->arrays.states[body.slot];
        const dynamics::BodyMass& mass = impl_->arrays.masses[body.slot];
        sum.kinetic += 0.5 * mass.mass * glm::dot(state.velocity, state.velocity) +
                       0.5 * glm::dot(state.spin, dynamics::angular_momentum(state, mass));
        sum.potential -= mass.mass * glm::dot(impl_->def.gravity, state.pose.position);
    }
    for (const JointId joint : impl_->joints.order()) {
        const SpringDef* spring = std::get_if<SpringDef>(&impl_->joints.find(joint)->def);
        if (spring == nullptr) continue;
        const double stretch = joint_state(joint).stretch;
        sum.potential += 0.5 * spring->stiffness * stretch * stretch;
    }
    return sum;
}

Momentum World::momentum() const {
    Momentum sum;
    for (const BodyId body : impl_->body_order) {
        if (!dynamics::has_mass(impl_->arrays.roles[body.slot])) continue;
        const dynamics::BodyState& state = impl_->arrays.states[body.slot];
        const dynamics::BodyMass& mass = impl_->arrays.masses[body.slot];
        const dvec3 linear = mass.mass * state.velocity;
        sum.linear += linear;
        sum.angular += dynamics::angular_momentum(state, mass) + glm::cross(state.pose.position, linear);
    }
    return sum;
}

std::size_t World::contact_count() const noexcept { return impl_->contacts.manifold_count() + impl_->sleepers.contacts().manifolds.size(); }

const Broadphase& World::broadphase() const noexcept { return impl_->broadphase; }
dvec3 World::broadphase_origin() const noexcept { return impl_->proxies.origin; }

ContactView World::contact(std::size_t index) const {
    CAROM_REQUIRE(index < contact_count(), ErrorCode::InvalidArgument, "no contact of that index", {});
    const bool awake = index < impl_->contacts.manifold_count();
    const dynamics::ContactSet& set = awake ? impl_->contacts : impl_->sleepers.contacts();
    const std::size_t number = awake ? impl_->contacts.manifold_number(index) : index - impl_->contacts.manifold_count();
    ContactView view;
    view.manifold = set.whole(static_cast<std::uint32_t>(number));
    const dynamics::ContactPair& pair = set.pairs[view.manifold.pair];
    view.shape_a = pair.shape_a();
    view.shape_b = pair.shape_b();
    view.body_a = pair.body_a;
    view.body_b = pair.body_b;
    view.origin = impl_->proxies.poses[pair.proxy_a()].position;
    view.friction_impulse.fill(vec3{0.0f});
    const std::span<const dynamics::PointImpulse> impulses = set.impulses_of(static_cast<std::uint32_t>(number));
    for (std::size_t k = 0; k < impulses.size(); ++k) {
        view.normal_impulse[k] = impulses[k].normal;
        view.friction_impulse[k] = impulses[k].friction;
    }
    return view;
}

std::optional<WorldRayHit> World::cast_ray(const Ray& ray) const {
    const Status status = validate(ray);
    CAROM_REQUIRE(status.ok(), status.error().code, status.error().message, std::nullopt);
    std::optional<WorldRayHit> best;
    Ray rest = ray;
    for (const BodyId body : impl_->body_order) {
        const dynamics::BodyRecord& record = *impl_->bodies.find(body);
        if (record.quarantined) continue;
        const Pose pose = impl_->body_pose(body);
        for (const ShapeId id : record.shapes) {
            const dynamics::ShapeRecord& s = *impl_->shapes.find(id);
            const std::optional<RayHit> hit = carom::cast_ray(s.shape, pose * s.def->local, rest);
            if (!hit || (best && hit->distance >= best->hit.distance)) continue;
            best = WorldRayHit{body, id, *hit};
            rest.max_distance = hit->distance;
        }
    }
    return best;
}

}  // namespace carom
