// Capsule against capsule and plane: closed forms, with two points where the axes lie along each other.
#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/plane_form.hpp>
#include <carom/narrowphase/detail/round_contact.hpp>
#include <carom/narrowphase/detail/segment.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <algorithm>

namespace carom::detail {
namespace {

Segment segment_of(const Capsule& capsule, const dmat3& axes, const dvec3& centre) noexcept {
    const dvec3 half = static_cast<double>(capsule.half_segment) * axes[1];
    return {centre - half, centre + half};
}

// The stretch of `a` that lies beside `b`, as parameters of a; empty (low > high) where there is none.
struct Stretch {
    double low = 1.0;
    double high = 0.0;
};
Stretch beside(const Segment& a, const Segment& b) noexcept {
    const dvec3 d = a.to - a.from;
    const double dd = glm::dot(d, d);
    if (!(dd > 0.0)) return {};
    const double s0 = glm::dot(b.from - a.from, d) / dd, s1 = glm::dot(b.to - a.from, d) / dd;
    return {std::max(0.0, std::min(s0, s1)), std::min(1.0, std::max(s0, s1))};
}

bool nearly_parallel(const dvec3& d, const dvec3& e) noexcept {
    const dvec3 c = glm::cross(d, e);
    return glm::dot(c, c) < kAlongSine * kAlongSine * glm::dot(d, d) * glm::dot(e, e);
}

// Square to both axes where they cross in a point; square to A's where they lie along each other.
dvec3 fallback_normal(const Segment& a, const Segment& b) noexcept {
    const dvec3 across = glm::cross(a.to - a.from, b.to - b.from);
    const dvec3 along = direction_of(a.to - a.from, {0.0, 1.0, 0.0}).unit;
    return direction_of(across, any_perpendicular(along)).unit;
}

}  // namespace

CollideStatus capsule_capsule(const PairFrame& pair, Workspace&, ManifoldSink& sink) {
    const Capsule& first = as<Capsule>(pair.first);
    const Capsule& second = as<Capsule>(pair.second);
    const double radius_a = static_cast<double>(first.radius), radius_b = static_cast<double>(second.radius);
    const Segment a = segment_of(first, dmat3{1.0}, dvec3{0.0});
    const Segment b = segment_of(second, pair.rotation, pair.translation);

    const SegmentParameters closest = closest_parameters(a, b);
    const dvec3 between = b.at(closest.t) - a.at(closest.s);
    const Direction direction = direction_of(between, fallback_normal(a, b));
    if (direction.length - radius_a - radius_b > pair.margin) return CollideStatus::Ok;

    Patch patch;
    patch.normal = direction.unit;
    const auto add = [&](double s, std::uint64_t feature) {
        const dvec3 p = a.at(s);
        const double distance = glm::dot(b.at(closest_parameter(b, p)) - p, patch.normal);
        if (distance - radius_a - radius_b <= pair.margin) add_ball(patch, p, radius_a, distance - radius_b, feature);
    };
    const Stretch stretch = beside(a, b);
    const double length = (stretch.high - stretch.low) * 2.0 * static_cast<double>(first.half_segment);
    if (nearly_parallel(a.to - a.from, b.to - b.from) && length > kSnap * std::min(radius_a, radius_b)) {
        add(stretch.low, 1);
        add(stretch.high, 2);
    }
    if (patch.count == 0) add_ball(patch, a.at(closest.s), radius_a, direction.length - radius_b, 0);
    sink.add(patch);
    return CollideStatus::Ok;
}

CollideStatus capsule_plane(const PairFrame& pair, Workspace&, ManifoldSink& sink) {
    const Capsule& capsule = as<Capsule>(pair.first);
    const double radius = static_cast<double>(capsule.radius);
    const PlaneForm plane = plane_in_first(pair);
    const Segment segment = segment_of(capsule, dmat3{1.0}, dvec3{0.0});
    Patch patch;
    patch.normal = -plane.normal;
    const double from = plane.distance(segment.from), to = plane.distance(segment.to);
    if (from - radius <= pair.margin) add_ball(patch, segment.from, radius, from, 1);
    if (to - radius <= pair.margin && capsule.half_segment > 0.0f) add_ball(patch, segment.to, radius, to, 2);
    if (patch.count > 0) sink.add(patch);
    return CollideStatus::Ok;
}

}  // namespace carom::detail
