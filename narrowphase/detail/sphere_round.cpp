// Sphere against sphere, capsule, box and plane: closed forms.
#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/plane_form.hpp>
#include <carom/narrowphase/detail/round_contact.hpp>
#include <carom/narrowphase/detail/segment.hpp>

namespace carom::detail {
namespace {

// A ball at the origin against the point `q` of the other shape's core, rounded by `radius`.
void ball_against_point(const PairFrame& pair, const dvec3& q, double radius, const dvec3& fallback, ManifoldSink& sink) {
    const double own = static_cast<double>(as<Sphere>(pair.first).radius);
    const Direction direction = direction_of(q, fallback);
    if (direction.length - own - radius > pair.margin) return;
    Patch patch;
    patch.normal = direction.unit;
    add_ball(patch, dvec3{0.0}, own, direction.length - radius, 0);
    sink.add(patch);
}

}  // namespace

CollideStatus sphere_sphere(const PairFrame& pair, Workspace&, ManifoldSink& sink) {
    ball_against_point(pair, pair.translation, static_cast<double>(as<Sphere>(pair.second).radius), {0.0, 1.0, 0.0}, sink);
    return CollideStatus::Ok;
}

CollideStatus sphere_capsule(const PairFrame& pair, Workspace&, ManifoldSink& sink) {
    const Capsule& capsule = as<Capsule>(pair.second);
    const dvec3 half = static_cast<double>(capsule.half_segment) * pair.rotation[1];
    const Segment segment{pair.translation - half, pair.translation + half};
    const dvec3 q = segment.at(closest_parameter(segment, dvec3{0.0}));
    // On the axis of the capsule the nearest way out is square to it.
    ball_against_point(pair, q, static_cast<double>(capsule.radius), any_perpendicular(pair.rotation[1]), sink);
    return CollideStatus::Ok;
}

CollideStatus sphere_box(const PairFrame& pair, Workspace&, ManifoldSink& sink) {
    const double radius = static_cast<double>(as<Sphere>(pair.first).radius);
    const dvec3 half(as<Box>(pair.second).half_extents);
    const dvec3 centre = pair.to_second(dvec3{0.0});
    const dvec3 closest = glm::clamp(centre, -half, half);
    const Direction out = direction_of(centre - closest, dvec3{0.0});
    if (out.length - radius > pair.margin) return CollideStatus::Ok;

    Patch patch;
    if (out.length > 0.0) {
        patch.normal = -(pair.rotation * out.unit);
        add_ball(patch, dvec3{0.0}, radius, out.length, 0);
    } else {  // the centre is inside: out through the nearest face
        const dvec3 room = half - glm::abs(centre);
        int axis = 0;
        if (room.y < room[axis]) axis = 1;
        if (room.z < room[axis]) axis = 2;
        patch.normal = (centre[axis] < 0.0 ? 1.0 : -1.0) * pair.rotation[axis];
        add_ball(patch, dvec3{0.0}, radius, -room[axis], 0);
    }
    sink.add(patch);
    return CollideStatus::Ok;
}

CollideStatus sphere_plane(const PairFrame& pair, Workspace&, ManifoldSink& sink) {
    const double radius = static_cast<double>(as<Sphere>(pair.first).radius);
    const PlaneForm plane = plane_in_first(pair);
    const double distance = plane.distance(dvec3{0.0});
    if (distance - radius > pair.margin) return CollideStatus::Ok;
    Patch patch;
    patch.normal = -plane.normal;
    add_ball(patch, dvec3{0.0}, radius, distance, 0);
    sink.add(patch);
    return CollideStatus::Ok;
}

}  // namespace carom::detail
