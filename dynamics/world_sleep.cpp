// Sleep as the world has it: what wakes whom, and what the step asks of it.
#include <carom/core/check.hpp>
#include <carom/dynamics/detail/world_impl.hpp>

#include <algorithm>

namespace carom {

using dynamics::Role;

void World::Impl::wake(BodyId body) {
    if (!sleepers.is_on()) return;
    const Role role = arrays.roles[body.slot];
    if (dynamics::has_mass(role)) return sleepers.wake(body.slot, arrays);
    if (role == Role::Absent) return;
    sleepers.wake_touching(body.slot, arrays);
    for (const JointId id : joints.order()) {
        const auto [a, b] = dynamics::bodies_of(joints.find(id)->def);
        if (a == body || b == body) wake_joined(joints.find(id)->def);
    }
}

void World::Impl::note_placed(BodyId body) {
    if (!sleepers.is_on() || dynamics::has_mass(arrays.roles[body.slot])) return;
    for (const ShapeId shape : bodies.find(body)->shapes) sleepers.note_placed(shape.slot);
}

void World::Impl::wake_joined(const JointDef& joint) {
    if (!sleepers.is_on()) return;
    const auto [a, b] = dynamics::bodies_of(joint);
    for (const BodyId body : {a, b}) {
        if (body && dynamics::has_mass(arrays.roles[body.slot])) sleepers.wake(body.slot, arrays);
    }
}

dynamics::SleepScene World::Impl::sleep_scene() {
    const auto slot_of = [](BodyId body) { return body ? body.slot : dynamics::BodyLink::kWorld; };
    sleep_links.clear();
    for (const JointId id : joints.order()) {
        const auto [a, b] = dynamics::bodies_of(joints.find(id)->def);
        sleep_links.push_back({slot_of(a), slot_of(b)});
    }
    return {contacts, arrays, def.gravity, sleep_links};
}

bool World::Impl::is_any_awake() const {
    if (sleepers.count() == 0) return true;
    for (std::uint32_t slot = 0; slot < arrays.roles.size(); ++slot) {
        if (dynamics::stirs(arrays, slot)) return true;
    }
    return false;
}

void World::Impl::wake_before_step(double dt) {
    sleepers.wake_by_others(proxies, dt, arrays);
    if (sleepers.give_back(arrays, contacts)) note_moved_contacts();
    sleepers.sync(arrays, proxies);
}

bool World::Impl::wake_touched() {
    if (sleepers.count() == 0 || !sleepers.wake_touched(contacts, arrays)) return false;
    if (patched) previous.take(contacts, threads());  // which have the impulses of the step before
    taken_over = true;
    patched = contacts_held = false;
    contacts.clear();  // they are found again
    if (sleepers.give_back(arrays, contacts)) previous.add(contacts);
    names.now.clear();
    sleepers.sync(arrays, proxies);
    return true;
}

// Some went to sleep or came back: the narrowphase and the solver remember others.
void World::Impl::note_moved_contacts() {
    names.now.clear();
    contacts_hold = false;
}

void World::Impl::fall_asleep(double dt, StepReport& report) {
    sleepers.scale_impulses(substep_ratio(dt));  // at rest they are forces
    sleepers.watch(arrays, proxies, def.gravity, dt);
    if (sleepers.fall_asleep(sleep_scene())) note_moved_contacts();
    report.asleep = sleepers.count();
    report.fell_asleep = sleepers.take_fallen();
    report.woken = sleepers.take_woken();
}

bool World::is_awake(BodyId body) const {
    CAROM_REQUIRE(impl_->bodies.find(body) != nullptr, ErrorCode::DeadId, "no such body", true);
    return impl_->arrays.roles[body.slot] != Role::Asleep;
}

void World::wake(BodyId body) {
    CAROM_REQUIRE(impl_->bodies.find(body) != nullptr, ErrorCode::DeadId, "no such body");
    impl_->wake(body);
}

bool World::put_to_sleep(BodyId body) {
    const dynamics::BodyRecord* record = impl_->bodies.find(body);
    CAROM_REQUIRE(record != nullptr, ErrorCode::DeadId, "no such body", false);
    CAROM_REQUIRE(record->type == BodyType::Dynamic, ErrorCode::WrongType, "only dynamic bodies sleep", false);
    CAROM_REQUIRE(impl_->sleepers.is_on(), ErrorCode::InvalidArgument, "WorldDef::sleep is off", false);
    const bool sleeps = impl_->sleepers.put_to_sleep(body.slot, impl_->sleep_scene());
    impl_->note_moved_contacts();
    return sleeps;
}

}  // namespace carom
