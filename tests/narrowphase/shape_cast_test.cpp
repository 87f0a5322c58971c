// Casts of a convex shape against one of any kind: between what the search for a time of impact finds for it and for a little more.
#include <carom/narrowphase/shape_cast.hpp>

#include <support/cast_cases.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace carom {
namespace {

using namespace test;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Far above what the closed forms promise for scenes of a few metres (3e-7 of the size), far below the shapes.
constexpr double kSkin = 1e-5;

TEST(ShapeCast, EveryKindMeetsEveryKindAsTheSearchSays) {
    Random random(0xca57);
    int touching = 0, overlapping = 0, separated = 0;
    for (int i = 0; i < kConvexKinds * kKinds * 14; ++i) {
        const Shape a = any_convex(random, i), b = any_shape(random, i / kConvexKinds);
        const Pose pose{0.3 * random_direction(random), random_rotation(random)};
        const RigidMotion motion = any_motion(random, i % 9 == 0 ? 0.4 : 3.0, i % 2 == 0 ? 0.0 : 4.0);
        const double separation = i % 5 == 0 ? 0.05 : 0.0;
        const TimeOfImpactSettings settings{.separation = separation, .most_checks = 2000};
        TimeOfImpactSettings wider = settings;
        wider.separation += kSkin;
        const ShapeImpact found = cast_shape(a, motion, b, pose, settings);
        const Impact truth = first_by_search(a, motion, b, pose, settings), earliest = first_by_search(a, motion, b, pose, wider);
        const std::string what = std::to_string(i) + " " + to_string(type_of(a)) + " " + to_string(type_of(b)) + " " + to_string(found.status);
        ASSERT_NE(found.status, ImpactStatus::Invalid) << what;
        ASSERT_NE(found.status, ImpactStatus::Clamped) << what;
        if (may_touch(truth.status)) {
            ASSERT_TRUE(may_touch(found.status)) << what;
            // The search ends up to 1e-9 of the sizes early, the closed form later than that but never late: within its tolerance in time.
            ASSERT_LE(found.t, truth.t + 1e-3) << what;
        }
        if (!may_touch(earliest.status)) {
            ASSERT_EQ(found.status, ImpactStatus::Separated) << what;
        } else {
            ASSERT_GE(found.t, earliest.t) << what;
        }
        touching += found.status == ImpactStatus::Touching ? 1 : 0;
        overlapping += found.status == ImpactStatus::Overlapping ? 1 : 0;
        separated += found.status == ImpactStatus::Separated ? 1 : 0;
        if (found.status != ImpactStatus::Touching) continue;
        ASSERT_NEAR(glm::length(found.normal), 1.0, 1e-9) << what;
        const Shape dot = Sphere{1e-6f};
        const RigidMotion there{.start = {found.point, kIdentityRotation}};
        ASSERT_EQ(cast_shape(dot, there, b, pose, {.separation = kSkin}).status, ImpactStatus::Overlapping) << what << ": the point is not on B";
        ASSERT_LT(distance(a, pose_at(motion, found.t), dot, there.start).lower, separation + kSkin) << what << ": the point is not on A";
    }
    EXPECT_GT(touching, 200);
    EXPECT_GT(overlapping, 20);
    EXPECT_GT(separated, 100);
}

/// By distances at sampled times: nothing is met before t, far from the world's origin too, where poses are coarse.
TEST(ShapeCast, NothingIsMetBeforeIt) {
    Random random(0xca58);
    for (int i = 0; i < kConvexKinds * kConvexKinds * 4; ++i) {
        const Shape a = any_convex(random, i), b = any_convex(random, i / kConvexKinds);
        const dvec3 far = (i % 3 == 0 ? 1e5 : 0.0) * random_direction(random);
        const Pose pose{far, random_rotation(random)};
        RigidMotion motion = any_motion(random, 2.0, i % 2 == 0 ? 0.0 : 4.0);
        motion.start.position += far;
        const ShapeImpact found = cast_shape(a, motion, b, pose, {.most_checks = 2000});
        if (found.status == ImpactStatus::Overlapping) continue;
        const double end = may_touch(found.status) ? found.t : 1.0;
        // pose_at() rounds to the world's coordinates, 1.5e-11 m at 1e5 m; the motion itself does not.
        const double coarse = i % 3 == 0 ? 1e-10 : 0.0;
        for (int k = 0; k <= 100; ++k) {
            const Pose now = pose_at(motion, end * k / 100);
            if (distance(a, now, b, pose).status != DistanceStatus::Overlap) continue;
            ASSERT_LT(penetration(a, now, b, pose).lower, coarse) << i << " at " << end * k / 100;
        }
    }
}

TEST(ShapeCast, TrianglesAndPartsAreNamedAndTheLowestWinsATie) {
    const Shape ball = Sphere{0.25f};
    const Shape pair = *Compound::build({{Sphere{0.5f}, {{-2, 0, 0}, kIdentityRotation}}, {Box{}, {{2, 0, 0}, kIdentityRotation}}});
    const RigidMotion down{.start = {{2, 5, 0}, kIdentityRotation}, .translation = {0, -10, 0}};
    EXPECT_EQ(cast_shape(ball, down, pair, {}).part, 1u);
    const RigidMotion across{.start = {{-9, 0, 0}, kIdentityRotation}, .translation = {20, 0, 0}};
    EXPECT_EQ(cast_shape(ball, across, pair, {}).part, 0u);
    const Shape twins = *Compound::build({{Sphere{}, {{-1, 0, 0}, kIdentityRotation}}, {Sphere{}, {{1, 0, 0}, kIdentityRotation}}});
    const RigidMotion between{.start = {{0, 5, 0}, kIdentityRotation}, .translation = {0, -10, 0}};
    EXPECT_EQ(cast_shape(Shape{Sphere{0.6f}}, between, twins, {}).part, 0u);
    // The closed form and the search name one triangle.
    const Shape mesh = box_mesh({0.5f, 0.3f, 0.4f}, 4);
    Random random(0xca59);
    int touching = 0;
    for (int i = 0; i < 40; ++i) {
        const RigidMotion motion = any_motion(random, 2.0, 0.0);
        const ShapeImpact closed = cast_shape(ball, motion, mesh, {});
        const geo::MeshImpact search = time_of_impact(ball, motion, *std::get<TriangleMeshPtr>(mesh), {});
        if (closed.status != ImpactStatus::Touching || search.status != ImpactStatus::Touching) continue;
        ++touching;
        const auto corners = std::get<TriangleMeshPtr>(mesh)->corners(closed.triangle);
        const geo::Triangle<double> hit{dvec3(corners[0]), dvec3(corners[1]), dvec3(corners[2])};
        EXPECT_EQ(geo::sweep(geo::Sphere<double>{closed.point, 1e-9}, dvec3{0.0}, hit).status, ImpactStatus::Overlapping) << i;
    }
    EXPECT_GT(touching, 20);
}

TEST(ShapeCast, NothingLaterThanUntilIsLookedFor) {
    Random random(0xca5a);
    for (int i = 0; i < kConvexKinds * kKinds; ++i) {
        const Shape a = any_convex(random, i), b = any_shape(random, i / kConvexKinds);
        const RigidMotion motion = any_motion(random, 3.0, i % 2 == 0 ? 0.0 : 2.0);
        const ShapeImpact whole = cast_shape(a, motion, b, {}, {.most_checks = 1000});
        if (whole.status != ImpactStatus::Touching || whole.t == 0.0) continue;
        const ShapeImpact just = cast_shape(a, motion, b, {}, {.most_checks = 1000, .until = whole.t});
        EXPECT_EQ(just.status, ImpactStatus::Touching) << i;
        EXPECT_EQ(just.t, whole.t) << i;
        const ShapeImpact before = cast_shape(a, motion, b, {}, {.most_checks = 1000, .until = 0.99 * whole.t});
        EXPECT_EQ(before.status, ImpactStatus::Separated) << i;
        EXPECT_EQ(before.t, 0.99 * whole.t) << i;
        EXPECT_EQ(before.normal, dvec3{0.0}) << i;
    }
}

TEST(ShapeCast, ABallThatTurnsAboutItsCentreMovesStraight) {
    const RigidMotion roll{.start = {{0, 3, 0}, kIdentityRotation}, .translation = {0, -4, 0}, .rotation = {0, 0, 50}};
    const ShapeImpact hit = cast_shape(Sphere{0.5f}, roll, Box{}, {});
    EXPECT_NEAR(hit.t, 0.5, 1e-12);
    EXPECT_LE(hit.t, 0.5);
    EXPECT_NEAR(hit.point.y, 0.5, 1e-12);
    EXPECT_NEAR(hit.normal.y, -1.0, 1e-12);
}

TEST(ShapeCast, TheCapIsSaid) {
    const Shape rod = Box{{1.0f, 0.01f, 0.01f}};
    const RigidMotion spin{.start = {{0, 0.0, 0}, kIdentityRotation}, .rotation = {0, 0, 40.0}};
    const Pose near{{0, 1.005, 0}, kIdentityRotation};
    const Shape post = *Compound::build({{Sphere{0.01f}, {}}});
    for (const Shape& b : {Shape{Sphere{0.01f}}, post}) {
        const ShapeImpact cut = cast_shape(rod, spin, b, near, {.most_checks = 2});
        EXPECT_EQ(cut.status, ImpactStatus::Clamped);
        EXPECT_LE(cut.t, cast_shape(rod, spin, b, near, {.most_checks = 10000}).t);
    }
}

TEST(ShapeCast, BadInputIsInvalid) {
    const Shape ball = Sphere{0.5f}, box = Box{};
    const auto status = [](const Shape& a, const RigidMotion& m, const Shape& b, const Pose& pose, const TimeOfImpactSettings& s = {}) {
        return cast_shape(a, m, b, pose, s).status;
    };
    const Shape mesh = box_mesh(vec3{0.5f}, 1), compound = *Compound::build({{Sphere{}, {}}});
    for (const Shape& b : {ball, box, mesh, compound, Shape{Plane{}}}) {
        for (const Shape& bad : {Shape{Plane{}}, mesh, compound, Shape{ConvexHullPtr{}}, Shape{CompoundPtr{}}, Shape{Sphere{-1.0f}}, Shape{Box{{1, NAN, 1}}}}) {
            EXPECT_EQ(status(bad, {}, b, {}), ImpactStatus::Invalid);
        }
        for (const Shape& a : {ball, box}) {
            EXPECT_EQ(status(a, {.translation = {kNaN, 0, 0}}, b, {}), ImpactStatus::Invalid);
            EXPECT_EQ(status(a, {.translation = {0, kInfinity, 0}}, b, {}), ImpactStatus::Invalid);
            EXPECT_EQ(status(a, {.rotation = {0, 1e10, 0}}, b, {}), ImpactStatus::Invalid);
            EXPECT_EQ(status(a, {.start = {{1e71, 0, 0}, kIdentityRotation}}, b, {}), ImpactStatus::Invalid);
            EXPECT_EQ(status(a, {}, b, {{kNaN, 0, 0}, kIdentityRotation}), ImpactStatus::Invalid);
            EXPECT_EQ(status(a, {}, b, {dvec3{0.0}, {kNaN, 0, 0, 0}}), ImpactStatus::Invalid);
            for (const TimeOfImpactSettings& s : {TimeOfImpactSettings{.separation = -1.0}, {.separation = kNaN}, {.tolerance = -1.0}, {.most_checks = 0},
                                                  {.until = -0.1}, {.until = 1.1}, {.until = kNaN}}) {
                EXPECT_EQ(status(a, {}, b, {}, s), ImpactStatus::Invalid);
            }
        }
    }
    for (const Shape& bad : {Shape{ConvexHullPtr{}}, Shape{CompoundPtr{}}, Shape{TriangleMeshPtr{}}, Shape{Sphere{kNaN}}, Shape{Plane{vec3{0.0f}, 0.0f}}}) {
        EXPECT_EQ(status(ball, {}, bad, {}), ImpactStatus::Invalid);
        EXPECT_EQ(status(box, {}, bad, {}), ImpactStatus::Invalid);
    }
    // Nothing that moves is a motion, and shapes of no size are points.
    EXPECT_EQ(status(ball, {}, box, {}), ImpactStatus::Overlapping);
    EXPECT_EQ(status(ball, {}, box, {{9, 0, 0}, kIdentityRotation}), ImpactStatus::Separated);
    EXPECT_EQ(status(Sphere{0.0f}, {.start = {{0, 2, 0}, kIdentityRotation}, .translation = {0, -4, 0}}, box, {}), ImpactStatus::Touching);
}

}  // namespace
}  // namespace carom
