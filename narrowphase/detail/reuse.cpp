#include <carom/collision/aabb.hpp>
#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/feature.hpp>
#include <carom/narrowphase/detail/reuse.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

// Turns larger than this are not measured.
constexpr double kMostTurn = 0.1;

struct Relative {
    dvec3 offset{0.0};
    dquat turn{1.0, 0.0, 0.0, 0.0};
};

Relative relative(const Pose& larger, const Pose& smaller) noexcept {
    const dquat back = glm::conjugate(larger.orientation);
    return {back * (smaller.position - larger.position), back * smaller.orientation};
}

// How far the shape's points may be from its origin, by its box.
double reach_of(const Aabb& box) noexcept { return glm::length(glm::max(glm::abs(box.lower), glm::abs(box.upper))); }
double reach_of(const Shape& shape) {
    switch (type_of(shape)) {
        case ShapeType::Plane: return std::numeric_limits<double>::infinity();
        case ShapeType::ConvexHull: return reach_of(std::get<ConvexHullPtr>(shape)->local_bounds());
        case ShapeType::TriangleMesh: return reach_of(std::get<TriangleMeshPtr>(shape)->local_bounds());
        case ShapeType::Compound: return reach_of(std::get<CompoundPtr>(shape)->local_bounds());
        default: return bounding_radius(shape);
    }
}

bool is_flat(const Shape& shape) {
    switch (type_of(shape)) {
        case ShapeType::Box:
        case ShapeType::Plane:
        case ShapeType::ConvexHull:
        case ShapeType::TriangleMesh: return true;
        case ShapeType::Compound: {
            const auto parts = std::get<CompoundPtr>(shape)->parts();
            return std::all_of(parts.begin(), parts.end(), [](const CompoundPart& part) { return is_flat(part.shape); });
        }
        default: return false;
    }
}

// A bound on the angle between two orientations whose quaternions differ by `difference`, which is 2 sin(angle / 4): exact to a
// thousandth below kMostTurn, and more than that is added.
double angle_bound(double difference) noexcept { return 2.01 * difference; }

}  // namespace

ShapeMotion motion_between(const Pose& before, const Pose& now) noexcept {
    if (before.orientation == now.orientation) return {};
    const dquat turn = now.orientation * glm::conjugate(before.orientation);
    const double difference = std::sqrt(2.0 * std::max(0.0, 1.0 - std::abs(turn.w)));
    return {glm::mat3_cast(turn), angle_bound(difference)};
}

PairRecord record_of(const NumberedPair& pair, const PlacedShapes& placed) noexcept {
    const Pose &a = placed.poses[pair.a], &b = placed.poses[pair.b];
    const double reach_a = reach_of(*placed.shapes[pair.a]), reach_b = reach_of(*placed.shapes[pair.b]);
    PairRecord record;
    record.b_is_smaller = reach_b < reach_a;
    record.reach = std::nextafter(static_cast<float>(std::min(reach_a, reach_b)), std::numeric_limits<float>::infinity());
    const Relative now = record.b_is_smaller ? relative(a, b) : relative(b, a);
    record.offset = now.offset;
    const double turn[4] = {now.turn.x, now.turn.y, now.turn.z, now.turn.w};
    for (int k = 0; k < 4; ++k) record.turn[k] = static_cast<float>(turn[k]);
    record.margin = pair.margin + pair.slack;
    record.flat = is_flat(*placed.shapes[pair.a]) && is_flat(*placed.shapes[pair.b]);
    record.a = pair.a;
    record.b = pair.b;
    // Pairs that were found together are not looked at anew together.
    const std::uint64_t share = scrambled((std::uint64_t{pair.a} << 32) | pair.b) % (kMostReuses / 2);
    record.left = static_cast<std::uint16_t>(pair.slack > 0.0f ? kMostReuses - 1 - share : 0);
    return record;
}

bool may_reuse(const PairRecord& record, const NumberedPair& pair, const PlacedShapes& placed) noexcept {
    if (record.left == 0 || (record.count > 0 && !record.flat)) return false;
    const Pose &a = placed.poses[pair.a], &b = placed.poses[pair.b];
    const Relative now = record.b_is_smaller ? relative(a, b) : relative(b, a);
    const double turn[4] = {now.turn.x, now.turn.y, now.turn.z, now.turn.w};
    double same = 0.0, opposite = 0.0;  // q and -q are one orientation
    for (int k = 0; k < 4; ++k) {
        const double before = static_cast<double>(record.turn[k]);
        same += (turn[k] - before) * (turn[k] - before);
        opposite += (turn[k] + before) * (turn[k] + before);
    }
    const double difference = std::sqrt(std::min(same, opposite));
    const double moved = glm::length(now.offset - record.offset) + angle_bound(difference) * static_cast<double>(record.reach);
    return difference < kMostTurn && moved <= static_cast<double>(pair.slack) &&
           static_cast<double>(pair.margin) + moved <= static_cast<double>(record.margin);
}

Manifold moved_manifold(const Manifold& before, const PairMotion& motion) noexcept {
    Manifold manifold = before;
    const dvec3 old_normal(before.normal);
    const dvec3 turned = (motion.a.angle <= motion.b.angle ? motion.a : motion.b).turn * old_normal;
    const dvec3 normal = turned / std::sqrt(glm::dot(turned, turned));
    manifold.normal = vec3(normal);
    for (std::size_t k = 0; k < before.count; ++k) {
        const ContactPoint& point = before.points[k];
        const dvec3 middle(point.position), half = (0.5 * static_cast<double>(point.separation)) * old_normal;
        const dvec3 on_a = motion.a.turn * (middle - half);
        const dvec3 on_b = motion.b.turn * ((middle + half) - motion.between_before) + motion.between_now;
        manifold.points[k].position = vec3(0.5 * (on_a + on_b));
        manifold.points[k].separation = static_cast<float>(glm::dot(normal, on_b - on_a));
    }
    return manifold;
}

}  // namespace carom::detail
