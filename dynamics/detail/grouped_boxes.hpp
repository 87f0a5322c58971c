// A list of boxes that are asked one after the other, by groups of neighbours in the list: where these are near each other most are passed over.
//
//   boxes.set(boxes.size(), box);                           // one more; or set(k, box): another one in its place
//   boxes.for_each_meeting(box, [&](std::size_t k) { ... });
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <cstddef>
#include <vector>

namespace carom::dynamics {

class GroupedBoxes {
public:
    static constexpr std::size_t kGroup = 16;

    [[nodiscard]] std::size_t size() const noexcept { return boxes_.size(); }
    void clear() noexcept {
        boxes_.clear();
        groups_.clear();
    }
    /// @param k  at most size().
    void set(std::size_t k, const Aabb& box) {
        if (k == boxes_.size()) boxes_.push_back(box);
        if (k / kGroup == groups_.size()) groups_.push_back(box);
        boxes_[k] = box;
        groups_[k / kGroup] = merge(groups_[k / kGroup], box);  // and of what was there before
    }
    /// Visits the numbers of the boxes that overlap `box`, ascending. Visits may set boxes: those that come later are asked as they are then.
    template <class Visit>
    void for_each_meeting(const Aabb& box, const Visit& visit) const {
        for (std::size_t k = 0; k < boxes_.size(); ++k) {
            if (k % kGroup == 0 && !overlaps(box, groups_[k / kGroup])) {
                k += kGroup - 1;
                continue;
            }
            if (overlaps(box, boxes_[k])) visit(k);
        }
    }
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(boxes_, groups_); }

private:
    std::vector<Aabb> boxes_, groups_;
};

}  // namespace carom::dynamics
