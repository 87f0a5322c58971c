#include <carom/narrowphase/detail/moving_core.hpp>

#include <carom/core/math.hpp>

#include <glm/geometric.hpp>

namespace carom::detail {

TrianglePoints triangle_points(const std::array<vec3, 3>& corners) noexcept {
    TrianglePoints t{corners, {}};
    for (int lane = 0; lane < kDoubleBundleWidth; ++lane) {
        const vec3& p = corners[lane < 3 ? static_cast<std::size_t>(lane) : 0];
        t.bundle.x.lane[lane] = static_cast<double>(p.x);
        t.bundle.y.lane[lane] = static_cast<double>(p.y);
        t.bundle.z.lane[lane] = static_cast<double>(p.z);
    }
    return t;
}

namespace {

/// Its half extents in the pair's unit, so that its axes are of unit length.
ConvexCore box_core(const MovingCore& moving, const dquat& orientation, const dvec3& centre) noexcept {
    ConvexCore core;
    core.half = moving.scale * dvec3(as<Box>(*moving.shape).half_extents);
    core.axes = glm::mat3_cast(orientation);
    core.centre = centre;
    core.reach = moving.reach + glm::length(moving.pivot);
    return core;
}

}  // namespace

bool MovingCore::is_box() const noexcept { return shape != nullptr && type_of(*shape) == ShapeType::Box; }

dvec3 MovingCore::normal_at(double t) const noexcept {
    return rotation == dvec3{0.0} ? plane_normal : rotate(rotation_from_vector(t * rotation), plane_normal);
}

ConvexCore MovingCore::core(double t, const dvec3& at) const noexcept {
    const dquat orientation = rotation == dvec3{0.0} ? start : rotation_from_vector(t * rotation) * start;
    if (is_plane()) {
        ConvexCore point;
        point.centre = at + rotate(orientation, foot - pivot);
        return point;
    }
    if (ready != nullptr) {
        ConvexCore placed = *ready;
        placed.centre = at;
        return placed;
    }
    const dvec3 centre = at - rotate(orientation, pivot);
    if (is_box()) return box_core(*this, orientation, centre);
    if (shape != nullptr) return core_of(*shape, orientation, centre, scale);
    ConvexCore flat;
    flat.kind = ConvexCore::Kind::Points;
    flat.points = triangle->corner;
    flat.bundles = {&triangle->bundle, 1};
    flat.axes = scale * glm::mat3_cast(orientation);
    flat.centre = centre;
    flat.reach = reach + glm::length(pivot);
    return flat;
}

double MovingPair::rounding() const noexcept {
    const double turns = 1.0 + glm::length(a.rotation) + glm::length(b.rotation);
    const double plane = b.is_plane() ? glm::length(b.foot) + glm::length(b.pivot) : 0.0;
    const double size = glm::length(between) + glm::length(along) + a.reach + b.reach + a.radius + b.radius + plane;
    return 0x1p-46 * turns * size;
}

}  // namespace carom::detail
