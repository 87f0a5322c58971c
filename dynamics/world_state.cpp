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
#define CAROM_FIND_DYNAMIC(body, message) \
    CAROM_FIND_BODY(body);                \
    CAROM_REQUIRE(record->type == BodyType::Dynamic, ErrorCode::WrongType, message)
#define CAROM_FIND_SHAPE(id, ...)                                                           \
    const dynamics::ShapeRecord* record = impl_->shapes.find(id);                           \
    CAROM_REQUIRE(record != nullptr, ErrorCode::DeadId, "no such shape", __VA_ARGS__)

Pose World::Impl::body_pose(BodyId body) const {
    const Pose principal = arrays.principal(body.slot);
    const Pose& pose = arrays.states[body.slot].pose;
    return principal == Pose{} ? pose : pose * inverse(principal);
}

void World::Impl::place_body(BodyId body, const Pose& pose) {
    const Pose principal = arrays.principal(body.slot);
    wake(body);
    contacts_hold = false;
    arrays.states[body.slot].pose = principal == Pose{} ? pose : pose * principal;
    note_placed(body);
    if (arrays.roles[body.slot] != dynamics::Role::Static) return;
    for (const ShapeId shape : bodies.find(body)->shapes) proxies.stale[shape.slot] = 1;
}

BodyType World::type(BodyId body) const {
    CAROM_FIND_BODY(body, BodyType::Static);
    return record->type;
}
const std::string& World::name(BodyId body) const {
    CAROM_FIND_BODY(body, kNoName);
    return record->name != nullptr ? *record->name : kNoName;
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
    const Pose principal = impl_->arrays.principal(body.slot);
    const dmat3 r = glm::mat3_cast(principal.orientation);
    dmat3 scaled = r;
    for (int i = 0; i < 3; ++i) scaled[i] *= mass.moments[i];
    return {mass.mass, principal.position, scaled * glm::transpose(r)};
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
    return *record->def;
}
Pose World::shape_pose(ShapeId shape) const {
    CAROM_FIND_SHAPE(shape, {});
    return impl_->body_pose(record->body) * record->def->local;
}

void World::release(BodyId body) {
    CAROM_FIND_BODY(body);
    if (!record->quarantined) return;
    impl_->bodies.find(body)->quarantined = false;
    impl_->arrays.roles[body.slot] = dynamics::role_of(record->type);
    impl_->put_in(body);
    impl_->wake(body);
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
    impl_->wake(body);
    impl_->arrays.states[body.slot].velocity = velocity;
    impl_->keep_locks(body.slot);
}
void World::set_angular_velocity(BodyId body, const dvec3& velocity) {
    CAROM_FIND_BODY(body);
    CAROM_REQUIRE(record->type != BodyType::Static, ErrorCode::WrongType, "static bodies have no velocity");
    CAROM_REQUIRE(is_finite(velocity), ErrorCode::NotFinite, "the velocity must be finite");
    impl_->wake(body);
    impl_->arrays.states[body.slot].spin = velocity;
    impl_->keep_locks(body.slot);
}
void World::Impl::keep_locks(std::uint32_t slot) {
    const unsigned char locked = arrays.masses[slot].locked;
    if (locked == LockedAxes::None) return;
    arrays.states[slot].velocity *= dynamics::free_moves(locked);
    arrays.states[slot].spin *= dynamics::free_moves(static_cast<unsigned char>(locked >> 3));
}

dynamics::BodyTraits& World::Impl::traits_of(std::uint32_t slot) {
    arrays.traits.resize(arrays.states.size());
    return arrays.traits[slot];
}

void World::set_gravity_scale(BodyId body, double scale) {
    CAROM_FIND_DYNAMIC(body, "only dynamic bodies have a gravity scale");
    const char* fault = dynamics::fault_of_gravity_scale(scale);
    CAROM_REQUIRE(fault == nullptr, ErrorCode::InvalidArgument, fault);
    impl_->wake(body);
    impl_->traits_of(body.slot).gravity_scale = scale;
}
void World::set_damping(BodyId body, double linear, double angular) {
    CAROM_FIND_DYNAMIC(body, "only dynamic bodies are damped");
    const char* fault = dynamics::fault_of_damping(linear, angular);
    CAROM_REQUIRE(fault == nullptr, ErrorCode::InvalidArgument, fault);
    impl_->wake(body);
    dynamics::BodyTraits& traits = impl_->traits_of(body.slot);
    traits.linear_damping = linear;
    traits.angular_damping = angular;
}
void World::set_continuity(BodyId body, Continuity continuity) {
    CAROM_FIND_BODY(body);
    const char* fault = dynamics::fault_of_continuity(continuity, record->type);
    CAROM_REQUIRE(fault == nullptr, ErrorCode::InvalidArgument, fault);
    impl_->continuous.begin(body.slot, continuity);
}
Continuity World::continuity(BodyId body) const {
    CAROM_FIND_BODY(body, Continuity::Automatic);
    return impl_->continuous.continuity(body.slot);
}
void World::set_locked_axes(BodyId body, unsigned char locked) {
    CAROM_FIND_DYNAMIC(body, "only dynamic bodies have locked axes");
    const char* fault = dynamics::fault_of_locks(locked);
    CAROM_REQUIRE(fault == nullptr, ErrorCode::InvalidArgument, fault);
    impl_->wake(body);
    static_cast<void>(impl_->traits_of(body.slot));
    impl_->arrays.masses[body.slot].locked = locked;
    impl_->contacts_hold = false;
    impl_->keep_locks(body.slot);
}
void World::apply_force(BodyId body, const dvec3& force, const dvec3& point) {
    CAROM_FIND_DYNAMIC(body, "only dynamic bodies take forces");
    CAROM_REQUIRE(is_finite(force) && is_finite(point), ErrorCode::NotFinite, "force and point must be finite");
    impl_->push(body, force, glm::cross(point - impl_->arrays.states[body.slot].pose.position, force));
}
void World::apply_torque(BodyId body, const dvec3& torque) {
    CAROM_FIND_DYNAMIC(body, "only dynamic bodies take torques");
    CAROM_REQUIRE(is_finite(torque), ErrorCode::NotFinite, "the torque must be finite");
    impl_->push(body, dvec3{0.0}, torque);
}
void World::Impl::push(BodyId body, const dvec3& force, const dvec3& torque) {
    const dynamics::BodyMass& mass = arrays.masses[body.slot];
    const dynamics::BodyTraits old = arrays.traits.empty() ? dynamics::BodyTraits{} : arrays.traits[body.slot];
    const dvec3 all = old.force + force, all_torque = old.torque + torque;
    const dvec3 turn = dynamics::world_inverse_inertia(arrays.states[body.slot], mass) * all_torque;
    CAROM_REQUIRE(glm::length(mass.inverse_mass * all) <= dynamics::kMostSpeed && glm::length(turn) <= dynamics::kMostSpeed,
                  ErrorCode::InvalidArgument, "the force or the torque is too large for the body");
    wake(body);
    traits_of(body.slot).force = all;
    traits_of(body.slot).torque = all_torque;
    pushed = true;
}

dynamics::FreeMotion World::Impl::free_motion(std::size_t slot) const noexcept {
    if (arrays.roles[slot] != dynamics::Role::Dynamic) return {.spin_tolerance = def.spin_tolerance};
    if (arrays.traits.empty()) return {.acceleration = def.gravity, .spin_tolerance = def.spin_tolerance};
    const dynamics::BodyTraits& t = arrays.traits[slot];
    return {arrays.acceleration(slot, def.gravity), t.torque, t.linear_damping, t.angular_damping, def.spin_tolerance};
}

double World::gravity_scale(BodyId body) const {
    CAROM_FIND_BODY(body, 1.0);
    return impl_->arrays.traits.empty() ? 1.0 : impl_->arrays.traits[body.slot].gravity_scale;
}
double World::linear_damping(BodyId body) const {
    CAROM_FIND_BODY(body, 0.0);
    return impl_->arrays.traits.empty() ? 0.0 : impl_->arrays.traits[body.slot].linear_damping;
}
double World::angular_damping(BodyId body) const {
    CAROM_FIND_BODY(body, 0.0);
    return impl_->arrays.traits.empty() ? 0.0 : impl_->arrays.traits[body.slot].angular_damping;
}
unsigned char World::locked_axes(BodyId body) const {
    CAROM_FIND_BODY(body, LockedAxes::None);
    return impl_->arrays.masses[body.slot].locked;
}

void World::apply_impulse(BodyId body, const dvec3& impulse, const dvec3& point) {
    CAROM_FIND_BODY(body);
    CAROM_REQUIRE(record->type == BodyType::Dynamic, ErrorCode::WrongType, "only dynamic bodies take impulses");
    CAROM_REQUIRE(is_finite(impulse) && is_finite(point), ErrorCode::NotFinite, "impulse and point must be finite");
    dynamics::BodyState& state = impl_->arrays.states[body.slot];
    const dynamics::BodyMass& mass = impl_->arrays.masses[body.slot];
    const dvec3 velocity = state.velocity + mass.inverse_mass * (dynamics::free_moves(mass.locked) * impulse);
    const dvec3 spin =
        state.spin + dynamics::world_inverse_inertia(state, mass) * glm::cross(point - state.pose.position, impulse);
    CAROM_REQUIRE(is_finite(velocity) && is_finite(spin), ErrorCode::InvalidArgument, "the impulse is too large for the body");
    impl_->wake(body);
    state.velocity = velocity;
    state.spin = spin;
}

}  // namespace carom
