// The half-space of a pair in the frame of the other shape.
#pragma once

#include <carom/narrowphase/detail/kernel.hpp>

#include <glm/geometric.hpp>

#include <cmath>

namespace carom::detail {

struct PlaneForm {
    dvec3 normal{0.0, 1.0, 0.0};  ///< unit to double precision, out of the solid
    double offset = 0.0;
    [[nodiscard]] double distance(const dvec3& p) const noexcept { return glm::dot(normal, p) - offset; }
};

/// @return the plane `pair.second` in the frame of the first shape. The stored normal is of unit length to single precision only;
/// the plane is the set dot(normal, x) = offset as stored.
[[nodiscard]] inline PlaneForm plane_in_first(const PairFrame& pair) noexcept {
    const Plane& plane = as<Plane>(pair.second);
    const dvec3 stored(plane.normal);
    const double length = std::sqrt(glm::dot(stored, stored));
    const dvec3 normal = pair.rotation * (stored / length);
    return {normal, static_cast<double>(plane.offset) / length + glm::dot(normal, pair.translation)};
}

}  // namespace carom::detail
