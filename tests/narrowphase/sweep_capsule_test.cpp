// Capsules as they come on boxes and triangles from every side: many pairs, against the distance of axis and solid in double.
#include <carom/collision/closest_points.hpp>
#include <carom/narrowphase/sweep.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

dvec3 any(Random& random, double size) { return size * dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)}; }

void fill(Random& random, geo::Aabb<double>& b) {
    const dvec3 p = any(random, 1.0), q = any(random, 1.0);
    b = {glm::min(p, q), glm::max(p, q)};
}
void fill(Random& random, geo::Obb<double>& b) {
    b = {any(random, 1.0), glm::abs(any(random, 0.7)), glm::mat3_cast(test::random_rotation(random))};
}
void fill(Random& random, geo::Triangle<double>& t) { t = {any(random, 1.0), any(random, 1.0), any(random, 1.0)}; }

/// Thick ones, whose axes pass what they touch from afar, and thin ones; contacts by 1e-9 either way may be either.
template <class B>
void judge(std::uint64_t seed) {
    Random random(seed);
    int touching = 0, separated = 0;
    for (int i = 0; i < 6000; ++i) {
        B b;
        fill(random, b);
        const dvec3 motion = any(random, i % 4 == 0 ? 1.0 : 6.0), at = any(random, 1.5) - 0.5 * motion;
        geo::Capsule<double> a{{at, at + any(random, i % 3 == 0 ? 0.1 : 1.0)}, random.range(0.0, i % 2 == 0 ? 1.2 : 0.2)};
        const auto distance = [&](double t) {
            return std::sqrt(geo::closest_points(geo::Segment<double>{a.axis.a + t * motion, a.axis.b + t * motion}, b).distance_sq);
        };
        double low = 0.0, high = 1.0;  // it is convex in t
        for (int k = 0; k < 60; ++k) {
            const double p = low + (high - low) / 3.0, q = high - (high - low) / 3.0;
            (distance(p) <= distance(q) ? high : low) = distance(p) <= distance(q) ? q : p;
        }
        const double least = std::min({distance(0.0), distance(low), distance(1.0)});
        if (i % 5 == 0) a.radius = least * (i % 10 == 0 ? 1.0 + 1e-6 : 1.0 - 1e-6);  // grazing
        const Impact hit = geo::sweep(a, motion, b);
        if (std::abs(least - a.radius) > 1e-9) {
            ASSERT_EQ(may_touch(hit.status), least <= a.radius) << i << " " << least - a.radius;
        }
        ++(may_touch(hit.status) ? touching : separated);
        if (hit.status != ImpactStatus::Touching) continue;
        for (const double share : {0.5, 0.9, 1.0}) ASSERT_GT(distance(share * hit.t), a.radius - 1e-9) << i;
        ASSERT_LT(distance(hit.t), a.radius + 1e-8) << i;
    }
    EXPECT_GT(touching, 1000);
    EXPECT_GT(separated, 500);
}
TEST(SweepCapsule, BoxesAreMetFromEverySide) { judge<geo::Aabb<double>>(0xca1); }
TEST(SweepCapsule, TurnedBoxesAreMetFromEverySide) { judge<geo::Obb<double>>(0xca2); }
TEST(SweepCapsule, TrianglesAreMetFromEverySide) { judge<geo::Triangle<double>>(0xca3); }

}  // namespace
}  // namespace carom
