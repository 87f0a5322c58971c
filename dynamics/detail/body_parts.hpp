// Which bodies lie near each other, for threads: slabs across the longest way of a heap, one for each thread, with as much to do in each.
//
//   parts.keep_up(slots, pairs, states, 2);          // once a step: chooses anew now and then
//   parts.note(slot, states[slot].pose.position);    // from any thread, for different slots
//   ... parts.of(slot) ...
//
// A body that the other core has changed takes as long to fetch as its contact to solve. Of bodies that are cut by a slab's face few touch both sides. Parts
// change who does what, never a result.
#pragma once

#include <carom/dynamics/detail/body_state.hpp>
#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

class BodyParts {
public:
    static constexpr std::size_t kMostParts = 8;

    /// Chooses where to cut, by where the bodies are, and notes them.
    /// @param weights  by slot: how much there is to do for each
    /// @param parts  1 .. kMostParts
    void choose(std::span<const std::uint32_t> slots, std::span<const std::uint32_t> weights, std::span<const BodyState> states,
                std::size_t parts);
    [[nodiscard]] std::size_t count() const noexcept { return count_; }

    /// The same, by how many contacts the bodies have, where that is due: every 16 steps, and when the number of bodies or of parts has changed.
    void keep_up(std::span<const std::uint32_t> slots, std::span<const ContactPair> pairs, std::span<const BodyState> states,
                 std::size_t parts);

    /// Makes room for slots below `slots`; new ones are in part 0 until they are noted.
    void resize(std::size_t slots) { part_of_slot_.resize(slots, 0); }
    void note(std::uint32_t slot, const dvec3& at) noexcept;
    [[nodiscard]] std::size_t of(std::uint32_t slot) const noexcept { return part_of_slot_[slot]; }
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(part_of_slot_, weights_); }

private:
    std::size_t count_ = 1;
    int axis_ = 0;
    std::array<double, kMostParts - 1> cuts_{};  // ascending; the first count_ - 1 of them
    std::vector<unsigned char> part_of_slot_;
    std::vector<std::uint32_t> weights_;  // by slot
    int age_ = 0;                         // in steps
    std::size_t bodies_ = 0;              // when parts were chosen
};

}  // namespace carom::dynamics
