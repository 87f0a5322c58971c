// Every pair of convex shapes against brute force: distance where apart, least depth where they overlap.
#include "oracle.hpp"

#include <carom/narrowphase/distance.hpp>

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

// A block whose faces were scanned with noise: coplanar ones are merged, and their planes lie a little outside of some of their corners.
TEST(ConvexPairs, RoundShapesOverMergedFacesAreNotLost) {
    Random r(11);
    int merged = 0;
    for (int i = 0; i < 60; ++i) {
        std::vector<vec3> points;
        for (int k = 0; k < 150; ++k) {
            dvec3 p{r.range(-0.5, 0.5), r.range(-0.5, 0.5), r.range(-0.5, 0.5)};
            p[k / 50] = (k % 2 == 0 ? 0.5 : -0.5) + 1.5e-6 * r.range(-1, 1);
            points.emplace_back(p);
        }
        const Shape hull = ConvexHull::build(points).value();
        for (const ConvexHull::Face& face : std::get<ConvexHullPtr>(hull)->faces()) merged += face.edge_count > 4 ? 1 : 0;
        for (int k = 0; k < 40; ++k) {
            const float radius = static_cast<float>(std::pow(10.0, r.range(-3.0, -0.5)));
            const Pose pose{{r.range(-0.48, 0.48), 0.5 + static_cast<double>(radius) * r.range(0.3, 1.0), r.range(-0.48, 0.48)}, kIdentityRotation};
            const DistanceResult truth = distance(Sphere{1e-12f}, pose, hull, Pose{});
            if (truth.status == DistanceStatus::Overlap || truth.upper > static_cast<double>(radius)) continue;  // beside the outermost points
            const Shape ball = Sphere{radius};
            std::vector<Manifold> found;
            collide({&ball, &hull, pose, {}, 0.01f}, 0, found);
            ASSERT_EQ(found.size(), 1u) << i << ' ' << k;
            ASSERT_NEAR(found[0].points[0].separation, truth.upper - static_cast<double>(radius), 5e-6) << i << ' ' << k;
        }
    }
    EXPECT_GT(merged, 10);
}

}  // namespace
}  // namespace carom
