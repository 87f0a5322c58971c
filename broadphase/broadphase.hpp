// Broadphase: bounds in, sorted unique pairs out. Every method stands behind this one interface.
//
//   auto broadphase = make_broadphase(BroadphaseMethod::SweepAndPrune);
//   std::span<const ProxyPair> pairs = broadphase->update(boxes, *executor);
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/types.hpp>

#include <compare>
#include <cstdint>
#include <memory>
#include <span>

namespace carom {

/// A closed box in float, relative to the broadphase's double origin [m].
struct FloatAabb {
    vec3 lower{0.0f};
    vec3 upper{0.0f};
    friend bool operator==(const FloatAabb&, const FloatAabb&) = default;
};

/// @return the smallest float box that holds `box` - `origin`: every bound rounded outward, so that boxes that overlap in
/// exact arithmetic overlap here too.
[[nodiscard]] FloatAabb round_outward(const Aabb& box, const dvec3& origin) noexcept;

/// Which of two proxies may meet: they are tested if each one's `layer` shares a bit with the other's `mask` and at
/// least one of them is movable.
struct ProxyFilter {
    std::uint64_t layer = 1;
    std::uint64_t mask = ~std::uint64_t{0};
    bool movable = true;
    friend bool operator==(const ProxyFilter&, const ProxyFilter&) = default;
};

/// Two proxies by index into the bounds, a < b.
struct ProxyPair {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    friend auto operator<=>(const ProxyPair&, const ProxyPair&) = default;
};

enum class BroadphaseMethod { BruteForce, SweepAndPrune };
[[nodiscard]] const char* to_string(BroadphaseMethod method) noexcept;

/// Finds the pairs of boxes that overlap (closed test) and whose filters agree.
class Broadphase {
public:
    virtual ~Broadphase() = default;
    [[nodiscard]] virtual BroadphaseMethod method() const noexcept = 0;

    /// @param bounds   (n,) finite, lower <= upper on every axis.
    /// @param filters  (n,).
    /// @return the pairs sorted by (a, b), each once; valid until the next call. On bad input (sizes that differ, NaN or
    /// inverted bounds) reports misuse, changes nothing and returns the pairs of the call before.
    /// The same list for every method, thread count and SIMD width.
    virtual std::span<const ProxyPair> update(std::span<const FloatAabb> bounds, std::span<const ProxyFilter> filters,
                                              Executor& executor) = 0;
};

[[nodiscard]] std::unique_ptr<Broadphase> make_broadphase(BroadphaseMethod method);

}  // namespace carom
