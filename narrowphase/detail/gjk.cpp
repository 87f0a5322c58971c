#include <carom/narrowphase/detail/gjk.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace carom::detail {
namespace {

constexpr int kMaxRounds = 64;
constexpr double kRelative = 1e-12;  // of the distance
constexpr double kRounding = 4e-15;  // of the coordinates: a dozen ulp
constexpr double kOverlap = 1e-12;   // of the coordinates

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

std::size_t support(std::span<const dvec3> points, const dvec3& direction) noexcept {
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

// The part of the tetrahedron nearest to the origin; four corners where the origin is inside.
Simplex nearest_on_tetrahedron(const Simplex& t) noexcept {
    constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};
    Simplex best;
    double least = 0.0;
    for (const auto& f : kFaces) {
        const Corner &a = t[f[0]], &b = t[f[1]], &c = t[f[2]];
        const dvec3 n = glm::cross(b.w - a.w, c.w - a.w);
        const double inside = glm::dot(n, t[f[3]].w - a.w);
        const double origin = -glm::dot(n, a.w);
        if (origin * inside > 0.0) continue;
        const Simplex s = nearest_on_triangle(a, b, c);
        const dvec3 p = s.point();
        const double pp = glm::dot(p, p);
        if (best.count == 0 || pp < least) {
            best = s;
            least = pp;
        }
    }
    return best.count == 0 ? t : best;
}

Simplex nearest(const Simplex& s) noexcept {
    switch (s.count) {
        case 2: return nearest_on_segment(s[0], s[1]);
        case 3: return nearest_on_triangle(s[0], s[1], s[2]);
        case 4: return nearest_on_tetrahedron(s);
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

GjkResult beyond_result(double distance) noexcept {
    GjkResult r;
    r.distance = distance;
    r.beyond = true;
    return r;
}

}  // namespace

GjkResult gjk(std::span<const dvec3> a, std::span<const dvec3> b, double cutoff) noexcept {
    Simplex simplex;
    simplex.add({a[0] - b[0], a[0], b[0], 0, 0, 1.0}, 1.0);
    double extent = 0.0;
    dvec3 v = simplex[0].w;
    double vv = glm::dot(v, v);
    for (int round = 0; round < kMaxRounds; ++round) {
        extent = std::max({extent, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
        if (vv <= kOverlap * kOverlap * extent * extent) return result_of(simplex, 0.0, true, true);

        const std::size_t ia = support(a, -v), ib = support(b, v);
        const Corner next{a[ia] - b[ib], a[ia], b[ib], ia, ib, 1.0};
        extent = std::max({extent, std::abs(next.w.x), std::abs(next.w.y), std::abs(next.w.z)});
        const double distance = std::sqrt(vv);
        const double bound = glm::dot(v, next.w);  // the support plane is this far off, times the distance
        if (bound > (cutoff + kRounding * extent) * distance) return beyond_result(distance);
        bool known = vv - bound <= kRelative * vv + kRounding * extent * distance;
        for (int i = 0; i < simplex.count; ++i) known = known || (simplex[i].index_a == ia && simplex[i].index_b == ib);
        if (known) return result_of(simplex, distance, false, true);

        Simplex grown = simplex;
        grown.add(next, 1.0);
        const Simplex smaller = nearest(grown);
        if (smaller.count == 4) return result_of(smaller, 0.0, true, true);
        v = smaller.point();
        const double closer = glm::dot(v, v);
        if (!(closer < vv)) return result_of(simplex, distance, false, true);  // rounding allows no progress
        simplex = smaller;
        vv = closer;
    }
    return result_of(simplex, std::sqrt(vv), false, false);
}

}  // namespace carom::detail
