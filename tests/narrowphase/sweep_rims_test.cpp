// Sweeps where a face ends: paths that pass its edge so low that only its inside is met, corners whose angles are small, sizes near zero.
#include <carom/narrowphase/sweep.hpp>

#include <gtest/gtest.h>

namespace carom {
namespace {

TEST(SweepRims, NothingSlipsBetweenAFaceAndItsEdge) {
    // Over an edge at a height between the radius and what the face is grown by, and then down to the face by 1e-16 of the way.
    const geo::Sphere<double> ball{{-0.20849937642974561, -1.5060607299785824, -0.33078358006557251}, 0.020801518942515876};
    const dvec3 motion{0.28359568227280552, 1.9975099616353331, 1.7355094457103188};
    const geo::Triangle<double> face{{-0.011997771403180923, -0.20174045429900445, 0.78071240547599507},
                                     {-0.40541699419427651, -0.72226413805042566, 0.022902132523522578},
                                     {0.6751945680597663, -0.91580377443158678, 0.91442950769061471}};
    const Impact hit = geo::sweep(ball, motion, face);
    ASSERT_EQ(hit.status, ImpactStatus::Touching);
    EXPECT_LE(hit.t, 0.3596);  // true, by arithmetic of 113 bits
    EXPECT_GE(hit.t, 0.359);
}

TEST(SweepRims, ShortAxesMakeUpNothingBesideAnEdge) {
    for (const double past : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
        const geo::Capsule<double> a{{{1.0 + past, -5e-10, 1.0}, {1.0 + past, 5e-10, 1.0}}, 0.0}, b{{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}, 0.0};
        EXPECT_EQ(geo::sweep(a, {0.0, 0.0, -2.0}, b).status, ImpactStatus::Separated) << past;
    }
}

// Lengths whose squares are less than any number are lengths.
TEST(SweepRims, LengthsWithoutASquareAreNeverLate) {
    for (const double tiny : {1e-100, 1e-150, 1e-155, 1e-160, 3e-161, 5e-162, 1e-163, 1e-300, 5e-324}) {
        const dvec3 along = tiny * glm::normalize(dvec3{1.0, 0.3, -0.4});
        const geo::Sphere<double> ball{{0.0, 0.0, 0.0}, 0.5};
        // As an axis: true at 0.4.
        const Impact onto = geo::sweep(ball, {0.0, 10.0, 0.0}, geo::Capsule<double>{{{0.0, 5.0, 0.0}, {tiny, 5.0, 0.0}}, 0.5});
        ASSERT_EQ(onto.status, ImpactStatus::Touching) << tiny;
        EXPECT_LE(onto.t, 0.4) << tiny;
        // As a motion.
        for (const dvec3& q : {dvec3{0.69, 0.0, 0.0}, dvec3{0.2, -0.3, 0.4}, dvec3{-0.4, 0.4, 0.4}}) {
            EXPECT_EQ(geo::sweep(ball, along, geo::Sphere<double>{q, 0.2}).status, ImpactStatus::Overlapping) << tiny;
            EXPECT_EQ(geo::sweep(ball, along, geo::Capsule<double>{{q, 2.0 * q}, 0.2}).status, ImpactStatus::Overlapping) << tiny;
        }
        EXPECT_EQ(geo::sweep(ball, along, geo::Sphere<double>{{0.8, 0.0, 0.0}, 0.2}).status, ImpactStatus::Separated) << tiny;
        // As the axis of a disc, towards which a half-space rises.
        const geo::Plane<double> roof{{0.0, 0.8, -0.6}, 0.0};
        const Impact disc = geo::sweep(roof, {0.0, 2.0, 0.0}, geo::Cylinder<double>{{{0.0, 1.25, 0.0}, {0.0, 1.25, tiny}}, 0.5});
        ASSERT_EQ(disc.status, ImpactStatus::Touching) << tiny;
        EXPECT_LE(disc.t, 0.375) << tiny;  // (1 - 0.8 * 0.5) / (0.8 * 2)
        // As a plane's normal: right, or not answered.
        const Impact fall = geo::sweep(geo::Sphere<double>{{0.0, 6.0, 0.0}, 1.0}, {0.0, -10.0, 0.0}, geo::Plane<double>{{0.0, tiny, 0.0}, 0.0});
        EXPECT_TRUE(fall.status == (tiny < 1e-140 ? ImpactStatus::Invalid : ImpactStatus::Touching)) << tiny;
        EXPECT_LE(fall.t, 0.5) << tiny;
    }
}

}  // namespace
}  // namespace carom
