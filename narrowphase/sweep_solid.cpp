// Balls and capsules that move against cylinders and hulls: each plane that parts the two moves t on, and none of them too far.
#include <carom/narrowphase/sweep.hpp>

#include <carom/narrowphase/detail/moving_core.hpp>
#include <carom/narrowphase/detail/sweep_frame.hpp>

#include <algorithm>
#include <cmath>

namespace carom::geo {
namespace {

using namespace carom::detail;

// ---- cylinders -----------------------------------------------------------------------------------------------------------------------

/// About the start of A.
struct Tube {
    dvec3 centre{0.0};
    dvec3 axis{0.0};  ///< of unit length; zero: a ball
    double half = 0.0, radius = 0.0;

    /// @param all  from one end to the other: not from what rounding made of the ends in A's frame, which would tilt a disc.
    Tube(const dvec3& middle, const dvec3& all, double r) noexcept : centre(middle), radius(r) {
        const double longest = std::max({std::abs(all.x), std::abs(all.y), std::abs(all.z)});
        if (longest == 0.0) return;
        const dvec3 scaled = all / longest;  // squares of which neither overflow nor vanish
        const double length = glm::length(scaled);
        axis = scaled / length;
        half = 0.5 * longest * length;
    }
    /// From the nearest point to p, which has no length where p is inside.
    [[nodiscard]] dvec3 way_to(const dvec3& p) const noexcept {
        const dvec3 from = p - centre;
        const double along = glm::dot(from, axis);
        dvec3 across = from - along * axis;
        across -= glm::dot(across, axis) * axis;  // of a point beside a wire what rounding left along it would tilt the plane
        const double out = glm::length(across), beside = std::max(out - radius, 0.0), beyond = std::max(std::abs(along) - half, 0.0);
        return (out > 0.0 ? beside / out : 0.0) * across + std::copysign(beyond, along) * axis;
    }
    /// What the solid has at most along n.
    [[nodiscard]] double reach(const dvec3& n) const noexcept {
        const double along = glm::dot(n, axis);
        return glm::dot(n, centre) + half * std::abs(along) + radius * glm::length(n - along * axis);
    }
};

/// The core of A at t: a point, or the segment from it.
struct Core {
    dvec3 at{0.0}, axis{0.0};
};

/// Where the segment is nearest: the distance is convex along it, so its slope tells on which side.
double nearest_share(const Tube& b, const Core& a) noexcept {
    if (a.axis == dvec3{0.0}) return 0.0;
    const auto slope = [&](double s) { return glm::dot(b.way_to(a.at + s * a.axis), a.axis); };
    if (slope(0.0) >= 0.0) return 0.0;
    if (slope(1.0) <= 0.0) return 1.0;
    double low = 0.0, high = 1.0;
    for (int k = 0; k < 54; ++k) {
        const double middle = 0.5 * (low + high), tilt = slope(middle);
        if (tilt == 0.0) return middle;
        (tilt < 0.0 ? low : high) = middle;
    }
    return low;
}

/// @return a unit vector from B to A across which they are apart; zero where they are not.
dvec3 parting(const Tube& b, const Core& a) noexcept {
    const double share = nearest_share(b, a);
    dvec3 n = b.way_to(a.at + share * a.axis);
    const double length = glm::length(n);
    if (!(length > 0.0)) return dvec3{0.0};
    n /= length;
    if (!(share > 0.0 && share < 1.0)) return n;
    // Inside of the segment it is square to it; what the search left of its slope would tilt the plane.
    n -= (glm::dot(n, a.axis) / glm::dot(a.axis, a.axis)) * a.axis;
    return glm::normalize(n);
}

constexpr int kMostPlanes = 128;
constexpr double kShortAxis = 1e-100;  // the least growth hides it

/// Any unit vector proves its step; the one between the closest points makes it Newton's on a convex function, which never passes the root.
Impact advance(const SweepFrame& frame, const dvec3& axis, const Tube& b) noexcept {
    const double size = glm::length(b.centre) + b.half + b.radius + glm::length(axis);
    const SweepPath path = frame.path(size);
    const double slack = path.radius - frame.radius_a, speed = glm::length(path.motion);
    double t = 0.0;
    for (int k = 1; k <= kMostPlanes; ++k) {
        const Core a{t * path.motion, axis};
        const dvec3 n = parting(b, a);
        const double gap = glm::dot(n, a.at) + std::min(0.0, glm::dot(n, axis)) - b.reach(n) - path.radius;
        if (n == dvec3{0.0} || !(gap > slack)) {
            Impact impact = impact_of({t, -n}, frame);
            impact.checks = k;
            return impact;
        }
        const double closing = -glm::dot(n, path.motion) + 8.0 * 0x1p-52 * speed;
        if (!(closing > 0.0)) return {.checks = k};
        const double next = t + gap / closing * kRounded;
        if (!(next <= 1.0)) return {.checks = k};
        if (!(next > t)) return {ImpactStatus::Touching, t, frame.from + t * path.motion - frame.radius_a * n, -n, k};
        t = next;
    }
    return {.status = ImpactStatus::Clamped, .t = t, .checks = kMostPlanes};
}

template <class T>
Tube tube_of(const Cylinder<T>& c, const SweepFrame& frame) noexcept {
    const dvec3 a(c.axis.a), b(c.axis.b);
    return {0.5 * (frame.local(a) + frame.local(b)), b - a, double(c.radius)};
}

// ---- hulls ---------------------------------------------------------------------------------------------------------------------------

dmat3 frame_with_y(const dvec3& y) noexcept {
    const dvec3 other = std::abs(y.x) < 0.5 ? dvec3{1, 0, 0} : dvec3{0, 1, 0}, x = glm::normalize(glm::cross(y, other));
    return {x, y, glm::cross(x, y)};
}

/// @param middle  of A, whose core is a segment of the length 2 `half` along `y`.
Impact onto_hull(const dvec3& middle, double half, const dvec3& y, double radius, const dvec3& motion, const ConvexHull& b) noexcept {
    const double size = std::max({std::abs(middle.x), std::abs(middle.y), std::abs(middle.z), half + radius, b.reach()});
    const int exponent = std::clamp(size > 0.0 ? std::ilogb(size) : 0, -1000, 1000);
    const double by = std::ldexp(1.0, -exponent);
    ConvexCore core_a, core_b;
    core_a.half.y = half;
    core_a.axes = by * frame_with_y(y);
    core_a.reach = by * half;
    core_b.kind = ConvexCore::Kind::Points;
    core_b.points = b.vertices(), core_b.bundles = b.point_bundles();
    core_b.axes = dmat3{by};
    core_b.reach = by * b.reach();
    MovingPair pair;
    pair.a.ready = &core_a, pair.b.ready = &core_b;
    pair.a.reach = core_a.reach * (1.0 + 0x1p-50), pair.b.reach = core_b.reach;
    pair.a.radius = by * radius;
    pair.between = -by * middle;
    pair.along = -by * motion;
    pair.unit = std::ldexp(1.0, exponent);
    Impact impact = find_impact(pair, {}, 1.0, nullptr);
    if (impact.status == ImpactStatus::Touching) impact.point += middle + impact.t * motion;
    return impact;
}

}  // namespace

template <class T>
BasicImpact<T> sweep(const Sphere<T>& a, const Vec3<T>& motion, const Cylinder<T>& b) noexcept {
    if (!fit(a) || !fit(b) || !usual_vector(motion)) return rounded<T>(kInvalidImpact);
    const SweepFrame frame{dvec3(a.center), dvec3(motion), double(a.radius), 0.0};
    return rounded<T>(advance(frame, dvec3{0.0}, tube_of(b, frame)));
}

template <class T>
BasicImpact<T> sweep(const Capsule<T>& a, const Vec3<T>& motion, const Cylinder<T>& b) noexcept {
    if (!fit(a) || !fit(b) || !usual_vector(motion)) return rounded<T>(kInvalidImpact);
    const SweepFrame frame{dvec3(a.axis.a), dvec3(motion), double(a.radius), 0.0};
    dvec3 axis = dvec3(a.axis.b) - dvec3(a.axis.a);
    if (!(glm::dot(axis, axis) > kShortAxis * kShortAxis)) axis = dvec3{0.0};
    const Tube tube = tube_of(b, frame);
    Impact impact = advance(frame, axis, tube);
    if (impact.status == ImpactStatus::Touching) {
        const Core at{impact.t * frame.motion, axis};
        const dvec3 nearest = at.at + nearest_share(tube, at) * axis;
        impact.point = frame.from + (nearest - tube.way_to(nearest));
    }
    return rounded<T>(impact);
}

#define CAROM_TUBE_SWEEPS(A)                                                                                 \
    template BasicImpact<float> sweep(const A<float>&, const Vec3<float>&, const Cylinder<float>&) noexcept; \
    template BasicImpact<double> sweep(const A<double>&, const Vec3<double>&, const Cylinder<double>&) noexcept;
CAROM_TUBE_SWEEPS(Sphere)
CAROM_TUBE_SWEEPS(Capsule)
#undef CAROM_TUBE_SWEEPS

Impact sweep(const Sphere<double>& a, const Vec3<double>& motion, const ConvexHull& b) noexcept {
    if (!fit(a) || !usual_vector(motion)) return kInvalidImpact;
    return onto_hull(a.center, 0.0, {0, 1, 0}, a.radius, motion, b);
}

Impact sweep(const Capsule<double>& a, const Vec3<double>& motion, const ConvexHull& b) noexcept {
    if (!fit(a) || !usual_vector(motion)) return kInvalidImpact;
    const dvec3 half = 0.5 * (a.axis.b - a.axis.a);
    const double length = glm::length(half);
    return onto_hull(a.axis.a + half, length, length > 0.0 ? half / length : dvec3{0, 1, 0}, a.radius, motion, b);
}

}  // namespace carom::geo
