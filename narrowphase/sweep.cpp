#include <carom/narrowphase/sweep.hpp>

#include <carom/collision/overlap_tests.hpp>
#include <carom/narrowphase/detail/sweep_frame.hpp>

#include <algorithm>

namespace carom::geo {
namespace {

using namespace carom::detail;

// ---- cores: what is left of a shape without its radius -------------------------------------------------------------------------------

struct BoxCore {
    dvec3 lower, upper;
};
struct TriangleCore {
    dvec3 a, b, c;
};
struct SegmentCore {
    dvec3 a, along;
};

// ---- a point's sweep against each core ----------------------------------------------------------------------------------------------

double farthest(const SegmentCore& s) noexcept { return std::max(glm::length(s.a), glm::length(s.a + s.along)); }
double farthest(const BoxCore& b) noexcept { return glm::length(glm::max(glm::abs(b.lower), glm::abs(b.upper))); }
double farthest(const TriangleCore& t) noexcept { return std::max({glm::length(t.a), glm::length(t.b), glm::length(t.c)}); }

SweepPart sweep_core(const SweepPath& path, const SegmentCore& s) noexcept { return sweep_segment(path, s.a, s.along); }
SweepPart sweep_core(const SweepPath& path, const BoxCore& b) noexcept { return sweep_box(path, b.lower, b.upper); }
SweepPart sweep_core(const SweepPath& path, const TriangleCore& t) noexcept {
    // From the corner opposite to the longest side, where the angle is largest.
    const dvec3 ab = t.b - t.a, bc = t.c - t.b, ca = t.a - t.c;
    const double c = glm::dot(ab, ab), a = glm::dot(bc, bc), b = glm::dot(ca, ca);
    const bool at_a = a >= b && a >= c, at_b = !at_a && b >= c;
    const dvec3 &corner = at_a ? t.a : at_b ? t.b : t.c, &u = at_a ? ab : at_b ? bc : ca, &back = at_a ? ca : at_b ? ab : bc;
    const SweepFace face(path, corner, u, -back);
    SweepPath rim = path;
    rim.radius += face.rim_growth();
    SweepPart first = sweep_face(path, face, FaceKind::Triangle);
    first = earlier(first, sweep_segment(rim, t.a, ab, first.t));
    first = earlier(first, sweep_segment(rim, t.b, bc, first.t));
    return earlier(first, sweep_segment(rim, t.c, ca, first.t));
}

/// The parallelogram that the edge q, q + u of B makes with the axis of A, and its rim.
SweepPart sweep_edges(const SweepPath& path, const dvec3& axis, const dvec3& q, const dvec3& u) noexcept {
    const SweepFace face(path, q, u, -axis);
    SweepPath rim = path;
    rim.radius += face.rim_growth();
    SweepPart first = sweep_face(path, face, FaceKind::Parallelogram);
    first = earlier(first, sweep_segment(rim, q, u, first.t));
    first = earlier(first, sweep_segment(rim, q - axis, u, first.t));
    first = earlier(first, sweep_segment(rim, q, -axis, first.t));
    return earlier(first, sweep_segment(rim, q + u, -axis, first.t));
}

BoxCore moved(const BoxCore& b, const dvec3& by) noexcept { return {b.lower + by, b.upper + by}; }
TriangleCore moved(const TriangleCore& t, const dvec3& by) noexcept { return {t.a + by, t.b + by, t.c + by}; }

/// The axis of A against the edges of B.
SweepPart sweep_rim(const SweepPath& path, const dvec3& axis, const TriangleCore& t) noexcept {
    const SweepPart first = earlier(sweep_edges(path, axis, t.a, t.b - t.a), sweep_edges(path, axis, t.b, t.c - t.b));
    return earlier(first, sweep_edges(path, axis, t.c, t.a - t.c));
}
SweepPart sweep_rim(const SweepPath& path, const dvec3& axis, const BoxCore& b) noexcept {
    // What the capsule sweeps, along the axes.
    const dvec3 low = glm::min(dvec3{0.0}, axis) + glm::min(dvec3{0.0}, path.motion) - path.radius;
    const dvec3 high = glm::max(dvec3{0.0}, axis) + glm::max(dvec3{0.0}, path.motion) + path.radius;
    SweepPart first;
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        for (unsigned side = 0; side < 4; ++side) {
            dvec3 q = b.lower, u{0.0};
            if (side & 1u) q[i] = b.upper[i];
            if (side & 2u) q[j] = b.upper[j];
            u[k] = b.upper[k] - b.lower[k];
            if (q[i] < low[i] || q[i] > high[i] || q[j] < low[j] || q[j] > high[j] || q[k] > high[k] || q[k] + u[k] < low[k]) continue;
            first = earlier(first, sweep_edges(path, axis, q, u));
        }
    }
    return first;
}

/// A capsule against a solid with faces, apart at the start.
template <class Core>
SweepPart sweep_capsule(const SweepFrame& frame, const dvec3& axis, const Core& core) noexcept {
    const SweepPath path = frame.path(farthest(core) + glm::length(axis));
    SweepPart first = earlier(sweep_core(path, core), sweep_core(path, moved(core, -axis)));
    return earlier(first, sweep_rim(path, axis, core));
}

// ---- frames --------------------------------------------------------------------------------------------------------------------------

/// The frame of an Obb, or none: vectors of the world in the box's.
template <class T>
dvec3 in_box(const Obb<T>& b, const dvec3& v) noexcept {
    return {glm::dot(dvec3(b.axes[0]), v), glm::dot(dvec3(b.axes[1]), v), glm::dot(dvec3(b.axes[2]), v)};
}
template <class T>
dvec3 from_box(const Obb<T>& b, const dvec3& v) noexcept {
    return v.x * dvec3(b.axes[0]) + v.y * dvec3(b.axes[1]) + v.z * dvec3(b.axes[2]);
}

/// The answer for a capsule: where A's axis, moved to t, is nearest to B.
template <class B>
Impact capsule_impact(const SweepPart& part, const SweepFrame& frame, const dvec3& axis, const B& b) noexcept {
    Impact impact = impact_of(part, frame);
    if (impact.status != ImpactStatus::Touching) return impact;
    impact.point = nearest_under(frame.from + impact.t * frame.motion, axis, b);
    return impact;
}

template <class T>
Triangle<double> widened(const Triangle<T>& t) noexcept {
    return {dvec3(t.a), dvec3(t.b), dvec3(t.c)};
}
template <class T>
Aabb<double> widened(const Aabb<T>& b) noexcept {
    return {dvec3(b.lower), dvec3(b.upper)};
}

template <class T>
Capsule<double> widened(const Capsule<T>& c) noexcept {
    return {{dvec3(c.axis.a), dvec3(c.axis.b)}, double(c.radius)};
}
TriangleCore core_of(const Triangle<double>& t, const SweepFrame& frame) noexcept {
    return {frame.local(t.a), frame.local(t.b), frame.local(t.c)};
}
BoxCore core_of(const Aabb<double>& b, const SweepFrame& frame) noexcept { return {frame.local(b.lower), frame.local(b.upper)}; }

/// A capsule whose axis pierces a face meets none of its edges and corners: that is asked first.
template <class B>
Impact capsule_sweep(const Capsule<double>& a, const dvec3& motion, const B& b) noexcept {
    if (overlaps(a, b)) return {.status = ImpactStatus::Overlapping, .t = 0.0};
    const SweepFrame frame{a.axis.a, motion, a.radius, 0.0};
    const dvec3 axis = a.axis.b - a.axis.a;
    return capsule_impact(sweep_capsule(frame, axis, core_of(b, frame)), frame, axis, b);
}

/// Back from the frame of an Obb.
template <class T>
Impact out_of_box(const Obb<T>& b, Impact impact) noexcept {
    if (impact.status != ImpactStatus::Touching) return impact;
    impact.point = dvec3(b.center) + from_box(b, impact.point);
    impact.normal = from_box(b, impact.normal);
    return impact;
}

/// A point against a box grown by the one it stands for: the axis that is entered last is the normal.
Impact box_sweep(const SweepFrame& frame, const BoxCore& core, const Aabb<double>& a, const Aabb<double>& b) noexcept {
    Impact impact = impact_of(sweep_box(frame.path(farthest(core)), core.lower, core.upper), frame);
    if (impact.status != ImpactStatus::Touching) return impact;
    const dvec3 by = impact.t * frame.motion;
    // The middle of what the two share at t, up to rounding.
    impact.point = glm::clamp(0.5 * (glm::max(a.lower + by, b.lower) + glm::min(a.upper + by, b.upper)), b.lower, b.upper);
    return impact;
}

template <class A, class B, class T>
bool all_fit(const A& a, const Vec3<T>& motion, const B& b) noexcept {
    return fit(a) && fit(b) && usual_vector(motion);
}

template <class A, class B, class T>
BasicImpact<T> batch_of_one(const A& a, const Vec3<T>& motion, const B& b) noexcept {
    BasicImpact<T> out;
    sweep_together<A, B, T>(std::span(&a, 1), std::span(&motion, 1), std::span(&b, 1), std::span(&out, 1));
    return out;
}

}  // namespace

template <class T>
BasicImpact<T> sweep(const Sphere<T>& a, const Vec3<T>& motion, const Sphere<T>& b) noexcept {
    if (!all_fit(a, motion, b)) return rounded<T>(kInvalidImpact);
    const SweepFrame frame{dvec3(a.center), dvec3(motion), double(a.radius), double(b.radius)};
    const dvec3 q = frame.local(dvec3(b.center));
    return rounded<T>(impact_of(sweep_point(frame.path(glm::length(q)), q), frame));
}

template <class T>
BasicImpact<T> sweep(const Sphere<T>& a, const Vec3<T>& motion, const Capsule<T>& b) noexcept {
    if (!all_fit(a, motion, b)) return rounded<T>(kInvalidImpact);
    const SweepFrame frame{dvec3(a.center), dvec3(motion), double(a.radius), double(b.radius)};
    const SegmentCore core{frame.local(dvec3(b.axis.a)), dvec3(b.axis.b) - dvec3(b.axis.a)};
    return rounded<T>(impact_of(sweep_core(frame.path(farthest(core)), core), frame));
}

template <class T>
BasicImpact<T> sweep(const Sphere<T>& a, const Vec3<T>& motion, const Aabb<T>& b) noexcept {
    if (!all_fit(a, motion, b)) return rounded<T>(kInvalidImpact);
    const SweepFrame frame{dvec3(a.center), dvec3(motion), double(a.radius), 0.0};
    const BoxCore core{frame.local(dvec3(b.lower)), frame.local(dvec3(b.upper))};
    return rounded_from<T>([&] { return impact_of(sweep_core(frame.path(farthest(core)), core), frame); });
}

template <class T>
BasicImpact<T> sweep(const Sphere<T>& a, const Vec3<T>& motion, const Obb<T>& b) noexcept {
    if (!all_fit(a, motion, b)) return rounded<T>(kInvalidImpact);
    const dvec3 start = dvec3(a.center) - dvec3(b.center);
    const SweepFrame frame{in_box(b, start), in_box(b, dvec3(motion)), double(a.radius), 0.0};
    const BoxCore core{-dvec3(b.half_extents) - frame.from, dvec3(b.half_extents) - frame.from};
    return rounded<T>(out_of_box(b, impact_of(sweep_core(frame.path(farthest(core)), core), frame)));
}

template <class T>
BasicImpact<T> sweep(const Sphere<T>& a, const Vec3<T>& motion, const Triangle<T>& b) noexcept {
    if (!all_fit(a, motion, b)) return rounded<T>(kInvalidImpact);
    const SweepFrame frame{dvec3(a.center), dvec3(motion), double(a.radius), 0.0};
    const TriangleCore core{frame.local(dvec3(b.a)), frame.local(dvec3(b.b)), frame.local(dvec3(b.c))};
    return rounded<T>(impact_of(sweep_core(frame.path(farthest(core)), core), frame));
}

template <class T>
BasicImpact<T> sweep(const Capsule<T>& a, const Vec3<T>& motion, const Sphere<T>& b) noexcept {
    if (!all_fit(a, motion, b)) return rounded<T>(kInvalidImpact);
    const SweepFrame frame{dvec3(a.axis.a), dvec3(motion), double(a.radius), double(b.radius)};
    const dvec3 axis = dvec3(a.axis.b) - dvec3(a.axis.a), q = frame.local(dvec3(b.center));
    Impact impact = impact_of(sweep_segment(frame.path(glm::length(q) + glm::length(axis)), q, -axis), frame);
    if (impact.status == ImpactStatus::Touching) impact.point = dvec3(b.center) - double(b.radius) * impact.normal;
    return rounded<T>(impact);
}

template <class T>
BasicImpact<T> sweep_by_parts(const Capsule<T>& a, const Vec3<T>& motion, const Capsule<T>& b) noexcept {
    if (!all_fit(a, motion, b)) return rounded<T>(kInvalidImpact);
    const SweepFrame frame{dvec3(a.axis.a), dvec3(motion), double(a.radius), double(b.radius)};
    const dvec3 axis = dvec3(a.axis.b) - dvec3(a.axis.a);
    const SegmentCore core{frame.local(dvec3(b.axis.a)), dvec3(b.axis.b) - dvec3(b.axis.a)};
    const SweepPart part = sweep_edges(frame.path(farthest(core) + glm::length(axis)), axis, core.a, core.along);
    Impact impact = capsule_impact(part, frame, axis, Segment<double>{dvec3(b.axis.a), dvec3(b.axis.b)});
    if (impact.status == ImpactStatus::Touching) impact.point -= double(b.radius) * impact.normal;
    return rounded<T>(impact);
}

template <class T>
BasicImpact<T> sweep_by_parts(const Capsule<T>& a, const Vec3<T>& motion, const Aabb<T>& b) noexcept {
    if (!all_fit(a, motion, b)) return rounded<T>(kInvalidImpact);
    return rounded<T>(capsule_sweep(widened(a), dvec3(motion), widened(b)));
}

template <class T>
BasicImpact<T> sweep_by_parts(const Capsule<T>& a, const Vec3<T>& motion, const Obb<T>& b) noexcept {
    if (!all_fit(a, motion, b)) return rounded<T>(kInvalidImpact);
    const dvec3 from = dvec3(a.axis.a) - dvec3(b.center), to = dvec3(a.axis.b) - dvec3(b.center);
    const Capsule<double> inside{{in_box(b, from), in_box(b, to)}, double(a.radius)};
    const Aabb<double> box{-dvec3(b.half_extents), dvec3(b.half_extents)};
    return rounded<T>(out_of_box(b, capsule_sweep(inside, in_box(b, dvec3(motion)), box)));
}

template <class T>
BasicImpact<T> sweep_by_parts(const Capsule<T>& a, const Vec3<T>& motion, const Triangle<T>& b) noexcept {
    if (!all_fit(a, motion, b)) return rounded<T>(kInvalidImpact);
    return rounded<T>(capsule_sweep(widened(a), dvec3(motion), widened(b)));
}

template <class T>
BasicImpact<T> sweep(const Capsule<T>& a, const Vec3<T>& motion, const Capsule<T>& b) noexcept {
    return batch_of_one(a, motion, b);
}
template <class T>
BasicImpact<T> sweep(const Capsule<T>& a, const Vec3<T>& motion, const Aabb<T>& b) noexcept {
    return batch_of_one(a, motion, b);
}
template <class T>
BasicImpact<T> sweep(const Capsule<T>& a, const Vec3<T>& motion, const Obb<T>& b) noexcept {
    return batch_of_one(a, motion, b);
}
template <class T>
BasicImpact<T> sweep(const Capsule<T>& a, const Vec3<T>& motion, const Triangle<T>& b) noexcept {
    return batch_of_one(a, motion, b);
}

template <class T>
BasicImpact<T> sweep(const Aabb<T>& a, const Vec3<T>& motion, const Aabb<T>& b) noexcept {
    if (!all_fit(a, motion, b)) return rounded<T>(kInvalidImpact);
    // A's lower corner, a point, against B grown by A.
    const SweepFrame frame{dvec3(a.lower), dvec3(motion), 0.0, 0.0};
    const BoxCore core{frame.local(dvec3(b.lower)) - (dvec3(a.upper) - dvec3(a.lower)), frame.local(dvec3(b.upper))};
    return rounded<T>(box_sweep(frame, core, Aabb<double>{dvec3(a.lower), dvec3(a.upper)}, widened(b)));
}

#define CAROM_BY_PARTS(B)                                                                                            \
    template BasicImpact<float> sweep_by_parts(const Capsule<float>&, const Vec3<float>&, const B<float>&) noexcept; \
    template BasicImpact<double> sweep_by_parts(const Capsule<double>&, const Vec3<double>&, const B<double>&) noexcept;
CAROM_BY_PARTS(Capsule)
CAROM_BY_PARTS(Aabb)
CAROM_BY_PARTS(Obb)
CAROM_BY_PARTS(Triangle)
#undef CAROM_BY_PARTS
#define CAROM_SWEEPS(A, B)                                                                            \
    template BasicImpact<float> sweep(const A<float>&, const Vec3<float>&, const B<float>&) noexcept; \
    template BasicImpact<double> sweep(const A<double>&, const Vec3<double>&, const B<double>&) noexcept;
CAROM_SWEEPS(Sphere, Sphere)
CAROM_SWEEPS(Sphere, Capsule)
CAROM_SWEEPS(Sphere, Aabb)
CAROM_SWEEPS(Sphere, Obb)
CAROM_SWEEPS(Sphere, Triangle)
CAROM_SWEEPS(Capsule, Sphere)
CAROM_SWEEPS(Capsule, Capsule)
CAROM_SWEEPS(Capsule, Aabb)
CAROM_SWEEPS(Capsule, Obb)
CAROM_SWEEPS(Capsule, Triangle)
CAROM_SWEEPS(Aabb, Aabb)
#undef CAROM_SWEEPS

}  // namespace carom::geo
