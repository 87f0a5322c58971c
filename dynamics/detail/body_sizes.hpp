// How large bodies are: what a motion of theirs is compared with.
//
//   list_body_sizes(proxies, slots, sizes);
#pragma once

#include <carom/dynamics/detail/proxies.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace carom::dynamics {

struct BodySize {
    double reach = 0.0;   ///< farthest point of a bounded shape from the centre of mass [m]
    double extent = 0.0;  ///< least of the bounded shapes [m]; 0: it has none
};

/// Replaces `sizes` by those of the bodies in slots 0 to `slots`.
inline void list_body_sizes(const ProxySet& proxies, std::size_t slots, std::vector<BodySize>& sizes) {
    sizes.assign(slots, BodySize{});
    for (std::size_t i = 0; i < proxies.by_slot.size(); ++i) {
        if (proxies.kinds[i] != ProxyKind::Bounded) continue;
        BodySize& size = sizes[proxies.bodies[i]];
        size.extent = size.extent == 0.0 ? proxies.extents[i] : std::min(size.extent, proxies.extents[i]);
        size.reach = std::max(size.reach, proxies.by_slot[i].reach);
    }
}

}  // namespace carom::dynamics
