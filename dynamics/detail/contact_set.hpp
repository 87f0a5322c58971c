// The contacts of a step and what they remember of the step before.
#pragma once

#include <carom/core/executor.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/core/ids.hpp>
#include <carom/narrowphase/manifold.hpp>

#include <array>
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
using ManifoldImpulses = std::array<PointImpulse, kMaxManifoldPoints>;

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
    std::vector<Manifold> manifolds;          ///< of a pair in a row; in the order of the pairs unless it is patched
    bool patched = false;                     ///< some manifolds lie elsewhere, or are unused (kNoPair)
    std::vector<std::uint32_t> order;         ///< where it is patched: of the manifolds in use, in the order of the pairs
    std::vector<ManifoldImpulses> impulses;   ///< one for each manifold
    ContactSummary summary;                   ///< of the manifolds
    std::vector<std::uint32_t> flying;        ///< pairs that fly
    std::vector<std::uint32_t> firsts;        ///< of each pair its first manifold, and the end: while pairs are made
    std::vector<std::uint32_t> first_counts;  ///< of each part of the manifolds, likewise
    std::vector<ContactSummary> parts;        ///< of the summary, while it is made

    [[nodiscard]] std::size_t manifold_count() const noexcept { return patched ? order.size() : manifolds.size(); }
    /// The i-th manifold in the order of the pairs, of those in use.
    [[nodiscard]] std::uint32_t manifold_number(std::size_t i) const noexcept { return patched ? order[i] : static_cast<std::uint32_t>(i); }

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
        impulses.clear();
    }
    /// Gives memory back where much more is held than needed (room.hpp).
    void trim();
    [[nodiscard]] std::size_t memory() const noexcept;
};

class CarriedContacts;

/// Makes a pair of each candidate that has manifolds, by `make` and in their order, numbers the manifolds' pairs by it, and sums the manifolds
/// up. Gives each point the impulses that the point of the same feature and the same pair had in `before`, times `scale` (the ratio of the
/// substeps: forces stay, impulses do not); zero where it is new (carry_impulses() has the rule).
/// In parts of fixed length: the same bits on every number of threads. Cost: linear in the two sets.
void link_manifolds(ContactSet& contacts, FunctionRef<ContactPair(std::uint32_t candidate)> make, const CarriedContacts& before, float scale,
                    Executor& executor);

/// The summary, over all manifolds; in parts as above.
void sum_up(ContactSet& contacts, Executor& executor);

}  // namespace carom::dynamics
