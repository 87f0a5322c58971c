#include <carom/narrowphase/detail/convex_core.hpp>

#include <carom/narrowphase/detail/kernel.hpp>
#include <carom/narrowphase/detail/polytope_lanes.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace carom::detail {
namespace {

double largest(const dvec3& v) noexcept { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// std::ldexp(1.0, exponent)
double power_of_two(int exponent) noexcept {
    return exponent > -1023 && exponent < 1024 ? std::bit_cast<double>(static_cast<std::uint64_t>(1023 + exponent) << 52)
                                               : std::ldexp(1.0, exponent);
}

// The exponent of a power of two that is above `size`, by no more than twice where that is a normal number, as std::frexp() has it.
int exponent_above(double size) noexcept {
    const auto biased = static_cast<int>(std::bit_cast<std::uint64_t>(size) >> 52 & 0x7ff);
    if (biased > 0 && biased < 0x7ff) return biased - 1022;
    int exponent = 0;
    std::frexp(size, &exponent);
    return exponent;
}

// Of a shape's core from its origin [m].
double reach_of(const Shape& shape) noexcept {
    switch (type_of(shape)) {
        case ShapeType::Box:
            return glm::length(dvec3(as<Box>(shape).half_extents)) * (1.0 + 0x1p-50);
        case ShapeType::Capsule:
            return static_cast<double>(as<Capsule>(shape).half_segment);
        case ShapeType::ConvexHull:
            return as<ConvexHullPtr>(shape)->reach();
        case ShapeType::Cylinder:
        case ShapeType::Cone: {
            const TruncatedCone solid = truncated_cone(shape, dmat3{1.0}, dvec3{0.0});
            const double h = solid.half_height, r = solid.largest_radius();
            return std::sqrt(h * h + r * r) * (1.0 + 0x1p-50);
        }
        default:
            return 0.0;
    }
}

// @param reach  of its core [m].
void fill_core(const Shape& shape, double reach, const dquat& orientation, const dvec3& centre, double scale, ConvexCore& core) noexcept {
    const dmat3 axes = glm::mat3_cast(orientation);
    core.axes = scale * axes;
    core.centre = centre;
    core.radius = scale * core_radius(shape);
    core.reach = scale * reach;
    switch (type_of(shape)) {
        case ShapeType::Box:
            core.half = dvec3(as<Box>(shape).half_extents);
            break;
        case ShapeType::Capsule:
            core.half.y = static_cast<double>(as<Capsule>(shape).half_segment);
            break;
        case ShapeType::ConvexHull:
            core.kind = ConvexCore::Kind::Points;
            core.points = as<ConvexHullPtr>(shape)->vertices();
            core.bundles = as<ConvexHullPtr>(shape)->point_bundles();
            break;
        case ShapeType::Cylinder:
        case ShapeType::Cone:
            core.kind = ConvexCore::Kind::Turned;
            core.solid = truncated_cone(shape, axes, centre);
            core.solid.half_height *= scale;
            core.solid.lower_radius *= scale;
            core.solid.upper_radius *= scale;
            break;
        default:
            break;
    }
}

}  // namespace

double core_radius(const Shape& shape) noexcept {
    if (const Sphere* sphere = std::get_if<Sphere>(&shape)) return static_cast<double>(sphere->radius);
    if (const Capsule* capsule = std::get_if<Capsule>(&shape)) return static_cast<double>(capsule->radius);
    return 0.0;
}

std::uint32_t ConvexCore::count() const noexcept {
    if (kind == Kind::Points) return static_cast<std::uint32_t>(points.size());
    return kind == Kind::Box ? 8 : 0;
}

dvec3 ConvexCore::place(std::uint32_t index) const noexcept {
    if (kind == Kind::Box) {
        return centre + axes * dvec3{index & 1 ? half.x : -half.x, index & 2 ? half.y : -half.y, index & 4 ? half.z : -half.z};
    }
    return centre + axes * dvec3(points[index]);
}

CoreSupport ConvexCore::support(const dvec3& direction) const noexcept {
    if (kind == Kind::Turned) return {solid.support(direction), 0};
    const dvec3 local = direction * axes;
    const auto bit = [&](int k) { return half[k] * local[k] > 0.0 ? 1u << k : 0u; };  // 0 where there is no extent
    const std::uint32_t index = kind == Kind::Box ? bit(0) + bit(1) + bit(2) : lowest(bundles, -local).number;
    return {place(index), index};
}

double ConvexCore::height(const dvec3& direction) const noexcept {
    if (kind == Kind::Turned) return glm::dot(direction, solid.support(direction));
    const dvec3 local = direction * axes;
    const double out = kind == Kind::Box ? half.x * std::abs(local.x) + half.y * std::abs(local.y) + half.z * std::abs(local.z)
                                         : -lowest(bundles, -local).value;
    return glm::dot(direction, centre) + out;
}

void supports(const ConvexCore& a, const ConvexCore& b, const dvec3& direction, CoreSupport& of_a, CoreSupport& of_b) noexcept {
    if (a.kind != ConvexCore::Kind::Points || b.kind != ConvexCore::Kind::Points) {
        of_a = a.support(direction);
        of_b = b.support(-direction);
        return;
    }
    const std::array<std::uint32_t, 2> found = lowest_of_two(a.bundles, -(direction * a.axes), b.bundles, direction * b.axes);
    of_a = {a.centre + a.axes * point_of(a.bundles, found[0]), found[0]};
    of_b = {b.centre + b.axes * point_of(b.bundles, found[1]), found[1]};
}

ConvexCore core_of(const Shape& shape, const dquat& orientation, const dvec3& centre, double scale) noexcept {
    ConvexCore core;
    fill_core(shape, reach_of(shape), orientation, centre, scale, core);
    return core;
}

CorePair core_pair(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) noexcept {
    // A quarter of the way, which does not overflow.
    const dvec3 quarter = 0.25 * pose_b.position - 0.25 * pose_a.position;
    const double reach_a = reach_of(a), reach_b = reach_of(b);
    const double size = std::max({largest(quarter), reach_a + core_radius(a), reach_b + core_radius(b)});
    const int exponent = std::min(exponent_above(size), 1020);  // size is below 2^exponent
    const double shrink = power_of_two(-exponent);
    const dvec3 between = (4.0 * shrink) * quarter;
    CorePair pair;
    pair.unit = power_of_two(exponent);
    fill_core(a, reach_a, pose_a.orientation, dvec3{0.0}, shrink, pair.a);
    fill_core(b, reach_b, pose_b.orientation, between, shrink, pair.b);
    pair.rounding = 0x1p-46 * (glm::length(between) + pair.a.reach + pair.b.reach + pair.a.radius + pair.b.radius);
    return pair;
}

}  // namespace carom::detail
