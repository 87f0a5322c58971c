// The point of a triangle closest to another point.
#pragma once

#include <carom/core/types.hpp>

#include <glm/geometric.hpp>

#include <array>

namespace carom::detail {

using Corners = std::array<dvec3, 3>;

struct TrianglePoint {
    dvec3 point{0.0};
    bool inside = false;  ///< in the face, not on an edge or at a corner
    std::uint32_t feature = 0;  ///< corner, or edge from that corner to the next; 0 inside
};

/// Method: Ericson, Real-Time Collision Detection (2005), sec. 5.1.5. Total: a triangle without area gives a point of its edges.
[[nodiscard]] inline TrianglePoint closest_on_triangle(const Corners& t, const dvec3& p) noexcept {
    const dvec3 &a = t[0], &b = t[1], &c = t[2];
    const dvec3 ab = b - a, ac = c - a;
    const double d1 = glm::dot(ab, p - a), d2 = glm::dot(ac, p - a);
    if (d1 <= 0.0 && d2 <= 0.0) return {a, false, 0};
    const double d3 = glm::dot(ab, p - b), d4 = glm::dot(ac, p - b);
    if (d3 >= 0.0 && d4 <= d3) return {b, false, 1};
    const double d5 = glm::dot(ab, p - c), d6 = glm::dot(ac, p - c);
    if (d6 >= 0.0 && d5 <= d6) return {c, false, 2};
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {a + (d1 / (d1 - d3)) * ab, false, 0};
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {a + (d2 / (d2 - d6)) * ac, false, 2};
    const double u = d4 - d3, v = d5 - d6;
    if (va <= 0.0 && u >= 0.0 && v >= 0.0) return {b + (u / (u + v)) * (c - b), false, 1};
    const double sum = va + vb + vc;
    if (!(sum > 0.0)) return {a, false, 0};
    return {a + (vb / sum) * ab + (vc / sum) * ac, true, 0};
}

}  // namespace carom::detail
