// The joints of a world: who they join, and whose contacts they leave out.
//
//   JointId id = joints.insert(def);
//   if (joints.parts(slot_a, slot_b)) ...   // no contacts between the two bodies
#pragma once

#include <carom/core/slot_map.hpp>
#include <carom/dynamics/detail/room.hpp>
#include <carom/dynamics/joint.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

struct JointRecord {
    JointDef def;
    dvec3 impulse{0.0};  ///< on B, over the last step [N s]
    double dt = 0.0;     ///< of that step [s]; 0: none yet
};

struct JoinedBodies {
    BodyId a, b;
};
[[nodiscard]] inline JoinedBodies bodies_of(const JointDef& def) noexcept {
    return std::visit([](const auto& joint) { return JoinedBodies{joint.body_a, joint.body_b}; }, def);
}

class JointSet {
public:
    JointId insert(const JointDef& def);
    void replace(JointId id, const JointDef& def);
    void erase(JointId id);
    /// Erases all joints of a body.
    void erase_of(BodyId body);

    [[nodiscard]] JointRecord* find(JointId id) noexcept { return records_.find(id); }
    [[nodiscard]] const JointRecord* find(JointId id) const noexcept { return records_.find(id); }
    [[nodiscard]] std::span<const JointId> order() const noexcept { return order_; }  ///< of creation
    [[nodiscard]] bool empty() const noexcept { return order_.empty(); }
    /// Another number after each change.
    [[nodiscard]] std::uint64_t version() const noexcept { return version_; }

    /// @return whether there is any pair of bodies whose contacts are left out.
    [[nodiscard]] bool parts_any() const noexcept { return !parted_.empty(); }
    /// @return whether contacts between the bodies in two slots are left out.
    [[nodiscard]] bool parts(std::uint32_t slot_a, std::uint32_t slot_b) const noexcept { return parts(parted_, slot_a, slot_b); }
    /// The same as it was when `parted` was kept.
    [[nodiscard]] static bool parts(std::span<const std::uint64_t> parted, std::uint32_t slot_a, std::uint32_t slot_b) noexcept;
    [[nodiscard]] const std::vector<std::uint64_t>& parted() const noexcept { return parted_; }
    [[nodiscard]] std::size_t memory() const noexcept { return records_.memory() + held_by(order_, parted_); }

private:
    /// Counts a change, and the pair of bodies that a joint parts, where it does: it comes or goes.
    void note(const JointDef& def, bool comes);

    SlotMap<JointRecord, JointId> records_;
    std::vector<JointId> order_;
    std::vector<std::uint64_t> parted_;  // slots of two bodies, the lower one first: sorted, once for each joint
    std::uint64_t version_ = 0;
};

}  // namespace carom::dynamics
