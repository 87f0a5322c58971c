// One broadphase with a set of moving boxes in it: what the comparison of broadphases asks of each.
//
//   std::unique_ptr<PairFinder> finder = make_bullet_pairs(boxes);
//   finder->update(boxes, moved); use(finder->pairs());
#pragma once

#include <carom/broadphase/broadphase.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace carom::bench {

/// Runs on one thread, at its defaults. Box i is that of slot i; all are movable and may meet.
class PairFinder {
public:
    PairFinder() = default;
    PairFinder(const PairFinder&) = delete;
    PairFinder& operator=(const PairFinder&) = delete;
    virtual ~PairFinder() = default;

    [[nodiscard]] virtual std::string name() const = 0;     ///< as filters and reports spell it
    [[nodiscard]] virtual std::string version() const = 0;  ///< of the library that runs
    /// Takes the new boxes of `moved` over and finds the pairs of all. This is what is timed.
    virtual void update(std::span<const FloatAabb> boxes, std::span<const std::uint32_t> moved) = 0;
    /// The pairs that the last update found, in any order: all that overlap, and perhaps some that do not.
    [[nodiscard]] virtual std::vector<ProxyPair> pairs() const = 0;
};

[[nodiscard]] std::unique_ptr<PairFinder> make_carom_pairs(std::span<const FloatAabb> boxes);
/// Carom, from scratch at each update.
[[nodiscard]] std::unique_ptr<PairFinder> make_carom_scratch(std::span<const FloatAabb> boxes);
/// btDbvtBroadphase.
[[nodiscard]] std::unique_ptr<PairFinder> make_bullet_pairs(std::span<const FloatAabb> boxes);
/// DynamicAABBTreeCollisionManager in double, which is its default.
[[nodiscard]] std::unique_ptr<PairFinder> make_fcl_pairs(std::span<const FloatAabb> boxes);
/// box_self_intersection_d, from scratch at each update.
[[nodiscard]] std::unique_ptr<PairFinder> make_cgal_pairs(std::span<const FloatAabb> boxes);

}  // namespace carom::bench
