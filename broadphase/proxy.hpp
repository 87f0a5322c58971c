// What a broadphase knows of a body: a box in float, and which others it may meet.
//
//   FloatAabb box = round_outward(bounds(shape, pose), origin);
//   ProxyFilter filter{.layer = kDebris, .mask = kGround | kPlayer};
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/core/types.hpp>

#include <compare>
#include <cstdint>

namespace carom {

/// A closed box in float, relative to the broadphase's double origin [m].
struct FloatAabb {
    vec3 lower{0.0f};
    vec3 upper{0.0f};
    friend bool operator==(const FloatAabb&, const FloatAabb&) = default;
};

/// Closed test: boxes that only touch overlap.
[[nodiscard]] inline bool overlaps(const FloatAabb& a, const FloatAabb& b) noexcept {
    return (a.lower.x <= b.upper.x) & (b.lower.x <= a.upper.x) & (a.lower.y <= b.upper.y) & (b.lower.y <= a.upper.y) &
           (a.lower.z <= b.upper.z) & (b.lower.z <= a.upper.z);
}

/// @return the smallest float box that holds `box` - `origin`: every bound rounded outward, so that boxes that overlap in
/// exact arithmetic overlap here too.
[[nodiscard]] FloatAabb round_outward(const Aabb& box, const dvec3& origin) noexcept;

/// @return whether round_outward(box, origin) is beyond `known` on any side, in a third of the time.
/// @param box  finite, and so is its distance from the origin.
[[nodiscard]] bool is_beyond(const Aabb& box, const dvec3& origin, const FloatAabb& known) noexcept;

/// A box of half size `grow` that moves from `origin` along `direction` for 0 <= t <= t_max; a ray where `grow` is zero. Finite.
struct SweepPath {
    dvec3 origin{0.0};
    dvec3 direction{0.0};
    double t_max = 0.0;
    dvec3 grow{0.0};
};

/// @return a box about all of the path, wide enough for what rounding does where it is met with a box: what lies beyond is not met.
[[nodiscard]] FloatAabb box_about(const SweepPath& path) noexcept;

/// Which of two proxies may meet: they are tested if each one's `layer` shares a bit with the other's `mask` and at
/// least one of them is movable.
struct ProxyFilter {
    std::uint64_t layer = 1;
    std::uint64_t mask = ~std::uint64_t{0};
    bool movable = true;
    friend bool operator==(const ProxyFilter&, const ProxyFilter&) = default;
};

[[nodiscard]] inline bool may_meet(const ProxyFilter& a, const ProxyFilter& b) noexcept {
    return (a.movable || b.movable) && (a.layer & b.mask) != 0 && (b.layer & a.mask) != 0;
}

/// Two proxies by slot, a < b.
struct ProxyPair {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    friend auto operator<=>(const ProxyPair&, const ProxyPair&) = default;
};

}  // namespace carom
