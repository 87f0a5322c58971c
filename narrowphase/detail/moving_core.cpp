#include <carom/narrowphase/detail/moving_core.hpp>

#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/proximity.hpp>
#include <carom/narrowphase/detail/slide_cores.hpp>
#include <carom/narrowphase/detail/sweep_parts.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

/// The shapes at t, in the frame of A's pivot, and a normal that may part them.
struct Moment {
    const MovingPair& pair;
    ConvexCore a, b;
    dvec3 between{0.0};  ///< B's pivot
    dvec3 normal{0.0};
    double rest = 0.0;  ///< how far s goes
};

/// A plane that parts the shapes of a moment and turns at a constant rate: with one of them its faces stay in it, with neither it stands.
class TurningPlane {
public:
    TurningPlane(const Moment& now, const dvec3& turn) noexcept : now_(now) {
        const dvec3 &n = now.normal, sway = glm::cross(turn, n), &along = now.pair.along;
        const double swing = glm::length(sway), pull = glm::dot(sway, along);
        const MovingCore &a = now.pair.a, &b = now.pair.b;
        rate_ = glm::dot(n, along) + glm::dot(sway, now.between);
        slope_a_ = glm::cross(n, a.rotation) + sway;
        slope_b_ = -(glm::cross(n, b.rotation) + sway);
        const auto curvature = [&](const MovingCore& core) {  // of a point's height in a frame that turns with the core
            const dvec3 differ = turn - core.rotation;
            const double most = glm::length(differ), first = glm::length(glm::cross(differ, n)) + now.rest * most * swing;
            return core.reach * (glm::length(core.rotation) * std::min(most, first) + most * swing);
        };
        const double carried = glm::length(turn) * swing * (glm::length(now.between) + 3.0 * now.rest * glm::length(along));
        bend_ = 0.5 * (curvature(a) + curvature(b) + carried) + std::max(0.0, -pull);
    }

    /// @return at least how far the shapes are apart across the plane at t + s; concave in s. `least` is taken off.
    [[nodiscard]] double gap(double s, double least) const noexcept {
        const dvec3 ma = now_.normal + s * slope_a_, mb = -now_.normal + s * slope_b_;
        const double top = glm::dot(ma, now_.a.support(ma).point);
        const double bottom = glm::dot(mb, now_.b.support(mb).point - now_.between);
        return (glm::dot(now_.normal, now_.between) + s * rate_) - top - bottom - (s * s * bend_ + least);
    }

private:
    const Moment& now_;
    dvec3 slope_a_{0.0}, slope_b_{0.0};
    double rate_ = 0.0, bend_ = 0.0;
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

/// The different points of a core that the closest point lies between.
struct Feature {
    std::array<std::uint32_t, 4> points{};
    int count = 0;

    Feature(const std::array<std::uint32_t, 4>& numbers, std::uint32_t used) noexcept {
        for (std::uint32_t i = 0; i < used; ++i) {
            if (std::find(points.begin(), points.begin() + count, numbers[i]) == points.begin() + count) points[static_cast<std::size_t>(count++)] = numbers[i];
        }
    }
    [[nodiscard]] dvec3 edge(const ConvexCore& core) const noexcept { return core.place(points[1]) - core.place(points[0]); }
};

/// How a plane turns that two edges stay in; with B where they are all but parallel.
dvec3 turn_with_edges(const Moment& now, const dvec3& edge_a, const dvec3& edge_b) noexcept {
    const dvec3 &n = now.normal, &turn_a = now.pair.a.rotation, &turn_b = now.pair.b.rotation;
    const double area = glm::dot(n, glm::cross(edge_a, edge_b));
    const dvec3 sway = glm::dot(glm::cross(turn_a, n), edge_a) * glm::cross(edge_b, n) + glm::dot(glm::cross(turn_b, n), edge_b) * glm::cross(n, edge_a);
    constexpr double kMostSwing = 4.0;  // times the two rates
    const double most = kMostSwing * (glm::length(turn_a) + glm::length(turn_b)) * std::abs(area);
    return glm::dot(sway, sway) <= most * most && area != 0.0 ? glm::cross(n, sway) / area : turn_b;
}

/// @return a turn with which a plane may part the two for long: that of the features which their closest points lie on.
/// @param closest  of the moment; it knows no features of curved shapes.
dvec3 turn_with_features(const Moment& now, const DistanceCache& closest) noexcept {
    const dvec3 &turn_a = now.pair.a.rotation, &turn_b = now.pair.b.rotation;
    const Feature a(closest.a, closest.count), b(closest.b, closest.count);
    if (a.count == 2 && b.count == 2) return turn_with_edges(now, a.edge(now.a), b.edge(now.b));
    if (a.count == 0) return now.a.curved() ? turn_b : turn_a;
    if (a.count > b.count) return turn_a;
    return b.count > 1 ? turn_b : dvec3{0.0};
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
    DistanceCache* const closest = cache != nullptr ? cache : &own;
    dvec3 last{0.0};
    if (t <= until && !plane && pair.a.rotation == dvec3{0.0} && pair.b.rotation == dvec3{0.0}) {
        const ConvexCore a = pair.a.core(t, dvec3{0.0}), b = pair.b.core(t, pair.between + t * pair.along);
        if (!a.curved() && !b.curved()) {
            const Slide slide = slide_cores({a, b, pair.along, t, until, least, near});
            t = slide.passes ? std::numeric_limits<double>::infinity() : slide.t;
            *closest = slide.closest;
            last = slide.normal;
            ++impact.checks;
        }
    }
    while (t <= until) {
        ++impact.checks;
        const dvec3 between = pair.between + t * pair.along;
        Moment now{pair, pair.a.core(t, dvec3{0.0}), pair.b.core(t, between), between, -pair.b.plane_normal, 1.0 - t};
        dvec3 touch{0.0};
        double upper = 0.0;
        if (plane) {
            touch = now.a.support(now.normal).point + pair.a.radius * now.normal;
            upper = glm::dot(now.normal, now.b.centre - touch);
        } else {
            const CorePair cores{now.a, now.b, pair.unit, rounding};
            // Points and normal of round shapes are right to the root of the tolerance.
            const Proximity p = find_proximity(cores, {.tolerance = 1e-11}, closest);
            // Round shapes that all but touch have no closest points; what parted them last still may.
            now.normal = p.normal != dvec3{0.0} ? p.normal : last;
            last = now.normal;
            const dvec3 way = p.on_a - p.on_b;
            const double length = glm::length(way);
            touch = p.on_b + pair.b.radius * (length > 16.0 * rounding ? way / length : -now.normal);
            upper = p.upper - radii;
        }
        const TurningPlane still(now, dvec3{0.0});
        const double free = now.normal == dvec3{0.0} ? 0.0 : still.gap(0.0, least);
        impact.t = t;
        if (free > 0.0 && upper - separation > near) {
            if (impact.checks >= settings.most_checks) {
                impact.status = ImpactStatus::Clamped;
                return impact;
            }
            // Up to a gap that counts as touching: where rounding hides the gap, the closest points cost three times as much.
            const double left = std::min(0.5 * near, 0.5 * free);
            const auto safe = [&](const TurningPlane& between_them) {
                return safe_step([&](double s) { return between_them.gap(s, least + left); }, free - left, now.rest);
            };
            const dvec3 turn = plane ? dvec3{0.0} : turn_with_features(now, *closest);
            double step = safe(turn == dvec3{0.0} ? still : TurningPlane(now, turn));
            if (step < now.rest && turn != dvec3{0.0}) step = std::max(step, safe(still));
            if (step >= now.rest) break;
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
