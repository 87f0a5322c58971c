#include <carom/narrowphase/time_of_impact.hpp>

#include <carom/collision/bvh_sweep.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/convex_query.hpp>
#include <carom/narrowphase/detail/impact_input.hpp>
#include <carom/narrowphase/detail/moving_core.hpp>
#include <carom/narrowphase/detail/one_sided.hpp>

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

using detail::fit;
using detail::is_shape;
using detail::MovingCore;
using detail::MovingPair;

dvec3 pivot_of(const RigidMotion& m) noexcept { return m.start.position + rotate(m.start.orientation, m.pivot); }

/// In metres.
MovingCore moving_core(const Shape& shape, const RigidMotion& m) noexcept {
    MovingCore core;
    core.start = m.start.orientation;
    core.rotation = m.rotation;
    core.pivot = m.pivot;
    if (const Plane* plane = std::get_if<Plane>(&shape)) {
        const dvec3 n(plane->normal);
        const double length = glm::length(n);
        core.foot = (static_cast<double>(plane->offset) / (length * length)) * n;
        core.plane_normal = rotate(m.start.orientation, n / length);
        return core;
    }
    core.shape = &shape;
    const detail::ConvexCore still = detail::core_of(shape, kIdentityRotation, dvec3{0.0}, 1.0);
    core.reach = (still.reach + glm::length(m.pivot)) * (1.0 + 0x1p-50);
    core.radius = still.radius;
    if (core.reach == 0.0) core.rotation = dvec3{0.0};
    return core;
}

MovingCore moving_core(const detail::TrianglePoints& triangle, const RigidMotion& m) noexcept {
    MovingCore core;
    core.triangle = &triangle;
    core.start = m.start.orientation;
    core.rotation = m.rotation;
    core.pivot = m.pivot;
    for (const vec3& corner : triangle.corner) core.reach = std::max(core.reach, glm::length(dvec3(corner) - m.pivot) * (1.0 + 0x1p-50));
    return core;
}

void shrink(MovingCore& core, double by) noexcept {
    core.pivot *= by;
    core.foot *= by;
    core.scale = by;
    core.reach *= by;
    core.radius *= by;
}

/// @return the pair with lengths brought near 1 by a power of two.
MovingPair moving_pair(const MovingCore& a, const RigidMotion& motion_a, const MovingCore& b, const RigidMotion& motion_b) noexcept {
    MovingPair pair{a, b};
    // The origins first: they may be far away and near each other.
    pair.between = (motion_b.start.position - motion_a.start.position) +
                   (rotate(motion_b.start.orientation, motion_b.pivot) - rotate(motion_a.start.orientation, motion_a.pivot));
    pair.along = motion_b.translation - motion_a.translation;
    const auto largest = [](const dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
    const double size = std::max({largest(pair.between), a.reach + a.radius, b.reach + b.radius, largest(b.foot)});
    const int exponent = std::clamp(size > 0.0 ? std::ilogb(size) : 0, -1000, 1000);
    const double by = std::ldexp(1.0, -exponent);
    pair.unit = std::ldexp(1.0, exponent);
    pair.between *= by;
    pair.along *= by;
    shrink(pair.a, by);
    shrink(pair.b, by);
    return pair;
}

constexpr Impact kInvalid{.status = ImpactStatus::Invalid, .t = 0.0};

/// Puts the point, which is relative to A's pivot at t, into the world.
Impact placed(Impact impact, const RigidMotion& motion_a) noexcept {
    if (impact.status == ImpactStatus::Touching) impact.point += pivot_of(motion_a) + impact.t * motion_a.translation;
    return impact;
}

/// @param a  no plane. Over a plane the point is A's lowest.
Impact search(const Shape& a, const RigidMotion& motion_a, const Shape& b, const RigidMotion& motion_b,
              const TimeOfImpactSettings& settings, DistanceCache* cache) noexcept {
    const MovingPair pair = moving_pair(moving_core(a, motion_a), motion_a, moving_core(b, motion_b), motion_b);
    return placed(find_impact(pair, settings, settings.until, cache), motion_a);
}

}  // namespace

Pose pose_at(const RigidMotion& motion, double t) noexcept {
    Pose pose = motion.start;
    if (motion.rotation != dvec3{0.0}) pose.orientation = rotation_from_vector(t * motion.rotation) * motion.start.orientation;
    pose.position = (pivot_of(motion) + t * motion.translation) - rotate(pose.orientation, motion.pivot);
    return pose;
}

Impact time_of_impact(const Shape& a, const RigidMotion& motion_a, const Shape& b, const RigidMotion& motion_b,
                      const TimeOfImpactSettings& settings, DistanceCache* cache) noexcept {
    if (!fit(motion_a) || !fit(motion_b) || !fit(settings) || !is_shape(a) || !is_shape(b)) return kInvalid;
    if (detail::query_fault(a, b).what != nullptr) return kInvalid;
    if (type_of(a) == ShapeType::Plane) {
        Impact impact = search(b, motion_b, a, motion_a, settings, cache);
        impact.normal = -impact.normal;
        return impact;
    }
    Impact impact = search(a, motion_a, b, motion_b, settings, cache);
    if (type_of(b) == ShapeType::Plane && impact.status == ImpactStatus::Touching) {
        const dvec3 local = moving_core(b, motion_b).foot;
        const dvec3 foot = motion_b.rotation == dvec3{0.0} ? transform_point(motion_b.start, local) + impact.t * motion_b.translation
                                                           : transform_point(pose_at(motion_b, impact.t), local);
        impact.point += glm::dot(impact.normal, foot - impact.point) * impact.normal;
    }
    return impact;
}

geo::MeshImpact time_of_impact(const Shape& a, const RigidMotion& motion_a, const TriangleMesh& b, const RigidMotion& motion_b,
                               const TimeOfImpactSettings& settings) {
    const Shape ball = Sphere{};
    if (!fit(motion_a) || !fit(motion_b) || !fit(settings) || !is_shape(a) || type_of(a) == ShapeType::Plane ||
        detail::query_fault(a, ball).what != nullptr) {
        return {kInvalid};
    }
    const MovingCore core = moving_core(a, motion_a);
    // The ball about A's pivot in the mesh's frame as it stands at the start; where the mesh turns, it is as much larger as its centre
    // may be carried round.
    const Pose& frame = motion_b.start;
    const dvec3 from = inverse_transform_point(frame, pivot_of(motion_a)), pivot = motion_b.pivot;
    const dvec3 along = inverse_transform_vector(frame, motion_a.translation - motion_b.translation);
    const double farthest = std::max(glm::length(from - pivot), glm::length(from + along - pivot));
    const double turned = std::min(glm::length(motion_b.rotation), 2.0) * farthest;
    const double radius = (core.reach + core.radius + settings.separation + turned) * (1.0 + 1e-12) + 1e-12 * farthest;
    geo::MeshImpact first;
    first.t = settings.until;
    int checks = 0;
    const auto centre_at = [&](double t) {
        return inverse_transform_point(pose_at(motion_b, t), transform_point(pose_at(motion_a, t), detail::centre_of(a)));
    };
    const detail::OneSidedPath path(b, b.is_one_sided() ? centre_at(0.0) : dvec3{0.0});
    const auto look = [&](std::uint32_t index) {
        // Where the mesh turns, its boxes are met in another order than its triangles.
        const auto farthest_wanted = [&] { return turned > 0.0 ? 1.0 : first.t; };
        if (path.passes(index)) return farthest_wanted();
        const detail::TrianglePoints points = detail::triangle_points(b.corners(index));
        const MovingPair pair = moving_pair(core, motion_a, moving_core(points, motion_b), motion_b);
        const Impact next = find_impact(pair, settings, first.t, nullptr);
        checks += next.checks;
        const bool earlier = !may_touch(first.status) || next.t < first.t || (next.t == first.t && index < first.triangle);
        if (may_touch(next.status) && earlier && !path.is_back(index, [&] { return centre_at(next.t); })) {
            static_cast<Impact&>(first) = next;
            first.triangle = index;
        }
        return farthest_wanted();
    };
    const double reach = turned > 0.0 ? 1.0 : settings.until;
    triangles_along(b.bvh(), {.origin = from, .direction = along, .t_max = reach}, dvec3{radius}, look);
    static_cast<Impact&>(first) = placed(first, motion_a);
    first.checks = checks;
    return first;
}

}  // namespace carom
