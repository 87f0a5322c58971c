// Joints: creating, destroying, reading and setting.
#include <carom/core/check.hpp>
#include <carom/dynamics/detail/world_impl.hpp>

namespace carom {

namespace {

const JointDef kNoJoint = SpringDef{};

}  // namespace

#define CAROM_FIND_JOINT(id, ...)                                   \
    const dynamics::JointRecord* record = impl_->joints.find(id);   \
    CAROM_REQUIRE(record != nullptr, ErrorCode::DeadId, "no such joint", __VA_ARGS__)

bool World::Impl::can_join(const JointDef& joint) const {
    const Status status = validate(joint);
    CAROM_REQUIRE(status.ok(), status.error().code, status.error().message, false);
    const auto [a, b] = dynamics::bodies_of(joint);
    CAROM_REQUIRE(a != b, ErrorCode::InvalidArgument, "a joint needs two bodies, or a body and the world", false);
    bool any_dynamic = false;
    for (const BodyId body : {a, b}) {
        if (!body) continue;
        const dynamics::BodyRecord* record = bodies.find(body);
        CAROM_REQUIRE(record != nullptr, ErrorCode::DeadId, "no such body", false);
        any_dynamic |= record->type == BodyType::Dynamic;
    }
    CAROM_REQUIRE(any_dynamic, ErrorCode::WrongType, "one body of a joint must be dynamic", false);
    return true;
}

JointId World::create_joint(const JointDef& def) {
    if (!impl_->can_join(def)) return {};
    impl_->wake_joined(def);
    impl_->contacts_hold = false;  // the joint may leave some out
    return impl_->joints.insert(def);
}

void World::destroy_joint(JointId joint) {
    CAROM_REQUIRE(is_alive(joint), ErrorCode::DeadId, "no such joint");
    impl_->wake_joined(joint_def(joint));
    impl_->contacts_hold = false;
    impl_->joints.erase(joint);
}

bool World::is_alive(JointId joint) const noexcept { return impl_->joints.find(joint) != nullptr; }
std::span<const JointId> World::joints() const noexcept { return impl_->joints.order(); }

const JointDef& World::joint_def(JointId joint) const {
    CAROM_FIND_JOINT(joint, kNoJoint);
    return record->def;
}

dvec3 World::Impl::anchor_point(BodyId body, const dvec3& anchor) const { return body ? transform_point(body_pose(body), anchor) : anchor; }

JointState World::joint_state(JointId joint) const {
    CAROM_FIND_JOINT(joint, {});
    JointState state;
    std::visit(
        [&](const auto& def) {
            state.anchor_a = impl_->anchor_point(def.body_a, def.anchor_a);
            state.anchor_b = impl_->anchor_point(def.body_b, def.anchor_b);
        },
        record->def);
    state.length = state.stretch = glm::length(state.anchor_b - state.anchor_a);
    if (const SpringDef* spring = std::get_if<SpringDef>(&record->def)) state.stretch -= spring->rest_length;
    if (record->dt > 0.0) state.force = record->impulse / record->dt;
    return state;
}

void World::set_joint(JointId joint, const JointDef& def) {
    CAROM_REQUIRE(is_alive(joint), ErrorCode::DeadId, "no such joint");
    if (!impl_->can_join(def)) return;
    impl_->wake_joined(joint_def(joint));
    impl_->wake_joined(def);
    impl_->contacts_hold = false;
    impl_->joints.replace(joint, def);
}

}  // namespace carom
