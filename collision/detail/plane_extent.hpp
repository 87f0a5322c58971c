// How far primitives reach below and above a plane, in double.
//
//   PlaneExtent e = extent_of(plane, box);   // e.lowest, e.highest: of the n- and the p-vertex
#pragma once

#include <carom/collision/detail/exact_sign.hpp>
#include <carom/collision/primitives.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace carom::geo {

/// The range of dot(normal, x) - offset over a shape; each end is within `error` of the exact one, and has its sign
/// where that is 0.
struct PlaneExtent {
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -std::numeric_limits<double>::infinity();
    double error = 0.0;
    bool is_number = true;  ///< false: NaN went in, or a negative size

    void add(double distance) noexcept {
        is_number = is_number && distance == distance;
        lowest = distance < lowest ? distance : lowest;
        highest = distance > highest ? distance : highest;
    }
    /// By `reach` on both sides.
    void widen(double reach) noexcept {
        is_number = is_number && reach >= 0.0;
        constexpr double kEps = std::numeric_limits<double>::epsilon();
        error = 6.0 * kEps * (std::max(std::abs(lowest), std::abs(highest)) + std::abs(reach));
        lowest -= reach;
        highest += reach;
    }
    [[nodiscard]] bool is_valid() const noexcept { return is_number && lowest <= highest; }
};

[[nodiscard]] inline double height_of(const Plane<double>& plane, const dvec3& point) noexcept {
    return accurate_dot(plane.normal, point, plane.offset);
}

[[nodiscard]] inline double length(const dvec3& v) noexcept { return std::sqrt(glm::dot(v, v)); }

[[nodiscard]] inline PlaneExtent extent_of(const Plane<double>& plane, const Sphere<double>& sphere) noexcept {
    PlaneExtent e;
    e.add(height_of(plane, sphere.center));
    e.widen(sphere.radius * length(plane.normal));
    return e;
}

[[nodiscard]] inline PlaneExtent extent_of(const Plane<double>& plane, const Aabb<double>& box) noexcept {
    dvec3 p = box.upper;
    dvec3 n = box.lower;
    for (int k = 0; k < 3; ++k) {
        if (plane.normal[k] < 0.0) {
            std::swap(p[k], n[k]);
        }
    }
    PlaneExtent e;
    e.lowest = height_of(plane, n);
    e.highest = height_of(plane, p);
    return e;
}

[[nodiscard]] inline PlaneExtent extent_of(const Plane<double>& plane, const Obb<double>& box) noexcept {
    PlaneExtent e;
    e.add(height_of(plane, box.center));
    double reach = 0.0;
    double size = 0.0;
    for (int k = 0; k < 3; ++k) {
        reach += std::abs(glm::dot(plane.normal, box.axes[k])) * box.half_extents[k];
        size += glm::dot(glm::abs(plane.normal), glm::abs(box.axes[k])) * std::abs(box.half_extents[k]);
        e.is_number = e.is_number && box.half_extents[k] >= 0.0;
    }
    e.widen(reach);
    e.error += 6.0 * std::numeric_limits<double>::epsilon() * size;
    return e;
}

[[nodiscard]] inline PlaneExtent extent_of(const Plane<double>& plane, const Capsule<double>& capsule) noexcept {
    PlaneExtent e;
    e.add(height_of(plane, capsule.axis.a));
    e.add(height_of(plane, capsule.axis.b));
    e.widen(capsule.radius * length(plane.normal));
    return e;
}

}  // namespace carom::geo
