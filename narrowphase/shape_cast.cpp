#include <carom/narrowphase/shape_cast.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/narrowphase/detail/impact_input.hpp>
#include <carom/narrowphase/sweep.hpp>

#include <memory>
#include <variant>

namespace carom {
namespace {

bool turns(const Shape& a, const RigidMotion& m) noexcept {
    return m.rotation != dvec3{0.0} && !(type_of(a) == ShapeType::Sphere && m.pivot == dvec3{0.0});
}

/// What does not turn, as sweep.hpp has it, in B's frame: a ball, or one drawn along a segment.
struct LocalMover {
    geo::Capsule<double> shape;
    dvec3 motion{0.0};
    bool ball = true;
};

/// @return whether A is one: grown by the separation and by what coming there may have rounded, so it is met no later than A is.
bool make_local(const Shape& a, const RigidMotion& m, const Pose& b, double separation, LocalMover& local) noexcept {
    if (turns(a, m)) return false;
    const dvec3 centre = inverse_transform_point(b, m.start.position);
    double radius = separation, length = 0.0;
    if (const Sphere* ball = std::get_if<Sphere>(&a)) {
        radius += double(ball->radius);
        local.shape.axis.a = local.shape.axis.b = centre;
    } else if (const Capsule* capsule = std::get_if<Capsule>(&a)) {
        length = double(capsule->half_segment);
        radius += double(capsule->radius);
        const dvec3 half = inverse_transform_vector(b, rotate(m.start.orientation, dvec3{0.0, length, 0.0}));
        local.shape.axis.a = centre - half, local.shape.axis.b = centre + half;
        local.ball = length == 0.0;
    } else {
        return false;
    }
    local.shape.radius = radius + 0x1p-46 * (glm::length(m.start.position - b.position) + length + glm::length(m.translation) + radius);
    local.motion = inverse_transform_vector(b, m.translation);
    return true;
}

template <class B>
auto sweep_local(const LocalMover& a, const B& b) {
    return a.ball ? geo::sweep(geo::Sphere<double>{a.shape.axis.a, a.shape.radius}, a.motion, b) : geo::sweep(a.shape, a.motion, b);
}

/// What closed form there is for `a` against a standing B, in B's frame. @return whether there is one. Written where it stays: numbers that have just been
/// stored one by one are slow to copy.
struct ClosedForm {
    const LocalMover& a;
    ShapeImpact& out;

    template <class B>
    bool meet(const B& b) const {
        static_cast<Impact&>(out) = sweep_local(a, b);
        return true;
    }
    bool operator()(const Plane& b) const { return meet(geo::Plane<double>{dvec3(b.normal), double(b.offset)}); }
    bool operator()(const Sphere& b) const { return meet(geo::Sphere<double>{dvec3{0.0}, double(b.radius)}); }
    bool operator()(const Capsule& b) const {
        const dvec3 half{0.0, double(b.half_segment), 0.0};
        return meet(geo::Capsule<double>{{-half, half}, double(b.radius)});
    }
    bool operator()(const Box& b) const {
        if (!a.ball) return false;  // no quicker than the search
        return meet(geo::Aabb<double>{-dvec3(b.half_extents), dvec3(b.half_extents)});
    }
    bool operator()(const TriangleMeshPtr& b) const {
        const geo::MeshImpact impact = sweep_local(a, *b);
        static_cast<Impact&>(out) = impact;
        if (impact.triangle != geo::MeshImpact::kNone) out.triangle = impact.triangle;
        return true;
    }
    template <class Other>
    bool operator()(const Other&) const {
        return false;
    }
};

constexpr ShapeImpact kInvalid{{.status = ImpactStatus::Invalid, .t = 0.0}, 0, 0};

/// Takes a contact out of B's frame.
void place(ShapeImpact& out, const Pose& pose_b, double until) noexcept {
    if (may_touch(out.status) && out.t > until) out = {{.t = until}, 0, 0};
    if (out.status == ImpactStatus::Separated) out.t = until;
    if (out.status == ImpactStatus::Touching) {
        out.point = transform_point(pose_b, out.point);
        out.normal = transform_vector(pose_b, out.normal);
    }
    if (!may_touch(out.status)) out.triangle = 0;
}

/// @param b  not a compound.
ShapeImpact cast_simple(const Shape& a, const RigidMotion& motion, const Shape& b, const Pose& pose_b,
                        const TimeOfImpactSettings& settings) {
    const TriangleMeshPtr* mesh = std::get_if<TriangleMeshPtr>(&b);
    LocalMover local;
    if (make_local(a, motion, pose_b, settings.separation, local)) {
        ShapeImpact out;
        if (std::visit(ClosedForm{local, out}, b)) {
            place(out, pose_b, settings.until);
            return out;
        }
    }
    if (mesh == nullptr) return {time_of_impact(a, motion, b, {.start = pose_b}, settings), 0, 0};
    const geo::MeshImpact impact = time_of_impact(a, motion, **mesh, {.start = pose_b}, settings);
    return {impact, impact.triangle == geo::MeshImpact::kNone ? 0 : impact.triangle, 0};
}

/// What A may reach up to `until`, in B's frame.
Aabb reach_box(const Shape& a, const RigidMotion& m, const Pose& pose_b, double separation) {
    const dvec3 arm = rotate(m.start.orientation, m.pivot);
    const dvec3 from = inverse_transform_point(pose_b, m.start.position + arm), along = inverse_transform_vector(pose_b, m.translation);
    const double radius = bounding_radius(a) + glm::length(m.pivot) + separation;
    const double size =
        radius + glm::length(from) + glm::length(along) + glm::length(pose_b.position) + glm::length(m.start.position - pose_b.position);
    return inflate({glm::min(from, from + along), glm::max(from, from + along)}, radius + 0x1p-44 * size);
}

ShapeImpact cast_compound(const Shape& a, const RigidMotion& motion, const Compound& b, const Pose& pose_b,
                          const TimeOfImpactSettings& settings) {
    ShapeImpact first{{.t = settings.until}, 0, 0};
    int checks = 0;
    TimeOfImpactSettings rest = settings;
    b.overlap(reach_box(a, motion, pose_b, settings.separation), [&](std::uint32_t part) {
        const CompoundPart& piece = b.parts()[part];
        const ShapeImpact next = cast_simple(a, motion, piece.shape, pose_b * piece.pose, rest);
        checks += next.checks;
        const bool earlier = !may_touch(first.status) || next.t < first.t || (next.t == first.t && part < first.part);
        if (may_touch(next.status) && earlier) {
            first = next;
            first.part = part;
            rest.until = first.t;
        }
        return true;
    });
    first.checks = checks;
    return first;
}

template <class Heavy>
bool is_null(const Shape& shape) noexcept {
    const auto* pointer = std::get_if<std::shared_ptr<const Heavy>>(&shape);
    return pointer != nullptr && *pointer == nullptr;
}

/// Whether A and B are shapes, A is convex, and neither is null.
bool fit(const Shape& a, const Shape& b) noexcept {
    if (!is_convex_solid(type_of(a)) || !detail::is_shape(a) || !detail::is_shape(b)) return false;
    return !is_null<ConvexHull>(a) && !is_null<ConvexHull>(b) && !is_null<TriangleMesh>(b) && !is_null<Compound>(b);
}

}  // namespace

ShapeImpact cast_shape(const Shape& a, const RigidMotion& motion, const Shape& b, const Pose& pose_b,
                       const TimeOfImpactSettings& settings) {
    if (!detail::fit(pose_b) || !detail::fit(motion) || !detail::fit(settings) || !fit(a, b)) return kInvalid;
    const CompoundPtr* compound = std::get_if<CompoundPtr>(&b);
    return compound != nullptr ? cast_compound(a, motion, **compound, pose_b, settings) : cast_simple(a, motion, b, pose_b, settings);
}

}  // namespace carom
