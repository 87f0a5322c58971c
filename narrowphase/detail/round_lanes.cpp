// Spheres and capsules against each other, spheres against boxes, both against planes: eight pairs at a time, in double.
//
// The same operations in the same order as in sphere_round.cpp and capsule_round.cpp, which take one pair and are what tests hold this against:
// the same bits.
#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/round_lanes.cpp>
#include <hwy/foreach_target.h>

#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/round_lanes.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

struct WideDirection {
    Doubles3 unit;
    Doubles length;
};
HWY_INLINE WideDirection direction_of(const Doubles3& v, const Doubles3& fallback) {
    const Doubles length = sqrt(dot(v, v));
    const DoubleMask has = length > Doubles(1e-140);
    return {select(has, over(v, length), fallback), select(has, length, Doubles(0.0))};
}

struct WideSegment {
    Doubles3 from, to;
    HWY_INLINE Doubles3 at(Doubles t) const { return from + (to - from) * t; }
};
HWY_INLINE WideSegment segment_of(Doubles half_length, const Doubles3& axis, const Doubles3& centre) {
    const Doubles3 half = axis * half_length;
    return {centre - half, centre + half};
}
HWY_INLINE Doubles closest_parameter(const WideSegment& s, const Doubles3& point) {
    const Doubles3 d = s.to - s.from;
    const Doubles length_sq = dot(d, d);
    return select(length_sq > Doubles(0.0), clamp01(dot(point - s.from, d) / length_sq), Doubles(0.0));
}
struct WideParameters {
    Doubles s, t;
};
HWY_INLINE WideParameters closest_parameters(const WideSegment& a, const WideSegment& b) {
    const Doubles3 d = a.to - a.from, e = b.to - b.from, r = a.from - b.from;
    const Doubles zero(0.0), dd = dot(d, d), ee = dot(e, e), de = dot(d, e);
    const Doubles determinant = dd * ee - de * de;
    Doubles s = select(determinant > zero, clamp01((de * dot(e, r) - ee * dot(d, r)) / determinant), zero);
    Doubles t = closest_parameter(b, a.at(s));
    s = closest_parameter(a, b.at(t));
    t = closest_parameter(b, a.at(s));
    return {s, t};
}

HWY_INLINE WideContact<1> one_point(const Doubles3& normal, const WideContactPoint& point) { return {normal, {point}}; }

HWY_INLINE WideContact<1> ball_against_point(const WideFrame& f, Doubles own, const Doubles3& q, Doubles radius, const Doubles3& fallback) {
    const WideDirection direction = direction_of(q, fallback);
    const DoubleMask apart = (direction.length - own) - radius > f.margin;
    return one_point(direction.unit, ball_point(zero3(), own, direction.unit, direction.length - radius, !apart));
}

struct SphereSphere {
    static HWY_INLINE WideContact<1> touch(const WideFrame& f, const Sizes& size) {
        return ball_against_point(f, size.first[0], f.translation, size.second[0], {Doubles(0.0), Doubles(1.0), Doubles(0.0)});
    }
};

struct SphereCapsule {
    static HWY_INLINE WideContact<1> touch(const WideFrame& f, const Sizes& size) {
        const WideSegment segment = segment_of(size.second[1], f.rotation.y, f.translation);
        const Doubles3 q = segment.at(closest_parameter(segment, zero3()));
        return ball_against_point(f, size.first[0], q, size.second[0], any_perpendicular(f.rotation.y));
    }
};

struct SphereBox {
    static HWY_INLINE WideContact<1> touch(const WideFrame& f, const Sizes& size) {
        const Doubles zero(0.0), one(1.0), radius = size.first[0];
        const Doubles3 half{size.second[0], size.second[1], size.second[2]}, centre = f.rotation.back(zero3() - f.translation);
        const auto clamped = [](Doubles x, Doubles h) { return least(greatest(x, -h), h); };
        const Doubles3 closest{clamped(centre.x, half.x), clamped(centre.y, half.y), clamped(centre.z, half.z)};
        const WideDirection out = direction_of(centre - closest, zero3());
        const DoubleMask valid = !(out.length - radius > f.margin), outside = out.length > zero;

        const Doubles3 room{half.x - abs(centre.x), half.y - abs(centre.y), half.z - abs(centre.z)};
        const DoubleMask y_best = room.y < room.x;
        const Doubles room_xy = select(y_best, room.y, room.x);
        const DoubleMask z_best = room.z < room_xy;
        const Doubles nearest = select(z_best, room.z, room_xy);
        const Doubles along = select(z_best, centre.z, select(y_best, centre.y, centre.x));
        const Doubles3 face = select(z_best, f.rotation.z, select(y_best, f.rotation.y, f.rotation.x));
        const Doubles3 normal = select(outside, -(f.rotation * out.unit), face * select(along < zero, one, -one));
        return one_point(normal, ball_point(zero3(), radius, normal, select(outside, out.length, -nearest), valid));
    }
};

struct SpherePlane {
    static HWY_INLINE WideContact<1> touch(const WideFrame& f, const Sizes& size) {
        const WidePlane plane(f, size);
        const Doubles distance = plane.distance(zero3());
        const Doubles3 normal = -plane.normal;
        return one_point(normal, ball_point(zero3(), size.first[0], normal, distance, !(distance - size.first[0] > f.margin)));
    }
};

struct CapsulePlane {
    static HWY_INLINE WideContact<2> touch(const WideFrame& f, const Sizes& size) {
        const WidePlane plane(f, size);
        const Doubles zero(0.0), radius = size.first[0], half = size.first[1];
        const WideSegment segment = segment_of(half, {zero, Doubles(1.0), zero}, zero3());
        const Doubles from = plane.distance(segment.from), to = plane.distance(segment.to);
        const Doubles3 normal = -plane.normal;
        return {normal,
                {ball_point(segment.from, radius, normal, from, from - radius <= f.margin, Doubles(1.0)),
                 ball_point(segment.to, radius, normal, to, (to - radius <= f.margin) & (half > zero), Doubles(2.0))}};
    }
};

struct CapsuleCapsule {
    // Square to both axes where they cross in a point; square to A's where they lie along each other.
    static HWY_INLINE Doubles3 fallback_normal(const WideSegment& a, const WideSegment& b) {
        const Doubles3 along = direction_of(a.to - a.from, {Doubles(0.0), Doubles(1.0), Doubles(0.0)}).unit;
        return direction_of(cross(a.to - a.from, b.to - b.from), any_perpendicular(along)).unit;
    }
    static HWY_INLINE WideContact<2> touch(const WideFrame& f, const Sizes& size) {
        const Doubles zero(0.0), one(1.0), radius_a = size.first[0], radius_b = size.second[0];
        const WideSegment a = segment_of(size.first[1], {zero, one, zero}, zero3());
        const WideSegment b = segment_of(size.second[1], f.rotation.y, f.translation);
        const WideParameters closest = closest_parameters(a, b);
        const WideDirection direction = direction_of(b.at(closest.t) - a.at(closest.s), fallback_normal(a, b));
        const Doubles3& normal = direction.unit;
        const DoubleMask touches = !((direction.length - radius_a) - radius_b > f.margin);

        // The stretch of A beside B, and whether the two lie along each other.
        const Doubles3 d = a.to - a.from, e = b.to - b.from;
        const Doubles dd = dot(d, d);
        const Doubles s0 = dot(b.from - a.from, d) / dd, s1 = dot(b.to - a.from, d) / dd;
        const Doubles low = select(dd > zero, greatest(zero, least(s0, s1)), one),
                      high = select(dd > zero, least(one, greatest(s0, s1)), zero);
        const Doubles length = ((high - low) * Doubles(2.0)) * size.first[1];
        const Doubles3 c = cross(d, e);
        const DoubleMask along =
            (dot(c, c) < (Doubles(kAlongSine * kAlongSine) * dd) * dot(e, e)) & (length > Doubles(kSnap) * least(radius_a, radius_b));

        const auto point = [&](Doubles s, double feature) {
            const Doubles3 p = a.at(s);
            const Doubles distance = dot(b.at(closest_parameter(b, p)) - p, normal);
            const DoubleMask valid = (touches & along) & ((distance - radius_a) - radius_b <= f.margin);
            return ball_point(p, radius_a, normal, distance - radius_b, valid, Doubles(feature));
        };
        WideContact<2> contact{normal, {point(low, 1.0), point(high, 2.0)}};
        const WideContactPoint middle = ball_point(a.at(closest.s), radius_a, normal, direction.length - radius_b, touches);
        WideContactPoint& first = contact.points[0];
        const DoubleMask alone = !(first.valid | contact.points[1].valid);
        first = {select(alone, middle.position, first.position), select(alone, middle.separation, first.separation),
                 select(alone, middle.feature, first.feature), first.valid | (alone & touches)};
        return contact;
    }
};

using Chosen = std::span<const std::uint32_t>;
using Manifolds = ManifoldList;
void SphereSphereLanes(const BatchInput& i, Chosen c, Manifolds& out) { run<SphereSphere>(i, c, ShapeType::Sphere, out); }
void SphereCapsuleLanes(const BatchInput& i, Chosen c, Manifolds& out) { run<SphereCapsule>(i, c, ShapeType::Sphere, out); }
void SphereBoxLanes(const BatchInput& i, Chosen c, Manifolds& out) { run<SphereBox>(i, c, ShapeType::Sphere, out); }
void SpherePlaneLanes(const BatchInput& i, Chosen c, Manifolds& out) { run<SpherePlane>(i, c, ShapeType::Sphere, out); }
void CapsuleCapsuleLanes(const BatchInput& i, Chosen c, Manifolds& out) { run<CapsuleCapsule>(i, c, ShapeType::Capsule, out); }
void CapsulePlaneLanes(const BatchInput& i, Chosen c, Manifolds& out) { run<CapsulePlane>(i, c, ShapeType::Capsule, out); }

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(SphereSphereLanes);
HWY_EXPORT(SphereCapsuleLanes);
HWY_EXPORT(SphereBoxLanes);
HWY_EXPORT(SpherePlaneLanes);
HWY_EXPORT(CapsuleCapsuleLanes);
HWY_EXPORT(CapsulePlaneLanes);

void sphere_sphere_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace&, ManifoldList& out) {
    HWY_DYNAMIC_DISPATCH(SphereSphereLanes)(input, chosen, out);
}
void sphere_capsule_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace&, ManifoldList& out) {
    HWY_DYNAMIC_DISPATCH(SphereCapsuleLanes)(input, chosen, out);
}
void sphere_box_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace&, ManifoldList& out) {
    HWY_DYNAMIC_DISPATCH(SphereBoxLanes)(input, chosen, out);
}
void sphere_plane_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace&, ManifoldList& out) {
    HWY_DYNAMIC_DISPATCH(SpherePlaneLanes)(input, chosen, out);
}
void capsule_capsule_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace&, ManifoldList& out) {
    HWY_DYNAMIC_DISPATCH(CapsuleCapsuleLanes)(input, chosen, out);
}
void capsule_plane_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace&, ManifoldList& out) {
    HWY_DYNAMIC_DISPATCH(CapsulePlaneLanes)(input, chosen, out);
}
}  // namespace carom::detail
#endif
