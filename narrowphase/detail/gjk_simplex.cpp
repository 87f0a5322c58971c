#include <carom/narrowphase/detail/gjk_simplex.hpp>

#include <algorithm>
#include <cmath>

namespace carom::detail {

Simplex nearest_on_segment(const Corner& a, const Corner& b) noexcept {
    Simplex s;
    const dvec3 d = b.w - a.w;
    const double dd = glm::dot(d, d), t = -glm::dot(a.w, d);
    if (!(t > 0.0)) {
        s.add(a, 1.0);
    } else if (!(t < dd)) {
        s.add(b, 1.0);
    } else {
        s.add(a, 1.0 - t / dd);
        s.add(b, t / dd);
    }
    return s;
}

namespace {

constexpr double kInside = 1e-9;  // of the coordinates

// The part of the triangle nearest to the origin (Ericson 2005, sec. 5.1.5).
Simplex nearest_on_triangle(const Corner& a, const Corner& b, const Corner& c) noexcept {
    Simplex s;
    const dvec3 ab = b.w - a.w, ac = c.w - a.w;
    const double d1 = -glm::dot(ab, a.w), d2 = -glm::dot(ac, a.w);
    if (d1 <= 0.0 && d2 <= 0.0) return s.add(a, 1.0), s;
    const double d3 = -glm::dot(ab, b.w), d4 = -glm::dot(ac, b.w);
    if (d3 >= 0.0 && d4 <= d3) return s.add(b, 1.0), s;
    const double d5 = -glm::dot(ab, c.w), d6 = -glm::dot(ac, c.w);
    if (d6 >= 0.0 && d5 <= d6) return s.add(c, 1.0), s;
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return nearest_on_segment(a, b);
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return nearest_on_segment(a, c);
    if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) return nearest_on_segment(b, c);
    const double sum = va + vb + vc;
    if (!(sum > 0.0)) return nearest_on_segment(a, b);  // no area left: rounding decides between the edges
    s.add(a, va / sum);
    s.add(b, vb / sum);
    s.add(c, vc / sum);
    return s;
}

// The same by trying the edges and the inside, and measuring: for triangles so thin that the tests above decide by rounding. Support points
// of curved surfaces make such.
Simplex nearest_on_sliver(const Corner& a, const Corner& b, const Corner& c) noexcept {
    Simplex best = nearest_on_segment(a, b);
    double least = length_sq(best);
    const auto offer = [&](const Simplex& s) {
        const double sq = length_sq(s);
        if (sq < least) {
            best = s;
            least = sq;
        }
    };
    offer(nearest_on_segment(b, c));
    offer(nearest_on_segment(c, a));
    const dvec3 n = glm::cross(b.w - a.w, c.w - a.w);
    const double nn = glm::dot(n, n);
    if (!(nn > 0.0)) return best;
    const dvec3 foot = (glm::dot(n, a.w) / nn) * n;
    const double wa = glm::dot(n, glm::cross(b.w - foot, c.w - foot)) / nn, wb = glm::dot(n, glm::cross(c.w - foot, a.w - foot)) / nn;
    const double wc = 1.0 - wa - wb;
    if (!(wa > 0.0 && wb > 0.0 && wc > 0.0)) return best;
    Simplex inside;
    inside.add(a, wa);
    inside.add(b, wb);
    inside.add(c, wc);
    offer(inside);
    return best;
}

// The part of the tetrahedron nearest to the origin; four corners where the origin is inside.
// @param all  for curved surfaces, whose support points make tetrahedra so flat that rounding decides which faces turn away from the
//             origin: looks at those faces too, and believes that the origin is inside only where its weights show it.
Simplex nearest_on_tetrahedron(const Simplex& t, bool all) noexcept {
    constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};
    Simplex best;
    double least = 0.0;
    int inside_of = 0;
    dvec3 sum{0.0};  // of the corners by the origin's weights: 0 where these are right
    double extent = 0.0;
    for (const auto& f : kFaces) {
        const Corner &a = t[f[0]], &b = t[f[1]], &c = t[f[2]];
        const dvec3 n = glm::cross(b.w - a.w, c.w - a.w);
        const double inside = glm::dot(n, t[f[3]].w - a.w);
        const double origin = -glm::dot(n, a.w);
        if (origin * inside > 0.0) {
            ++inside_of;
            if (!all) continue;
            const dvec3& opposite = t[f[3]].w;
            sum += (origin / inside) * opposite;
            extent = std::max({extent, std::abs(opposite.x), std::abs(opposite.y), std::abs(opposite.z)});
        }
        const Simplex s = all ? nearest_on_sliver(a, b, c) : nearest_on_triangle(a, b, c);
        const double pp = length_sq(s);
        if (best.count == 0 || pp < least) {
            best = s;
            least = pp;
        }
    }
    return inside_of == 4 && (!all || glm::dot(sum, sum) <= kInside * kInside * extent * extent) ? t : best;
}

}  // namespace

Simplex nearest(const Simplex& s, bool curved) noexcept {
    switch (s.count) {
        case 2: return nearest_on_segment(s[0], s[1]);
        case 3: return curved ? nearest_on_sliver(s[0], s[1], s[2]) : nearest_on_triangle(s[0], s[1], s[2]);
        case 4: return nearest_on_tetrahedron(s, curved);
        default: return s;
    }
}

}  // namespace carom::detail
