#include <carom/dynamics/world_memory.hpp>

#include <carom/dynamics/detail/room.hpp>
#include <carom/dynamics/detail/world_impl.hpp>

#include <utility>

namespace carom {
namespace {

constexpr std::size_t kSharing = 16;  // [bytes] that count who has a shared value

std::size_t held_by_name(const std::unique_ptr<const std::string>& name) noexcept {
    if (name == nullptr) return 0;
    return sizeof(std::string) + (name->capacity() > std::string{}.capacity() ? name->capacity() + 1 : 0);  // short ones lie in the string itself
}

}  // namespace

WorldMemory World::memory() const noexcept {
    using dynamics::held_by;
    const Impl& w = *impl_;
    WorldMemory sum;
    sum.bodies = sizeof(Impl) + w.bodies.memory() +
                 held_by(w.body_order, w.arrays.states, w.arrays.masses, w.arrays.roles, w.arrays.traits, w.arrays.principals, w.last_valid);
    const ShapeDef* last = nullptr;  // neighbours share one
    for (const BodyId body : w.body_order) {
        const dynamics::BodyRecord& record = *w.bodies.find(body);
        sum.bodies += record.shapes.memory() + held_by_name(record.name);
        for (const ShapeId shape : record.shapes) {
            const ShapeDef* const def = w.shapes.find(shape)->def.get();
            if (std::exchange(last, def) != def) sum.shapes += sizeof(ShapeDef) + kSharing;
        }
    }
    sum.shapes += w.shapes.memory() + w.proxies.memory();
    sum.joints = w.joints.memory() + w.joint_solver.memory();
    sum.broadphase = w.broadphase.memory();
    sum.contacts = w.contacts.memory() + w.contact_changes.memory() + w.previous.memory() + w.passing.memory() +
                   held_by(w.candidate_parts, w.names.now, w.names.before, w.last_manifolds, w.found_manifolds, w.displaced);
    for (const dynamics::CandidatePart& part : w.candidate_parts) sum.contacts += held_by(part.pairs);
    sum.solver = w.solver.memory() + w.direct.memory();
    sum.scratch = w.scratch.memory();
    sum.other = w.impacts.memory() + w.residual.memory() + w.continuous.memory() + w.paths.memory() + w.sleepers.memory() +
                held_by(w.free_bodies, w.sleep_links);
    return sum;
}

}  // namespace carom
