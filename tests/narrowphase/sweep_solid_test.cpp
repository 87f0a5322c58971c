// Balls and capsules against cylinders and hulls, half-spaces against cones, hulls and meshes: never late, early by what sweep.hpp says.
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/narrowphase/sweep.hpp>
#include <carom/narrowphase/time_of_impact.hpp>

#include <support/exact_distance.hpp>
#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace carom {
namespace {

using exact::Rational;
using Real = long double;
using rvec3 = glm::vec<3, Real>;

template <class T>
glm::vec<3, T> any_vector(Random& random, double size) {
    return glm::vec<3, T>(size * dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)});
}

Real length_of(const rvec3& v) { return std::sqrt(glm::dot(v, v)); }

/// How far a point is from a solid cylinder.
template <class T>
Real distance_to(const geo::Cylinder<T>& c, const rvec3& p) {
    const rvec3 a(c.axis.a), b(c.axis.b), middle = Real(0.5) * (a + b);
    const Real length = length_of(b - a);
    const rvec3 axis = (b - a) / length, from = p - middle;
    const Real along = glm::dot(from, axis), across = length_of(from - along * axis);
    const Real beside = std::max(Real(0), across - Real(c.radius)), beyond = std::max(Real(0), std::abs(along) - Real(0.5) * length);
    return std::sqrt(beside * beside + beyond * beyond);
}

/// The least of a convex function on [0, 1], and where.
template <class F>
Real least(const F& f, Real* where = nullptr) {
    Real low = 0, high = 1;
    for (int i = 0; i < 200; ++i) {
        const Real p = low + (high - low) / 3, q = high - (high - low) / 3;
        if (f(p) <= f(q)) {
            high = q;
        } else {
            low = p;
        }
    }
    const Real middle = Real(0.5) * (low + high);
    if (where != nullptr) *where = middle;
    return std::min({f(middle), f(Real(0)), f(Real(1))});
}

template <class T>
Real core_distance(const geo::Sphere<T>& a, const geo::Cylinder<T>& b, const rvec3& by) {
    return distance_to(b, rvec3(a.center) + by);
}
template <class T>
Real core_distance(const geo::Capsule<T>& a, const geo::Cylinder<T>& b, const rvec3& by) {
    const rvec3 from = rvec3(a.axis.a) + by, along = rvec3(a.axis.b) - rvec3(a.axis.a);
    return least([&](Real s) { return distance_to(b, from + s * along); });
}

template <class T>
void place(Random& random, geo::Sphere<T>& s, const glm::vec<3, T>& at) {
    s = {at, T(random.range(0.0, 0.4))};
}
template <class T>
void place(Random& random, geo::Capsule<T>& c, const glm::vec<3, T>& at) {
    c = {{at, at + any_vector<T>(random, 0.8)}, T(random.unit() < 0.2 ? 0.0 : random.range(0.0, 0.4))};
}

/// @param slack  what the distance of a segment is known to [m].
template <class T, class A>
void judge(const A& a, const glm::vec<3, T>& motion, const geo::Cylinder<T>& b, double slack) {
    const BasicImpact<T> hit = geo::sweep(a, motion, b);
    const auto gap = [&](Real t) { return core_distance(a, b, t * rvec3(motion)) - Real(a.radius); };
    ASSERT_TRUE(hit.status != ImpactStatus::Invalid && hit.status != ImpactStatus::Clamped);
    if (hit.status == ImpactStatus::Separated) {
        ASSERT_GT(least(gap), -slack) << "missed";
        return;
    }
    for (const Real share : {Real(0.25), Real(0.75), Real(1)})
        ASSERT_TRUE(hit.t == T(0) || gap(share * Real(hit.t)) > -slack)
            << "late at " << double(hit.t) << " by " << double(gap(share * Real(hit.t))) << " at " << double(share);
    const double size = 6.0 + glm::length(dvec3(motion)), step = std::is_same_v<T, float> ? 1.2e-7 : 0.0;
    const double most = requires { a.center; }
    ? 96.0 : 1e5;  // of eps S
    ASSERT_LT(gap(Real(hit.t)), most * 0x1p-52 * size + step * glm::length(dvec3(motion)));
    ASSERT_EQ(hit.status == ImpactStatus::Overlapping, hit.t == T(0));
    if (hit.status == ImpactStatus::Overlapping) return;
    const double near = std::is_same_v<T, float> ? 4e-6 : 1e-7;
    ASSERT_NEAR(glm::length(dvec3(hit.normal)), 1.0, 1e-6);
    ASSERT_LT(distance_to(b, rvec3(hit.point)), near) << "the point is not on B";
    A moved = a;
    if constexpr (requires { moved.center; }) {
        moved.center += hit.t * motion;
        ASSERT_NEAR(glm::length(dvec3(hit.point) - dvec3(moved.center)), double(a.radius), near);
    }
    // From A to B: against it, A leaves B.
    const rvec3 back = Real(hit.t) * rvec3(motion) - Real(0x1p-10) * rvec3(hit.normal);
    ASSERT_TRUE(a.radius < T(1e-3) || core_distance(a, b, back) > core_distance(a, b, Real(hit.t) * rvec3(motion)));
}

template <class T, class A>
void judge_cylinders(std::uint64_t seed, int count, double slack) {
    Random random(seed);
    int touching = 0, separated = 0;
    for (int i = 0; i < count; ++i) {
        A a;
        const glm::vec<3, T> motion = any_vector<T>(random, i % 4 == 0 ? 1.0 : 6.0);
        place(random, a, any_vector<T>(random, 1.0) - motion * T(0.5));
        const auto p = any_vector<T>(random, 1.0);
        // Tubes, discs and rods.
        const double length = i % 7 == 0 ? 1e-3 : 1.0, radius = i % 5 == 0 ? 1e-3 : 0.6;
        const geo::Cylinder<T> b{{p, p + any_vector<T>(random, length)}, T(random.range(0.1, 1.0) * radius)};
        judge<T>(a, motion, b, slack);
        if (testing::Test::HasFatalFailure()) FAIL() << "number " << i;
        const ImpactStatus status = geo::sweep(a, motion, b).status;
        touching += status == ImpactStatus::Touching, separated += status == ImpactStatus::Separated;
        if (i % 4 != 1) continue;
        // Grazing: A's radius such that the two just touch, or just do not.
        const Real reach = least([&](Real t) { return core_distance(a, b, t * rvec3(motion)); });
        if (!(reach > 0.01L)) continue;
        for (const double gap : {-1e-7, -1e-12, -0x1p-52, 0.0, 0x1p-52, 1e-12, 1e-7}) {
            A grazing = a;
            grazing.radius = T(reach * Real(1.0 + gap));
            judge<T>(grazing, motion, b, slack);
            if (testing::Test::HasFatalFailure()) FAIL() << "number " << i << " gap " << gap;
        }
    }
    EXPECT_GT(touching, count / 8);
    EXPECT_GT(separated, count / 8);
}

template <class T>
class SweepSolidOf : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(SweepSolidOf, Scalars);

TYPED_TEST(SweepSolidOf, SpheresMeetCylinders) { judge_cylinders<TypeParam, geo::Sphere<TypeParam>>(0x5c11, 3000, 0.0); }
// Thirds tell where a function is least to the root of its rounding: of the least itself nothing is lost but that.
TYPED_TEST(SweepSolidOf, CapsulesMeetCylinders) { judge_cylinders<TypeParam, geo::Capsule<TypeParam>>(0xc411, 80, 1e-18); }

ConvexHullPtr any_tetrahedron(Random& random) {
    for (;;) {
        std::vector<vec3> points;
        for (int i = 0; i < 4; ++i) points.push_back(any_vector<float>(random, 1.0));
        const Result<ConvexHullPtr> hull = ConvexHull::build(points);
        if (hull) return *hull;
    }
}

/// The faces of a tetrahedron, exactly, and whether something is inside of it.
struct ExactHull {
    std::vector<exact::Solid> faces;
    std::vector<exact::Vec> corners;

    explicit ExactHull(const ConvexHull& hull) {
        const auto v = hull.vertices();
        for (int skip = 0; skip < 4; ++skip) {
            std::vector<dvec3> c;
            for (int i = 0; i < 4; ++i) {
                if (i != skip) c.push_back(dvec3(v[static_cast<std::size_t>(i)]));
            }
            faces.push_back(exact::solid(geo::Triangle<double>{c[0], c[1], c[2]}));
        }
        for (const vec3& p : v) corners.push_back(exact::vec(p));
    }
    [[nodiscard]] bool holds(const exact::Vec& p) const {
        int sides = 0;
        for (int k = 0; k < 4; ++k) {
            const exact::Vec &a = corners[static_cast<std::size_t>((k + 1) % 4)], &b = corners[static_cast<std::size_t>((k + 2) % 4)],
                             &c = corners[static_cast<std::size_t>((k + 3) % 4)], &d = corners[static_cast<std::size_t>(k)];
            const exact::Vec n = exact::cross(b - a, c - a);
            sides += exact::dot(n, p - a).sign() * exact::dot(n, d - a).sign() >= 0;
        }
        return sides == 4;
    }
    /// Of the core of A, moved.
    [[nodiscard]] Rational distance_sq(exact::Solid a, const exact::Vec& by) const {
        for (exact::Vec& p : a.corners) p = p + by;
        if (holds(a.corners.front())) return Rational(0);
        Rational least = exact::core_distance_sq(a, faces.front());
        for (const exact::Solid& face : faces) least = std::min(least, Rational(exact::core_distance_sq(a, face)));
        return least;
    }
};

template <class A>
void judge_hulls(std::uint64_t seed, int count) {
    Random random(seed);
    int touching = 0, separated = 0, overlapping = 0;
    for (int i = 0; i < count; ++i) {
        const ConvexHullPtr hull = any_tetrahedron(random);
        const dvec3 motion = any_vector<double>(random, i % 4 == 0 ? 1.0 : 6.0);
        A a;
        place(random, a, any_vector<double>(random, 1.0) - 0.5 * motion);
        const Impact hit = geo::sweep(a, motion, *hull);
        const ExactHull truth(*hull);
        const exact::Solid solid = exact::solid(a);
        const exact::Vec by = exact::vec(motion);
        const auto apart = [&](const Rational& t) { return truth.distance_sq(solid, t * by) > exact::square(solid.radius); };
        ASSERT_TRUE(hit.status != ImpactStatus::Invalid && hit.status != ImpactStatus::Clamped) << i;
        touching += hit.status == ImpactStatus::Touching, separated += hit.status == ImpactStatus::Separated,
            overlapping += hit.status == ImpactStatus::Overlapping;
        if (hit.status == ImpactStatus::Separated) {
            for (int k = 0; k <= 8; ++k) ASSERT_TRUE(apart(Rational(k / 8.0))) << i << " missed at " << k;
            continue;
        }
        const double gap = std::sqrt(static_cast<double>(truth.distance_sq(solid, Rational(hit.t) * by))) - a.radius;
        ASSERT_LT(gap, 1e-8) << i;
        if (hit.status == ImpactStatus::Overlapping) continue;
        for (const double share : {0.25, 0.5, 0.75, 1.0}) ASSERT_TRUE(apart(Rational(share) * Rational(hit.t))) << i << " late";
        ASSERT_NEAR(glm::length(hit.normal), 1.0, 1e-9) << i;
        const double off = std::sqrt(static_cast<double>(truth.distance_sq(exact::solid(hit.point), exact::Vec{0, 0, 0})));
        ASSERT_LT(off, 1e-7) << i;
        // The same hull as a shape, placed where its frame is.
        if constexpr (std::is_same_v<A, geo::Sphere<double>>) {
            const auto radius = static_cast<float>(a.radius);
            const Impact other =
                time_of_impact(Shape{Sphere{radius}}, {.start = {a.center, kIdentityRotation}, .translation = motion}, Shape{hull}, {});
            ASSERT_EQ(other.status, geo::sweep(geo::Sphere<double>{a.center, double(radius)}, motion, *hull).status) << i;
        }
    }
    EXPECT_GT(touching, count / 8);
    EXPECT_GT(separated, count / 8);
    EXPECT_GT(overlapping, 0);
}

TEST(SweepSolid, SpheresMeetHulls) { judge_hulls<geo::Sphere<double>>(0x5411, 400); }
TEST(SweepSolid, CapsulesMeetHulls) { judge_hulls<geo::Capsule<double>>(0xc411, 150); }

// Of hulls and meshes exactly the lowest vertex, of cones that of the tip or the rim.
TEST(SweepSolid, PlanesMeetTheLowestPoint) {
    Random random(0x91a4);
    int touching = 0, separated = 0, overlapping = 0;
    for (int i = 0; i < 400; ++i) {
        const ConvexHullPtr hull = any_tetrahedron(random);
        const TriangleMeshPtr mesh = *TriangleMesh::build(hull->vertices(), std::vector<TriangleMesh::Triangle>{{0, 1, 2}, {1, 2, 3}});
        const geo::Plane<double> plane{any_vector<double>(random, 2.0), random.range(-3.0, 0.0)};
        const dvec3 motion = any_vector<double>(random, 6.0);
        const Impact hit = geo::sweep(plane, motion, *hull), again = geo::sweep(plane, motion, *mesh);
        ASSERT_EQ(hit.status, again.status) << i;
        ASSERT_EQ(hit.t, again.t) << i;
        const exact::Vec n = exact::vec(plane.normal), by = exact::vec(motion);
        const auto above = [&](const Rational& t) {
            return std::ranges::all_of(hull->vertices(),
                                       [&](const vec3& v) { return exact::dot(n, exact::vec(v) - t * by) > exact::number(plane.offset); });
        };
        touching += hit.status == ImpactStatus::Touching, separated += hit.status == ImpactStatus::Separated,
            overlapping += hit.status == ImpactStatus::Overlapping;
        if (hit.status == ImpactStatus::Overlapping) {
            ASSERT_FALSE(above(Rational(-1e-12)) && above(Rational(1e-12))) << i;
            continue;
        }
        ASSERT_TRUE(above(Rational(hit.t))) << i << " late";
        const double speed = std::abs(glm::dot(plane.normal, motion)) / glm::length(plane.normal);
        ASSERT_FALSE(hit.status == ImpactStatus::Touching && speed > 0.1 && above(Rational(hit.t) + Rational(1e-12))) << i << " early";
    }
    EXPECT_GT(touching, 40);
    EXPECT_GT(separated, 40);
    EXPECT_GT(overlapping, 40);
    // A cone on its side, on its base and on its tip.
    const geo::Plane<double> floor{{0, 2, 0}, 0};
    const dvec3 up{0, 10, 0};
    EXPECT_NEAR(geo::sweep(floor, up, geo::Cone<double>{{0, 6, 0}, {0, 5, 0}, 0.5}).t, 0.5, 1e-12);
    EXPECT_NEAR(geo::sweep(floor, up, geo::Cone<double>{{0, 5, 0}, {0, 6, 0}, 0.5}).t, 0.5, 1e-12);
    EXPECT_NEAR(geo::sweep(floor, up, geo::Cone<double>{{1, 5, 0}, {0, 5, 0}, 0.5}).t, 0.45, 1e-12);
    EXPECT_NEAR(geo::sweep(geo::Plane<float>{{0, 2, 0}, 0}, {0, 10, 0}, geo::Cone<float>{{1, 5, 0}, {0, 5, 0}, 0.5f}).t, 0.45f, 1e-6f);
}

TEST(SweepSolid, SizelessShapesAndMotionsAreAnswered) {
    const geo::Cylinder<double> tube{{{2, -1, 0}, {2, 1, 0}}, 0.5}, disc{{{2, 0, 0}, {2, 0, 0}}, 0.5}, line{{{2, -1, 0}, {2, 1, 0}}, 0.0};
    const geo::Sphere<double> point{dvec3{0.0}, 0.0}, ball{dvec3{0.0}, 0.25}, inside{{2, 0.3, 0.1}, 0.1};
    const geo::Capsule<double> dot{{dvec3{0.0}, dvec3{0.0}}, 0.0}, hair{{dvec3{0.0}, dvec3{0.0, 1e-150, 0.0}}, 0.25},
        spear{{{-9, 0, 0}, {9, 0.1, 0.2}}, 0.01};
    const dvec3 right{4, 0, 0}, nowhere{0.0};
    EXPECT_NEAR(geo::sweep(point, right, tube).t, 0.375, 1e-13);
    EXPECT_NEAR(geo::sweep(point, right, disc).t, 0.375, 1e-13) << "a ball of that radius";
    EXPECT_NEAR(geo::sweep(point, right, line).t, 0.5, 1e-13);
    EXPECT_NEAR(geo::sweep(dot, right, tube).t, 0.375, 1e-13);
    EXPECT_NEAR(geo::sweep(hair, right, tube).t, 0.3125, 1e-13);
    EXPECT_EQ(geo::sweep(ball, nowhere, tube).status, ImpactStatus::Separated);
    EXPECT_EQ(geo::sweep(ball, nowhere, tube).t, 1.0);
    EXPECT_EQ(geo::sweep(ball, 1e-300 * right, tube).status, ImpactStatus::Separated);
    EXPECT_EQ(geo::sweep(inside, right, tube).status, ImpactStatus::Overlapping);
    EXPECT_EQ(geo::sweep(spear, right, tube).status, ImpactStatus::Overlapping) << "neither end, nor any rim, is near";
    const ConvexHullPtr hull = *ConvexHull::build(std::vector<vec3>{{2, -1, -1}, {2, 1, -1}, {2, 0, 1}, {4, 0, 0}});
    EXPECT_NEAR(geo::sweep(point, right, *hull).t, 0.5, 1e-8);
    EXPECT_NEAR(geo::sweep(dot, right, *hull).t, 0.5, 1e-8);
    EXPECT_EQ(geo::sweep(ball, nowhere, *hull).status, ImpactStatus::Separated);
    EXPECT_EQ(geo::sweep(geo::Sphere<double>{{2.5, 0, 0}, 0.0}, right, *hull).status, ImpactStatus::Overlapping);
    EXPECT_EQ(geo::sweep(spear, right, *hull).status, ImpactStatus::Overlapping);
}

// What rounding leaves of the way along the wire must not be taken for a way across it, which is short.
TEST(SweepSolid, PointsPassWiresThatTheyMissByLittle) {
    Random random(0x317e);
    for (int i = 0; i < 2000; ++i) {
        const dquat turn = test::random_rotation(random);
        const dvec3 axis = rotate(turn, dvec3{0, 1, 0}), along = rotate(turn, dvec3{1, 0, 0}), aside = rotate(turn, dvec3{0, 0, 1});
        const double off = std::pow(10.0, random.range(-10.0, -7.0));
        const dvec3 middle = random.range(-0.9, 0.9) * axis;
        const geo::Sphere<double> point{middle - along + off * aside, 0.0};
        EXPECT_EQ(geo::sweep(point, 2.0 * along, geo::Cylinder<double>{{-axis, axis}, 0.0}).status, ImpactStatus::Separated) << off;
    }
}

TEST(SweepSolid, BadInputIsInvalid) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const geo::Sphere<double> ball{{9, 0, 0}, 1.0};
    const geo::Capsule<double> rod{{{9, 0, 0}, {9, 1, 0}}, 1.0};
    const geo::Cylinder<double> tube{{{0, 0, 0}, {0, 1, 0}}, 1.0};
    const geo::Cone<double> cone{{0, 1, 0}, {0, 0, 0}, 1.0};
    const geo::Plane<double> floor{{0, 1, 0}, -5.0};
    const ConvexHullPtr hull = *ConvexHull::build(std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    const TriangleMeshPtr mesh = *TriangleMesh::build(hull->vertices(), std::vector<TriangleMesh::Triangle>{{0, 1, 2}});
    const dvec3 along{1, 0, 0};
    const auto expect_invalid = [](const Impact& impact) {
        EXPECT_EQ(impact.status, ImpactStatus::Invalid);
        EXPECT_EQ(impact.t, 0.0);
    };
    for (const double bad : {kInfinity, std::numeric_limits<double>::quiet_NaN(), 1e71}) {
        const dvec3 motion{0, bad, 0};
        for (const Impact& i : {geo::sweep(ball, motion, tube), geo::sweep(rod, motion, tube), geo::sweep(ball, motion, *hull),
                                geo::sweep(rod, motion, *hull), geo::sweep(floor, motion, cone), geo::sweep(floor, motion, *hull),
                                geo::sweep(floor, motion, *mesh)}) {
            expect_invalid(i);
        }
        expect_invalid(geo::sweep(geo::Sphere<double>{{bad, 0, 0}, 1.0}, along, *hull));
        expect_invalid(geo::sweep(geo::Capsule<double>{{{bad, 0, 0}, {0, 0, 0}}, 1.0}, along, *hull));
        expect_invalid(geo::sweep(geo::Plane<double>{{0, bad, 0}, 0.0}, along, *hull));
        expect_invalid(geo::sweep(ball, along, geo::Cylinder<double>{{{0, 0, 0}, {0, bad, 0}}, 1.0}));
        expect_invalid(geo::sweep(rod, along, geo::Cylinder<double>{{{0, 0, 0}, {0, 1, 0}}, bad}));
        expect_invalid(geo::sweep(floor, along, geo::Cone<double>{{0, bad, 0}, {0, 0, 0}, 1.0}));
        expect_invalid(geo::sweep(floor, along, geo::Cone<double>{{0, 1, 0}, {0, 0, bad}, 1.0}));
    }
    expect_invalid(geo::sweep(geo::Sphere<double>{{9, 0, 0}, -1.0}, along, tube));
    expect_invalid(geo::sweep(geo::Sphere<double>{{9, 0, 0}, -1.0}, along, *hull));
    expect_invalid(geo::sweep(geo::Capsule<double>{rod.axis, -1.0}, along, *hull));
    expect_invalid(geo::sweep(ball, along, geo::Cylinder<double>{tube.axis, -1.0}));
    expect_invalid(geo::sweep(floor, along, geo::Cone<double>{cone.tip, cone.base_center, -1.0}));
    expect_invalid(geo::sweep(geo::Plane<double>{{0, 0, 0}, 0.0}, along, *mesh));
}

}  // namespace
}  // namespace carom
