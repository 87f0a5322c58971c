// The exact squared distance of two primitives: what overlap_tests.hpp and closest_points.hpp are judged by.
//
//   exact::Solid a = exact::solid(sphere), b = exact::solid(obb);
//   EXPECT_TRUE(exact::core_distance_sq(a, b) > exact::square(a.radius + b.radius));   // apart
//
// A core (point, segment, triangle or box) is its corners, edges and triangles. Two that do not cross are nearest at a corner and a
// triangle or at two edges, so all of those are tried; but those that doubles show to be farther by 1e-5 of the size, ten thousand times
// what the doubles may err by, are not computed exactly. The corners of a turned box are c ± h0 a0 ± h1 a1 ± h2 a2 as given, orthonormal
// or not.
#pragma once

#include <carom/collision/primitives.hpp>

#include <support/exact.hpp>

#include <array>
#include <utility>
#include <vector>

namespace carom::exact {

struct Solid {
    std::vector<Vec> corners;
    std::vector<std::array<std::size_t, 2>> edges;
    std::vector<std::array<std::size_t, 3>> faces;
    bool closed = false;  ///< the faces run round a body, counter-clockwise seen from outside
    Rational radius = 0;
};

template <class T>
[[nodiscard]] Solid solid(const glm::vec<3, T>& p) {
    return {{vec(p)}, {}, {}, false, 0};
}
template <class T>
[[nodiscard]] Solid solid(const geo::Sphere<T>& s) {
    return {{vec(s.center)}, {}, {}, false, number(s.radius)};
}
template <class T>
[[nodiscard]] Solid solid(const geo::Segment<T>& s) {
    return {{vec(s.a), vec(s.b)}, {{0, 1}}, {}, false, 0};
}
template <class T>
[[nodiscard]] Solid solid(const geo::Capsule<T>& c) {
    Solid s = solid(c.axis);
    s.radius = number(c.radius);
    return s;
}
template <class T>
[[nodiscard]] Solid solid(const geo::Triangle<T>& t) {
    return {{vec(t.a), vec(t.b), vec(t.c)}, {{0, 1}, {1, 2}, {2, 0}}, {{0, 1, 2}}, false, 0};
}
/// A box of eight corners, of which bit i chooses the side on axis i.
[[nodiscard]] inline Solid box_of(std::vector<Vec> corners) {
    return {std::move(corners),
            {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}},
            {{0, 4, 6},
             {0, 6, 2},
             {1, 3, 7},
             {1, 7, 5},
             {0, 1, 5},
             {0, 5, 4},
             {2, 6, 7},
             {2, 7, 3},
             {0, 2, 3},
             {0, 3, 1},
             {4, 5, 7},
             {4, 7, 6}},
            true,
            0};
}
template <class T>
[[nodiscard]] Solid solid(const geo::Aabb<T>& b) {
    std::vector<Vec> corners;
    const Vec l = vec(b.lower), u = vec(b.upper);
    for (int k = 0; k < 8; ++k) corners.push_back({(k & 1) ? u.x : l.x, (k & 2) ? u.y : l.y, (k & 4) ? u.z : l.z});
    return box_of(std::move(corners));
}
template <class T>
[[nodiscard]] Solid solid(const geo::Obb<T>& b) {
    std::vector<Vec> corners;
    for (int k = 0; k < 8; ++k) {
        Vec p = vec(b.center);
        for (int i = 0; i < 3; ++i) {
            const Vec half = number(b.half_extents[i]) * vec(b.axes[i]);
            p = ((k >> i) & 1) ? p + half : p - half;
        }
        corners.push_back(p);
    }
    return box_of(std::move(corners));
}

namespace detail {

[[nodiscard]] inline Rational segments_sq(const Vec& p, const Vec& u, const Vec& q, const Vec& v) {
    const Vec w = p - q;
    const Rational a = dot(u, u), b = dot(u, v), c = dot(v, v), d = dot(u, w), e = dot(v, w);
    const Rational det = a * c - b * b;
    if (det.sign() != 0) {
        const Rational s = b * e - c * d, t = a * e - b * d;
        if (s.sign() >= 0 && s <= det && t.sign() >= 0 && t <= det) return square(dot(w, cross(u, v))) / det;
    }
    return std::min({distance_sq(p, q, q + v), distance_sq(p + u, q, q + v), distance_sq(q, p, p + u), distance_sq(q + v, p, p + u)});
}

/// Whether the segment from p to q meets the triangle, for a segment that is not in its plane.
[[nodiscard]] inline bool crosses(const Vec& p, const Vec& q, const Vec& a, const Vec& b, const Vec& c) {
    const Vec n = cross(b - a, c - a);
    const Rational hp = dot(n, p - a), hq = dot(n, q - a);
    if (hp.sign() * hq.sign() > 0 || hp == hq) return false;
    const Vec d = q - p;
    const int x = dot(d, cross(a - p, b - p)).sign(), y = dot(d, cross(b - p, c - p)).sign(), z = dot(d, cross(c - p, a - p)).sign();
    return (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0);
}

[[nodiscard]] inline bool inside(const Vec& p, const Solid& s) {
    if (!s.closed) return false;
    for (const auto& f : s.faces) {
        const Vec &a = s.corners[f[0]], &b = s.corners[f[1]], &c = s.corners[f[2]];
        const Vec n = cross(b - a, c - a);
        if (length_sq(n).sign() == 0 || dot(n, p - a).sign() > 0) return false;  // a flat box has no inside
    }
    return true;
}

/// The corners once more in double, divided by their size, to rule out what plainly does not matter.
class Rough {
public:
    explicit Rough(const Solid& s, const Vec& origin, const Rational& size) {
        for (const Vec& p : s.corners) {
            const Vec q = p - origin;
            corners_.push_back({static_cast<double>(Rational(q.x / size)), static_cast<double>(Rational(q.y / size)),
                                static_cast<double>(Rational(q.z / size))});
        }
    }
    [[nodiscard]] const dvec3& operator[](std::size_t k) const { return corners_[k]; }

private:
    std::vector<dvec3> corners_;
};

inline constexpr double kPlainly = 1e-5;

/// Squared, within 1e-7 of the distance: an error of a rounding in either parameter moves along nearly parallel lines only.
[[nodiscard]] inline double rough_segments(const dvec3& p, const dvec3& u, const dvec3& q, const dvec3& v) {
    const auto on = [](const dvec3& x, const dvec3& from, const dvec3& along) {
        const double l = glm::dot(along, along);
        return from + (l > 0.0 ? std::clamp(glm::dot(x - from, along) / l, 0.0, 1.0) : 0.0) * along;
    };
    const auto length = [](const dvec3& d) { return std::sqrt(glm::dot(d, d)); };
    double best =
        std::min({length(on(p, q, v) - p), length(on(p + u, q, v) - (p + u)), length(on(q, p, u) - q), length(on(q + v, p, u) - (q + v))});
    const dvec3 n = glm::cross(u, v), w = q - p;
    const double nn = glm::dot(n, n);
    if (nn > 0.0) {
        const double s = glm::dot(glm::cross(w, v), n) / nn;
        const dvec3 x = p + std::clamp(s, 0.0, 1.0) * u;
        best = std::min(best, length(on(x, q, v) - x));
    }
    return best;
}

inline bool enters(const Solid& a, const Rough& ra, const Solid& b, const Rough& rb) {
    for (const Vec& p : a.corners) {
        if (inside(p, b)) return true;
    }
    for (const auto& f : b.faces) {
        const dvec3 n = glm::cross(rb[f[1]] - rb[f[0]], rb[f[2]] - rb[f[0]]);
        for (const auto& e : a.edges) {
            const double p = glm::dot(n, ra[e[0]] - rb[f[0]]), q = glm::dot(n, ra[e[1]] - rb[f[0]]);
            if (std::min(p, q) > kPlainly || std::max(p, q) < -kPlainly) continue;
            if (crosses(a.corners[e[0]], a.corners[e[1]], b.corners[f[0]], b.corners[f[1]], b.corners[f[2]])) return true;
        }
    }
    return false;
}

}  // namespace detail

/// The squared distance of the cores; 0 where they overlap.
[[nodiscard]] inline Rational core_distance_sq(const Solid& a, const Solid& b) {
    Rational size = 0;
    for (const Solid* s : {&a, &b}) {
        for (const Vec& p : s->corners) size = std::max(size, largest(p - a.corners[0]));
    }
    if (size.sign() == 0) return 0;
    const detail::Rough ra(a, a.corners[0], size), rb(b, a.corners[0], size);
    if (detail::enters(a, ra, b, rb) || detail::enters(b, rb, a, ra)) return 0;
    Rational best = length_sq(a.corners[0] - b.corners[0]);
    double rough_best = std::sqrt(glm::dot(rb[0] - ra[0], rb[0] - ra[0]));
    const auto edges = [&](const auto& visit) {
        for (const auto& e : a.edges) {
            for (const auto& f : b.edges) {
                visit(e, f, detail::rough_segments(ra[e[0]], ra[e[1]] - ra[e[0]], rb[f[0]], rb[f[1]] - rb[f[0]]));
            }
        }
    };
    edges([&](const auto&, const auto&, double rough) { rough_best = std::min(rough_best, rough); });
    edges([&](const auto& e, const auto& f, double rough) {
        if (rough > rough_best + detail::kPlainly) return;
        const Vec &p = a.corners[e[0]], &q = b.corners[f[0]];
        best = std::min(best, detail::segments_sq(p, a.corners[e[1]] - p, q, b.corners[f[1]] - q));
    });
    const auto corners_against = [&](const Solid& x, const detail::Rough& rx, const Solid& y, const detail::Rough& ry) {
        for (std::size_t k = 0; k < x.corners.size(); ++k) {
            for (const auto& f : y.faces) {
                // The plane is nearer than the triangle.
                const dvec3 n = glm::cross(ry[f[1]] - ry[f[0]], ry[f[2]] - ry[f[0]]);
                if (std::fabs(glm::dot(n, rx[k] - ry[f[0]])) >
                    (rough_best + detail::kPlainly) * std::sqrt(glm::dot(n, n)) + detail::kPlainly)
                    continue;
                best = std::min(best, distance_sq(x.corners[k], y.corners[f[0]], y.corners[f[1]], y.corners[f[2]]));
            }
            if (!y.faces.empty()) continue;
            for (const auto& e : y.edges) best = std::min(best, distance_sq(x.corners[k], y.corners[e[0]], y.corners[e[1]]));
        }
    };
    corners_against(a, ra, b, rb);
    corners_against(b, rb, a, ra);
    return best;
}

/// The squared distance of a point from a core.
[[nodiscard]] inline Rational core_distance_sq(const Vec& p, const Solid& s) { return core_distance_sq(Solid{{p}, {}, {}, false, 0}, s); }

}  // namespace carom::exact
