// Vertices and planes of a convex polytope as SIMD lanes read them: eight to a bundle.
//
//   for (const PointBundle& p : hull.point_bundles()) ... p.x.lane[k] ...
#pragma once

#include <carom/core/bundle.hpp>
#include <carom/core/types.hpp>

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace carom {

/// Eight points [m]. Lanes beyond the last point repeat one of them.
struct PointBundle {
    DoubleBundle x, y, z;
};

/// Eight planes dot(normal, p) = offset, normals unit and outward, offsets [m]. Lanes without a plane have no normal and an infinite
/// offset: every point is infinitely far below them.
struct PlaneBundle {
    DoubleBundle x, y, z, offset;
};

[[nodiscard]] constexpr std::size_t double_bundle_count(std::size_t count) noexcept {
    return (count + static_cast<std::size_t>(kDoubleBundleWidth) - 1) / static_cast<std::size_t>(kDoubleBundleWidth);
}

/// @param number  below the number of points or planes. @return it.
[[nodiscard]] inline dvec3 point_of(std::span<const PointBundle> points, std::size_t number) noexcept {
    const PointBundle& p = points[number / kDoubleBundleWidth];
    const std::size_t lane = number % kDoubleBundleWidth;
    return {p.x.lane[lane], p.y.lane[lane], p.z.lane[lane]};
}
[[nodiscard]] inline dvec3 normal_of(std::span<const PlaneBundle> planes, std::size_t number) noexcept {
    const PlaneBundle& p = planes[number / kDoubleBundleWidth];
    const std::size_t lane = number % kDoubleBundleWidth;
    return {p.x.lane[lane], p.y.lane[lane], p.z.lane[lane]};
}
[[nodiscard]] inline double offset_of(std::span<const PlaneBundle> planes, std::size_t number) noexcept {
    return planes[number / kDoubleBundleWidth].offset.lane[number % kDoubleBundleWidth];
}

inline void set_point(PointBundle& bundle, std::size_t lane, const dvec3& p) noexcept {
    bundle.x.lane[lane] = p.x;
    bundle.y.lane[lane] = p.y;
    bundle.z.lane[lane] = p.z;
}
inline void set_plane(PlaneBundle& bundle, std::size_t lane, const dvec3& normal, double offset) noexcept {
    bundle.x.lane[lane] = normal.x;
    bundle.y.lane[lane] = normal.y;
    bundle.z.lane[lane] = normal.z;
    bundle.offset.lane[lane] = offset;
}
/// Marks the lanes from `count` on as empty.
inline void end_planes(PlaneBundle& bundle, std::size_t count) noexcept {
    for (std::size_t lane = count; lane < kDoubleBundleWidth; ++lane) {
        set_plane(bundle, lane, dvec3{0.0}, std::numeric_limits<double>::infinity());
    }
}

}  // namespace carom
