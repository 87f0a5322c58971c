#include <carom/dynamics/detail/first_touch.hpp>

#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/narrowphase/shape_cast.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace carom::dynamics {
namespace {

template <class... Functions>
struct Overloaded : Functions... {
    using Functions::operator()...;
};

RigidMotion at(const RigidMotion& motion, const Pose& local) noexcept {
    RigidMotion moved = motion;
    moved.start = motion.start * local;
    moved.pivot = inverse_transform_point(local, motion.pivot);
    return moved;
}

struct Core {
    Shape shape;
    dvec3 centre{0.0};  ///< in the shape's frame
};

/// What a convex shape but a hull is thinned to. @param rest  of its thickness.
Core core_of(const Shape& shape, double rest) {
    const auto left = static_cast<float>(rest);
    return std::visit(Overloaded{
                          [&](const Sphere& s) { return Core{Sphere{left * s.radius}}; },
                          [&](const Box& b) {
                              const vec3& h = b.half_extents;
                              return Core{Box{h - (1.0f - left) * std::min({h.x, h.y, h.z})}};
                          },
                          [&](const Capsule& c) { return Core{Capsule{left * c.radius, c.half_segment}}; },
                          [&](const Cylinder& c) {
                              const float less = (1.0f - left) * std::min(c.radius, c.half_height);
                              return Core{Cylinder{c.radius - less, c.half_height - less}};
                          },
                          [&](const Cone& c) {
                              // Smaller about the centre of the ball that touches it from inside.
                              const double radius = c.radius, height = 2.0 * static_cast<double>(c.half_height);
                              const double inside = radius * height / (radius + std::sqrt(radius * radius + height * height));
                              return Core{Cone{left * c.radius, left * c.half_height}, {0.0, (1.0 - rest) * (inside - 0.5 * height), 0.0}};
                          },
                          [&](const auto& other) { return Core{other}; },
                      },
                      shape);
}

bool is_mesh(const Shape& shape) noexcept { return type_of(shape) == ShapeType::TriangleMesh; }

/// A convex shape and any other that is no compound, unless that does not turn.
Impact touch_convex(const Shape& a, const RigidMotion& motion_a, const Shape& b, const RigidMotion& motion_b, const TimeOfImpactSettings& settings) {
    if (motion_b.rotation == dvec3{0.0}) {  // where B stands, the rest has closed forms
        RigidMotion passing = motion_a;
        passing.translation -= motion_b.translation;
        Impact impact = cast_shape(a, passing, b, motion_b.start, settings);
        impact.point += impact.t * motion_b.translation;
        return impact;
    }
    if (!is_mesh(b)) return time_of_impact(a, motion_a, b, motion_b, settings);
    return time_of_impact(a, motion_a, *std::get<TriangleMeshPtr>(b), motion_b, settings);
}

/// @param a  no compound; nor is B, unless it does not turn.
Impact touch_parts(const MovingShape& a, int level, const MovingShape& b, const TimeOfImpactSettings& settings, Cores& cores) {
    const Shape* shape = a.shape;
    if (is_mesh(*shape)) {
        if (level == 0 && !is_mesh(*b.shape) && type_of(*b.shape) != ShapeType::Plane) {
            Impact impact = touch_convex(*b.shape, b.motion, *shape, a.motion, settings);
            impact.normal = -impact.normal;
            return impact;
        }
        shape = cores.hull_of(std::get<TriangleMeshPtr>(*shape));
        if (shape == nullptr) return {};
    }
    if (level == 0) return touch_convex(*shape, a.motion, *b.shape, b.motion, settings);
    if (const ConvexHullPtr* const hull = std::get_if<ConvexHullPtr>(shape)) {
        return touch_convex(*cores.core_of(*hull, level), a.motion, *b.shape, b.motion, settings);
    }
    const Core core = core_of(*shape, kRestOfLevel[level]);
    return touch_convex(core.shape, at(a.motion, {core.centre, kIdentityRotation}), *b.shape, b.motion, settings);
}

/// Calls `visit` for the shape, or for each part of a compound, as a MovingShape.
template <class Visit>
void for_each_part(const MovingShape& shape, const Visit& visit) {
    const CompoundPtr* const compound = std::get_if<CompoundPtr>(shape.shape);
    if (compound == nullptr) return visit(shape);
    for (const CompoundPart& part : (*compound)->parts()) visit(MovingShape{&part.shape, at(shape.motion, part.pose)});
}

}  // namespace

template <class Make>
const Shape* Cores::find(const std::shared_ptr<const void>& of, int level, const Make& make) {
    for (const Hull& known : hulls_) {
        if (known.of == of && known.level == level) return known.exists ? &known.shape : nullptr;
    }
    const Result<ConvexHullPtr> hull = make();
    hulls_.push_back({of, level, hull ? Shape{*hull} : Shape{}, hull.has_value()});
    return hull ? &hulls_.back().shape : nullptr;
}

void Cores::forget_unused() {
    std::erase_if(hulls_, [](const Hull& known) { return known.of.use_count() == 1; });
}

const Shape* Cores::hull_of(const TriangleMeshPtr& mesh) {
    return find(mesh, 0, [&] { return ConvexHull::build(mesh->vertices()); });
}

const Shape* Cores::core_of(const ConvexHullPtr& hull, int level) {
    return find(hull, level, [&] {
        std::vector<vec3> points;
        for (const vec3& vertex : hull->vertices()) points.push_back(vec3(hull->centre() + kRestOfLevel[level] * (dvec3(vertex) - hull->centre())));
        return ConvexHull::build(points);
    });
}

Impact first_touch(const MovingShape& a, int level, const MovingShape& b, const TimeOfImpactSettings& settings, Cores& cores) {
    Impact first;
    for_each_part(a, [&](const MovingShape& part_a) {
        const auto meet = [&](const MovingShape& part_b) {
            const Impact impact = touch_parts(part_a, level, part_b, settings, cores);
            const bool sooner = may_touch(impact.status) && (!may_touch(first.status) || impact.t < first.t);
            if (sooner) first = impact;
        };
        const bool mesh_first = is_mesh(*part_a.shape) && level == 0;
        if (b.motion.rotation == dvec3{0.0} && !mesh_first) {
            meet(b);
        } else {
            for_each_part(b, meet);
        }
    });
    return first;
}

}  // namespace carom::dynamics
