// Bodies and shapes: creating, destroying, mass.
#include <carom/dynamics/world.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/check.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/world_impl.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace carom {

using dynamics::BodyMass;
using dynamics::BodyState;
using dynamics::Role;

namespace {

constexpr double kUnitTolerance = 1e-3;
constexpr double kFarthest = 1e30;  // [m], of anything in its body: the float boxes of the broadphase hold it

/// Masses and moments that floats hold, with headroom for products and reciprocals.
constexpr double kLeastMass = 1e-30;
constexpr double kMostMass = 1e30;

WorldDef checked(const WorldDef& def) {
    const Status status = validate(def);
    CAROM_REQUIRE(status.ok(), status.error().code, status.error().message, WorldDef{});
    return def;
}

bool in_mass_range(double x) { return x >= kLeastMass && x <= kMostMass; }

/// Whether the solver's floats can hold such a body.
Status check_mass_range(const MassProperties& m) {
    if (Status status = validate(m); !status) return status;
    const dvec3 moments = principal_axes(m.inertia).moments;
    if (in_mass_range(m.mass) && in_mass_range(moments.x) && in_mass_range(moments.y) && in_mass_range(moments.z)) return {};
    return Error{ErrorCode::InvalidArgument, "mass and moments of inertia must be within 1e-30 and 1e30", "mass properties"};
}

bool is_unit(const dquat& q) { return std::abs(glm::length(q) - 1.0) <= kUnitTolerance; }

/// Whether a body needs traits.
bool asks_for_more(const BodyDef& def) {
    return def.gravity_scale != 1.0 || def.linear_damping != 0.0 || def.angular_damping != 0.0 || def.locked != LockedAxes::None;
}

/// @return null if all is well, else what is wrong with what a body asks for beyond pose and velocity.
const char* fault_of(const BodyDef& def) {
    if (const char* fault = dynamics::fault_of_gravity_scale(def.gravity_scale)) return fault;
    if (const char* fault = dynamics::fault_of_damping(def.linear_damping, def.angular_damping)) return fault;
    if (const char* fault = dynamics::fault_of_locks(def.locked)) return fault;
    if (const char* fault = dynamics::fault_of_continuity(def.continuity, def.type)) return fault;
    if (!def.can_sleep && def.type != BodyType::Dynamic) return "only dynamic bodies sleep";
    return asks_for_more(def) && def.type != BodyType::Dynamic ? "gravity scale, damping and locked axes are of dynamic bodies" : nullptr;
}

/// @return null if all is well, else what is wrong with the shape's definition on such a body.
const char* fault_of(const ShapeDef& def) {
    if (!is_finite(def.density) || def.density <= 0.0) return "density must be positive";
    if (!is_finite(def.friction) || def.friction < 0.0f) return "friction must not be negative";
    if (!is_finite(def.restitution) || def.restitution < 0.0f || def.restitution > 1.0f) return "restitution must be in [0, 1]";
    if (!(def.rolling_resistance >= 0.0f && def.rolling_resistance <= 1e30f)) return "rolling_resistance must be within 0 .. 1e30 m";
    if (!(def.torsion >= 0.0f && def.torsion <= 1e30f)) return "torsion must be within 0 .. 1e30 m";
    for (const std::optional<CombineRule>& rule : {def.friction_rule, def.restitution_rule, def.rolling_rule}) {
        if (rule && *rule > CombineRule::Maximum) return "no such rule to combine by";
    }
    if (!is_finite(def.local) || !is_unit(def.local.orientation)) return "the local pose must be finite, of unit orientation";
    return nullptr;
}

/// Farthest point of a shape from its body's centre of mass.
double reach_of(const Shape& shape, const Pose& local) { return glm::length(local.position) + bounding_radius(shape); }

}  // namespace

Status validate(const WorldDef& def) {
    const auto fault = [](ErrorCode code, const char* message) { return Status{Error{code, message, "WorldDef"}}; };
    if (!is_finite(def.gravity)) return fault(ErrorCode::NotFinite, "gravity must be finite");
    if (def.substeps < 1 || def.substeps > 1024) return fault(ErrorCode::InvalidArgument, "substeps must be in 1..1024");
    if (!(def.contact_rate > 0.0 && def.contact_rate <= 0.25)) {
        return fault(ErrorCode::InvalidArgument, "contact_rate must be in (0, 0.25]");
    }
    if (!is_finite(def.contact_damping) || def.contact_damping < 0.0) {
        return fault(ErrorCode::InvalidArgument, "contact_damping must not be negative");
    }
    if (!(def.contact_reuse >= 0.0 && def.contact_reuse <= 0.1)) {
        return fault(is_finite(def.contact_reuse) ? ErrorCode::InvalidArgument : ErrorCode::NotFinite, "contact_reuse must lie in 0 .. 0.1");
    }
    if (def.contact_method > ContactMethod::Impulses) return fault(ErrorCode::InvalidArgument, "no such contact method");
    if (!(def.direct_sag >= 1e-6 && def.direct_sag <= 0.01)) {
        return fault(is_finite(def.direct_sag) ? ErrorCode::InvalidArgument : ErrorCode::NotFinite, "direct_sag must lie in 1e-6 .. 0.01");
    }
    if (def.direct_budget > std::size_t{1} << 32) return fault(ErrorCode::InvalidArgument, "direct_budget must be in 0..2^32");
    if (!is_finite(def.max_push) || def.max_push < 0.0) return fault(ErrorCode::InvalidArgument, "max_push must not be negative");
    if (!(def.spin_tolerance >= 1e-12 && def.spin_tolerance <= 1.0)) {
        return fault(is_finite(def.spin_tolerance) ? ErrorCode::InvalidArgument : ErrorCode::NotFinite, "spin_tolerance must lie in 1e-12 .. 1");
    }
    if (!is_valid(def.broadphase)) return fault(ErrorCode::InvalidArgument, "no such broadphase");
    if (def.pair_limit < 1 || def.pair_limit > std::size_t{1} << 31) return fault(ErrorCode::InvalidArgument, "pair_limit must be in 1..2^31");
    if (!(def.continuous.motion >= 1e-3 && def.continuous.motion <= 0.5)) {
        return fault(is_finite(def.continuous.motion) ? ErrorCode::InvalidArgument : ErrorCode::NotFinite, "continuous.motion must lie in 1e-3 .. 0.5");
    }
    if (def.continuous.most_impacts < 1 || def.continuous.most_impacts > 1000) {
        return fault(ErrorCode::InvalidArgument, "continuous.most_impacts must be in 1..1000");
    }
    if (!(def.sleep.time >= 0.01 && def.sleep.time <= 1000.0)) {
        return fault(is_finite(def.sleep.time) ? ErrorCode::InvalidArgument : ErrorCode::NotFinite, "sleep.time must lie in 0.01 .. 1000 s");
    }
    if (!(def.sleep.motion >= 1e-9 && def.sleep.motion <= 0.1)) {
        return fault(is_finite(def.sleep.motion) ? ErrorCode::InvalidArgument : ErrorCode::NotFinite, "sleep.motion must lie in 1e-9 .. 0.1");
    }
    if (def.plan != PlanMode::Automatic && def.plan != PlanMode::Everything) {
        return fault(ErrorCode::InvalidArgument, "no such plan mode");
    }
    return {};
}

World::Impl::Impl(const WorldDef& settings) : def(settings), broadphase({.method = settings.broadphase, .pair_limit = settings.pair_limit, .lists_changes = false}), continuous(settings.continuous), sleepers(settings.sleep) {}

World::World(const WorldDef& def) : impl_(std::make_unique<Impl>(checked(def))) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

const WorldDef& World::settings() const noexcept { return impl_->def; }

BodyId World::create_body(const BodyDef& def) {
    CAROM_REQUIRE(dynamics::role_of(def.type) != Role::Absent, ErrorCode::InvalidArgument, "no such body type", {});
    CAROM_REQUIRE(is_finite(def.position) && is_finite(def.orientation), ErrorCode::NotFinite, "the pose must be finite", {});
    CAROM_REQUIRE(is_unit(def.orientation), ErrorCode::InvalidArgument, "the orientation must be a unit quaternion", {});
    CAROM_REQUIRE(is_finite(def.linear_velocity) && is_finite(def.angular_velocity), ErrorCode::NotFinite,
                  "velocities must be finite", {});
    const char* fault = fault_of(def);
    CAROM_REQUIRE(fault == nullptr, ErrorCode::InvalidArgument, fault, {});
    const BodyId id = impl_->bodies.insert({def.type, false, def.name.empty() ? nullptr : std::make_unique<const std::string>(def.name), {}});
    dynamics::BodyArrays& arrays = impl_->arrays;
    if (arrays.states.size() <= id.slot) {
        arrays.states.resize(id.slot + 1);
        arrays.masses.resize(id.slot + 1);
        arrays.roles.resize(id.slot + 1, Role::Absent);
    }
    const bool moves = def.type != BodyType::Static;
    arrays.states[id.slot] = BodyState{{def.position, glm::normalize(def.orientation)},
                                       moves ? def.linear_velocity : dvec3{0.0},
                                       moves ? def.angular_velocity : dvec3{0.0}};
    arrays.masses[id.slot] = BodyMass{};
    arrays.set_principal(id.slot, {});
    if (id.slot < impl_->last_valid.size()) impl_->last_valid[id.slot] = {};  // that of another
    arrays.masses[id.slot].locked = def.locked;
    if (!arrays.traits.empty()) arrays.traits.resize(arrays.states.size()), arrays.traits[id.slot] = {};
    if (asks_for_more(def)) {
        dynamics::BodyTraits& traits = impl_->traits_of(id.slot);
        traits.gravity_scale = def.gravity_scale;
        traits.linear_damping = def.linear_damping;
        traits.angular_damping = def.angular_damping;
    }
    arrays.roles[id.slot] = dynamics::role_of(def.type);
    // Until it has shapes, a body moves as a kilogram with unit inertia.
    if (def.type == BodyType::Dynamic) impl_->assign_mass(id, {1.0, dvec3{0.0}, dmat3{1.0}});
    impl_->continuous.begin(id.slot, def.continuity);
    impl_->continuous.note_shapes();
    impl_->sleepers.note_shapes();
    if (impl_->sleepers.is_on()) impl_->sleepers.begin(id.slot, def.can_sleep, arrays.states[id.slot]);
    impl_->body_order.push_back(id);
    return id;
}

void World::destroy_body(BodyId body) {
    const dynamics::BodyRecord* record = impl_->bodies.find(body);
    CAROM_REQUIRE(record != nullptr, ErrorCode::DeadId, "no such body");
    if (!record->quarantined) impl_->take_out(body);
    for (const ShapeId shape : record->shapes) impl_->shapes.erase(shape);
    impl_->joints.erase_of(body);
    impl_->arrays.roles[body.slot] = Role::Absent;
    impl_->bodies.erase(body);
    std::erase(impl_->body_order, body);
}

ShapeId World::add_shape(BodyId body, Shape shape, const ShapeDef& def) {
    dynamics::BodyRecord* record = impl_->bodies.find(body);
    CAROM_REQUIRE(record != nullptr, ErrorCode::DeadId, "no such body", {});
    const Status shape_status = validate(shape);
    CAROM_REQUIRE(shape_status.ok(), shape_status.error().code, shape_status.error().message, {});
    const char* fault = fault_of(def);
    CAROM_REQUIRE(fault == nullptr, ErrorCode::InvalidArgument, fault, {});
    CAROM_REQUIRE(!is_bounded(shape) || reach_of(shape, def.local) <= kFarthest, ErrorCode::InvalidArgument,
                  "the shape reaches farther than 1e30 m from its body", {});
    if (record->type == BodyType::Dynamic) {
        CAROM_REQUIRE(is_bounded(shape), ErrorCode::WrongType, "planes only on static and kinematic bodies", {});
        const TriangleMeshPtr* const mesh = std::get_if<TriangleMeshPtr>(&shape);
        CAROM_REQUIRE(mesh == nullptr || !(*mesh)->is_one_sided(), ErrorCode::WrongType, "one-sided meshes only on static and kinematic bodies", {});
    }
    ShapeDef kept = def;
    kept.local.orientation = glm::normalize(def.local.orientation);
    std::optional<MassProperties> mass;
    if (record->type == BodyType::Dynamic && !impl_->arrays.masses[body.slot].given) {
        const Result<MassProperties> part = carom::mass_properties(shape, def.density);
        CAROM_REQUIRE(part.has_value(), part.error().code, part.error().message, {});
        mass = impl_->mass_with(*record, transform(*part, kept.local));
        const Status range = check_mass_range(*mass);
        CAROM_REQUIRE(range.ok(), range.error().code, range.error().message, {});
    }
    const ShapeId id = impl_->shapes.insert({body, std::move(shape), impl_->shared_def(kept)});
    record->shapes.push_back(id);
    if (record->type == BodyType::Dynamic) impl_->wake(body);
    if (mass) impl_->assign_mass(body, *mass);
    if (record->quarantined) return id;
    const dynamics::ShapeRecord& added = *impl_->shapes.find(id);
    impl_->census.count_shape(added.shape, *added.def, +1);
    if (record->shapes.size() == 1) impl_->census.count_body(record->type, +1);
    if (mass) {
        impl_->put_proxies(body);  // the centre of mass is another
    } else {
        impl_->put_proxy(id);
    }
    impl_->note_placed(body);
    return id;
}

std::shared_ptr<const ShapeDef> World::Impl::shared_def(const ShapeDef& kept) {
    if (last_def == nullptr || *last_def != kept) last_def = std::make_shared<const ShapeDef>(kept);
    return last_def;
}

bool World::is_alive(BodyId body) const noexcept { return impl_->bodies.find(body) != nullptr; }
bool World::is_alive(ShapeId shape) const noexcept { return impl_->shapes.find(shape) != nullptr; }
std::size_t World::body_count() const noexcept { return impl_->body_order.size(); }
std::span<const BodyId> World::bodies() const noexcept { return impl_->body_order; }

void World::set_mass_properties(BodyId body, const MassProperties& mass) {
    const dynamics::BodyRecord* record = impl_->bodies.find(body);
    CAROM_REQUIRE(record != nullptr, ErrorCode::DeadId, "no such body");
    CAROM_REQUIRE(record->type == BodyType::Dynamic, ErrorCode::WrongType, "only dynamic bodies have mass");
    const Status status = check_mass_range(mass);
    CAROM_REQUIRE(status.ok(), status.error().code, status.error().message);
    CAROM_REQUIRE(glm::length(mass.center) <= kFarthest, ErrorCode::InvalidArgument, "the centre of mass is too far away");
    impl_->wake(body);
    impl_->assign_mass(body, mass);
    impl_->arrays.masses[body.slot].given = true;
    if (!record->quarantined) impl_->put_proxies(body);
}

MassProperties World::Impl::mass_with(const dynamics::BodyRecord& record, const MassProperties& added) const {
    std::vector<MassProperties> parts{added};
    for (const ShapeId id : record.shapes) {
        const dynamics::ShapeRecord& s = *shapes.find(id);
        parts.push_back(transform(carom::mass_properties(s.shape, s.def->density).value(), s.def->local));
    }
    return combine(parts);
}

void World::Impl::assign_mass(BodyId body, const MassProperties& properties) {
    contacts_hold = false;
    BodyMass& mass = arrays.masses[body.slot];
    BodyState& state = arrays.states[body.slot];
    const Pose origin = body_pose(body);
    const PrincipalAxes axes = principal_axes(properties.inertia);
    mass.mass = properties.mass;
    mass.inverse_mass = 1.0 / properties.mass;
    static_cast<FreeRotation&>(mass) = classify(axes.moments);
    const Pose principal{properties.center, axes.orientation};
    arrays.set_principal(body.slot, principal);
    const dvec3 old_center = state.pose.position;
    state.pose = origin * principal;
    state.velocity += glm::cross(state.spin, state.pose.position - old_center);
    keep_locks(body.slot);
}

void World::Impl::put_proxy(ShapeId id) {
    contacts_hold = false;
    const dynamics::ShapeRecord& s = *shapes.find(id);
    const std::uint32_t slot = s.body.slot;
    dynamics::NewProxy proxy;
    proxy.id = id;
    proxy.owner = s.body;
    proxy.shape = s.shape;
    const Pose local = inverse(arrays.principal(slot)) * s.def->local;
    proxy.local = dynamics::LocalPose(local);
    proxy.reach = reach_of(s.shape, local);
    // A mesh that others come to is a surface: the box round it says nothing of how far ahead contacts with it are wanted.
    const bool surface = type_of(s.shape) == ShapeType::TriangleMesh && arrays.roles[slot] != Role::Dynamic;
    proxy.extent = surface ? std::numeric_limits<double>::infinity() : smallest_extent(s.shape);
    proxy.surface = {s.def->friction, s.def->restitution, s.def->friction_rule, s.def->restitution_rule};
    proxy.resistance = {s.def->rolling_resistance, s.def->torsion, s.def->rolling_rule};
    // What is kinematic may wake what sleeps: pairs of the two are wanted.
    const bool is_movable = arrays.roles[slot] == Role::Dynamic || (sleepers.is_on() && arrays.roles[slot] == Role::Kinematic);
    dynamics::put_proxy(proxies, std::move(proxy), ProxyFilter{s.def->layer, s.def->mask, is_movable});
    sleepers.note_shapes();
    continuous.note_shapes();
}

void World::Impl::put_proxies(BodyId body) {
    for (const ShapeId id : bodies.find(body)->shapes) put_proxy(id);
}

void World::Impl::put_in(BodyId body) {
    put_proxies(body);
    note_placed(body);
    count_body(body, +1);
}

void World::Impl::take_out(BodyId body) {
    contacts_hold = false;
    wake(body);
    sleepers.note_shapes();
    continuous.note_shapes();
    for (const ShapeId id : bodies.find(body)->shapes) dynamics::drop_proxy(proxies, id.slot);
    count_body(body, -1);
}

void World::Impl::count_body(BodyId body, int sign) {
    const dynamics::BodyRecord& record = *bodies.find(body);
    if (!record.shapes.empty()) census.count_body(record.type, sign);
    for (const ShapeId id : record.shapes) {
        const dynamics::ShapeRecord& shape = *shapes.find(id);
        census.count_shape(shape.shape, *shape.def, sign);
    }
}

}  // namespace carom
