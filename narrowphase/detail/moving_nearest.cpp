// The nearest point of a triangle or parallelogram to the origin, quickly: Ericson, Real-Time Collision Detection (2005), sec. 5.1.5
// and 5.1.9. Nothing relies on it, so nothing guards it against rounding.
#include <carom/narrowphase/detail/moving_difference.hpp>

#include <algorithm>
#include <cmath>

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

NearestCorner nearest_on_triangle(const dvec3& a, const dvec3& b, const dvec3& c) noexcept {
    const dvec3 ab = b - a, ac = c - a;
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
    const dvec3 flat = glm::cross(ab, ac);
    return towards(a, &flat, 0.0);
}

/// w + u p + v q with u and v in [0, 1].
NearestCorner nearest_on_parallelogram(const dvec3& w, const dvec3& p, const dvec3& q) noexcept {
    const double pp = glm::dot(p, p), qq = glm::dot(q, q), pq = glm::dot(p, q);
    const double pw = glm::dot(p, w), qw = glm::dot(q, w);
    const double det = pp * qq - pq * pq;
    const auto best_u = [&](double v) { return pp > 0.0 ? std::clamp(-(pw + v * pq) / pp, 0.0, 1.0) : 0.0; };
    if (det > 1e-20 * pp * qq) {
        const double u = (pq * qw - qq * pw) / det;
        const double v = (pq * pw - pp * qw) / det;
        if (u >= 0.0 && u <= 1.0 && v >= 0.0 && v <= 1.0) {
            const dvec3 flat = glm::cross(p, q);
            return towards(w, &flat, u);
        }
    }
    // On the outline: clamp u, then v for it, then u again.
    double u = det > 1e-20 * pp * qq ? std::clamp((pq * qw - qq * pw) / det, 0.0, 1.0) : 0.0;
    const double v = qq > 0.0 ? std::clamp(-(qw + u * pq) / qq, 0.0, 1.0) : 0.0;
    u = best_u(v);
    return towards(w + u * p + v * q, nullptr, u);
}

}  // namespace

NearestCorner nearest_of(const MovingDifference& d, double t) noexcept {
    const dvec3 a = d.corner(0, t), b = d.corner(1, t), c = d.corner(2, t);
    return d.count == 3 ? nearest_on_triangle(a, b, c) : nearest_on_parallelogram(a, c - a, b - a);
}

}  // namespace carom::detail
