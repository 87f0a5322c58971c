// Times of impact of shapes that move and turn: never late, close when they touch, and honest about the rest.
#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/core/math.hpp>
#include <carom/narrowphase/time_of_impact.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

namespace carom {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Shape any_shape(Random& random, int kind) {
    const auto size = [&] { return static_cast<float>(random.range(0.1, 0.6)); };
    switch (kind % 6) {
        case 0: return Sphere{size()};
        case 1: return Box{{size(), size(), size()}};
        case 2: return Capsule{size(), size()};
        case 3: return Cylinder{size(), size()};
        case 4: return Cone{size(), size()};
        default: {
            std::vector<vec3> points;
            for (int i = 0; i < 12; ++i) points.push_back(size() * vec3(test::random_direction(random)));
            return *ConvexHull::build(points);
        }
    }
}

RigidMotion any_motion(Random& random, double distance, double speed, double spin) {
    RigidMotion m;
    m.start = {distance * test::random_direction(random), test::random_rotation(random)};
    m.translation = speed * test::random_direction(random) - m.start.position * random.range(0.5, 2.5);
    m.rotation = spin * random.unit() * test::random_direction(random);
    m.pivot = 0.1 * test::random_direction(random);
    return m;
}

/// @return how a result contradicts distances at sampled times, or "".
std::string fault(const Shape& a, const RigidMotion& ma, const Shape& b, const RigidMotion& mb, const Impact& impact, double separation,
                  double near) {
    if (impact.status == ImpactStatus::Invalid) return "invalid";
    const double end = may_touch(impact.status) ? impact.t : 1.0;
    for (int k = 0; k <= 200; ++k) {
        const double s = end * k / 200;
        const DistanceResult d = distance(a, pose_at(ma, s), b, pose_at(mb, s));
        const bool met = d.status == DistanceStatus::Overlap || d.upper < separation;
        if (met && !(impact.status == ImpactStatus::Overlapping)) return "met at " + std::to_string(s) + " before " + std::to_string(end);
    }
    if (impact.status != ImpactStatus::Touching) return "";
    const DistanceResult d = distance(a, pose_at(ma, end), b, pose_at(mb, end));
    if (d.status != DistanceStatus::Overlap && d.lower > separation + near) return "not near: " + std::to_string(d.lower);
    if (std::abs(glm::length(impact.normal) - 1.0) > 1e-9) return "no normal";
    // The contact is a point of the world that both are near.
    const RigidMotion there{.start = {impact.point, kIdentityRotation}};
    const Shape dot = Sphere{1e-6f};
    if (distance(b, pose_at(mb, end), dot, there.start).lower > 1e-5) return "the point is not on B";
    if (distance(a, pose_at(ma, end), dot, there.start).lower > separation + near + 1e-5) return "the point is not on A";
    return "";
}

TEST(TimeOfImpact, NoPairMeetsBeforeIt) {
    Random random(0x701);
    int touching = 0, separated = 0, clamped = 0, checks = 0;
    for (int i = 0; i < 36 * 12; ++i) {
        const Shape a = any_shape(random, i), b = any_shape(random, i / 6);
        const double spin = i % 3 == 0 ? 0.0 : i % 3 == 1 ? 2.0 : 40.0;
        const RigidMotion ma = any_motion(random, 2.5, 0.5, spin), mb = any_motion(random, 0.3, 0.2, i % 2 == 0 ? 0.0 : spin);
        const double separation = i % 5 == 0 ? 0.05 : 0.0;
        const Impact impact = time_of_impact(a, ma, b, mb, {.separation = separation, .most_checks = 400});
        ASSERT_EQ(fault(a, ma, b, mb, impact, separation, 1e-6), "")
            << i << " " << to_string(type_of(a)) << " " << to_string(type_of(b)) << " " << to_string(impact.status);
        touching += impact.status == ImpactStatus::Touching ? 1 : 0;
        separated += impact.status == ImpactStatus::Separated ? 1 : 0;
        clamped += impact.status == ImpactStatus::Clamped ? 1 : 0;
        checks += impact.checks;
    }
    EXPECT_GT(touching, 100);
    EXPECT_GT(separated, 30);
    EXPECT_LT(clamped, 4);
    RecordProperty("checks", checks);
}

/// Neighbours in a falling crowd: near each other, both turning a little. A plane that stands creeps towards their contact.
TEST(TimeOfImpact, NeighboursThatTurnTakeFewSteps) {
    Random random(0xc10d);
    int touching = 0, checks = 0, most = 0;
    for (int i = 0; i < 36 * 20; ++i) {
        const Shape a = any_shape(random, i), b = any_shape(random, i / 6);
        RigidMotion ma{.start = {dvec3{0.0}, test::random_rotation(random)}}, mb{.start = {3.0 * test::random_direction(random), test::random_rotation(random)}};
        const DistanceResult apart = distance(a, ma.start, b, mb.start);
        mb.start.position -= (apart.lower - random.range(1e-4, 0.05)) * apart.normal;
        ma.rotation = random.range(0.1, 0.5) * test::random_direction(random), mb.rotation = random.range(0.1, 0.5) * test::random_direction(random);
        ma.translation = 0.1 * test::random_direction(random), mb.translation = 0.1 * test::random_direction(random);
        const Impact impact = time_of_impact(a, ma, b, mb, {.tolerance = 1e-5, .most_checks = 1000});
        ASSERT_EQ(fault(a, ma, b, mb, impact, 0.0, 2e-5), "") << i << " " << to_string(type_of(a)) << " " << to_string(type_of(b));
        if (impact.status != ImpactStatus::Touching) continue;
        ++touching;
        checks += impact.checks;
        most = std::max(most, impact.checks);
    }
    std::printf("steps to a contact between neighbours: mean %.2f, most %d of %d\n", static_cast<double>(checks) / touching, most, touching);
    EXPECT_GT(touching, 150);
    EXPECT_LT(checks, 6 * touching);
    EXPECT_LT(most, 60);
}

TEST(TimeOfImpact, WithoutTurningItIsTheSweep) {
    Random random(0x5eee);
    int touching = 0;
    for (int i = 0; i < 200; ++i) {
        const Sphere ball{static_cast<float>(random.range(0.1, 0.4))};
        const Box box{vec3(glm::abs(test::random_direction(random))) + 0.05f};
        const RigidMotion m = any_motion(random, 3.0, 1.0, 0.0);
        const Pose centre{m.start.position, kIdentityRotation};
        const Impact sweep = geo::sweep(geo::Sphere<double>{m.start.position, static_cast<double>(ball.radius)}, m.translation,
                                        geo::Aabb<double>{-dvec3(box.half_extents), dvec3(box.half_extents)});
        const Impact search = time_of_impact(Shape{ball}, {.start = centre, .translation = m.translation}, Shape{box}, {});
        ASSERT_EQ(search.status, sweep.status) << i;
        ASSERT_LE(search.t, sweep.t + 1e-13) << i;
        if (sweep.status != ImpactStatus::Touching) continue;
        ++touching;
        // Within 1e-9 of the sizes along the normal; on grazing paths that is longer along the path.
        const double speed = std::abs(glm::dot(sweep.normal, m.translation));
        EXPECT_NEAR(search.t, sweep.t, speed > 0.3 ? 2e-8 : 1e-3) << i;
    }
    EXPECT_GT(touching, 40);
}

/// Contacts to the very end of the motion, and none for who asks for less.
TEST(TimeOfImpact, WhatMeetsAtTheLastIsMet) {
    Random random(0x1a57);
    for (int i = 0; i < 36 * 8; ++i) {
        const Shape a = any_shape(random, i), b = any_shape(random, i / 6);
        const RigidMotion still{.start = {dvec3{0.0}, test::random_rotation(random)}};
        RigidMotion comes{.start = {4.0 * test::random_direction(random), test::random_rotation(random)}};
        const DistanceResult apart = distance(a, still.start, b, comes.start);
        const double met = i % 4 == 0 ? 1.0 - 1e-6 : random.range(0.9, 1.0);
        comes.translation = -(apart.lower / met) * apart.normal;  // along the distance, which the two points of it go
        const Impact impact = time_of_impact(a, still, b, comes);
        ASSERT_EQ(impact.status, ImpactStatus::Touching) << i << " " << to_string(type_of(a)) << " " << to_string(type_of(b));
        EXPECT_LE(impact.t, met * (1.0 + 1e-12)) << i;
        EXPECT_NEAR(impact.t, met, 1e-6) << i;
        EXPECT_EQ(time_of_impact(a, still, b, comes, {.until = 0.99 * met}).status, ImpactStatus::Separated) << i;
        comes.translation *= 0.999 * met;
        EXPECT_EQ(time_of_impact(a, still, b, comes).status, ImpactStatus::Separated) << i;
    }
}

/// A motion that ends where it began, turned by whole turns: only the way between hits.
TEST(TimeOfImpact, ItFollowsTheScrewNotTheShortArc) {
    const Shape rod = Box{{1.0f, 0.001f, 0.001f}}, ball = Sphere{0.05f};
    for (const double turns : {1.0, 2.0, 6.5, 26.0}) {
        const RigidMotion spin{.rotation = {0, 0, 2.0 * kPi * turns}};
        const RigidMotion above{.start = {{0, 0.9, 0}, kIdentityRotation}};
        const Impact hit = time_of_impact(rod, spin, ball, above, {.most_checks = 512});
        ASSERT_EQ(hit.status, ImpactStatus::Touching) << turns;
        // The rod's side meets the ball when the angle between rod and ball has sine (0.05 + 0.001) / 0.9.
        const double angle = 0.5 * kPi - std::asin(0.051 / 0.9);
        EXPECT_LE(hit.t, angle / (2.0 * kPi * turns) + 1e-15) << turns;
        EXPECT_NEAR(hit.t, angle / (2.0 * kPi * turns), 1e-7) << turns;
        const RigidMotion clear{.start = {{0, 1.06, 0}, kIdentityRotation}};
        EXPECT_EQ(time_of_impact(rod, spin, ball, clear, {.most_checks = 4096}).status, ImpactStatus::Separated) << turns;
    }
}

/// A rod a thousand times as long as thick, at 1e4 rad/s over 1/240 s, and a ball that flies into its disc.
TEST(TimeOfImpact, AThinRodSpinningFastIsNotPassed) {
    const Shape rod = Box{{0.5f, 0.0005f, 0.0005f}}, ball = Sphere{0.01f};
    Random random(0x20d);
    int met = 0;
    for (int i = 0; i < 60; ++i) {
        const RigidMotion spin{.start = {dvec3{0.0}, test::random_rotation(random)}, .rotation = (1e4 / 240.0) * test::random_direction(random)};
        const dvec3 from = 1.2 * test::random_direction(random);
        const RigidMotion fly{.start = {from, kIdentityRotation}, .translation = -from * random.range(0.2, 2.0)};
        const Impact impact = time_of_impact(rod, spin, ball, fly, {.most_checks = 2000});
        ASSERT_NE(impact.status, ImpactStatus::Invalid);
        const double end = may_touch(impact.status) ? impact.t : 1.0;
        for (int k = 0; k < 1500; ++k) {
            const double s = end * k / 1500;
            ASSERT_NE(distance(rod, pose_at(spin, s), ball, pose_at(fly, s)).status, DistanceStatus::Overlap) << i << " at " << s;
        }
        met += impact.status == ImpactStatus::Touching ? 1 : 0;
    }
    EXPECT_GT(met, 20);
}

TEST(TimeOfImpact, APlaneIsMetByTheLowestPoint) {
    const Shape floor = Plane{{0, 1, 0}, 0.5f}, box = Box{{0.5f, 0.5f, 0.5f}};
    const RigidMotion fall{.start = {{3, 4, -2}, kIdentityRotation}, .translation = {1, -6, 0}};
    for (const bool swapped : {false, true}) {
        const Impact hit = swapped ? time_of_impact(floor, {}, box, fall) : time_of_impact(box, fall, floor, {});
        ASSERT_EQ(hit.status, ImpactStatus::Touching);
        EXPECT_LE(hit.t, 0.5);
        EXPECT_NEAR(hit.t, 0.5, 1e-8);
        EXPECT_NEAR(hit.normal.y, swapped ? 1.0 : -1.0, 1e-12);
        EXPECT_NEAR(hit.point.y, 0.5, 1e-7);
    }
    // The point is on B, however far apart they touch.
    for (const bool swapped : {false, true}) {
        const TimeOfImpactSettings apart{.separation = 0.25};
        const Impact hit = swapped ? time_of_impact(floor, {}, box, fall, apart) : time_of_impact(box, fall, floor, {}, apart);
        ASSERT_EQ(hit.status, ImpactStatus::Touching);
        EXPECT_NEAR(hit.point.y, swapped ? 0.75 : 0.5, 1e-7);
    }
    // A corner turns down onto it.
    const RigidMotion tip{.start = {{0, 1.1, 0}, kIdentityRotation}, .rotation = {0, 0, 0.5 * kPi}};
    const Impact corner = time_of_impact(box, tip, floor, {});
    ASSERT_EQ(corner.status, ImpactStatus::Touching);
    const double angle = std::acos(0.6 / std::sqrt(0.5));  // of the corner below the centre, from straight down
    EXPECT_LE(corner.t, (0.25 * kPi - angle) / (0.5 * kPi) + 1e-15);
    EXPECT_NEAR(corner.t, (0.25 * kPi - angle) / (0.5 * kPi), 1e-7);
    EXPECT_EQ(time_of_impact(box, {.start = {{0, 0.9, 0}, kIdentityRotation}}, floor, {}).status, ImpactStatus::Overlapping);
    const RigidMotion whirl{.start = {{0, 1.3, 0}, kIdentityRotation}, .rotation = {0, 0, 90}};
    EXPECT_EQ(time_of_impact(box, whirl, floor, {}, {.most_checks = 1000}).status, ImpactStatus::Separated);
}

TEST(TimeOfImpact, FastBodiesDoNotTunnelThroughThinWalls) {
    Random random(0x3a11);
    const Shape wall = Box{{5.0f, 5.0f, 0.0005f}};
    for (int i = 0; i < 600; ++i) {
        const Shape body = any_shape(random, i);
        const double speed = std::pow(10.0, random.range(1.7, 4.0)) / 60.0;
        const RigidMotion shot{.start = {{random.range(-1, 1), random.range(-1, 1), -1.0 - random.unit()}, test::random_rotation(random)},
                               .translation = {0, 0, 4.0 + speed},
                               .rotation = random.range(0.0, 100.0) * test::random_direction(random)};
        const Impact impact = time_of_impact(body, shot, wall, {}, {.most_checks = 1000});
        ASSERT_TRUE(may_touch(impact.status)) << i;
        ASSERT_LT(pose_at(shot, impact.t).position.z, 0.0) << i;
    }
}

TEST(TimeOfImpact, AMeshIsMetAtItsFirstTriangle) {
    Random random(0x3e57);
    std::vector<vec3> vertices;
    std::vector<TriangleMesh::Triangle> triangles;
    for (std::uint32_t i = 0; i < 40; ++i) {
        const dvec3 p = 1.5 * dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
        for (int k = 0; k < 3; ++k) vertices.push_back(vec3(p + 0.4 * test::random_direction(random)));
        triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const TriangleMeshPtr mesh = *TriangleMesh::build(vertices, triangles);
    // Each triangle as a thin hull stands in for it: they can only meet later than it does by the thickness.
    int touching = 0, separated = 0;
    for (int i = 0; i < 60; ++i) {
        const Shape body = any_shape(random, i);
        RigidMotion ma = any_motion(random, 3.5, 0.5, i % 2 == 0 ? 0.0 : 5.0), mb;
        if (i % 3 == 0) mb = {.start = {dvec3{0.1}, test::random_rotation(random)}, .translation = {0.1, 0.2, 0.0}, .rotation = {0.2, 0.1, 1.0}};
        const geo::MeshImpact found = time_of_impact(body, ma, *mesh, mb, {.most_checks = 1000});
        double first = 2.0;
        for (std::uint32_t k = 0; k < 40; ++k) {
            const auto c = mesh->corners(k);
            const dvec3 n = glm::normalize(glm::cross(dvec3(c[1] - c[0]), dvec3(c[2] - c[0])));
            std::vector<vec3> slab;
            for (const vec3& p : c) slab.push_back(p + vec3(1e-4 * n)), slab.push_back(p - vec3(1e-4 * n));
            const auto hull = ConvexHull::build(slab);
            if (!hull) continue;
            const Impact one = time_of_impact(body, ma, Shape{*hull}, mb, {.most_checks = 1000});
            if (may_touch(one.status)) first = std::min(first, one.t);
        }
        ++(may_touch(found.status) ? touching : separated);
        // The slabs are larger, so they are met no later; and not much earlier, but on grazing paths.
        ASSERT_TRUE(!may_touch(found.status) || first <= found.t + 1e-9) << i;
        ASSERT_TRUE(first <= 1.0 || found.status == ImpactStatus::Separated) << i;
        if (found.status != ImpactStatus::Touching) continue;
        const auto c = mesh->corners(found.triangle);
        const dvec3 local = inverse_transform_point(pose_at(mb, found.t), found.point);
        const Impact at = geo::sweep(geo::Sphere<double>{local, 1e-6}, dvec3{0.0}, geo::Triangle<double>{dvec3(c[0]), dvec3(c[1]), dvec3(c[2])});
        ASSERT_EQ(at.status, ImpactStatus::Overlapping) << i;
        ASSERT_LT(distance(body, pose_at(ma, found.t), Shape{Sphere{1e-6f}}, {found.point, kIdentityRotation}).lower, 1e-6) << i;
    }
    EXPECT_GT(touching, 15);
    EXPECT_GT(separated, 2);
    EXPECT_EQ(time_of_impact(Shape{Plane{}}, {}, *mesh, {}).status, ImpactStatus::Invalid);
    EXPECT_EQ(time_of_impact(Shape{Sphere{}}, {.translation = dvec3{kInfinity}}, *mesh, {}).status, ImpactStatus::Invalid);
}

TEST(TimeOfImpact, TheCapIsSaidAndEarly) {
    const Shape rod = Box{{1.0f, 0.01f, 0.01f}}, ball = Sphere{0.1f};
    const RigidMotion spin{.rotation = {0, 0, 40.0}}, fly{.start = {{0, 1.02, 0}, kIdentityRotation}, .translation = {0.0, -0.2, 0.0}};
    const Impact whole = time_of_impact(rod, spin, ball, fly, {.most_checks = 1000});
    ASSERT_EQ(whole.status, ImpactStatus::Touching);
    for (const int cap : {1, 2, 4}) {
        const Impact cut = time_of_impact(rod, spin, ball, fly, {.most_checks = cap});
        EXPECT_LE(cut.t, whole.t);
        EXPECT_LE(cut.checks, cap);
        EXPECT_TRUE(may_touch(cut.status));
    }
    EXPECT_EQ(time_of_impact(rod, spin, ball, fly, {.most_checks = 1}).status, ImpactStatus::Clamped);
}

TEST(TimeOfImpact, OverlapMotionlessAndTinyAreAnswered) {
    const Shape box = Box{{0.5f, 0.5f, 0.5f}}, dust = Sphere{1e-30f};
    const RigidMotion far{.start = {{4, 0, 0}, kIdentityRotation}};
    EXPECT_EQ(time_of_impact(box, {}, box, {.start = {{0.9, 0, 0}, kIdentityRotation}}).status, ImpactStatus::Overlapping);
    EXPECT_EQ(time_of_impact(box, {}, box, {.start = {{1.0, 0, 0}, kIdentityRotation}}).status, ImpactStatus::Overlapping);
    EXPECT_EQ(time_of_impact(box, {}, box, far).status, ImpactStatus::Separated);
    const Impact mote = time_of_impact(dust, {.translation = {8, 0, 0}}, box, far);
    ASSERT_EQ(mote.status, ImpactStatus::Touching);
    EXPECT_LE(mote.t, 3.5 / 8.0);
    EXPECT_NEAR(mote.t, 3.5 / 8.0, 1e-9);
    // Far from the world's origin nothing is lost but what the start poses have lost already.
    const dvec3 away{1e7, -1e7, 1e7};
    const Impact there = time_of_impact(box, {.start = {away, kIdentityRotation}, .translation = {8, 0, 0}}, box,
                                        {.start = {away + dvec3{4, 0, 0}, kIdentityRotation}});
    EXPECT_NEAR(there.t, 3.0 / 8.0, 1e-8);
}

TEST(TimeOfImpact, BadInputIsInvalid) {
    const Shape box = Box{{0.5f, 0.5f, 0.5f}}, hull = ConvexHullPtr{}, plane = Plane{};
    const RigidMotion still, far{.start = {{4, 0, 0}, kIdentityRotation}};
    for (const double bad : {kInfinity, std::numeric_limits<double>::quiet_NaN(), 1e71}) {
        for (const RigidMotion& m : {RigidMotion{.start = {dvec3{bad}, kIdentityRotation}}, RigidMotion{.translation = dvec3{bad}},
                                     RigidMotion{.rotation = dvec3{bad}}, RigidMotion{.pivot = dvec3{bad}}}) {
            EXPECT_EQ(time_of_impact(box, m, box, far).status, ImpactStatus::Invalid);
            EXPECT_EQ(time_of_impact(box, far, box, m).status, ImpactStatus::Invalid);
            EXPECT_EQ(time_of_impact(box, far, box, m).t, 0.0);
        }
    }
    EXPECT_EQ(time_of_impact(box, far, box, still, {.separation = -1.0}).status, ImpactStatus::Invalid);
    for (const double until : {-0.1, 1.1, std::nan("")}) {
        EXPECT_EQ(time_of_impact(box, far, box, still, {.until = until}).status, ImpactStatus::Invalid) << until;
    }
    EXPECT_EQ(time_of_impact(box, far, box, still, {.tolerance = kInfinity}).status, ImpactStatus::Invalid);
    EXPECT_EQ(time_of_impact(box, far, box, still, {.most_checks = 0}).status, ImpactStatus::Invalid);
    EXPECT_EQ(time_of_impact(hull, still, box, far).status, ImpactStatus::Invalid);
    EXPECT_EQ(time_of_impact(plane, still, plane, far).status, ImpactStatus::Invalid);
    EXPECT_EQ(time_of_impact(plane, {.rotation = {0, 1, 0}}, plane, far).status, ImpactStatus::Invalid);
}

TEST(TimeOfImpact, ShapesThatAreNoneAreInvalid) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
    const RigidMotion still, fly{.start = {{5, 0, 0}, kIdentityRotation}, .translation = {-10, 0, 0}};
    const Shape box = Box{{0.5f, 0.5f, 0.5f}};
    const auto mesh = TriangleMesh::build(std::vector<vec3>{{-1, -1, -1}, {1, -1, 1}, {0, 1, 1}}, std::vector<TriangleMesh::Triangle>{{0, 2, 1}});
    ASSERT_TRUE(mesh.has_value());
    for (const float bad : {kNan, kInf, -1.0f}) {
        for (const Shape& shape : {Shape{Sphere{bad}}, Shape{Box{{bad, 1, 1}}}, Shape{Box{{1, bad, 1}}}, Shape{Box{{1, 1, bad}}}, Shape{Capsule{bad, 1}},
                                   Shape{Capsule{1, bad}}, Shape{Cylinder{bad, 1}}, Shape{Cylinder{1, bad}}, Shape{Cone{bad, 1}}, Shape{Cone{1, bad}}}) {
            EXPECT_EQ(time_of_impact(shape, fly, box, still).status, ImpactStatus::Invalid) << bad << ' ' << shape.index();
            EXPECT_EQ(time_of_impact(box, fly, shape, still).status, ImpactStatus::Invalid) << bad << ' ' << shape.index();
            EXPECT_EQ(time_of_impact(shape, fly, **mesh, still).status, ImpactStatus::Invalid) << bad << ' ' << shape.index();
        }
    }
    for (const Plane& plane : {Plane{{kNan, 1, 0}, 0}, Plane{{0, kInf, 0}, 0}, Plane{{0, 0, 0}, 0}, Plane{{0, 1, 0}, kNan}, Plane{{0, 1, 0}, kInf}}) {
        EXPECT_EQ(time_of_impact(Shape{plane}, still, box, fly).status, ImpactStatus::Invalid);
        EXPECT_EQ(time_of_impact(box, fly, Shape{plane}, still).status, ImpactStatus::Invalid);
    }
    EXPECT_EQ(time_of_impact(Shape{Sphere{0.0f}}, fly, box, still).status, ImpactStatus::Touching);
}

TEST(TimeOfImpact, SeparationsBeyondAnyLengthAreInvalid) {
    const Shape ball = Sphere{1.0f};
    const RigidMotion still, away{.start = {{5, 0, 0}, kIdentityRotation}};
    for (const double large : {3.0, 1e10, 1e70}) {
        EXPECT_EQ(time_of_impact(ball, away, ball, still, {.separation = large}).status, ImpactStatus::Overlapping) << large;
    }
    for (const double larger : {1.1e70, 1e155, 1e300}) {
        EXPECT_EQ(time_of_impact(ball, away, ball, still, {.separation = larger}).status, ImpactStatus::Invalid) << larger;
        EXPECT_EQ(time_of_impact(ball, away, ball, still, {.tolerance = larger}).status, ImpactStatus::Invalid) << larger;
    }
}

}  // namespace
}  // namespace carom
