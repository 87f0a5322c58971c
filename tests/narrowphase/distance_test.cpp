// Distances and depths of convex shapes against exact rationals.
#include <fuzz/convex_check.hpp>

#include <carom/collision/compound.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/check.hpp>
#include <carom/narrowphase/overlap.hpp>

#include "oracle.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace carom {
namespace {

using test::Condition;
using test::NearPair;

constexpr ShapeType kPolyhedral[] = {ShapeType::Sphere, ShapeType::Box, ShapeType::Capsule, ShapeType::ConvexHull};
constexpr ShapeType kConvex[] = {ShapeType::Sphere,     ShapeType::Box,      ShapeType::Capsule,
                                 ShapeType::ConvexHull, ShapeType::Cylinder, ShapeType::Cone};

TEST(Distance, BoundsHoldAgainstExactRationals) {
    Random random(0xd157);
    int converged = 0, apart = 0;
    for (const Condition condition : test::kConditions) {
        for (const ShapeType a : kPolyhedral) {
            for (const ShapeType b : kPolyhedral) {
                const NearPair p = test::near_pair(random, a, b, condition);
                const DistanceResult r = distance(p.a, p.pose_a, p.b, p.pose_b);
                ASSERT_EQ(test::bounds_fault(p, test::JudgedPair(p), r), "") << int(condition) << " " << to_string(a) << " " << to_string(b) << " "
                                                  << to_string(r.status) << " " << r.lower << " " << r.upper;
                if (r.lower > 0.0) ++apart, converged += r.status == DistanceStatus::Converged ? 1 : 0;
            }
        }
    }
    EXPECT_GT(apart, 40);
    EXPECT_EQ(converged, apart);
}

TEST(Distance, WitnessesLieOnTheShapesAndAreUpperApart) {
    Random random(0x317);
    for (int i = 0; i < 100; ++i) {
        const NearPair p = test::near_pair(random, kPolyhedral[i % 4], kPolyhedral[(i / 4) % 4], Condition::Random);
        const DistanceResult r = distance(p.a, p.pose_a, p.b, p.pose_b);
        if (r.lower <= 0.0) continue;
        const double e = test::query_rounding(p);
        EXPECT_NEAR(glm::length(r.on_b - r.on_a), r.upper, 2.0 * e);
        EXPECT_NEAR(glm::length(r.normal), 1.0, 1e-14);
        EXPECT_GT(glm::dot(r.normal, r.on_b - r.on_a), (1.0 - 1e-9) * r.upper - 4.0 * e);
        const exact::Vec origin = exact::vec(p.pose_a.position);
        const auto off = [&](const dvec3& point, const Shape& shape, const Pose& pose) {
            const exact::Solid s = exact::solid(shape, pose);
            return exact::core_distance_sq(origin + exact::vec(point), s) <= exact::square(s.radius + exact::number(2.0 * e));
        };
        EXPECT_TRUE(off(r.on_a, p.a, p.pose_a) && off(r.on_b, p.b, p.pose_b)) << i;
    }
}

// Farthest point along n, in long double.
test::Real reach(const Shape& shape, const Pose& pose, const dvec3& origin, const test::RealVec& n) {
    using test::Real;
    const test::RealVec local = carom::rotate_inverse(glm::qua<Real>(pose.orientation), n);
    const Real base = glm::dot(n, test::real(pose.position) - test::real(origin));
    const auto turned = [&](Real half, Real lower, Real upper) {
        const Real across = std::sqrt(local.x * local.x + local.z * local.z);
        return std::max(half * local.y + upper * across, -half * local.y + lower * across);
    };
    if (const Sphere* s = std::get_if<Sphere>(&shape)) return base + Real(s->radius) * test::length_of(n);
    if (const Capsule* c = std::get_if<Capsule>(&shape)) return base + Real(c->radius) * test::length_of(n) + Real(c->half_segment) * std::abs(local.y);
    if (const Cylinder* c = std::get_if<Cylinder>(&shape)) return base + turned(Real(c->half_height), Real(c->radius), Real(c->radius));
    if (const Cone* c = std::get_if<Cone>(&shape)) return base + turned(Real(c->half_height), Real(c->radius), 0);
    Real most = -1e300L;
    const std::vector<vec3> corners = std::holds_alternative<Box>(shape)
                                          ? test::corners_of(std::get<Box>(shape))
                                          : std::vector<vec3>(std::get<ConvexHullPtr>(shape)->vertices().begin(),
                                                              std::get<ConvexHullPtr>(shape)->vertices().end());
    for (const vec3& v : corners) most = std::max(most, glm::dot(local, test::real(dvec3(v))));
    return base + most;
}

TEST(Distance, SupportPlanesProveTheLowerBoundOfTurnedShapes) {
    Random random(0x70e);
    int apart = 0, tight = 0;
    for (const Condition condition : test::kConditions) {
        for (int i = 0; i < 300; ++i) {
            const NearPair p = test::near_pair(random, i % 2 ? ShapeType::Cylinder : ShapeType::Cone, kConvex[i % 6], condition);
            const DistanceResult r = distance(p.a, p.pose_a, p.b, p.pose_b);
            if (r.lower <= 0.0) continue;
            const test::RealVec n = test::real(r.normal);
            const test::Real gap = -reach(p.b, p.pose_b, p.pose_a.position, -n) - reach(p.a, p.pose_a, p.pose_a.position, n);
            ASSERT_GE(gap * (1 + 1e-15L), static_cast<test::Real>(r.lower)) << int(condition) << " " << i;
            EXPECT_NEAR(glm::length(r.on_b - r.on_a), r.upper, 2.0 * test::query_rounding(p));
            ++apart;
            tight += r.upper - r.lower <= 1e-9 * p.size + 8.0 * test::query_rounding(p) ? 1 : 0;
        }
    }
    EXPECT_GT(apart, 800);
    EXPECT_GT(tight, apart * 99 / 100) << "of " << apart;
}

TEST(Distance, AKnownAnswer) {
    const DistanceResult r = distance(Box{{1, 1, 1}}, {}, Sphere{0.5f}, {{3, 0, 0}, kIdentityRotation});
    EXPECT_EQ(r.status, DistanceStatus::Converged);
    EXPECT_LE(r.lower, 1.5);
    EXPECT_GE(r.upper, 1.5);
    EXPECT_NEAR(r.lower, r.upper, 1e-12);
    EXPECT_NEAR(glm::length(r.normal - dvec3{1, 0, 0}), 0.0, 1e-14);
    EXPECT_NEAR(r.on_a.x, 1.0, 1e-13);
    EXPECT_NEAR(r.on_b.x, 2.5, 1e-13);
}

TEST(Distance, PlanesHaveTheirSides) {
    const Pose ground{{0, 1, 0}, kIdentityRotation}, high{{5, 4, 0}, kIdentityRotation}, low{{5, 1.25, 0}, kIdentityRotation};
    const Plane plane{{0, 1, 0}, 0.5f};
    const Shape cone = Cone{0.5f, 1.0f};
    const DistanceResult above = distance(plane, ground, cone, high), swapped = distance(cone, high, plane, ground);
    EXPECT_NEAR(above.lower, 1.5, 1e-12);
    EXPECT_LE(above.lower, 1.5);
    EXPECT_GE(above.upper, 1.5);
    EXPECT_EQ(above.normal, (dvec3{0, 1, 0}));
    EXPECT_EQ(swapped.normal, (dvec3{0, -1, 0}));
    EXPECT_NEAR(above.on_b.y, 2.0, 1e-12);
    EXPECT_NEAR(swapped.on_a.y, -1.0, 1e-12);
    EXPECT_EQ(distance(plane, ground, cone, low).status, DistanceStatus::Overlap);
    EXPECT_EQ(overlaps(plane, ground, cone, low), Overlap::Overlapping);
    EXPECT_EQ(overlaps(plane, ground, cone, high), Overlap::Apart);
    EXPECT_EQ(overlaps(plane, ground, cone, {{5, 2.5, 0}, kIdentityRotation}), Overlap::Undecided);
    EXPECT_NEAR(penetration(plane, ground, cone, low).upper, 1.25, 1e-12);
    EXPECT_EQ(penetration(plane, ground, cone, high).upper, 0.0);
}

TEST(Distance, AWarmStartSavesRoundsAndAWrongOneChangesNoBound) {
    Random random(0xcac4e);
    int cold = 0, warm = 0;
    for (int i = 0; i < 300; ++i) {
        NearPair p = test::near_pair(random, ShapeType::ConvexHull, ShapeType::ConvexHull, Condition::Random);
        DistanceCache cache;
        const DistanceResult first = distance(p.a, p.pose_a, p.b, p.pose_b, {}, &cache);
        p.pose_b.position += 1e-3 * test::random_direction(random);
        const DistanceResult again = distance(p.a, p.pose_a, p.b, p.pose_b, {}, &cache);
        const DistanceResult alone = distance(p.a, p.pose_a, p.b, p.pose_b);
        DistanceCache other{{900, 1, 2, 3}, {4, 5, 6, 7}, 4}, wild{{0, 1, 2, 3}, {3, 2, 1, 0}, 4};
        EXPECT_EQ(other.count, 4u);
        for (const DistanceResult& r : {distance(p.a, p.pose_a, p.b, p.pose_b, {}, &other), distance(p.a, p.pose_a, p.b, p.pose_b, {}, &wild), again}) {
            EXPECT_LE(r.lower, alone.upper);
            EXPECT_LE(alone.lower, r.upper);
            EXPECT_EQ(r.status == DistanceStatus::Overlap, alone.status == DistanceStatus::Overlap);
        }
        if (first.status != DistanceStatus::Converged) continue;
        cold += first.iterations;
        warm += again.iterations;
    }
    EXPECT_LT(2 * warm, cold);
}

TEST(Distance, SettingsBoundTheWork) {
    Random random(0x5e7);
    for (int i = 0; i < 100; ++i) {
        const NearPair p = test::near_pair(random, ShapeType::Cylinder, ShapeType::ConvexHull, Condition::Random);
        const DistanceResult full = distance(p.a, p.pose_a, p.b, p.pose_b);
        if (full.status != DistanceStatus::Converged) continue;
        const DistanceResult rough = distance(p.a, p.pose_a, p.b, p.pose_b, {.tolerance = 0.1});
        EXPECT_LE(rough.iterations, full.iterations);
        EXPECT_LE(rough.lower, full.upper);
        EXPECT_GE(rough.upper, full.lower);
        const DistanceResult one = distance(p.a, p.pose_a, p.b, p.pose_b, {.most_iterations = 1});
        EXPECT_EQ(one.iterations, 1);
        EXPECT_EQ(one.status, DistanceStatus::Stopped);
        EXPECT_LE(one.lower, full.upper);
        EXPECT_GE(one.upper, full.lower);
    }
}

TEST(Penetration, BoundsHoldTheLeastDepth) {
    Random random(0xdee9);
    for (int i = 0; i < 600; ++i) {
        const ShapeType a = i % 2 ? ShapeType::Box : ShapeType::ConvexHull, b = (i / 2) % 2 ? ShapeType::Box : ShapeType::ConvexHull;
        const NearPair p = test::near_pair(random, a, b, i % 3 ? Condition::Deep : Condition::NearContact);
        const auto solid = [&](const Shape& s, const Pose& pose) {
            return std::holds_alternative<Box>(s) ? test::solid_of(std::get<Box>(s), pose, p.pose_a.position)
                                                  : test::solid_of(*std::get<ConvexHullPtr>(s), pose, p.pose_a.position);
        };
        const test::Real depth = -test::greatest_separation(solid(p.a, p.pose_a), solid(p.b, p.pose_b)).value;
        const PenetrationResult r = penetration(p.a, p.pose_a, p.b, p.pose_b);
        const double e = 8.0 * test::query_rounding(p);
        if (depth < -e) {
            EXPECT_EQ(r.upper, 0.0);
            continue;
        }
        EXPECT_LE(r.lower, static_cast<double>(depth) + 1e-12) << i;
        EXPECT_GE(r.upper, static_cast<double>(depth) - 1e-12) << i;
        EXPECT_LT(r.upper - r.lower, 1e-9) << i << " depth " << static_cast<double>(depth);
        if (r.upper > 0.0) {
            EXPECT_NEAR(glm::length(r.normal), 1.0, 1e-12);
        }
    }
}

// Moved by `upper` along the normal they are apart: in long double, by the ends of their segments.
TEST(Penetration, CapsulesThatCrossAtAnyAnglePartAlongTheNormal) {
    Random random(0xc805);
    for (const double angle : {1.2e-12, 1e-11, 1e-9, 1e-7, 1e-3, 1.0}) {
        for (int i = 0; i < 200; ++i) {
            const Shape capsule = Capsule{1e-6f, 1.0f};
            const Pose here{dvec3{0.0}, test::random_rotation(random)}, there{dvec3{0.0}, glm::normalize(here.orientation * test::about({1, 0, 0}, angle))};
            const PenetrationResult r = penetration(capsule, here, capsule, there);
            const auto reach = [&](const Pose& pose) {
                const glm::mat<3, 3, test::Real> axes = glm::mat3_cast(glm::qua<test::Real>(pose.orientation));
                return std::abs(glm::dot(axes[1], test::real(r.normal)));
            };
            const test::Real along = reach(here) + reach(there) + 2.0L * test::Real(1e-6f);
            ASSERT_GE(test::Real(r.upper), along) << angle << " " << i;
            ASSERT_LT(r.upper, 2.0000001e-6) << angle << " " << i;
        }
    }
}

TEST(Penetration, ConcentricRoundShapesHaveADirection) {
    const Pose here{{3, 2, 1}, kIdentityRotation};
    const Shape ball = Sphere{0.5f}, rod = Capsule{0.25f, 1.0f};
    const PenetrationResult balls = penetration(ball, here, ball, here), rods = penetration(rod, here, rod, here);
    EXPECT_NEAR(balls.lower, 1.0, 1e-12);
    EXPECT_NEAR(balls.upper, 1.0, 1e-12);
    EXPECT_EQ(balls.normal, (dvec3{0, 1, 0}));
    EXPECT_NEAR(rods.upper, 0.5, 1e-12);
    EXPECT_NEAR(rods.normal.y, 0.0, 1e-12);
}

TEST(DistanceMisuse, IsReportedAndGivesNothing) {
    const Shape box = Box{}, plane = Plane{}, null = ConvexHullPtr{}, mesh = TriangleMeshPtr{}, compound = CompoundPtr{};
    const Pose here;
    Pose nan;
    nan.position.y = std::numeric_limits<double>::quiet_NaN();
    Pose infinite;
    infinite.orientation.x = std::numeric_limits<double>::infinity();
    for (const Shape* bad : {&null, &mesh, &compound}) {
        EXPECT_THROW((void)distance(*bad, here, box, here), MisuseError);
        EXPECT_THROW((void)distance(box, here, *bad, here), MisuseError);
        EXPECT_THROW((void)overlaps(box, here, *bad, here), MisuseError);
        EXPECT_THROW((void)penetration(box, here, *bad, here), MisuseError);
    }
    EXPECT_THROW((void)distance(plane, here, plane, here), MisuseError);
    for (const Pose& bad : {nan, infinite}) {
        EXPECT_THROW((void)distance(box, bad, box, here), MisuseError);
        EXPECT_THROW((void)overlaps(box, here, box, bad), MisuseError);
        EXPECT_THROW((void)penetration(box, here, box, bad), MisuseError);
    }
    EXPECT_THROW((void)distance(box, here, box, here, {.tolerance = -1.0}), MisuseError);
    EXPECT_THROW((void)distance(box, here, box, here, {.most_iterations = 0}), MisuseError);
    const ErrorHandler before = set_error_handler([](const Error&) {});
    const DistanceResult r = distance(plane, here, plane, here);
    EXPECT_EQ(overlaps(plane, here, plane, here), Overlap::Undecided);
    set_error_handler(before);
    EXPECT_EQ(r.status, DistanceStatus::Stopped);
    EXPECT_EQ(r.lower, 0.0);
    EXPECT_TRUE(std::isinf(r.upper));
}

// Directions that are known before the quotients of the nearest point lead there as fast.
TEST(Distance, OfTwoHullsTakesFewRounds) {
    Random r(67);
    int rounds = 0, apart = 0;
    for (int i = 0; i < 1000; ++i) {
        const Shape a = test::random_hull(r, 32, 0.4, 1.0), b = test::random_hull(r, 32, 0.4, 1.0);
        const DistanceResult found = distance(a, {}, b, {test::random_direction(r) * r.range(0.5, 2.4), test::random_rotation(r)});
        if (found.status == DistanceStatus::Overlap) continue;
        ASSERT_EQ(found.status, DistanceStatus::Converged) << i;
        rounds += found.iterations;
        ++apart;
    }
    EXPECT_GT(apart, 400);
    EXPECT_LT(rounds, 5.5 * apart);
}

}  // namespace
}  // namespace carom
