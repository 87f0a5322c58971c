// Placed shapes in exact rationals: what distance() and overlaps() are judged by.
//
//   exact::Solid a = exact::solid(shape_a, pose_a), b = exact::solid(shape_b, pose_b);
//   EXPECT_TRUE(exact::core_distance_sq(a, b) > exact::square(a.radius + b.radius));   // apart
#pragma once

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/pose.hpp>

#include <support/exact_distance.hpp>

#include <vector>

namespace carom::exact {

/// v rotated by the quaternion as its numbers stand: v + 2 w (u x v) + 2 u x (u x v).
[[nodiscard]] inline Vec rotated(const dquat& q, const Vec& v) {
    const Vec u{number(q.x), number(q.y), number(q.z)}, t = Rational(2) * cross(u, v);
    return v + number(q.w) * t + cross(u, t);
}
[[nodiscard]] inline Vec placed(const Pose& pose, const Vec& v) { return vec(pose.position) + rotated(pose.orientation, v); }

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
    const ConvexHull& hull = **std::get_if<ConvexHullPtr>(&shape);
    Solid s;
    s.closed = true;
    for (const vec3& v : hull.vertices()) s.corners.push_back(placed(pose, vec(v)));
    for (std::uint32_t e = 0; e < hull.edges().size(); e += 2) s.edges.push_back({hull.edges()[e].origin, hull.edges()[e + 1].origin});
    for (const ConvexHull::Face& face : hull.faces()) {
        std::uint32_t e = face.first_edge;
        const std::size_t first = hull.edges()[e].origin;
        e = hull.edges()[e].next;
        for (std::uint32_t k = 2; k < face.edge_count; ++k, e = hull.edges()[e].next) {
            s.faces.push_back({first, hull.edges()[e].origin, hull.edges()[hull.edges()[e].next].origin});
        }
    }
    return s;
}

}  // namespace carom::exact
