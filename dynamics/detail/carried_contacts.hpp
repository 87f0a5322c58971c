// What a step takes over of the contacts of the step before: the impulses of points, by pair and feature. A quarter of what the contacts themselves take.
//
//   carried.take(contacts, executor);                             // before contacts are made anew
//   if (const CarriedPair* old = ...) carry_impulses(points, carried.points_of(*old), scale, impulses);
#pragma once

#include <carom/core/executor.hpp>
#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/dynamics/detail/room.hpp>
#include <carom/dynamics/detail/scratch_pool.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

struct CarriedPoint {
    std::uint64_t feature = 0;
    PointImpulse impulse;
};

/// Slots are reused: the same key with another generation is another pair.
struct CarriedPair {
    std::uint64_t key = 0;
    std::uint32_t generation_a = 0, generation_b = 0;  ///< of the shapes, whose slots the key has
    std::uint32_t first_point = 0, point_count = 0;

    [[nodiscard]] bool is(const ContactPair& pair) const noexcept {
        return key == pair.key && generation_a == pair.generation_a && generation_b == pair.generation_b;
    }
};

class CarriedContacts {
public:
    explicit CarriedContacts(ScratchPool& pool) noexcept : memory_(pool) {}

    /// Replaces what is held by the points of `contacts` in use. Cost: linear, some 10 ns a manifold.
    void take(const ContactSet& contacts, Executor& executor);
    /// Adds those of pairs that are not held yet.
    void add(const ContactSet& contacts);
    /// Gives all back to the pool: nothing is held.
    void clear() noexcept;

    /// [bytes], without what is of the pool.
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(firsts_); }
    /// By rising key.
    [[nodiscard]] std::span<const CarriedPair> pairs() const noexcept { return pairs_; }
    /// In the order of the pair's manifolds.
    [[nodiscard]] std::span<const CarriedPoint> points_of(const CarriedPair& pair) const noexcept {
        return points_.subspan(pair.first_point, pair.point_count);
    }

private:
    void resize(std::size_t pairs, std::size_t points);
    void swap(CarriedContacts& other) noexcept;

    ScratchList<std::byte> memory_;
    std::span<CarriedPair> pairs_;
    std::span<CarriedPoint> points_;
    std::vector<std::uint32_t> firsts_;  // of each part its first point
};

/// Gives each point of a manifold the impulse that the point of its feature had, times `scale`; zero where it is new. Where several points share a
/// feature, the n-th gets the n-th one's.
void carry_impulses(std::span<const ContactPoint> points, std::span<const CarriedPoint> old, float scale, std::span<PointImpulse> impulses) noexcept;

}  // namespace carom::dynamics
