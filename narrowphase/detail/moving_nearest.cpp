// The nearest point of a triangle or parallelogram to the origin, quickly: Ericson, Real-Time Collision Detection (2005), sec. 5.1.5
// and 5.1.9. Nothing relies on it, so nothing guards it against rounding.
#include <carom/narrowphase/detail/moving_difference.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace carom::detail {
namespace {

/// @param flat  where the nearest point is inside: across the plane, which stays right when the distance goes to zero.
NearestCorner towards(const dvec3& point, const dvec3* flat, double u) noexcept {
    dvec3 n = point;
    double distance = glm::length(point);
    if (flat != nullptr) {
        const double length = glm::length(*flat);
        const double height = glm::dot(*flat, point);
        if (length > 0.0) {
            n = (height < 0.0 ? -1.0 / length : 1.0 / length) * *flat;
            return {n, std::abs(height) / length, u};
        }
    }
    if (!(distance > 0.0)) return {dvec3{0.0}, 0.0, u};
    return {n / distance, distance, u};
}

/// Figures thinner than the root of this, by their length, are their outlines: what decides what is inside, and their normal, are differences
/// of products, which rounding spoils well before they vanish.
constexpr double kThin = 1e-10;

/// @param corner  in order round the figure. Where the nearest point is within a side, the normal is made perpendicular to it once more, since
/// the point, a sum of far larger vectors, is not.
NearestCorner nearest_on_outline(std::span<const dvec3> corner) noexcept {
    NearestCorner nearest{dvec3{0.0}, std::numeric_limits<double>::infinity(), 0.0};
    for (std::size_t i = 0; i < corner.size(); ++i) {
        const dvec3 &a = corner[i], side = corner[(i + 1) % corner.size()] - a;
        const double sq = glm::dot(side, side);
        const double s = sq > 0.0 ? std::clamp(-glm::dot(a, side) / sq, 0.0, 1.0) : 0.0;
        dvec3 point = a + s * side;
        if (s > 0.0 && s < 1.0) point -= (glm::dot(point, side) / sq) * side;
        const double distance = glm::length(point);
        if (!(distance < nearest.distance)) continue;
        const std::array<double, 4> u{s, 1.0, 1.0 - s, 0.0};
        nearest = {distance > 0.0 ? point / distance : dvec3{0.0}, distance, u[i]};
    }
    return nearest;
}

NearestCorner nearest_on_triangle(const dvec3& a, const dvec3& b, const dvec3& c) noexcept {
    const dvec3 ab = b - a, ac = c - a, flat = glm::cross(ab, ac);
    const double longest = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(c - b, c - b)});
    if (!(glm::dot(flat, flat) > kThin * longest * longest)) return nearest_on_outline(std::array{a, b, c});
    const double d1 = -glm::dot(ab, a), d2 = -glm::dot(ac, a);
    if (d1 <= 0.0 && d2 <= 0.0) return towards(a, nullptr, 0.0);
    const double d3 = -glm::dot(ab, b), d4 = -glm::dot(ac, b);
    if (d3 >= 0.0 && d4 <= d3) return towards(b, nullptr, 0.0);
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return towards(a + (d1 / (d1 - d3)) * ab, nullptr, 0.0);
    const double d5 = -glm::dot(ab, c), d6 = -glm::dot(ac, c);
    if (d6 >= 0.0 && d5 <= d6) return towards(c, nullptr, 0.0);
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return towards(a + (d2 / (d2 - d6)) * ac, nullptr, 0.0);
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
        return towards(b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b), nullptr, 0.0);
    }
    return towards(a, &flat, 0.0);
}

/// w + u p + v q with u and v in [0, 1].
NearestCorner nearest_on_parallelogram(const dvec3& w, const dvec3& p, const dvec3& q) noexcept {
    const double pp = glm::dot(p, p), qq = glm::dot(q, q), pq = glm::dot(p, q);
    const double pw = glm::dot(p, w), qw = glm::dot(q, w);
    const double det = pp * qq - pq * pq;
    if (!(det > kThin * pp * qq)) return nearest_on_outline(std::array{w, w + p, w + p + q, w + q});
    double u = (pq * qw - qq * pw) / det;
    const double inside_v = (pq * pw - pp * qw) / det;
    if (u >= 0.0 && u <= 1.0 && inside_v >= 0.0 && inside_v <= 1.0) {
        const dvec3 flat = glm::cross(p, q);
        return towards(w, &flat, u);
    }
    // On the outline: clamp u, then v for it, then u again.
    const double v = std::clamp(-(qw + std::clamp(u, 0.0, 1.0) * pq) / qq, 0.0, 1.0);
    u = std::clamp(-(pw + v * pq) / pp, 0.0, 1.0);
    return towards(w + u * p + v * q, nullptr, u);
}

}  // namespace

NearestCorner nearest_of(const MovingDifference& d, double t) noexcept {
    const dvec3 a = d.corner(0, t), b = d.corner(1, t), c = d.corner(2, t);
    return d.count == 3 ? nearest_on_triangle(a, b, c) : nearest_on_parallelogram(a, c - a, b - a);
}

}  // namespace carom::detail
