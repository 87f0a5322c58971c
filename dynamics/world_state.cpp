// Reading and setting the state of bodies and shapes.
#include <carom/core/check.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/world_impl.hpp>

#include <cmath>

namespace carom {

namespace {

const Shape kNoShape = Sphere{1.0f};
const ShapeDef kNoShapeDef{};
const std::string kNoName;

}  // namespace

#define CAROM_FIND_BODY(body, ...)                                                          \
    const dynamics::BodyRecord* record = impl_->bodies.find(body);                          \
    CAROM_REQUIRE(record != nullptr, ErrorCode::DeadId, "no such body", __VA_ARGS__)
#define CAROM_FIND_SHAPE(id, ...)                                                           \
    const dynamics::ShapeRecord* record = impl_->shapes.find(id);                           \
    CAROM_REQUIRE(record != nullptr, ErrorCode::DeadId, "no such shape", __VA_ARGS__)

Pose World::Impl::body_pose(BodyId body) const {
    const Pose& principal = arrays.masses[body.slot].principal;
    const Pose& pose = arrays.states[body.slot].pose;
    return principal == Pose{} ? pose : pose * inverse(principal);
}

void World::Impl::place_body(BodyId body, const Pose& pose) {
    const Pose& principal = arrays.masses[body.slot].principal;
    arrays.states[body.slot].pose = principal == Pose{} ? pose : pose * principal;
    if (arrays.roles[body.slot] != dynamics::Role::Static) return;
    for (const ShapeId shape : bodies.find(body)->shapes) proxies.stale[shape.slot] = 1;
}

BodyType World::type(BodyId body) const {
    CAROM_FIND_BODY(body, BodyType::Static);
    return record->type;
}
const std::string& World::name(BodyId body) const {
    CAROM_FIND_BODY(body, kNoName);
    return record->name;
}
Pose World::pose(BodyId body) const {
    CAROM_FIND_BODY(body, {});
    return impl_->body_pose(body);
}
dvec3 World::center_of_mass(BodyId body) const {
    CAROM_FIND_BODY(body, dvec3{0.0});
    return impl_->arrays.states[body.slot].pose.position;
}
dvec3 World::linear_velocity(BodyId body) const {
    CAROM_FIND_BODY(body, dvec3{0.0});
    return impl_->arrays.states[body.slot].velocity;
}
dvec3 World::angular_velocity(BodyId body) const {
    CAROM_FIND_BODY(body, dvec3{0.0});
    return impl_->arrays.states[body.slot].spin;
}
MassProperties World::mass_properties(BodyId body) const {
    CAROM_FIND_BODY(body, {});
    const dynamics::BodyMass& mass = impl_->arrays.masses[body.slot];
    if (mass.mass == 0.0) return {};
    const dmat3 r = glm::mat3_cast(mass.principal.orientation);
    dmat3 scaled = r;
    for (int i = 0; i < 3; ++i) scaled[i] *= mass.moments[i];
    return {mass.mass, mass.principal.position, scaled * glm::transpose(r)};
}
bool World::is_quarantined(BodyId body) const {
    CAROM_FIND_BODY(body, false);
    return record->quarantined;
}
std::span<const ShapeId> World::shapes(BodyId body) const {
    CAROM_FIND_BODY(body, {});
    return record->shapes;
}

BodyId World::body_of(ShapeId shape) const {
    CAROM_FIND_SHAPE(shape, {});
    return record->body;
}
const Shape& World::shape(ShapeId shape) const {
    CAROM_FIND_SHAPE(shape, kNoShape);
    return record->shape;
}
const ShapeDef& World::shape_def(ShapeId shape) const {
    CAROM_FIND_SHAPE(shape, kNoShapeDef);
    return record->def;
}
Pose World::shape_pose(ShapeId shape) const {
    CAROM_FIND_SHAPE(shape, {});
    return impl_->body_pose(record->body) * record->def.local;
}

void World::release(BodyId body) {
    CAROM_FIND_BODY(body);
    if (!record->quarantined) return;
    impl_->bodies.find(body)->quarantined = false;
    impl_->arrays.roles[body.slot] = dynamics::role_of(record->type);
    impl_->put_in(body);
}

void World::set_pose(BodyId body, const Pose& pose) {
    CAROM_FIND_BODY(body);
    CAROM_REQUIRE(is_finite(pose), ErrorCode::NotFinite, "the pose must be finite");
    CAROM_REQUIRE(std::abs(glm::length(pose.orientation) - 1.0) <= 1e-3, ErrorCode::InvalidArgument,
                  "the orientation must be a unit quaternion");
    impl_->place_body(body, {pose.position, glm::normalize(pose.orientation)});
}
void World::set_linear_velocity(BodyId body, const dvec3& velocity) {
    CAROM_FIND_BODY(body);
    CAROM_REQUIRE(record->type != BodyType::Static, ErrorCode::WrongType, "static bodies have no velocity");
    CAROM_REQUIRE(is_finite(velocity), ErrorCode::NotFinite, "the velocity must be finite");
    impl_->arrays.states[body.slot].velocity = velocity;
}
void World::set_angular_velocity(BodyId body, const dvec3& velocity) {
    CAROM_FIND_BODY(body);
    CAROM_REQUIRE(record->type != BodyType::Static, ErrorCode::WrongType, "static bodies have no velocity");
    CAROM_REQUIRE(is_finite(velocity), ErrorCode::NotFinite, "the velocity must be finite");
    impl_->arrays.states[body.slot].spin = velocity;
}
void World::apply_impulse(BodyId body, const dvec3& impulse, const dvec3& point) {
    CAROM_FIND_BODY(body);
    CAROM_REQUIRE(record->type == BodyType::Dynamic, ErrorCode::WrongType, "only dynamic bodies take impulses");
    CAROM_REQUIRE(is_finite(impulse) && is_finite(point), ErrorCode::NotFinite, "impulse and point must be finite");
    dynamics::BodyState& state = impl_->arrays.states[body.slot];
    const dynamics::BodyMass& mass = impl_->arrays.masses[body.slot];
    const dvec3 velocity = state.velocity + mass.inverse_mass * impulse;
    const dvec3 spin =
        state.spin + dynamics::world_inverse_inertia(state, mass) * glm::cross(point - state.pose.position, impulse);
    CAROM_REQUIRE(is_finite(velocity) && is_finite(spin), ErrorCode::InvalidArgument, "the impulse is too large for the body");
    state.velocity = velocity;
    state.spin = spin;
}

}  // namespace carom
