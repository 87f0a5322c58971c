// Parallel edges and faces folded to a line, in any direction: they pass each other, and touch only where they do.
#include <carom/core/random.hpp>
#include <carom/narrowphase/deforming_triangles.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>

namespace carom {
namespace {

/// A line in any direction, a direction across it, and the one across both.
struct Lines {
    dvec3 origin, along, across, aside;

    explicit Lines(Random& random) : origin(test::random_direction(random)), along(test::random_direction(random)), across(0.0), aside(0.0) {
        across = glm::normalize(glm::cross(along, test::random_direction(random)));
        aside = glm::cross(along, across);
    }
    [[nodiscard]] MovingPoint still(double s) const { return {origin + s * along, origin + s * along}; }
    /// From one side of the line at s to the other, `gap` from it.
    [[nodiscard]] MovingPoint past(double s, double gap) const {
        const dvec3 over = origin + s * along + gap * aside;
        return {over - across, over + across};
    }
};

TEST(DeformingLines, PassEachOtherAtAnyGap) {
    Random random(0x11e5);
    for (const double gap : {1e-13, 1e-11, 1e-9, 1e-7, 1e-5, 1e-3, 0.1}) {
        int met = 0;
        for (int i = 0; i < 2000; ++i) {
            const Lines lines(random);
            const double s = random.range(-0.5, 0.5), length = random.range(0.3, 1.5), fold = random.range(0.2, 0.8);
            met += may_touch(time_of_impact(EdgeEdgeMotion{{lines.past(s, gap), lines.past(s + length, gap)}, {lines.still(0.0), lines.still(1.0)}}).status);
            met += may_touch(time_of_impact(VertexFaceMotion{lines.past(s, gap), {lines.still(0.0), lines.still(1.0), lines.still(fold)}}).status);
        }
        EXPECT_EQ(met, 0) << gap;
    }
}

TEST(DeformingLines, AreNearWhereTheyTouch) {
    Random random(0x11e6);
    for (int i = 0; i < 5000; ++i) {
        const Lines lines(random);
        const double s = random.range(-0.2, 0.8);
        // They meet at 0.5 to within the rounding of the corners, and above the line they stand still on at 0.
        const Impact edges = time_of_impact(EdgeEdgeMotion{{lines.past(s, 0.0), lines.past(s + 0.5, 0.0)}, {lines.still(0.0), lines.still(1.0)}});
        const Impact face = time_of_impact(VertexFaceMotion{lines.past(0.5, 0.0), {lines.still(0.0), lines.still(1.0), lines.still(0.3)}});
        for (const Impact& impact : {edges, face}) {
            if (may_touch(impact.status)) {
                EXPECT_NEAR(impact.t, 0.5, 1e-13);
            }
        }
    }
}

}  // namespace
}  // namespace carom
