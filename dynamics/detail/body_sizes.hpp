// How large bodies are: what a motion of theirs is compared with.
//
//   list_body_sizes(proxies, slots, sizes);
#pragma once

#include <carom/core/math.hpp>
#include <carom/dynamics/detail/proxies.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace carom::dynamics {

struct BodySize {
    double reach = 0.0;   ///< farthest point of a bounded shape from the centre of mass [m]
    double extent = 0.0;  ///< least of the bounded shapes [m]; 0: it has none
    /// For each principal axis: the shapes are solids of revolution about it but for so much [m]. Infinite of shapes that are none.
    dvec3 out_of_round{0.0};
};

/// @param local  where the shape is in the principal frame. @param reach  its farthest point from there [m].
[[nodiscard]] inline dvec3 out_of_round(const Shape& shape, const Pose& local, double reach) noexcept {
    const ShapeType type = type_of(shape);
    const bool turned = type == ShapeType::Capsule || type == ShapeType::Cylinder || type == ShapeType::Cone;
    if (!turned && type != ShapeType::Sphere) return dvec3{std::numeric_limits<double>::infinity()};
    const dvec3 own = turned ? rotate(local.orientation, dvec3{0.0, 1.0, 0.0}) : dvec3{0.0}, c = local.position;
    dvec3 off;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double tilt = own[j] * own[j] + own[k] * own[k];  // squared sine; the farthest point is within twice the reach of the shape's middle
        off[i] = std::sqrt(c[j] * c[j] + c[k] * c[k]) + (tilt < 1e-6 ? 2.1 * reach * std::sqrt(tilt) : std::numeric_limits<double>::infinity());
    }
    return off;
}

/// Replaces `sizes` by those of the bodies in slots 0 to `slots`.
inline void list_body_sizes(const ProxySet& proxies, std::size_t slots, std::vector<BodySize>& sizes) {
    sizes.assign(slots, BodySize{});
    for (std::size_t i = 0; i < proxies.by_slot.size(); ++i) {
        if (proxies.kinds[i] != ProxyKind::Bounded) continue;
        BodySize& size = sizes[proxies.bodies[i]];
        size.extent = size.extent == 0.0 ? proxies.extents[i] : std::min(size.extent, proxies.extents[i]);
        size.reach = std::max(size.reach, proxies.by_slot[i].reach);
        size.out_of_round = glm::max(size.out_of_round, out_of_round(proxies.by_slot[i].shape, proxies.by_slot[i].local.get(), proxies.by_slot[i].reach));
    }
}

}  // namespace carom::dynamics
