// Bodies in slabs, one for each thread.
#include <carom/core/random.hpp>
#include <carom/dynamics/detail/body_parts.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace carom::dynamics {
namespace {

struct Heap {
    std::vector<BodyState> states;
    std::vector<std::uint32_t> slots, weights;

    Heap(int count, const dvec3& size, std::uint64_t seed) {
        Random random(seed);
        for (int i = 0; i < count; ++i) {
            BodyState state;
            state.pose.position = size * dvec3{random.unit(), random.unit(), random.unit()};
            states.push_back(state);
        }
        slots.resize(states.size());
        std::iota(slots.begin(), slots.end(), 0u);
        weights.assign(states.size(), 1);
    }
    [[nodiscard]] std::vector<std::uint32_t> shares(const BodyParts& parts) const {
        std::vector<std::uint32_t> sums(parts.count(), 0);
        for (const std::uint32_t slot : slots) sums.at(parts.of(slot)) += weights[slot];
        return sums;
    }
};

TEST(BodyParts, AreSlabsAcrossTheLongestWayWithAsMuchInEach) {
    for (int axis = 0; axis < 3; ++axis) {
        dvec3 size{1.0};
        size[axis] = 3.0;
        for (const std::size_t count : {1u, 2u, 3u, 8u}) {
            Heap heap(2000, size, 7);
            for (const std::uint32_t slot : heap.slots) heap.weights[slot] = heap.states[slot].pose.position[axis] < 1.0 ? 4 : 1;
            const std::uint32_t all = std::accumulate(heap.weights.begin(), heap.weights.end(), 0u);
            BodyParts parts;
            parts.resize(heap.states.size());
            parts.choose(heap.slots, heap.weights, heap.states, count);
            EXPECT_EQ(parts.count(), count);
            for (const std::uint32_t sum : heap.shares(parts))
                EXPECT_NEAR(sum, static_cast<double>(all) / static_cast<double>(count), 0.015 * all) << axis;
            std::vector<double> low(count, 1e9), high(count, -1e9);
            for (const std::uint32_t slot : heap.slots) {
                const double at = heap.states[slot].pose.position[axis];
                low[parts.of(slot)] = std::min(low[parts.of(slot)], at);
                high[parts.of(slot)] = std::max(high[parts.of(slot)], at);
            }
            for (std::size_t part = 1; part < count; ++part) EXPECT_LE(high[part - 1], low[part]) << axis;
        }
    }
}

TEST(BodyParts, OneFarAwayDoesNotTakeTheOthersSlab) {
    Heap heap(1000, {4, 1, 1}, 3);
    heap.states[17].pose.position.x = 400.0;
    BodyParts parts;
    parts.resize(heap.states.size());
    parts.choose(heap.slots, heap.weights, heap.states, 2);
    const std::vector<std::uint32_t> shares = heap.shares(parts);
    EXPECT_NEAR(shares[0], 500.0, 60.0);
}

TEST(BodyParts, BodiesInOnePlaceAndNoneAreInSomePart) {
    Heap heap(50, dvec3{0.0}, 1);
    BodyParts parts;
    parts.resize(60);
    parts.choose(heap.slots, heap.weights, heap.states, 3);
    for (const std::uint32_t slot : heap.slots) EXPECT_LT(parts.of(slot), 3u);
    EXPECT_EQ(parts.of(55), 0u) << "not noted yet";
    parts.choose({}, heap.weights, heap.states, 2);
    EXPECT_EQ(parts.count(), 2u);
    parts.note(3, {1e30, 0, 0});
    EXPECT_LT(parts.of(3), 2u);
}

TEST(BodyParts, ABodyThatMovesIsNotedElsewhere) {
    Heap heap(400, {4, 1, 1}, 5);
    BodyParts parts;
    parts.resize(heap.states.size());
    parts.choose(heap.slots, heap.weights, heap.states, 2);
    parts.note(9, {-1.0, 0.5, 0.5});
    EXPECT_EQ(parts.of(9), 0u);
    parts.note(9, {5.0, 0.5, 0.5});
    EXPECT_EQ(parts.of(9), 1u);
}

}  // namespace
}  // namespace carom::dynamics
