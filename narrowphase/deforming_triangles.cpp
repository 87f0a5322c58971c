#include <carom/narrowphase/deforming_triangles.hpp>

#include <carom/core/check.hpp>
#include <carom/narrowphase/detail/moving_difference.hpp>

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

using detail::Coplanarity;
using detail::kNever;
using detail::MovingDifference;
using detail::NearestCorner;
using detail::TimeSpan;

/// Between these the sixth powers of coordinates, which directions take, are in range.
constexpr double kLargestUsual = 0x1p100;
constexpr double kLeastUsual = 0x1p-100;

/// Four corners, in the order of the motion's members, and which of them make up A.
struct Corners {
    std::array<MovingPoint, 4> point;
    bool edges = false;
};

Corners corners_of(const VertexFaceMotion& m) noexcept { return {{m.vertex, m.face[0], m.face[1], m.face[2]}, false}; }
Corners corners_of(const EdgeEdgeMotion& m) noexcept { return {{m.a[0], m.a[1], m.b[0], m.b[1]}, true}; }

double largest_coordinate(const dvec3& v) noexcept { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

MovingDifference difference_of(const Corners& corners) noexcept {
    MovingDifference d;
    const auto& p = corners.point;
    const auto set = [&](std::size_t i, const MovingPoint& a, const MovingPoint& b) {
        d.start[i] = a.start - b.start;
        d.end[i] = a.end - b.end;
        d.size = std::max({d.size, largest_coordinate(d.start[i]), largest_coordinate(d.end[i])});
    };
    if (corners.edges) {
        d.count = 4;
        set(0, p[0], p[2]);
        set(1, p[0], p[3]);
        set(2, p[1], p[2]);
        set(3, p[1], p[3]);
    } else {
        set(0, p[0], p[1]);
        set(1, p[0], p[2]);
        set(2, p[0], p[3]);
    }
    return d;
}

/// A direction that separates where the nearest points are too close to show one: across the plane, along it across a side, across the longest
/// side and the motion (which lets parallel edges pass each other), an axis.
TimeSpan last_resort(const MovingDifference& d, double t, double separation, int& checks) noexcept {
    const std::array<std::size_t, 4> round = d.count == 3 ? std::array<std::size_t, 4>{0, 1, 2, 0} : std::array<std::size_t, 4>{0, 1, 3, 2};
    std::array<dvec3, 4> at{dvec3{0.0}, dvec3{0.0}, dvec3{0.0}, dvec3{0.0}};
    for (int i = 0; i < d.count; ++i) at[static_cast<std::size_t>(i)] = d.corner(i, t);
    TimeSpan best;
    const auto attempt = [&](const dvec3& direction) {
        const double length = glm::length(direction);
        if (!(length > 0.0)) return;
        for (const double sign : {1.0, -1.0}) {
            const TimeSpan proved = d.separated_along((sign / length) * direction, separation);
            ++checks;
            if (proved.from <= t && proved.to > std::max(best.to, t)) best = proved;
        }
    };
    const dvec3 flat = glm::cross(at[1] - at[0], at[2] - at[0]);
    attempt(flat);
    const auto sides = static_cast<std::size_t>(d.count);
    dvec3 longest{0.0}, motion{0.0};
    for (std::size_t i = 0; i < sides; ++i) {
        const dvec3 side = at[round[(i + 1) % sides]] - at[round[i]];
        attempt(glm::cross(flat, side));
        if (glm::dot(side, side) > glm::dot(longest, longest)) longest = side;
        motion += d.end[i] - d.start[i];
    }
    attempt(glm::cross(longest, motion));
    attempt({1.0, 0.0, 0.0});
    attempt({0.0, 1.0, 0.0});
    attempt({0.0, 0.0, 1.0});
    return best;
}

struct Search {
    ImpactStatus status = ImpactStatus::Separated;
    double t = 1.0;
    NearestCorner nearest;
    int checks = 0;
};

Search search(const MovingDifference& d, const DeformingSettings& settings) noexcept {
    if (d.separated_by_axis(settings.separation)) return {ImpactStatus::Separated, 1.0, {}, 1};
    const Coplanarity coplanar(d, settings.separation);
    Search found;
    double t = coplanar.advance(0.0);
    found.checks = 2;
    while (t <= 1.0) {
        found.t = t;
        found.nearest = nearest_of(d, t);
        const bool start = t == 0.0;
        TimeSpan proved = d.separated_along(found.nearest.normal, settings.separation);
        ++found.checks;
        if (!(proved.from <= t && proved.to > t)) proved = last_resort(d, t, settings.separation, found.checks);
        if (!(proved.from <= t && proved.to > t)) {
            found.status = start ? ImpactStatus::Overlapping : ImpactStatus::Touching;
            return found;
        }
        if (found.nearest.distance <= settings.separation + settings.tolerance && proved.to <= 1.0) {
            proved = last_resort(d, t, settings.separation, found.checks);  // near, but perhaps past each other
            if (!(proved.from <= t && proved.to > 1.0)) {
                found.status = ImpactStatus::Touching;
                return found;
            }
        }
        if (found.checks >= settings.most_checks) {
            found.status = ImpactStatus::Clamped;
            return found;
        }
        t = proved.to;
        if (t <= 1.0) t = coplanar.advance(t);
    }
    found.t = 1.0;
    return found;
}

Impact impact_of(const Corners& corners, const DeformingSettings& settings) noexcept {
    Impact impact;
    const MovingDifference d = difference_of(corners);
    const Search found = search(d, settings);
    impact.status = found.status;
    impact.t = found.t;
    impact.checks = found.checks;
    if (found.status == ImpactStatus::Separated) return impact;
    const auto at = [&](std::size_t i) { return (1.0 - found.t) * corners.point[i].start + found.t * corners.point[i].end; };
    impact.point = corners.edges ? glm::mix(at(0), at(1), found.nearest.u) : at(0);
    impact.normal = -found.nearest.normal;
    return impact;
}

/// Checks the input and brings unusual coordinates near 1.
Impact checked(Corners corners, DeformingSettings settings) noexcept {
    double largest = 0.0;
    bool finite = is_finite(settings.separation) && is_finite(settings.tolerance);
    for (const MovingPoint& p : corners.point) {
        finite = finite && is_finite(p.start) && is_finite(p.end);
        largest = std::max({largest, largest_coordinate(p.start), largest_coordinate(p.end)});
    }
    if (!finite || settings.separation < 0.0 || settings.tolerance < 0.0 || settings.most_checks < 1) {
        return {.status = ImpactStatus::Invalid, .t = 0.0};
    }
    if (largest <= kLargestUsual && (largest >= kLeastUsual || largest == 0.0)) return impact_of(corners, settings);
    const int exponent = std::ilogb(largest);
    for (MovingPoint& p : corners.point) {
        for (int k = 0; k < 3; ++k) {
            p.start[k] = std::scalbn(p.start[k], -exponent);
            p.end[k] = std::scalbn(p.end[k], -exponent);
        }
    }
    settings.separation = std::scalbn(settings.separation, -exponent);
    settings.tolerance = std::scalbn(settings.tolerance, -exponent);
    Impact impact = impact_of(corners, settings);
    for (int k = 0; k < 3; ++k) impact.point[k] = std::scalbn(impact.point[k], exponent);
    return impact;
}

template <class Motion>
void batch(std::span<const Motion> motions, std::span<Impact> out, const DeformingSettings& settings) {
    CAROM_REQUIRE(motions.size() == out.size(), ErrorCode::InvalidArgument, "times_of_impact: motions and out differ in length");
    for (std::size_t i = 0; i < motions.size(); ++i) out[i] = time_of_impact(motions[i], settings);
}

}  // namespace

Impact time_of_impact(const VertexFaceMotion& motion, const DeformingSettings& settings) noexcept {
    return checked(corners_of(motion), settings);
}

Impact time_of_impact(const EdgeEdgeMotion& motion, const DeformingSettings& settings) noexcept {
    return checked(corners_of(motion), settings);
}

Impact time_of_impact(const std::array<MovingPoint, 3>& a, const std::array<MovingPoint, 3>& b, const DeformingSettings& settings) noexcept {
    Impact first;
    int checks = 0;
    const auto take = [&](Impact next, bool swapped) {
        checks += next.checks;
        if (swapped) next.normal = -next.normal;
        if (!may_touch(next.status) || first.status == ImpactStatus::Invalid) return;
        if (next.status == ImpactStatus::Invalid || !may_touch(first.status) || next.t < first.t) first = next;
    };
    for (std::size_t i = 0; i < 3; ++i) {
        take(time_of_impact(VertexFaceMotion{a[i], b}, settings), false);
        take(time_of_impact(VertexFaceMotion{b[i], a}, settings), true);
        for (std::size_t j = 0; j < 3; ++j) {
            take(time_of_impact(EdgeEdgeMotion{{a[i], a[(i + 1) % 3]}, {b[j], b[(j + 1) % 3]}}, settings), false);
        }
    }
    first.checks = checks;
    return first;
}

void times_of_impact(std::span<const VertexFaceMotion> motions, std::span<Impact> out, const DeformingSettings& settings) {
    batch(motions, out, settings);
}

void times_of_impact(std::span<const EdgeEdgeMotion> motions, std::span<Impact> out, const DeformingSettings& settings) {
    batch(motions, out, settings);
}

}  // namespace carom
