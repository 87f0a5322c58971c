#include <carom/narrowphase/shape_cast.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/narrowphase/detail/impact_input.hpp>
#include <carom/narrowphase/sweep.hpp>

#include <memory>
#include <optional>
#include <variant>

namespace carom {
namespace {

/// What does not turn, as sweep.hpp has it: a ball, or one drawn along a segment.
struct RoundMover {
    dvec3 centre{0.0};
    dvec3 half_axis{0.0};  ///< from the centre to an end, world axes; zero of a ball
    double radius = 0.0;
};

bool turns(const Shape& a, const RigidMotion& m) noexcept {
    return m.rotation != dvec3{0.0} && !(type_of(a) == ShapeType::Sphere && m.pivot == dvec3{0.0});
}

std::optional<RoundMover> round_mover(const Shape& a, const RigidMotion& m) noexcept {
    if (turns(a, m)) return {};
    if (const Sphere* ball = std::get_if<Sphere>(&a)) return RoundMover{m.start.position, dvec3{0.0}, double(ball->radius)};
    if (const Capsule* capsule = std::get_if<Capsule>(&a)) {
        const dvec3 half = rotate(m.start.orientation, dvec3{0.0, double(capsule->half_segment), 0.0});
        return RoundMover{m.start.position, half, double(capsule->radius)};
    }
    return {};
}

/// A round mover in B's frame, grown by the separation and by what coming there may have rounded: so it is met no later than A is.
struct LocalMover {
    geo::Capsule<double> shape;
    dvec3 motion{0.0};
    bool ball = true;
};

LocalMover into(const Pose& b, const RoundMover& a, const dvec3& motion, double separation) noexcept {
    const dvec3 centre = inverse_transform_point(b, a.centre), half = inverse_transform_vector(b, a.half_axis);
    const double size = glm::length(a.centre - b.position) + glm::length(a.half_axis) + glm::length(motion) + a.radius + separation;
    LocalMover local{{{centre - half, centre + half}, a.radius + separation + 0x1p-46 * size}, inverse_transform_vector(b, motion)};
    local.ball = a.half_axis == dvec3{0.0};
    return local;
}

template <class B>
auto sweep_local(const LocalMover& a, const B& b) {
    return a.ball ? geo::sweep(geo::Sphere<double>{a.shape.axis.a, a.shape.radius}, a.motion, b) : geo::sweep(a.shape, a.motion, b);
}

/// What closed form there is for `a` against a standing B, in B's frame.
struct ClosedForm {
    const LocalMover& a;
    std::uint32_t& triangle;

    std::optional<Impact> operator()(const Plane& b) const { return sweep_local(a, geo::Plane<double>{dvec3(b.normal), double(b.offset)}); }
    std::optional<Impact> operator()(const Sphere& b) const { return sweep_local(a, geo::Sphere<double>{dvec3{0.0}, double(b.radius)}); }
    std::optional<Impact> operator()(const Capsule& b) const {
        const dvec3 half{0.0, double(b.half_segment), 0.0};
        return sweep_local(a, geo::Capsule<double>{{-half, half}, double(b.radius)});
    }
    std::optional<Impact> operator()(const Box& b) const {
        if (!a.ball) return {};  // no quicker than the search
        return sweep_local(a, geo::Aabb<double>{-dvec3(b.half_extents), dvec3(b.half_extents)});
    }
    std::optional<Impact> operator()(const TriangleMeshPtr& b) const {
        const geo::MeshImpact impact = sweep_local(a, *b);
        if (impact.triangle != geo::MeshImpact::kNone) triangle = impact.triangle;
        return impact;
    }
    template <class Other>
    std::optional<Impact> operator()(const Other&) const {
        return {};
    }
};

constexpr ShapeImpact kInvalid{{.status = ImpactStatus::Invalid, .t = 0.0}, 0, 0};

/// Of a contact in B's frame.
ShapeImpact placed(const Impact& impact, std::uint32_t triangle, const Pose& pose_b, double until) noexcept {
    ShapeImpact out{impact, 0, 0};
    if (may_touch(impact.status) && impact.t > until) out = {{.t = until}, 0, 0};
    if (out.status == ImpactStatus::Separated) out.t = until;
    if (out.status == ImpactStatus::Touching) {
        out.point = transform_point(pose_b, impact.point);
        out.normal = transform_vector(pose_b, impact.normal);
    }
    if (may_touch(out.status)) out.triangle = triangle;
    return out;
}

/// @param b  not a compound.
ShapeImpact cast_simple(const Shape& a, const RigidMotion& motion, const Shape& b, const Pose& pose_b, const TimeOfImpactSettings& settings) {
    const TriangleMeshPtr* mesh = std::get_if<TriangleMeshPtr>(&b);
    if (const std::optional<RoundMover> mover = round_mover(a, motion)) {
        std::uint32_t triangle = 0;
        const LocalMover local = into(pose_b, *mover, motion.translation, settings.separation);
        if (const std::optional<Impact> impact = std::visit(ClosedForm{local, triangle}, b)) {
            return placed(*impact, triangle, pose_b, settings.until);
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
    const double size = radius + glm::length(from) + glm::length(along) + glm::length(pose_b.position) + glm::length(m.start.position - pose_b.position);
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

ShapeImpact cast_shape(const Shape& a, const RigidMotion& motion, const Shape& b, const Pose& pose_b, const TimeOfImpactSettings& settings) {
    if (!detail::fit(pose_b) || !detail::fit(motion) || !detail::fit(settings) || !fit(a, b)) return kInvalid;
    const CompoundPtr* compound = std::get_if<CompoundPtr>(&b);
    return compound != nullptr ? cast_compound(a, motion, **compound, pose_b, settings) : cast_simple(a, motion, b, pose_b, settings);
}

}  // namespace carom
