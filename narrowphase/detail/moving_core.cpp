#include <carom/narrowphase/detail/moving_core.hpp>

#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/proximity.hpp>
#include <carom/narrowphase/detail/sweep_parts.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom::detail {
namespace {

/// The shapes at t, in the frame of A's pivot, and a normal that may part them.
struct Moment {
    const MovingPair& pair;
    ConvexCore a, b;
    dvec3 between{0.0};  ///< B's pivot
    dvec3 normal{0.0};

    /// @return at least how far the shapes are apart along the normal at t + s; concave in s. `least` is taken off.
    [[nodiscard]] double gap(double s, double least) const noexcept {
        const dvec3 ma = normal + s * glm::cross(normal, pair.a.rotation);
        const dvec3 mb = -normal - s * glm::cross(normal, pair.b.rotation);
        const double top = glm::dot(ma, a.support(ma).point);
        const double bottom = glm::dot(mb, b.support(mb).point - between);
        const double bend = 0.5 * s * s * (curvature(pair.a) + curvature(pair.b));
        return glm::dot(normal, between + s * pair.along) - top - bottom - (bend + least);
    }

private:
    [[nodiscard]] double curvature(const MovingCore& core) const noexcept {
        return glm::length(core.rotation) * glm::length(glm::cross(core.rotation, normal)) * core.reach;
    }
};

/// @return the longest step found for which `gap` stays positive; 0 where none is. A secant of a concave function ends before its root.
template <class Gap>
double safe_step(const Gap& gap, double now, double rest) noexcept {
    double safe = 0.0, far = rest;
    for (int k = 0; k < 5; ++k) {
        const double then = gap(far);
        if (then >= 0.0) return far;
        safe = std::max(safe, far * (now / (now - then)) * (1.0 - 0x1p-50));
        const double next = std::sqrt(safe * far);
        if (!(next > 1.05 * safe)) break;
        far = next;
    }
    return safe;
}

/// @return when the balls about the two pivots first come near; kNoContact where they never do.
double balls_meet(const MovingPair& pair, double separation) noexcept {
    const double radius = pair.a.reach + pair.a.radius + pair.b.reach + pair.b.radius + separation;
    const SweepPath path{-pair.along, radius + 4.0 * pair.rounding(), glm::length(pair.between) + radius};
    return sweep_point(path, pair.between).t;
}

}  // namespace

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

ConvexCore MovingCore::core(double t, const dvec3& at) const noexcept {
    const dquat orientation = rotation == dvec3{0.0} ? start : rotation_from_vector(t * rotation) * start;
    if (plane_normal != dvec3{0.0}) {
        ConvexCore point;
        point.centre = at + rotate(orientation, foot - pivot);
        return point;
    }
    const dvec3 centre = at - rotate(orientation, pivot);
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
    const double size = glm::length(between) + glm::length(along) + a.reach + b.reach + a.radius + b.radius + glm::length(b.foot);
    return 0x1p-46 * turns * size;
}

Impact find_impact(const MovingPair& pair, const TimeOfImpactSettings& settings, double until, DistanceCache* cache) noexcept {
    const double separation = settings.separation / pair.unit;
    const double radii = pair.a.radius + pair.b.radius, rounding = pair.rounding();
    const double near = std::max(settings.tolerance / pair.unit, 1e-9 * (pair.a.reach + pair.b.reach + radii));
    const bool plane = pair.b.plane_normal != dvec3{0.0};
    const double least = radii + rounding + separation * (1.0 + 0x1p-50);
    double t = plane ? 0.0 : balls_meet(pair, separation);
    Impact impact;
    DistanceCache own;
    dvec3 last{0.0};
    while (t <= until) {
        ++impact.checks;
        const dvec3 between = pair.between + t * pair.along;
        Moment now{pair, pair.a.core(t, dvec3{0.0}), pair.b.core(t, between), between, -pair.b.plane_normal};
        dvec3 touch{0.0};
        double upper = 0.0;
        if (plane) {
            touch = now.a.support(now.normal).point + pair.a.radius * now.normal;
            upper = glm::dot(now.normal, now.b.centre - touch);
        } else {
            const CorePair cores{now.a, now.b, pair.unit, rounding};
            // Points and normal of round shapes are right to the root of the tolerance.
            const Proximity p = find_proximity(cores, {.tolerance = 1e-11}, cache != nullptr ? cache : &own);
            // Round shapes that all but touch have no closest points; what parted them last still may.
            now.normal = p.normal != dvec3{0.0} ? p.normal : last;
            last = now.normal;
            const dvec3 way = p.on_a - p.on_b;
            const double length = glm::length(way);
            touch = p.on_b + pair.b.radius * (length > 16.0 * rounding ? way / length : -now.normal);
            upper = p.upper - radii;
        }
        const double free = now.normal == dvec3{0.0} ? 0.0 : now.gap(0.0, least);
        impact.t = t;
        if (free > 0.0 && upper - separation > near) {
            if (impact.checks >= settings.most_checks) {
                impact.status = ImpactStatus::Clamped;
                return impact;
            }
            // Up to a gap that counts as touching: where rounding hides the gap, the closest points cost three times as much.
            const double left = std::min(0.5 * near, 0.5 * free);
            const double step = safe_step([&](double s) { return now.gap(s, least + left); }, free - left, 1.0 - t);
            if (step >= 1.0 - t) break;
            if (t + step > t) {
                t += step;
                continue;
            }
        }
        impact.status = t > 0.0 || free > 0.0 ? ImpactStatus::Touching : ImpactStatus::Overlapping;
        if (impact.status == ImpactStatus::Touching) impact.point = pair.unit * touch, impact.normal = now.normal;
        return impact;
    }
    impact.t = until;
    return impact;
}

}  // namespace carom::detail
