// The contacts of a step and what they remember of the step before.
#pragma once

#include <carom/core/executor.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/core/ids.hpp>
#include <carom/narrowphase/manifold.hpp>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

/// Two shapes that have manifolds. Pairs are sorted by key.
struct ContactPair {
    static constexpr std::uint32_t kPlane = 0x80000000u;

    std::uint64_t key = 0;  ///< slots of the two shapes, that of a in the upper half, and a bit that sorts planes (b) after the rest
    BodyId body_a, body_b;
    std::uint32_t generation_a = 0, generation_b = 0;  ///< of the shapes
    std::uint32_t first_manifold = 0, manifold_count = 0;
    std::uint32_t point_count = 0;           ///< of these manifolds together
    bool predicted = false;  ///< none of them touches yet
    bool passes = false;     ///< and in this step none will: nobody's to solve (passing.hpp)
    bool flies = false;  ///< the two bounce or pass, and nothing holds either: not the solver's (impacts.hpp)

    /// Slots of the shapes.
    [[nodiscard]] std::uint32_t proxy_a() const noexcept { return static_cast<std::uint32_t>(key >> 32); }
    [[nodiscard]] std::uint32_t proxy_b() const noexcept { return static_cast<std::uint32_t>(key) & ~kPlane; }
    [[nodiscard]] ShapeId shape_a() const noexcept { return {proxy_a(), generation_a}; }
    [[nodiscard]] ShapeId shape_b() const noexcept { return {proxy_b(), generation_b}; }
    /// Whether it is the solver's.
    [[nodiscard]] bool is_solved() const noexcept { return !passes && !flies; }
};
static_assert(sizeof(ContactPair) == 48, "a world has two or three a body");

/// Impulses of one contact point, in the order of the manifold's points [N s].
struct PointImpulse {
    float normal = 0.0f;
    vec3 friction{0.0f};  ///< world axes: survives a change of the tangents
};

/// A manifold without its points, which lie with those of all others: of four that it may have a pile's has one or two.
struct ContactManifold {
    vec3 normal{0.0f};              ///< unit, world axes, from A to B
    std::uint32_t pair = 0;         ///< index of the pair
    std::uint32_t first_point = 0;  ///< and its impulse
    std::uint8_t count = 0;         ///< points in use, 1..4
    std::uint8_t room = 0;          ///< that are its own, in use or not
    std::uint16_t part_a = 0;       ///< of A, where it is a compound; otherwise 0
    std::uint16_t part_b = 0;
};
static_assert(sizeof(ContactManifold) == 28, "a world has two or three a body");

/// Largest and mean penetration by the manifolds themselves.
struct ContactSummary {
    std::size_t points = 0;
    std::size_t touching = 0;       ///< separation <= 0
    double max_penetration = 0.0;   ///< [m]
    double mean_penetration = 0.0;  ///< over the touching points [m]
};

/// What a manifold that is not used any more has for a pair. Its count is 0.
inline constexpr std::uint32_t kNoPair = ~std::uint32_t{0};

struct ContactSet {
    std::vector<ContactPair> pairs;
    std::vector<ContactManifold> manifolds;   ///< of a pair in a row; in the order of the pairs unless it is patched
    std::vector<ContactPoint> points;         ///< of a manifold in a row
    std::vector<PointImpulse> impulses;       ///< one for each point
    std::size_t unused_points = 0;            ///< of points that no manifold has any more
    bool patched = false;                     ///< some manifolds lie elsewhere, or are unused (kNoPair)
    std::vector<std::uint32_t> order;         ///< where it is patched: of the manifolds in use, in the order of the pairs
    ContactSummary summary;                   ///< of the manifolds
    std::vector<std::uint32_t> flying;        ///< pairs that fly
    std::vector<std::uint32_t> firsts;        ///< of each pair its first manifold, and the end: while pairs are made
    std::vector<std::uint32_t> first_counts;  ///< of each part of the manifolds, likewise
    std::vector<ContactSummary> parts;        ///< of the summary, while it is made

    [[nodiscard]] std::size_t manifold_count() const noexcept { return patched ? order.size() : manifolds.size(); }
    /// The i-th manifold in the order of the pairs, of those in use.
    [[nodiscard]] std::uint32_t manifold_number(std::size_t i) const noexcept { return patched ? order[i] : static_cast<std::uint32_t>(i); }

    [[nodiscard]] std::span<const ContactPoint> points_of(const ContactManifold& m) const noexcept { return std::span{points}.subspan(m.first_point, m.count); }
    [[nodiscard]] std::span<const PointImpulse> impulses_of(std::uint32_t manifold) const noexcept {
        return std::span{impulses}.subspan(manifolds[manifold].first_point, manifolds[manifold].count);
    }
    [[nodiscard]] std::span<PointImpulse> impulses_of(std::uint32_t manifold) noexcept {
        return std::span{impulses}.subspan(manifolds[manifold].first_point, manifolds[manifold].count);
    }
    void clear_impulses(const ContactPair& pair) noexcept {
        for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) std::ranges::fill(impulses_of(m), PointImpulse{});
    }
    /// The manifold with its points.
    [[nodiscard]] Manifold whole(std::uint32_t manifold) const noexcept;
    /// Appends a manifold; its impulses are zero.
    void append(const Manifold& manifold, std::uint32_t pair);
    /// Puts another one in its place: among the points of the one that was there, if there is room.
    void put(std::uint32_t manifold, const Manifold& found);
    /// The manifold is not used any more.
    void drop(std::uint32_t manifold) noexcept;
    /// Closes the ranks of the points, if many are unused.
    void close_up();

    /// How many points of a manifold in use are to be solved.
    [[nodiscard]] std::uint32_t solved_points(std::uint32_t manifold) const noexcept {
        return pairs[manifolds[manifold].pair].passes ? 0 : manifolds[manifold].count;
    }

    void clear() noexcept {
        summary = {};
        flying.clear();
        order.clear();
        patched = false;
        pairs.clear();
        manifolds.clear();
        points.clear();
        impulses.clear();
        unused_points = 0;
    }
    /// Gives memory back where much more is held than needed (room.hpp).
    void trim();
    [[nodiscard]] std::size_t memory() const noexcept;
};

class CarriedContacts;

/// Makes a pair of each candidate that has manifolds (append() names it as the pair), by `make` and in their order, numbers the manifolds' pairs by it, and sums the manifolds
/// up. Gives each point the impulses that the point of the same feature and the same pair had in `before`, times `scale` (the ratio of the
/// substeps: forces stay, impulses do not); zero where it is new (carry_impulses() has the rule).
/// In parts of fixed length: the same bits on every number of threads. Cost: linear in the two sets.
void link_manifolds(ContactSet& contacts, FunctionRef<ContactPair(std::uint32_t candidate)> make, const CarriedContacts& before, float scale,
                    Executor& executor);

/// The summary, over all manifolds; in parts as above.
void sum_up(ContactSet& contacts, Executor& executor);

}  // namespace carom::dynamics
