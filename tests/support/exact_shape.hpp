// Placed shapes in exact rationals: what distance() and overlaps() are judged by.
//
//   exact::Solid a = exact::solid(shape_a, pose_a), b = exact::solid(shape_b, pose_b);
//   EXPECT_TRUE(exact::core_distance_sq(a, b) > exact::square(a.radius + b.radius));   // apart
#pragma once

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/pose.hpp>

#include <support/exact_distance.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>
#include <vector>

namespace carom::exact {

/// v rotated by the quaternion as its numbers stand: v + 2 w (u x v) + 2 u x (u x v).
[[nodiscard]] inline Vec rotated(const dquat& q, const Vec& v) {
    const Vec u{number(q.x), number(q.y), number(q.z)}, t = Rational(2) * cross(u, v);
    return v + number(q.w) * t + cross(u, t);
}
[[nodiscard]] inline Vec placed(const Pose& pose, const Vec& v) { return vec(pose.position) + rotated(pose.orientation, v); }

/// The convex hull of its corners, by trying all triples: a triangle with no corner above it is a face, with others where four corners or
/// more are in one plane. The faces of a ConvexHull would not do: those of four corners and more are flat to rounding only.
[[nodiscard]] inline Solid hull_of_corners(std::vector<Vec> corners) {
    Solid s{std::move(corners), {}, {}, true, 0};
    const std::size_t count = s.corners.size();
    Rational size = 0;
    for (const Vec& p : s.corners) size = std::max(size, largest(p - s.corners[0]));
    const detail::Rough rough(s, s.corners[0], size.sign() == 0 ? Rational(1) : size);
    const auto above = [&](std::size_t p, std::size_t i, std::size_t j, std::size_t k) {
        const double n = glm::dot(glm::cross(rough[j] - rough[i], rough[k] - rough[i]), rough[p] - rough[i]);
        if (std::abs(n) > 1e-12) return n > 0.0;  // of numbers up to 2, each within 2^-52
        const Vec& from = s.corners[i];
        return dot(cross(s.corners[j] - from, s.corners[k] - from), s.corners[p] - from).sign() > 0;
    };
    std::set<std::array<std::size_t, 2>> edges;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = i + 1; j < count; ++j) {
            for (std::size_t k = i + 1; k < count; ++k) {
                if (k == j) continue;
                bool face = length_sq(cross(s.corners[j] - s.corners[i], s.corners[k] - s.corners[i])).sign() != 0;
                for (std::size_t p = 0; p < count && face; ++p) face = p == i || p == j || p == k || !above(p, i, j, k);
                if (!face) continue;
                s.faces.push_back({i, j, k});
                for (const auto& e : {std::array{i, j}, std::array{std::min(j, k), std::max(j, k)}, std::array{i, k}}) edges.insert(e);
            }
        }
    }
    s.edges.assign(edges.begin(), edges.end());
    return s;
}

/// A sphere, box, capsule or hull.
[[nodiscard]] inline Solid solid(const Shape& shape, const Pose& pose) {
    if (const Sphere* sphere = std::get_if<Sphere>(&shape)) return {{vec(pose.position)}, {}, {}, false, number(sphere->radius)};
    if (const Capsule* capsule = std::get_if<Capsule>(&shape)) {
        const Vec up{0, number(capsule->half_segment), 0};
        return {{placed(pose, -up), placed(pose, up)}, {{0, 1}}, {}, false, number(capsule->radius)};
    }
    if (const Box* box = std::get_if<Box>(&shape)) {
        std::vector<Vec> corners;
        const Vec h = vec(box->half_extents);
        for (int k = 0; k < 8; ++k) {
            corners.push_back(placed(pose, {(k & 1) ? h.x : -h.x, (k & 2) ? h.y : -h.y, (k & 4) ? h.z : -h.z}));
        }
        return box_of(std::move(corners));
    }
    std::vector<Vec> corners;
    for (const vec3& v : (*std::get_if<ConvexHullPtr>(&shape))->vertices()) corners.push_back(placed(pose, vec(v)));
    return hull_of_corners(std::move(corners));
}

}  // namespace carom::exact
