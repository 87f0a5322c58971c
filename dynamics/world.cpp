// Bodies and shapes: creating, destroying, mass.
#include <carom/dynamics/world.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/core/check.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/world_impl.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace carom {

using dynamics::BodyMass;
using dynamics::BodyState;
using dynamics::Role;

namespace {

constexpr double kUnitTolerance = 1e-3;

/// @return null if all is well, else what is wrong with the settings.
const char* fault_of(const WorldDef& def) {
    if (!is_finite(def.gravity)) return "gravity must be finite";
    if (def.substeps < 1 || def.substeps > 1024) return "substeps must be in 1..1024";
    if (!is_finite(def.contact_frequency) || def.contact_frequency <= 0.0) return "contact_frequency must be positive";
    if (!is_finite(def.contact_damping) || def.contact_damping < 0.0) return "contact_damping must not be negative";
    if (!is_finite(def.max_push_speed) || def.max_push_speed < 0.0) return "max_push_speed must not be negative";
    return nullptr;
}

WorldDef checked(const WorldDef& def) {
    const char* fault = fault_of(def);
    CAROM_REQUIRE(fault == nullptr, ErrorCode::InvalidArgument, fault, WorldDef{});
    return def;
}

bool is_unit(const dquat& q) { return std::abs(glm::length(q) - 1.0) <= kUnitTolerance; }

/// @return null if all is well, else what is wrong with the shape's definition on such a body.
const char* fault_of(const ShapeDef& def) {
    if (!is_finite(def.density) || def.density <= 0.0) return "density must be positive";
    if (!is_finite(def.friction) || def.friction < 0.0f) return "friction must not be negative";
    if (!is_finite(def.restitution) || def.restitution < 0.0f || def.restitution > 1.0f) return "restitution must be in [0, 1]";
    if (!is_finite(def.local) || !is_unit(def.local.orientation)) return "the local pose must be finite, of unit orientation";
    return nullptr;
}

Role role_of(BodyType type) {
    switch (type) {
        case BodyType::Static: return Role::Static;
        case BodyType::Kinematic: return Role::Kinematic;
        case BodyType::Dynamic: return Role::Dynamic;
    }
    return Role::Absent;
}

/// Farthest point of a shape from its body's centre of mass.
double reach_of(const Shape& shape, const Pose& local) { return glm::length(local.position) + bounding_radius(shape); }

}  // namespace

World::Impl::Impl(const WorldDef& settings) : def(settings), broadphase(make_broadphase(settings.broadphase)) {}

World::World(const WorldDef& def) : impl_(std::make_unique<Impl>(checked(def))) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

const WorldDef& World::settings() const noexcept { return impl_->def; }

BodyId World::create_body(const BodyDef& def) {
    CAROM_REQUIRE(is_finite(def.position) && is_finite(def.orientation), ErrorCode::NotFinite, "the pose must be finite", {});
    CAROM_REQUIRE(is_unit(def.orientation), ErrorCode::InvalidArgument, "the orientation must be a unit quaternion", {});
    CAROM_REQUIRE(is_finite(def.linear_velocity) && is_finite(def.angular_velocity), ErrorCode::NotFinite,
                  "velocities must be finite", {});
    const BodyId id = impl_->bodies.insert({def.type, def.name, {}, false});
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
    arrays.roles[id.slot] = role_of(def.type);
    impl_->update_mass(id);
    impl_->body_order.push_back(id);
    return id;
}

void World::destroy_body(BodyId body) {
    const dynamics::BodyRecord* record = impl_->bodies.find(body);
    CAROM_REQUIRE(record != nullptr, ErrorCode::DeadId, "no such body");
    for (const ShapeId shape : record->shapes) impl_->shapes.erase(shape);
    impl_->arrays.roles[body.slot] = Role::Absent;
    impl_->bodies.erase(body);
    std::erase(impl_->body_order, body);
    impl_->proxies_stale = true;
}

ShapeId World::add_shape(BodyId body, Shape shape, const ShapeDef& def) {
    dynamics::BodyRecord* record = impl_->bodies.find(body);
    CAROM_REQUIRE(record != nullptr, ErrorCode::DeadId, "no such body", {});
    const Status shape_status = validate(shape);
    CAROM_REQUIRE(shape_status.ok(), shape_status.error().code, shape_status.error().message, {});
    const char* fault = fault_of(def);
    CAROM_REQUIRE(fault == nullptr, ErrorCode::InvalidArgument, fault, {});
    if (record->type == BodyType::Dynamic) {
        const ShapeType type = type_of(shape);
        CAROM_REQUIRE(type != ShapeType::Plane && type != ShapeType::TriangleMesh, ErrorCode::WrongType,
                      "planes and triangle meshes only on static and kinematic bodies", {});
        const Result<MassProperties> mass = carom::mass_properties(shape, def.density);
        CAROM_REQUIRE(mass.has_value(), mass.error().code, mass.error().message, {});
    }
    ShapeDef kept = def;
    kept.local.orientation = glm::normalize(def.local.orientation);
    const ShapeId id = impl_->shapes.insert({body, std::move(shape), kept});
    record->shapes.push_back(id);
    impl_->update_mass(body);
    impl_->proxies_stale = true;
    return id;
}

bool World::is_alive(BodyId body) const noexcept { return impl_->bodies.find(body) != nullptr; }
bool World::is_alive(ShapeId shape) const noexcept { return impl_->shapes.find(shape) != nullptr; }
std::size_t World::body_count() const noexcept { return impl_->body_order.size(); }
std::span<const BodyId> World::bodies() const noexcept { return impl_->body_order; }

void World::set_mass_properties(BodyId body, const MassProperties& mass) {
    const dynamics::BodyRecord* record = impl_->bodies.find(body);
    CAROM_REQUIRE(record != nullptr, ErrorCode::DeadId, "no such body");
    CAROM_REQUIRE(record->type == BodyType::Dynamic, ErrorCode::WrongType, "only dynamic bodies have mass");
    const Status status = validate(mass);
    CAROM_REQUIRE(status.ok(), status.error().code, status.error().message);
    impl_->assign_mass(body, mass);
    impl_->arrays.masses[body.slot].given = true;
    impl_->proxies_stale = true;
}

void World::Impl::update_mass(BodyId body) {
    if (arrays.roles[body.slot] != Role::Dynamic || arrays.masses[body.slot].given) return;
    std::vector<MassProperties> parts;
    for (const ShapeId id : bodies.find(body)->shapes) {
        const dynamics::ShapeRecord& s = *shapes.find(id);
        parts.push_back(transform(carom::mass_properties(s.shape, s.def.density).value(), s.def.local));
    }
    // A body without shapes yet moves as a kilogram with unit inertia.
    if (parts.empty()) parts.push_back({1.0, dvec3{0.0}, dmat3{1.0}});
    assign_mass(body, combine(parts));
}

void World::Impl::assign_mass(BodyId body, const MassProperties& properties) {
    BodyMass& mass = arrays.masses[body.slot];
    BodyState& state = arrays.states[body.slot];
    const Pose origin = body_pose(body);
    const PrincipalAxes axes = principal_axes(properties.inertia);
    mass.mass = properties.mass;
    mass.inverse_mass = 1.0 / properties.mass;
    mass.moments = axes.moments;
    mass.inverse_moments = 1.0 / axes.moments;
    mass.principal = {properties.center, axes.orientation};
    dynamics::classify_inertia(mass);
    const dvec3 old_center = state.pose.position;
    state.pose = origin * mass.principal;
    state.velocity += glm::cross(state.spin, state.pose.position - old_center);
}

void World::Impl::refresh_proxies() {
    proxies.bounded.clear();
    proxies.unbounded.clear();
    proxies.filters.clear();
    std::vector<ShapeId> ids;
    for (const BodyId body : body_order) {
        const dynamics::BodyRecord& record = *bodies.find(body);
        if (!record.quarantined) ids.insert(ids.end(), record.shapes.begin(), record.shapes.end());
    }
    std::stable_sort(ids.begin(), ids.end());
    for (const ShapeId id : ids) {
        const dynamics::ShapeRecord& s = *shapes.find(id);
        const std::uint32_t slot = s.body.slot;
        dynamics::Proxy proxy;
        proxy.id = id;
        proxy.owner = s.body;
        proxy.body = slot;
        proxy.shape = &s.shape;
        proxy.local = inverse(arrays.masses[slot].principal) * s.def.local;
        proxy.reach = reach_of(s.shape, proxy.local);
        proxy.extent = smallest_extent(s.shape);
        proxy.friction = s.def.friction;
        proxy.restitution = s.def.restitution;
        proxy.filter = {s.def.layer, s.def.mask, arrays.roles[slot] == Role::Dynamic};
        if (is_bounded(s.shape)) {
            proxies.bounded.push_back(proxy);
            proxies.filters.push_back(proxy.filter);
        } else {
            proxies.unbounded.push_back(proxy);
        }
    }
    proxies.static_boxes_stale = true;
    proxies_stale = false;
    choices = choose();
}

}  // namespace carom
