// One pair at a time.
#include <carom/core/check.hpp>
#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/convex_query.hpp>
#include <carom/narrowphase/detail/epa.hpp>
#include <carom/narrowphase/distance.hpp>
#include <carom/narrowphase/overlap.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom {
namespace {

using detail::ConvexCore;
using detail::CorePair;
using detail::Proximity;

DistanceResult refused() noexcept {
    DistanceResult r;
    r.upper = std::numeric_limits<double>::infinity();
    r.status = DistanceStatus::Stopped;
    return r;
}

// A point or a segment has no inside.
bool is_thin(const ConvexCore& core) noexcept { return core.kind == ConvexCore::Kind::Box && core.half.x == 0.0 && core.half.z == 0.0; }

// Unit, square to two segments or points that meet.
dvec3 across(const CorePair& pair) noexcept {
    const dvec3 u = pair.a.half.y * pair.a.axes[1], v = pair.b.half.y * pair.b.axes[1], n = glm::cross(u, v);
    const double nn = glm::dot(n, n), uu = glm::dot(u, u), vv = glm::dot(v, v);
    if (nn > 1e-24 * uu * vv && nn > 0.0) {
        // Rounding tilts the product of nearly parallel ones by some 1e-16 over their angle. Made square to one it is so to the other: what is left of
        // the tilt counts by the angle.
        const dvec3 unit = n / std::sqrt(nn), square = unit - (glm::dot(unit, u) / uu) * u;
        return square / glm::length(square);
    }
    if (uu > 0.0) return any_perpendicular(u / std::sqrt(uu));
    return vv > 0.0 ? any_perpendicular(v / std::sqrt(vv)) : dvec3{0.0, 1.0, 0.0};
}

// Lengths in the pair's unit.
PenetrationResult depth_of_cores(const CorePair& pair) noexcept {
    const double radii = pair.a.radius + pair.b.radius;
    const Proximity p = detail::find_proximity(pair, {}, nullptr);
    if (p.lower > radii) return {};
    PenetrationResult r;
    if (p.lower > 0.0 || (is_thin(pair.a) && is_thin(pair.b))) {
        // The difference is that of the cores and a ball: the depth is what the distance lacks of the radii.
        r.lower = radii - p.upper;
        r.upper = radii - p.lower + pair.rounding;
        r.normal = p.lower > 0.0 ? p.normal : across(pair);
        r.on_a = p.on_a;
        r.on_b = p.on_b;
    } else {
        const detail::Penetration inside = detail::penetration(pair.a, pair.b, 2.0 * std::max(pair.a.reach, pair.b.reach));
        r.lower = radii + inside.floor - pair.rounding;
        r.upper = radii + inside.depth + pair.rounding;
        r.normal = inside.normal;
        r.on_a = inside.on_a;
        r.on_b = inside.on_b;
    }
    if (r.upper <= 0.0) return {};
    r.lower = std::max(0.0, r.lower);
    r.on_a += pair.a.radius * r.normal;
    r.on_b -= pair.b.radius * r.normal;
    return r;
}

}  // namespace

const char* to_string(DistanceStatus status) noexcept {
    switch (status) {
        case DistanceStatus::Converged: return "converged";
        case DistanceStatus::Overlap: return "overlap";
        case DistanceStatus::Rounding: return "rounding";
        case DistanceStatus::Stopped: return "stopped";
    }
    return "";
}

const char* to_string(Overlap verdict) noexcept {
    switch (verdict) {
        case Overlap::Apart: return "apart";
        case Overlap::Overlapping: return "overlapping";
        case Overlap::Undecided: return "undecided";
    }
    return "";
}

DistanceResult distance(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, const DistanceSettings& settings,
                        DistanceCache* cache) {
    const detail::PairFault fault = detail::query_fault(a, pose_a, b, pose_b);
    CAROM_REQUIRE(fault.what == nullptr, fault.code, fault.what, refused());
    const char* const wrong = detail::settings_fault(settings);
    CAROM_REQUIRE(wrong == nullptr, ErrorCode::InvalidArgument, wrong, refused());
    return detail::pair_distance(a, pose_a, b, pose_b, settings, cache);
}

PenetrationResult penetration(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    const detail::PairFault fault = detail::query_fault(a, pose_a, b, pose_b);
    CAROM_REQUIRE(fault.what == nullptr, fault.code, fault.what, PenetrationResult{});
    if (const auto h = detail::plane_height(a, pose_a, b, pose_b)) {
        if (h->height > h->rounding) return {};
        return {std::max(0.0, -h->height - h->rounding), -h->height + h->rounding, h->normal, h->on_a, h->on_b};
    }
    const CorePair pair = detail::core_pair(a, pose_a, b, pose_b);
    PenetrationResult r = depth_of_cores(pair);
    r.lower *= pair.unit;
    r.upper *= pair.unit;
    r.on_a *= pair.unit;
    r.on_b *= pair.unit;
    return r;
}

Overlap overlaps(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, DistanceCache* cache) {
    const detail::PairFault fault = detail::query_fault(a, pose_a, b, pose_b);
    CAROM_REQUIRE(fault.what == nullptr, fault.code, fault.what, Overlap::Undecided);
    return detail::pair_overlaps(a, pose_a, b, pose_b, cache);
}

}  // namespace carom
