#include <carom/dynamics/detail/joint_set.hpp>

#include <algorithm>

namespace carom::dynamics {
namespace {

std::uint64_t key_of(std::uint32_t a, std::uint32_t b) noexcept { return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b); }

}  // namespace

JointId JointSet::insert(const JointDef& def) {
    const JointId id = records_.insert({def});
    order_.push_back(id);
    note(def, true);
    return id;
}

void JointSet::replace(JointId id, const JointDef& def) {
    note(records_.find(id)->def, false);
    records_.find(id)->def = def;
    note(def, true);
}

void JointSet::erase(JointId id) {
    note(records_.find(id)->def, false);
    records_.erase(id);
    std::erase(order_, id);
}

void JointSet::erase_of(BodyId body) {
    const auto gone = std::ranges::stable_partition(order_, [&](JointId id) {
        const JoinedBodies bodies = bodies_of(records_.find(id)->def);
        return bodies.a != body && bodies.b != body;
    });
    for (const JointId id : gone) {
        note(records_.find(id)->def, false);
        records_.erase(id);
    }
    order_.erase(gone.begin(), gone.end());
}

bool JointSet::parts(std::span<const std::uint64_t> parted, std::uint32_t slot_a, std::uint32_t slot_b) noexcept {
    return std::ranges::binary_search(parted, key_of(slot_a, slot_b));
}

void JointSet::note(const JointDef& def, bool comes) {
    ++version_;
    const JoinedBodies bodies = bodies_of(def);
    if (std::visit([](const auto& joint) { return joint.collide_connected; }, def) || !bodies.a || !bodies.b) return;
    const std::uint64_t key = key_of(bodies.a.slot, bodies.b.slot);
    const auto place = std::ranges::lower_bound(parted_, key);
    if (comes) {
        parted_.insert(place, key);
    } else {
        parted_.erase(place);
    }
}

}  // namespace carom::dynamics
