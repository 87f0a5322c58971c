#include <carom/narrowphase/detail/gjk.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace carom::detail {
namespace {

constexpr int kMaxRounds = 64;
constexpr int kMaxRoundsCurved = 128;
constexpr double kRelative = 1e-12;  // of the distance
constexpr double kRounding = 4e-15;  // of the coordinates: a dozen ulp
constexpr double kOverlap = 1e-12;   // of the coordinates
constexpr double kInside = 1e-9;     // of the coordinates

struct Corner {
    dvec3 w{0.0};  // on_a - on_b
    dvec3 on_a{0.0};
    dvec3 on_b{0.0};
    std::size_t index_a = 0, index_b = 0;
    double weight = 1.0;
};

struct Simplex {
    std::array<Corner, 4> corners;
    int count = 0;

    [[nodiscard]] const Corner& operator[](int i) const noexcept { return corners[static_cast<std::size_t>(i)]; }
    void add(const Corner& c, double weight) noexcept {
        corners[static_cast<std::size_t>(count)] = c;
        corners[static_cast<std::size_t>(count++)].weight = weight;
    }
    [[nodiscard]] dvec3 point() const noexcept {
        dvec3 sum{0.0};
        for (int i = 0; i < count; ++i) sum += (*this)[i].weight * (*this)[i].w;
        return sum;
    }
};

// A support point and its number; those of a curved surface have none.
struct Support {
    dvec3 point{0.0};
    std::size_t index = 0;
};

Support support(std::span<const dvec3> points, const dvec3& direction) noexcept {
    const std::size_t index = farthest_along(points, direction);
    return {points[index], index};
}
Support support(const TruncatedCone& solid, const dvec3& direction) noexcept { return {solid.support(direction), 0}; }

// Any point of a set, to begin with.
const dvec3& some_point(std::span<const dvec3> points) noexcept { return points[0]; }
const dvec3& some_point(const TruncatedCone& solid) noexcept { return solid.centre; }

bool same(const Corner& a, const Corner& b) noexcept { return a.index_a == b.index_a && a.index_b == b.index_b && a.w == b.w; }

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

double length_sq(const Simplex& s) noexcept {
    const dvec3 p = s.point();
    return glm::dot(p, p);
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

Simplex nearest(const Simplex& s, bool curved) noexcept {
    switch (s.count) {
        case 2: return nearest_on_segment(s[0], s[1]);
        case 3: return curved ? nearest_on_sliver(s[0], s[1], s[2]) : nearest_on_triangle(s[0], s[1], s[2]);
        case 4: return nearest_on_tetrahedron(s, curved);
        default: return s;
    }
}

GjkResult result_of(const Simplex& s, double distance, bool overlap, bool converged) noexcept {
    GjkResult r;
    for (int i = 0; i < s.count; ++i) {
        r.on_a += s[i].weight * s[i].on_a;
        r.on_b += s[i].weight * s[i].on_b;
    }
    r.distance = distance;
    r.overlap = overlap;
    r.converged = converged;
    return r;
}

// The simplex's point as one corner. Between it and a support point beyond there is always a nearer one, whatever rounding makes of the
// simplex itself.
Corner merged(const Simplex& s) noexcept {
    const GjkResult r = result_of(s, 0.0, false, true);
    return {s.point(), r.on_a, r.on_b, 0, 0, 1.0};
}

GjkResult beyond_result(double distance) noexcept {
    GjkResult r;
    r.distance = distance;
    r.beyond = true;
    return r;
}

template <class A, class B>
GjkResult search(const A& a, const B& b, double cutoff, int max_rounds, Simplex& simplex) noexcept {
    const bool curved = max_rounds > kMaxRounds;
    simplex.add({some_point(a) - some_point(b), some_point(a), some_point(b), 0, 0, 1.0}, 1.0);
    double extent = 0.0;
    dvec3 v = simplex[0].w;
    double vv = glm::dot(v, v);
    if (!is_finite(vv)) return beyond_result(vv);  // farther apart than any cutoff
    for (int round = 0; round < max_rounds; ++round) {
        extent = std::max({extent, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
        // Below 1e-140 the squares of a direction's parts underflow, which curved supports need.
        if (vv <= kOverlap * kOverlap * extent * extent || (curved && vv < 1e-280)) return result_of(simplex, 0.0, true, true);

        const Support of_a = support(a, -v), of_b = support(b, v);
        const Corner next{of_a.point - of_b.point, of_a.point, of_b.point, of_a.index, of_b.index, 1.0};
        extent = std::max({extent, std::abs(next.w.x), std::abs(next.w.y), std::abs(next.w.z)});
        const double distance = std::sqrt(vv);
        const double bound = glm::dot(v, next.w);  // the support plane is this far off, times the distance
        if (bound > (cutoff + kRounding * extent) * distance) return beyond_result(distance);
        bool known = vv - bound <= kRelative * vv + kRounding * extent * distance;
        for (int i = 0; i < simplex.count; ++i) known = known || same(simplex[i], next);
        if (known) return result_of(simplex, distance, false, true);

        Simplex grown = simplex;
        grown.add(next, 1.0);
        Simplex smaller = nearest(grown, curved);
        if (smaller.count == 4) {
            simplex = smaller;
            return result_of(simplex, 0.0, true, true);
        }
        if (curved && !(length_sq(smaller) < vv)) smaller = nearest_on_segment(merged(simplex), next);
        v = smaller.point();
        const double closer = glm::dot(v, v);
        if (!(closer < vv)) return result_of(simplex, distance, false, true);  // rounding allows no progress
        simplex = smaller;
        vv = closer;
    }
    return result_of(simplex, std::sqrt(vv), false, false);
}

template <class A, class B>
GjkResult search(const A& a, const B& b, double cutoff, int max_rounds) noexcept {
    Simplex simplex;
    return search(a, b, cutoff, max_rounds, simplex);
}

template <class A, class B>
GjkResult search(const A& a, const B& b, double cutoff, int max_rounds, GjkSimplex& last) noexcept {
    Simplex simplex;
    const GjkResult result = search(a, b, cutoff, max_rounds, simplex);
    last.count = simplex.count;
    for (int i = 0; i < simplex.count; ++i) {
        last.on_a[static_cast<std::size_t>(i)] = simplex[i].on_a;
        last.on_b[static_cast<std::size_t>(i)] = simplex[i].on_b;
    }
    return result;
}

}  // namespace

std::size_t farthest_along(std::span<const dvec3> points, const dvec3& direction) noexcept {
    std::size_t best = 0;
    double reach = glm::dot(points[0], direction);
    for (std::size_t i = 1; i < points.size(); ++i) {
        const double r = glm::dot(points[i], direction);
        if (r > reach) {
            reach = r;
            best = i;
        }
    }
    return best;
}

GjkResult gjk(std::span<const dvec3> a, std::span<const dvec3> b, double cutoff) noexcept { return search(a, b, cutoff, kMaxRounds); }
GjkResult gjk(const TruncatedCone& a, std::span<const dvec3> b, double cutoff) noexcept {
    return search(a, b, cutoff, kMaxRoundsCurved);
}
GjkResult gjk(const TruncatedCone& a, const TruncatedCone& b, double cutoff) noexcept {
    return search(a, b, cutoff, kMaxRoundsCurved);
}

GjkResult gjk(std::span<const dvec3> a, std::span<const dvec3> b, double cutoff, GjkSimplex& last) noexcept {
    return search(a, b, cutoff, kMaxRounds, last);
}
GjkResult gjk(const TruncatedCone& a, std::span<const dvec3> b, double cutoff, GjkSimplex& last) noexcept {
    return search(a, b, cutoff, kMaxRoundsCurved, last);
}
GjkResult gjk(const TruncatedCone& a, const TruncatedCone& b, double cutoff, GjkSimplex& last) noexcept {
    return search(a, b, cutoff, kMaxRoundsCurved, last);
}

}  // namespace carom::detail
