// Whether a shape went in a step where the broadphase does not expect it: out of the box that update_swept_bounds() gave it.
#pragma once

#include <carom/dynamics/detail/proxies.hpp>

namespace carom::dynamics {

/// A body's step: how it stood and moved when its boxes were made, and how it is now.
struct BodyWay {
    const Pose& from;
    const dvec3& velocity;  ///< then [m/s]
    const BodyState& to;
    double dt = 0.0;
};

/// @return whether the box about both ends of the way, with room for the bend between them, is beyond the one that the broadphase has.
[[nodiscard]] bool strays(const ProxySet& proxies, std::uint32_t proxy, const BodyWay& step);

/// @return whether a glance tells that strays() is false, a tenth of its cost and less. Never wrong where it says so.
[[nodiscard]] bool surely_stays(const ProxySet& proxies, std::uint32_t proxy, const BodyWay& step);

}  // namespace carom::dynamics
