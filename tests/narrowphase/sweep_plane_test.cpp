// Half-spaces that move onto what is far along them, and onto discs that they are next to parallel to: never late, and early by rounding alone.
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/narrowphase/sweep.hpp>

#include <support/exact_distance.hpp>
#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace carom {
namespace {

using exact::Rational;
using Real = long double;
using rvec3 = glm::vec<3, Real>;

dvec3 any(Random& random, double size) { return size * dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)}; }
Real length_of(const rvec3& v) { return std::sqrt(glm::dot(v, v)); }

// What is far along the plane is known to less.
TEST(SweepPlane, PlanesThatReachFarAreNeverLate) {
    Random random(0xfa4);
    for (int i = 0; i < 400; ++i) {
        const geo::Plane<double> plane{test::random_direction(random), 0.0};
        const dvec3 far = 1e5 * glm::normalize(glm::cross(plane.normal, any(random, 1.0)));
        std::vector<vec3> points;
        for (int k = 0; k < 4; ++k) points.push_back(vec3(far + plane.normal + any(random, 0.5)));
        const Result<ConvexHullPtr> hull = ConvexHull::build(points);
        if (!hull) continue;
        const TriangleMeshPtr mesh = *TriangleMesh::build(points, std::vector<TriangleMesh::Triangle>{{0, 1, 2}, {1, 2, 3}});
        const dvec3 motion = 3.0 * plane.normal + 0.3 * any(random, 1.0);
        const exact::Vec n = exact::vec(plane.normal), by = exact::vec(motion);
        const auto judge_late = [&](const Impact& hit, std::span<const vec3> vertices) {
            if (hit.status == ImpactStatus::Overlapping) return;
            for (const vec3& v : vertices)
                ASSERT_GT(exact::dot(n, exact::vec(v) - Rational(hit.t) * by).sign(), 0) << i << " late at " << hit.t;
        };
        judge_late(geo::sweep(plane, motion, **hull), (*hull)->vertices());
        judge_late(geo::sweep(plane, motion, *mesh), mesh->vertices());
        if (HasFatalFailure()) return;
    }
}

// Where the axis runs along the plane's normal but for a tilt that rounding all but hides, the rim's lowest point is known by that tilt.
TEST(SweepPlane, PlanesMeetDiscsThatTheyAreNextToParallelTo) {
    Random random(0xd15c);
    for (int i = 0; i < 6000; ++i) {
        const dvec3 n = test::random_direction(random), base = any(random, 1.0), tilt = any(random, 1.0);
        const dvec3 top = base + random.range(0.1, 1.0) * (n + std::pow(10.0, random.range(-18.0, -1.0)) * tilt);
        const double radius = random.range(0.1, 1.0);
        const geo::Plane<double> plane{n, -3.0};
        const rvec3 across = glm::cross(rvec3(n), rvec3(top) - rvec3(base));
        const Real long_n = length_of(rvec3(n)), rim = Real(radius) * length_of(across) / (length_of(rvec3(top) - rvec3(base)) * long_n);
        const Real of_base = glm::dot(rvec3(n), rvec3(base)) / long_n, of_top = glm::dot(rvec3(n), rvec3(top)) / long_n;
        const auto judge_lowest = [&](const Impact& hit, Real lowest) {
            const Real left = lowest - Real(hit.t) * 8 * glm::dot(rvec3(n), rvec3(n)) / long_n - Real(plane.offset) / long_n;
            ASSERT_EQ(hit.status, ImpactStatus::Touching) << i;
            ASSERT_GT(left, Real(0)) << i << " late";
            ASSERT_LT(left, Real(96 * 0x1p-52 * 20.0)) << i;
        };
        judge_lowest(geo::sweep(plane, 8.0 * n, geo::Cylinder<double>{{base, top}, radius}), std::min(of_base, of_top) - rim);
        judge_lowest(geo::sweep(plane, 8.0 * n, geo::Cone<double>{top, base, radius}), std::min(of_base - rim, of_top));
        if (HasFatalFailure()) return;
    }
}

}  // namespace
}  // namespace carom
