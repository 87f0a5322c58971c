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

}  // namespace
}  // namespace carom
