#include <carom/narrowphase/detail/convex_query.hpp>

#include <carom/narrowphase/detail/box_distance.hpp>
#include <carom/narrowphase/detail/box_verdict.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

bool is_null(const Shape& shape) noexcept {
    const ConvexHullPtr* hull = std::get_if<ConvexHullPtr>(&shape);
    return hull != nullptr && *hull == nullptr;
}

DistanceResult over_plane(const PlaneHeight& h) noexcept {
    DistanceResult r;
    r.iterations = 1;
    if (h.height < -h.rounding) {
        r.status = DistanceStatus::Overlap;
        return r;
    }
    r.lower = std::max(0.0, h.height - h.rounding);
    r.upper = h.height + h.rounding;
    r.on_a = h.on_a;
    r.on_b = h.on_b;
    r.status = r.lower > 0.0 ? DistanceStatus::Converged : DistanceStatus::Rounding;
    if (r.lower > 0.0) r.normal = h.normal;
    return r;
}

// From the cores in the pair's unit to the shapes in metres.
DistanceResult result_of(const CorePair& pair, const Proximity& p) noexcept {
    const double radii = pair.a.radius + pair.b.radius;
    DistanceResult r;
    r.iterations = p.iterations;
    r.status = p.status;
    if (p.status == DistanceStatus::Overlap || p.upper < radii) {
        r.status = DistanceStatus::Overlap;
        return r;
    }
    r.lower = std::min(pair.unit * std::max(0.0, p.lower - radii), std::numeric_limits<double>::max());
    r.upper = pair.unit * (p.upper - radii);
    const dvec3 way = p.on_b - p.on_a;
    const double length = std::sqrt(glm::dot(way, way));
    const dvec3 along = length > 8.0 * pair.rounding ? way / length : dvec3{0.0};
    r.on_a = pair.unit * (p.on_a + pair.a.radius * along);
    r.on_b = pair.unit * (p.on_b - pair.b.radius * along);
    r.normal = p.normal != dvec3{0.0} ? p.normal : along;
    if (r.lower <= 0.0 && p.upper - radii <= 8.0 * pair.rounding) {
        r.normal = dvec3{0.0};
        r.status = DistanceStatus::Rounding;
    }
    return r;
}

bool is_plane(const Shape& shape) noexcept { return type_of(shape) == ShapeType::Plane; }

}  // namespace

PairFault query_fault(const Shape& a, const Shape& b) noexcept {
    if (is_null(a) || is_null(b)) return {"distance: a hull is null", ErrorCode::WrongType};
    const bool convex_a = is_convex_solid(type_of(a)), convex_b = is_convex_solid(type_of(b));
    if ((convex_a && convex_b) || (convex_a && is_plane(b)) || (is_plane(a) && convex_b)) return {};
    return {"distance: two convex shapes, or one and a plane, are needed", ErrorCode::WrongType};
}

PairFault query_fault(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) noexcept {
    if (finite_residue(pose_a) + finite_residue(pose_b) != 0.0) return {"distance: a pose is not finite", ErrorCode::NotFinite};
    return query_fault(a, b);
}

const char* settings_fault(const DistanceSettings& settings) noexcept {
    if (!is_finite(settings.tolerance) || settings.tolerance < 0.0) return "distance: the tolerance is negative or not finite";
    return settings.most_iterations < 1 ? "distance: at least one iteration is needed" : nullptr;
}

std::optional<PlaneHeight> plane_height(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) noexcept {
    if (!is_plane(a) && !is_plane(b)) return {};
    const bool first = is_plane(a);
    const Plane& plane = std::get<Plane>(first ? a : b);
    // The plane's origin stands in as a point of its own.
    const CorePair pair = core_pair(first ? b : a, first ? pose_b : pose_a, Sphere{0.0f}, first ? pose_a : pose_b);
    const dvec3 normal = glm::mat3_cast((first ? pose_a : pose_b).orientation) * dvec3(plane.normal);
    const double length = std::sqrt(glm::dot(normal, normal)), offset = static_cast<double>(plane.offset) / pair.unit;
    const dvec3 unit = normal / length;
    const dvec3 lowest = pair.a.support(-unit).point - pair.a.radius * unit;
    const double height = glm::dot(unit, lowest - pair.b.centre) - offset / length;
    PlaneHeight result;
    result.height = height * pair.unit;
    result.rounding = (pair.rounding + 0x1p-46 * std::abs(offset)) * pair.unit;
    const dvec3 foot = lowest - height * unit, origin = first ? pair.b.centre : dvec3{0.0};
    result.normal = first ? unit : -unit;
    result.on_a = pair.unit * ((first ? foot : lowest) - origin);
    result.on_b = pair.unit * ((first ? lowest : foot) - origin);
    return result;
}

DistanceResult pair_distance(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, const DistanceSettings& settings,
                             DistanceCache* cache) noexcept {
    const Box *const box_a = std::get_if<Box>(&a), *const box_b = std::get_if<Box>(&b);
    if (box_a != nullptr && box_b != nullptr && cache == nullptr) {
        if (const auto r = box_distance(box_a->half_extents, pose_a, box_b->half_extents, pose_b, settings.tolerance)) return *r;
    }
    if (const std::optional<PlaneHeight> height = plane_height(a, pose_a, b, pose_b)) return over_plane(*height);
    const CorePair pair = core_pair(a, pose_a, b, pose_b);
    return result_of(pair, find_proximity(pair, {-1.0, settings.tolerance, settings.most_iterations}, cache));
}

Overlap pair_overlaps(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, DistanceCache* cache) noexcept {
    if (const std::optional<PlaneHeight> h = plane_height(a, pose_a, b, pose_b)) {
        return h->height > h->rounding ? Overlap::Apart : h->height < -h->rounding ? Overlap::Overlapping : Overlap::Undecided;
    }
    const Box *const box_a = std::get_if<Box>(&a), *const box_b = std::get_if<Box>(&b);
    if (box_a != nullptr && box_b != nullptr) {
        const Overlap verdict = judge_boxes(box_a->half_extents, pose_a, box_b->half_extents, pose_b);
        if (verdict != Overlap::Undecided) return verdict;
    }
    const CorePair pair = core_pair(a, pose_a, b, pose_b);
    const double radii = pair.a.radius + pair.b.radius;
    const Proximity p = find_proximity(pair, {.decide = radii}, cache);
    if (p.lower > radii) return Overlap::Apart;
    return p.status == DistanceStatus::Overlap || p.upper < radii ? Overlap::Overlapping : Overlap::Undecided;
}

}  // namespace carom::detail
