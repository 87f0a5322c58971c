// The nearest point of the cone is in the cone, and no point of it is nearer; its derivative is that of differences.
#include <carom/dynamics/detail/friction_cone.hpp>

#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <algorithm>

namespace carom::dynamics {
namespace {

dvec3 draw(Random& random) { return {random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)}; }

bool is_inside(const dvec3& impulse, const dvec3& n, double friction) {
    const double normal = glm::dot(impulse, n);
    return normal >= -1e-15 && glm::length(impulse - normal * n) <= friction * normal + 1e-14;
}

TEST(FrictionCone, NoPointOfTheConeIsNearer) {
    Random random(11);
    int states[3] = {};
    for (int i = 0; i < 3000; ++i) {
        const dvec3 n = glm::normalize(draw(random)), y = draw(random);
        const double friction = i % 5 == 0 ? 0.0 : random.range(0, 2);
        const ConePoint p = nearest_in_cone(y, n, friction);
        ++states[static_cast<int>(p.state)];
        ASSERT_TRUE(is_inside(p.impulse, n, friction));
        // Of a convex cone the nearest point p has (y - p)·p = 0 and (y - p)·q <= 0 for every q in it.
        ASSERT_NEAR(glm::dot(y - p.impulse, p.impulse), 0.0, 1e-14);
        for (int k = 0; k < 20; ++k) {
            const dvec3 side = draw(random), t = side - glm::dot(side, n) * n;
            const dvec3 q = n + friction * random.unit() * t / glm::length(t);
            ASSERT_LE(glm::dot(y - p.impulse, q), 1e-14);
        }
    }
    EXPECT_GT(*std::min_element(states, states + 3), 300) << "all three states were met";
}

TEST(FrictionCone, TheDerivativeIsThatOfDifferences) {
    Random random(12);
    int compared = 0;
    for (int i = 0; i < 1000; ++i) {
        const dvec3 n = glm::normalize(draw(random)), y = draw(random), d = draw(random);
        const double friction = random.range(0.05, 2), step = 1e-6;
        const ConePoint p = nearest_in_cone(y, n, friction);
        const ConePoint ahead = nearest_in_cone(y + step * d, n, friction), behind = nearest_in_cone(y - step * d, n, friction);
        if (ahead.state != behind.state) continue;  // across an edge there is none
        ++compared;
        const dvec3 difference = (ahead.impulse - behind.impulse) / (2.0 * step);
        // Near the axis of the cone the bend is sharp: third derivatives go with 1 / |y_t|².
        const double tangential = glm::length(y - glm::dot(y, n) * n);
        EXPECT_LT(glm::length(p.derivative(d) - difference), 1e-8 / tangential);
        EXPECT_LT(glm::length(p.derivative() * d - p.derivative(d)), 1e-14);
    }
    EXPECT_GT(compared, 900);
}

}  // namespace
}  // namespace carom::dynamics
