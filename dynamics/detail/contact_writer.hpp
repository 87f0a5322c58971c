// All contacts of a step that finds them anew, as the narrowphase hands them on.
//
//   ContactWriter writer(contacts);
//   collide(placed, candidates, executor, scratch, [&](std::size_t i, std::span<const Manifold> found) { ... writer.add(manifold, i); });
//   writer.finish();                              // until then the set is not whole
//   link_manifolds(contacts, ...);                // which makes pairs and impulses
#pragma once

#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace carom::dynamics {

/// Writes manifolds over those of the step before, which need not be cleared for it. Of impulses there is room alone.
class ContactWriter {
public:
    explicit ContactWriter(ContactSet& set) noexcept : set_(set) {}
    void add(const Manifold& found, std::uint32_t pair) {
        if (manifolds_ == set_.manifolds.size()) grow(set_.manifolds, manifolds_ + 1);
        if (points_ + kMaxManifoldPoints > set_.points.size()) grow(set_.points, points_ + kMaxManifoldPoints);
        const auto count = static_cast<std::uint8_t>(found.count);
        set_.manifolds[manifolds_++] = {found.normal, pair, static_cast<std::uint32_t>(points_), count, count, found.part_a, found.part_b};
        std::ranges::copy(found.points, set_.points.begin() + static_cast<std::ptrdiff_t>(points_));  // all of them: what follows is written over
        points_ += count;
    }
    void finish() {
        set_.manifolds.resize(manifolds_);
        set_.points.resize(points_);
        resize_with_room(set_.impulses, points_);
        set_.unused_points = 0;
    }

private:
    template <class T>
    static void grow(std::vector<T>& list, std::size_t size) {
        reserve_with_room(list, size);
        list.resize(list.capacity());
    }
    ContactSet& set_;
    std::size_t manifolds_ = 0, points_ = 0;
};

}  // namespace carom::dynamics
