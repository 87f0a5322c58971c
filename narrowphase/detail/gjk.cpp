#include <carom/narrowphase/detail/gjk.hpp>
#include <carom/narrowphase/detail/gjk_simplex.hpp>

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

        simplex.add(next, 1.0);
        const SimplexPart part = nearest_part(simplex, curved);
        if (part.count == 4) return result_of(simplex, 0.0, true, true);
        dvec3 nearer = part_point(simplex, part);
        if (glm::dot(nearer, nearer) < vv) {
            simplex.keep(part);
        } else {
            simplex.drop_last();
            if (!curved) return result_of(simplex, distance, false, true);  // rounding allows no progress
            const Simplex smaller = nearest_on_segment(merged(simplex), next);
            nearer = smaller.point();
            if (!(glm::dot(nearer, nearer) < vv)) return result_of(simplex, distance, false, true);
            simplex = smaller;
        }
        v = nearer;
        vv = glm::dot(v, v);
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
GjkResult gjk(const TruncatedCone& a, std::span<const dvec3> b, double cutoff) noexcept { return search(a, b, cutoff, kMaxRoundsCurved); }
GjkResult gjk(const TruncatedCone& a, const TruncatedCone& b, double cutoff) noexcept { return search(a, b, cutoff, kMaxRoundsCurved); }

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
