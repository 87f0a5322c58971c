// Which part of a simplex is nearest to the origin. A simplex is anything whose corners are s[i], i below 4, each with its point s[i].w.
//
//   const SimplexPart part = part_of_triangle(s, 0, 1, 2);   // v = part_point(s, part)
#pragma once

#include <carom/core/types.hpp>

#include <hwy/base.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom::detail {

inline constexpr int kTetrahedronFaces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};  // with the corner opposite

/// Corners that hold the nearest point, with their weights.
struct SimplexPart {
    int count = 0;
    int corner[4];
    double weight[4];

    /// @param share  the weight times any number that is the same for all.
    void add(int number, double its_weight, double /*share*/) noexcept {
        corner[count] = number;
        weight[count++] = its_weight;
    }
};

/// The same, and what the weights were divided from: a direction is known before the quotients are.
struct DirectedPart {
    int count = 0;
    int corner[4];
    double weight[4];
    double share[4];

    void add(int number, double its_weight, double its_share) noexcept {
        corner[count] = number;
        share[count] = its_share;
        weight[count++] = its_weight;
    }
};

/// The part's point.
template <class S, class Part>
HWY_INLINE dvec3 part_point(const S& s, const Part& part) noexcept {
    dvec3 sum{0.0};
    for (int i = 0; i < part.count; ++i) sum += part.weight[i] * s[part.corner[i]].w;
    return sum;
}

/// The part's point times any number.
template <class S>
HWY_INLINE dvec3 part_direction(const S& s, const DirectedPart& part) noexcept {
    dvec3 sum{0.0};
    for (int i = 0; i < part.count; ++i) sum += part.share[i] * s[part.corner[i]].w;
    return sum;
}

/// Of corners `a` and `b`.
template <class Part = SimplexPart, class S>
HWY_INLINE Part part_of_segment(const S& s, int a, int b) noexcept {
    Part part;
    const dvec3 d = s[b].w - s[a].w;
    const double dd = glm::dot(d, d), t = -glm::dot(s[a].w, d);
    if (!(t > 0.0)) {
        part.add(a, 1.0, 1.0);
    } else if (!(t < dd)) {
        part.add(b, 1.0, 1.0);
    } else {
        part.add(a, 1.0 - t / dd, dd - t);
        part.add(b, t / dd, t);
    }
    return part;
}

/// Of the part's point.
template <class S, class Part>
double length_sq(const S& s, const Part& part) noexcept {
    const dvec3 p = part_point(s, part);
    return glm::dot(p, p);
}

/// Of a triangle (Ericson 2005, sec. 5.1.5).
template <class Part = SimplexPart, class S>
HWY_INLINE Part part_of_triangle(const S& s, int i, int j, int k) noexcept {
    Part part;
    const dvec3 &a = s[i].w, &b = s[j].w, &c = s[k].w;
    const dvec3 ab = b - a, ac = c - a;
    const double d1 = -glm::dot(ab, a), d2 = -glm::dot(ac, a);
    if (d1 <= 0.0 && d2 <= 0.0) return part.add(i, 1.0, 1.0), part;
    const double d3 = -glm::dot(ab, b), d4 = -glm::dot(ac, b);
    if (d3 >= 0.0 && d4 <= d3) return part.add(j, 1.0, 1.0), part;
    const double d5 = -glm::dot(ab, c), d6 = -glm::dot(ac, c);
    if (d6 >= 0.0 && d5 <= d6) return part.add(k, 1.0, 1.0), part;
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return part_of_segment<Part>(s, i, j);
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return part_of_segment<Part>(s, i, k);
    if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) return part_of_segment<Part>(s, j, k);
    const double sum = va + vb + vc;
    if (!(sum > 0.0)) return part_of_segment<Part>(s, i, j);  // no area left: rounding decides between the edges
    part.add(i, va / sum, va);
    part.add(j, vb / sum, vb);
    part.add(k, vc / sum, vc);
    return part;
}

/// The same by trying the edges and the inside, and measuring: for triangles so thin that the tests above decide by rounding. Support points
/// of curved surfaces make such.
template <class S>
SimplexPart part_of_sliver(const S& s, int i, int j, int k) noexcept {
    SimplexPart best = part_of_segment(s, i, j);
    double least = length_sq(s, best);
    const auto offer = [&](const SimplexPart& part) {
        const double sq = length_sq(s, part);
        if (sq < least) {
            best = part;
            least = sq;
        }
    };
    offer(part_of_segment(s, j, k));
    offer(part_of_segment(s, k, i));
    const dvec3 &a = s[i].w, &b = s[j].w, &c = s[k].w;
    const dvec3 n = glm::cross(b - a, c - a);
    const double nn = glm::dot(n, n);
    if (!(nn > 0.0)) return best;
    const dvec3 foot = (glm::dot(n, a) / nn) * n;
    const double wa = glm::dot(n, glm::cross(b - foot, c - foot)) / nn, wb = glm::dot(n, glm::cross(c - foot, a - foot)) / nn;
    const double wc = 1.0 - wa - wb;
    if (!(wa > 0.0 && wb > 0.0 && wc > 0.0)) return best;
    SimplexPart inside;
    inside.add(i, wa, wa);
    inside.add(j, wb, wb);
    inside.add(k, wc, wc);
    offer(inside);
    return best;
}

/// Of a tetrahedron; four corners, without weights, where the origin is inside.
/// @tparam all  for curved surfaces, whose support points make tetrahedra so flat that rounding decides which faces turn away from the
///              origin: looks at those faces too, and believes that the origin is inside only where its weights show it.
template <bool all, class Part = SimplexPart, class S>
Part part_of_tetrahedron(const S& t) noexcept {
    constexpr double kInside = 1e-9;  // of the coordinates
    Part best;
    double least = 0.0;
    int inside_of = 0;
    dvec3 sum{0.0};  // of the corners by the origin's weights: 0 where these are right
    double extent = 0.0;
    for (const auto& f : kTetrahedronFaces) {
        const dvec3 &a = t[f[0]].w, &b = t[f[1]].w, &c = t[f[2]].w, &opposite = t[f[3]].w;
        const dvec3 n = glm::cross(b - a, c - a);
        const double inside = glm::dot(n, opposite - a);
        const double origin = -glm::dot(n, a);
        if (origin * inside > 0.0) {
            ++inside_of;
            if constexpr (!all) continue;
            sum += (origin / inside) * opposite;
            extent = std::max({extent, std::abs(opposite.x), std::abs(opposite.y), std::abs(opposite.z)});
        }
        const Part part = [&] {
            if constexpr (all) {
                return part_of_sliver(t, f[0], f[1], f[2]);
            } else {
                return part_of_triangle<Part>(t, f[0], f[1], f[2]);
            }
        }();
        const double pp = length_sq(t, part);
        if (best.count == 0 || pp < least) {
            best = part;
            least = pp;
        }
    }
    if (inside_of < 4 || (all && !(glm::dot(sum, sum) <= kInside * kInside * extent * extent))) return best;
    best.count = 0;
    for (int i = 0; i < 4; ++i) best.add(i, 1.0, 1.0);
    return best;
}

/// Whether the origin lies in the tetrahedron, deeper than `rounding` behind each face: then it is in that of the exact corners too.
template <class S>
bool holds_origin(const S& t, double rounding) noexcept {
    for (const auto& f : kTetrahedronFaces) {
        const dvec3 &a = t[f[0]].w, u = t[f[1]].w - a, v = t[f[2]].w - a, n = glm::cross(u, v);
        const double slack = rounding * std::sqrt(glm::dot(n, n)) +
                             0x1p-49 * std::sqrt(glm::dot(u, u) * glm::dot(v, v)) * (std::sqrt(glm::dot(a, a)) + rounding);
        const double inside = glm::dot(n, t[f[3]].w - a), origin = -glm::dot(n, a);
        if (!(std::abs(origin) > slack) || !(std::abs(inside) > slack) || (origin > 0.0) != (inside > 0.0)) return false;
    }
    return true;
}

}  // namespace carom::detail
