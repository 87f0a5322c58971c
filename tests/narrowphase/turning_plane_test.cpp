// Half-spaces that turn against every bounded shape: never late, near where they touch, judged by the lowest point in long double.
#include <carom/collision/convex_hull.hpp>
#include <carom/core/math.hpp>
#include <carom/narrowphase/time_of_impact.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace carom {
namespace {

using Real = long double;
using rvec3 = glm::vec<3, Real>;

struct Turn {
    rvec3 axis;
    Real angle;
    [[nodiscard]] rvec3 operator()(const rvec3& v) const {  // Rodrigues
        const Real c = std::cos(angle), s = std::sin(angle);
        return c * v + s * glm::cross(axis, v) + (Real(1) - c) * glm::dot(axis, v) * axis;
    }
};

Turn turn_of(const dvec3& rotation, double t) {
    const rvec3 r(rotation);
    const Real length = std::sqrt(glm::dot(r, r));
    return length > Real(0) ? Turn{r / length, Real(t) * length} : Turn{rvec3{1, 0, 0}, Real(0)};
}

rvec3 turned(const dquat& q, const rvec3& v) {
    const rvec3 u{q.x, q.y, q.z};
    const rvec3 w = Real(2) * glm::cross(u, v);
    return v + Real(q.w) * w + glm::cross(u, w);
}

/// Where a point or a direction of the shape's frame is at t.
rvec3 direction_at(const RigidMotion& m, const rvec3& v, double t) { return turn_of(m.rotation, t)(turned(m.start.orientation, v)); }
rvec3 point_at(const RigidMotion& m, const rvec3& p, double t) {
    const rvec3 pivot(m.pivot);
    return rvec3(m.start.position) + turned(m.start.orientation, pivot) + Real(t) * rvec3(m.translation) + direction_at(m, p - pivot, t);
}

/// The least of n . x over a shape at t.
Real lowest(const Shape& shape, const RigidMotion& m, const rvec3& n, double t) {
    const auto along = [&](const rvec3& v) { return glm::dot(n, direction_at(m, v, t)); };
    const Real centre = glm::dot(n, point_at(m, rvec3{0}, t)), y = along({0, 1, 0});
    const Real across = std::sqrt(std::max(Real(0), Real(1) - y * y));
    if (const auto* s = std::get_if<Sphere>(&shape)) return centre - Real(s->radius);
    if (const auto* b = std::get_if<Box>(&shape)) {
        return centre - Real(b->half_extents.x) * std::abs(along({1, 0, 0})) - Real(b->half_extents.y) * std::abs(y) -
               Real(b->half_extents.z) * std::abs(along({0, 0, 1}));
    }
    if (const auto* c = std::get_if<Capsule>(&shape)) return centre - Real(c->radius) - Real(c->half_segment) * std::abs(y);
    if (const auto* c = std::get_if<Cylinder>(&shape)) return centre - Real(c->half_height) * std::abs(y) - Real(c->radius) * across;
    if (const auto* c = std::get_if<Cone>(&shape)) {
        const Real tip = Real(c->half_height) * y;
        return centre + std::min(tip, -tip - Real(c->radius) * across);
    }
    Real least = 1e30L;
    for (const vec3& v : std::get<ConvexHullPtr>(shape)->vertices()) least = std::min(least, glm::dot(n, point_at(m, rvec3(v), t)));
    return least;
}

/// How far a shape is above a plane at t.
Real height(const Shape& shape, const RigidMotion& m, const Plane& plane, const RigidMotion& mp, double t) {
    const rvec3 n(plane.normal);
    const Real length = std::sqrt(glm::dot(n, n));
    const rvec3 up = direction_at(mp, n / length, t);
    return lowest(shape, m, up, t) - glm::dot(up, point_at(mp, (Real(plane.offset) / (length * length)) * n, t));
}

Shape any_shape(Random& random, int kind) {
    const auto size = [&] { return static_cast<float>(random.range(0.05, 0.6)); };
    switch (kind % 6) {
        case 0:
            return Sphere{size()};
        case 1:
            return Box{{size(), size(), size()}};
        case 2:
            return Capsule{size(), size()};
        case 3:
            return Cylinder{size(), size()};
        case 4:
            return Cone{size(), size()};
        default: {
            std::vector<vec3> points;
            for (int i = 0; i < 12; ++i) points.push_back(size() * vec3(test::random_direction(random)));
            return *ConvexHull::build(points);
        }
    }
}

struct Scene {
    Shape shape;
    RigidMotion motion;
    Plane plane;
    RigidMotion plane_motion;

    Scene(Random& random, int k) : shape(any_shape(random, k)) {
        const double spin = k % 5 == 0 ? 0.0 : k % 7 == 0 ? 12.0 : 1.5, far = k % 11 == 0 ? 100.0 : 4.0;
        plane = Plane{static_cast<float>(random.range(0.3, 3.0)) * vec3(test::random_direction(random)),
                      static_cast<float>(random.range(-2.0, 2.0))};
        plane_motion.start = {random.range(0.0, 3.0) * test::random_direction(random), test::random_rotation(random)};
        plane_motion.rotation = (k % 13 == 0 ? 15.0 : random.range(0.0, 2.5)) * test::random_direction(random);
        plane_motion.pivot = random.range(0.0, k % 3 == 0 ? 5.0 : 0.5) * test::random_direction(random);
        plane_motion.translation = random.range(0.0, 3.0) * test::random_direction(random);
        motion.start.orientation = test::random_rotation(random);
        motion.rotation = spin * test::random_direction(random);
        motion.pivot = 0.1 * test::random_direction(random);
        motion.translation = random.range(0.0, 3.0) * test::random_direction(random);
        // In front of it, but for a few.
        const dvec3 up(direction_at(plane_motion, rvec3(glm::normalize(dvec3(plane.normal))), 0.0)),
            beside = far * random.unit() * test::random_direction(random);
        motion.start.position = plane_motion.start.position + beside;
        const double above = static_cast<double>(height(shape, motion, plane, plane_motion, 0.0));
        const double wanted = k % 17 == 0 ? random.range(-0.3, 0.1) : random.range(0.001, 0.5 + 0.5 * far);
        motion.start.position += (wanted - above) * up;
    }
    [[nodiscard]] Real height_at(double t) const { return height(shape, motion, plane, plane_motion, t); }
    [[nodiscard]] double rounding() const {
        const double size = glm::length(motion.start.position - plane_motion.start.position) + glm::length(motion.translation) +
                            glm::length(plane_motion.translation) + glm::length(plane_motion.pivot) +
                            3.0 * (1.0 + std::abs(static_cast<double>(plane.offset)) / 0.3);
        return 1.4e-14 * (1.0 + glm::length(motion.rotation) + glm::length(plane_motion.rotation)) * size;
    }
};

void expect_kept(double separation, std::uint64_t seed) {
    Random random(seed);
    int touching = 0, separated = 0, overlapping = 0, checks = 0;
    constexpr int kCases = 3000;
    for (int k = 0; k < kCases; ++k) {
        const Scene scene(random, k);
        const TimeOfImpactSettings settings{.separation = separation};
        const Shape plane = scene.plane;
        const Impact hit = time_of_impact(scene.shape, scene.motion, plane, scene.plane_motion, settings);
        const Impact other = time_of_impact(plane, scene.plane_motion, scene.shape, scene.motion, settings);
        ASSERT_EQ(hit.status, other.status) << k;
        ASSERT_EQ(hit.t, other.t) << k;
        ASSERT_NE(hit.status, ImpactStatus::Invalid) << k;
        ASSERT_NE(hit.status, ImpactStatus::Clamped) << k;
        checks += hit.checks;
        touching += hit.status == ImpactStatus::Touching;
        separated += hit.status == ImpactStatus::Separated;
        overlapping += hit.status == ImpactStatus::Overlapping;
        if (hit.status == ImpactStatus::Overlapping) {
            ASSERT_LE(scene.height_at(0.0), separation + 2.0 * scene.rounding()) << k;
            continue;
        }
        for (int i = 0; i <= 300; ++i) ASSERT_GT(scene.height_at(hit.t * i / 300), separation - scene.rounding()) << k << " at " << i;
        if (hit.status == ImpactStatus::Separated) continue;
        const double near = 4e-9 + 8.0 * scene.rounding();
        ASSERT_LT(scene.height_at(hit.t), separation + near) << k;
        // From the shape to the plane, and on that.
        const rvec3 n(scene.plane.normal);
        const rvec3 up = direction_at(scene.plane_motion, n / std::sqrt(glm::dot(n, n)), hit.t);
        ASSERT_LT(glm::length(hit.normal + dvec3(up)), 1e-12) << k;
        const Real foot = glm::dot(up, point_at(scene.plane_motion, (Real(scene.plane.offset) / glm::dot(n, n)) * n, hit.t));
        ASSERT_LT(std::abs(glm::dot(up, rvec3(hit.point)) - foot), 1e-7) << k;
    }
    EXPECT_GT(touching, 800);
    EXPECT_GT(separated, 500);
    EXPECT_GT(overlapping, separation > 0.0 ? 20 : 50);
    EXPECT_LT(checks, 8 * kCases);
    std::printf("turning planes: %.2f checks, %d touching, %d separated, %d overlapping\n", 1.0 * checks / kCases, touching, separated,
                overlapping);
}

TEST(TurningPlane, NoShapeComesToItBeforeTheTime) { expect_kept(0.0, 0x7a1); }
TEST(TurningPlane, NoneComesWithinASeparation) { expect_kept(0.05, 0x7a2); }

TEST(TurningPlane, ABallIsMetAtItsAngle) {
    const Shape ball = Sphere{0.05f}, floor = Plane{{0.0f, 2.0f, 0.0f}, 0.0f};
    const RigidMotion still{.start = {{5.0, 2.0, 1.0}, kIdentityRotation}};
    const double angle = std::atan2(2.0, 5.0) - std::asin(static_cast<double>(0.05f) / std::sqrt(29.0));
    for (const double turn : {0.5, 1.0, 40.0 * kPi}) {
        const Impact hit = time_of_impact(ball, still, floor, {.rotation = {0.0, 0.0, turn}});
        ASSERT_EQ(hit.status, ImpactStatus::Touching);
        EXPECT_LE(hit.t, angle / turn * (1.0 + 1e-13));
        EXPECT_NEAR(hit.t * turn, angle, 1e-8);
    }
    // The other way round it comes from behind, half a turn later; about its own normal it stays where it is.
    const Impact back = time_of_impact(ball, still, floor, {.rotation = {0.0, 0.0, -4.0}});
    EXPECT_NEAR(4.0 * back.t, kPi - std::atan2(2.0, 5.0) - std::asin(static_cast<double>(0.05f) / std::sqrt(29.0)), 1e-8);
    EXPECT_EQ(time_of_impact(ball, still, floor, {.rotation = {0.0, 100.0, 0.0}}).status, ImpactStatus::Separated);
    EXPECT_EQ(time_of_impact(ball, still, floor, {.rotation = {0.0, 0.0, angle - 1e-6}}).status, ImpactStatus::Separated);
}

// Both go round together: what is above the plane stays there, at any rate.
TEST(TurningPlane, WhatTurnsWithItIsNotMet) {
    const Shape box = Box{{0.5f, 0.1f, 0.3f}}, floor = Plane{{0.0f, 1.0f, 0.0f}, 0.0f};
    for (const double turn : {1.0, 30.0}) {
        const dvec3 rotation{0.3 * turn, 0.1, turn};
        const RigidMotion about{.start = {{0.0, 0.100001, 0.0}, kIdentityRotation}, .rotation = rotation, .pivot = {0.0, -0.100001, 0.0}};
        const Impact hit = time_of_impact(box, about, floor, {.rotation = rotation});
        EXPECT_EQ(hit.status, ImpactStatus::Separated);
        EXPECT_LE(hit.checks, 2);
    }
}

}  // namespace
}  // namespace carom
