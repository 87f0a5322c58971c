// Every pair of convex shapes against brute force: distance where apart, least depth where they overlap.
#include "oracle.hpp"

#include <gtest/gtest.h>

namespace carom {
namespace {

using namespace test;

// A convex shape as a core without radius, and a radius.
struct RoundSolid {
    Solid core;
    double radius = 0.0;
};

RoundSolid core_of(const Shape& shape, const Pose& pose, const dvec3& origin) {
    switch (type_of(shape)) {
        case ShapeType::Sphere: {
            const RealVec c = placed(dvec3{0.0}, pose, origin);
            return {solid_of_segment(c, c), static_cast<double>(std::get<Sphere>(shape).radius)};
        }
        case ShapeType::Capsule: {
            const Capsule& c = std::get<Capsule>(shape);
            const double h = static_cast<double>(c.half_segment);
            return {solid_of_segment(placed({0, -h, 0}, pose, origin), placed({0, h, 0}, pose, origin)), static_cast<double>(c.radius)};
        }
        case ShapeType::Box: return {solid_of(std::get<Box>(shape), pose, origin), 0.0};
        default: return {solid_of(*std::get<ConvexHullPtr>(shape), pose, origin), 0.0};
    }
}

constexpr ShapeType kConvex[] = {ShapeType::Sphere, ShapeType::Box, ShapeType::Capsule, ShapeType::ConvexHull};

// Free poses, almost aligned ones, aligned ones, and deep ones.
Pose random_local(Random& r, int kind) {
    Pose pose{random_direction(r) * r.range(kind == 3 ? 0.0 : 0.2, kind == 3 ? 0.3 : 2.2), random_rotation(r)};
    if (kind == 1) pose.orientation = about(random_direction(r), r.range(-1e-5, 1e-5));
    if (kind == 2) pose.orientation = kIdentityRotation;
    return pose;
}

void check_pair(ShapeType ta, ShapeType tb, int count) {
    Random r(4711 + 10 * static_cast<std::uint64_t>(ta) + static_cast<std::uint64_t>(tb));
    const float margin = 0.03f;
    int touching = 0, near = 0, apart = 0;
    for (int i = 0; i < count; ++i) {
        SCOPED_TRACE(testing::Message() << to_string(ta) << " " << to_string(tb) << " " << i);
        const Shape a = random_shape(ta, r), b = random_shape(tb, r);
        const Pose pa{random_direction(r) * 3.0, random_rotation(r)};
        const Pose pb = pa * random_local(r, i % 4);
        const RoundSolid ca = core_of(a, pa, pa.position), cb = core_of(b, pb, pa.position);
        const double truth = static_cast<double>(signed_distance(ca.core, cb.core)) - ca.radius - cb.radius;
        const std::vector<Manifold> m = collide_all(a, pa, b, pb, margin);
        if (truth > static_cast<double>(margin) + 1e-6) {
            ++apart;
            ASSERT_TRUE(m.empty());
            continue;
        }
        if (truth > static_cast<double>(margin) - 1e-6) continue;
        ASSERT_EQ(m.size(), 1u);
        (truth < 0 ? touching : near)++;
        const double least = static_cast<double>(least_separation(m[0]));
        // Two axes give box against box a lower bound where corners face each other; everything else gives the distance itself.
        if (truth > 0 && ta == ShapeType::Box && tb == ShapeType::Box) {
            ASSERT_LE(least, truth + 2e-6);
            ASSERT_GE(least, 0.5 * truth - 2e-6);
        } else {
            ASSERT_NEAR(least, truth, 3e-6);
        }
        const dvec3 n(m[0].normal);
        ASSERT_NEAR(glm::dot(n, n), 1.0, 1e-6);
        // The normal is one along which the shapes are that deep: moving B out by the depth parts them.
        const double gap = static_cast<double>(gap_along(ca.core, cb.core, real(n))) - ca.radius - cb.radius;
        if (truth < 0) {
            ASSERT_NEAR(gap, least, 5e-6);
        }
    }
    EXPECT_GT(touching, count / 20);
    EXPECT_GT(apart, count / 20);
    EXPECT_GT(near, 0);
}

TEST(ConvexPairs, SeparationIsThatOfBruteForce) {
    for (const ShapeType a : kConvex) {
        for (const ShapeType b : kConvex) {
            check_pair(a, b, a == ShapeType::ConvexHull && b == ShapeType::ConvexHull ? 250 : 500);
            if (HasFatalFailure()) return;
        }
    }
}

}  // namespace
}  // namespace carom
