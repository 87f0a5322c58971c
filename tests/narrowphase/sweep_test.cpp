// Sweeps in closed form against exact distances: never late, never missed, early by rounding alone.
#include <carom/collision/closest_points.hpp>
#include <carom/core/math.hpp>
#include <carom/narrowphase/sweep.hpp>

#include <support/exact_distance.hpp>
#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace carom {
namespace {

using exact::Rational;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class T>
glm::vec<3, T> any_vector(Random& random, double size) {
    return glm::vec<3, T>(size * dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)});
}
template <class T>
void fill(Random& random, geo::Sphere<T>& s) {
    s = {any_vector<T>(random, 1.0), T(random.range(0.0, 0.4))};
}
template <class T>
void fill(Random& random, geo::Capsule<T>& c) {
    c = {{any_vector<T>(random, 1.0), any_vector<T>(random, 1.0)}, T(random.range(0.0, 0.4))};
}
template <class T>
void fill(Random& random, geo::Aabb<T>& b) {
    const auto p = any_vector<T>(random, 1.0), q = any_vector<T>(random, 1.0);
    b = {glm::min(p, q), glm::max(p, q)};
}
template <class T>
void fill(Random& random, geo::Obb<T>& b) {
    b.center = any_vector<T>(random, 1.0);
    b.half_extents = glm::abs(any_vector<T>(random, 0.7));
    if constexpr (std::is_same_v<T, double>) {
        b.axes = glm::mat3_cast(test::random_rotation(random));
    } else {
        b.axes = glm::mat<3, 3, T>(0, 1, 0, 0, 0, 1, 1, 0, 0);  // floats are orthonormal only to 1e-7 else
    }
}
template <class T>
void fill(Random& random, geo::Triangle<T>& t) {
    t = {any_vector<T>(random, 1.0), any_vector<T>(random, 1.0), any_vector<T>(random, 1.0)};
}

/// The squared distance of the cores of A, moved to t, and B, and the summed radius.
template <class A, class B, class T>
struct Truth {
    exact::Solid a, b;
    exact::Vec motion;
    Rational radius_sq;

    Truth(const A& first, const glm::vec<3, T>& by, const B& second)
        : a(exact::solid(first)), b(exact::solid(second)), motion(exact::vec(by)), radius_sq(exact::square(a.radius + b.radius)) {}
    [[nodiscard]] Rational distance_sq(const Rational& t) const {
        exact::Solid moved = a;
        for (exact::Vec& p : moved.corners) p = p + t * motion;
        if constexpr (std::is_same_v<A, geo::Aabb<T>>) {
            Rational sum = 0;
            for (int k = 0; k < 3; ++k) {  // corner 0 is the lower one, corner 7 the upper
                const Rational gap = std::max(Rational(moved.corners[0][k] - b.corners[7][k]), Rational(b.corners[0][k] - moved.corners[7][k]));
                if (gap.sign() > 0) sum += gap * gap;
            }
            return sum;
        } else {
            return exact::core_distance_sq(moved, b);
        }
    }
    [[nodiscard]] bool apart(const Rational& t) const { return distance_sq(t) > radius_sq || (radius_sq.sign() == 0 && distance_sq(t).sign() > 0); }
};

// Cores in double.
template <class T>
auto core(const geo::Sphere<T>& s) { return dvec3(s.center); }
template <class T>
auto core(const geo::Capsule<T>& c) { return geo::Segment<double>{dvec3(c.axis.a), dvec3(c.axis.b)}; }
template <class T>
auto core(const geo::Aabb<T>& b) { return geo::Aabb<double>{dvec3(b.lower), dvec3(b.upper)}; }
template <class T>
auto core(const geo::Obb<T>& b) { return geo::Obb<double>{dvec3(b.center), dvec3(b.half_extents), dmat3(b.axes)}; }
template <class T>
auto core(const geo::Triangle<T>& t) { return geo::Triangle<double>{dvec3(t.a), dvec3(t.b), dvec3(t.c)}; }
dvec3 moved(const dvec3& p, const dvec3& by) { return p + by; }
geo::Segment<double> moved(const geo::Segment<double>& s, const dvec3& by) { return {s.a + by, s.b + by}; }
geo::Aabb<double> moved(const geo::Aabb<double>& b, const dvec3& by) { return {b.lower + by, b.upper + by}; }

/// When they are nearest, to 1e-8 or so: the distance is convex in t.
template <class A, class B, class T>
double nearest_time(const A& a, const glm::vec<3, T>& motion, const B& b) {
    double low = 0.0, high = 1.0;
    const auto at = [&](double t) { return geo::closest_points(moved(core(a), t * dvec3(motion)), core(b)).distance_sq; };
    for (int i = 0; i < 80; ++i) {
        const double p = low + (high - low) / 3.0, q = high - (high - low) / 3.0;
        (at(p) <= at(q) ? high : low) = at(p) <= at(q) ? q : p;
    }
    return 0.5 * (low + high);
}

template <class T, class A, class B>
void judge(const A& a, const glm::vec<3, T>& motion, const B& b, const BasicImpact<T>& impact, double nearest, double early = 0.0) {
    const Truth<A, B, T> truth(a, motion, b);
    ASSERT_NE(impact.status, ImpactStatus::Invalid);
    if (impact.status == ImpactStatus::Separated) {
        for (const double t : {0.5, nearest}) ASSERT_TRUE(truth.apart(Rational(t))) << "missed at " << t;
        return;
    }
    const Rational t(static_cast<double>(impact.t));
    // No contact before t; at t they are as near as rounding tells.
    ASSERT_TRUE(impact.t == T(0) || truth.apart(t / 2)) << "late: " << impact.t;
    ASSERT_TRUE(impact.t == T(0) || truth.apart(t)) << "late: " << impact.t;
    const double size = 4.0 + glm::length(dvec3(motion)), step = std::is_same_v<T, float> ? 1.2e-7 : 2e-14;
    const double gap = std::sqrt(static_cast<double>(truth.distance_sq(t))) - std::sqrt(static_cast<double>(truth.radius_sq));
    ASSERT_LT(gap, 1e-12 * size + step * glm::length(dvec3(motion)) + early);
    ASSERT_TRUE((impact.status == ImpactStatus::Overlapping) == (impact.t == T(0)));
    if (impact.status == ImpactStatus::Overlapping) return;
    ASSERT_NEAR(glm::length(dvec3(impact.normal)), 1.0, 1e-6);
    // The point lies on both: on A moved to t, and on B.
    const double near = (std::is_same_v<T, float> ? 4e-6 : 1e-9) + early;
    exact::Solid moved = truth.a;
    for (exact::Vec& p : moved.corners) p = p + t * truth.motion;
    const auto off = [&](const exact::Solid& s) {
        const double d = std::sqrt(static_cast<double>(exact::core_distance_sq(exact::solid(dvec3(impact.point)), s)));
        return std::abs(d - static_cast<double>(s.radius));
    };
    ASSERT_LT(off(moved), near);
    ASSERT_LT(off(truth.b), near);
    // From A to B: moving against it, A would leave B.
    exact::Solid back = moved;
    for (exact::Vec& p : back.corners) p = p - exact::Rational(0x1p-10) * exact::vec(dvec3(impact.normal));
    ASSERT_TRUE(truth.radius_sq.sign() == 0 || exact::core_distance_sq(back, truth.b) > exact::core_distance_sq(moved, truth.b));
}

template <class T, class A, class B>
void judge_random(Random& random, int count) {
    int touching = 0, separated = 0;
    for (int i = 0; i < count; ++i) {
        A a;
        B b;
        fill(random, a);
        fill(random, b);
        // Mostly towards B from outside.
        const glm::vec<3, T> motion = any_vector<T>(random, i % 4 == 0 ? 1.0 : 6.0);
        const glm::vec<3, T> away = -motion * T(0.5);
        if constexpr (requires { a.center; }) {
            a.center += away;
        } else if constexpr (requires { a.axis; }) {
            a.axis.a += away, a.axis.b += away;
        } else {
            a.lower += away, a.upper += away;
        }
        const BasicImpact<T> impact = geo::sweep(a, motion, b);
        touching += impact.status == ImpactStatus::Touching ? 1 : 0;
        separated += impact.status == ImpactStatus::Separated ? 1 : 0;
        const double nearest = nearest_time(a, motion, b);
        judge<T>(a, motion, b, impact, nearest);
        if (testing::Test::HasFatalFailure()) FAIL() << "number " << i;
        // Grazing: A's radius such that the two just touch, or just do not.
        if constexpr (requires { a.radius; }) {
            if (i % 4 != 1) continue;
            const Truth<A, B, T> truth(a, motion, b);
            const double reach = std::sqrt(static_cast<double>(truth.distance_sq(Rational(nearest)))) - static_cast<double>(truth.b.radius);
            if (!(reach > 0.01)) continue;
            for (const double gap : {-1e-7, -1e-12, -0x1p-52, 0.0, 0x1p-52, 1e-12, 1e-7}) {
                A grazing = a;
                grazing.radius = T(reach * (1.0 + gap));
                judge<T>(grazing, motion, b, geo::sweep(grazing, motion, b), nearest);
                if (testing::Test::HasFatalFailure()) FAIL() << "number " << i << " gap " << gap;
            }
        }
    }
    EXPECT_GT(touching, 0);
    EXPECT_GT(separated, 0);
}

template <class T>
class SweepOf : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(SweepOf, Scalars);

TYPED_TEST(SweepOf, SpheresMeetWhatTheyMeet) {
    using T = TypeParam;
    Random random(0x5b0e);
    judge_random<T, geo::Sphere<T>, geo::Sphere<T>>(random, 40);
    judge_random<T, geo::Sphere<T>, geo::Capsule<T>>(random, 40);
    judge_random<T, geo::Sphere<T>, geo::Aabb<T>>(random, 20);
    judge_random<T, geo::Sphere<T>, geo::Obb<T>>(random, 20);
    judge_random<T, geo::Sphere<T>, geo::Triangle<T>>(random, 40);
}
TYPED_TEST(SweepOf, CapsulesMeetWhatTheyMeet) {
    using T = TypeParam;
    Random random(0xca75);
    judge_random<T, geo::Capsule<T>, geo::Sphere<T>>(random, 40);
    judge_random<T, geo::Capsule<T>, geo::Capsule<T>>(random, 40);
    judge_random<T, geo::Capsule<T>, geo::Aabb<T>>(random, 20);
    judge_random<T, geo::Capsule<T>, geo::Obb<T>>(random, 20);
    judge_random<T, geo::Capsule<T>, geo::Triangle<T>>(random, 40);
}
TYPED_TEST(SweepOf, BoxesMeetBoxes) {
    using T = TypeParam;
    Random random(0xb0b0);
    judge_random<T, geo::Aabb<T>, geo::Aabb<T>>(random, 40);
}

/// The least height of a solid's corners over the plane, less its radius, is positive at t: exactly.
template <class T, class B>
bool above(const geo::Plane<T>& plane, const B& b, const exact::Vec& shift) {
    const exact::Solid solid = exact::solid(b);
    const exact::Vec n = exact::vec(plane.normal);
    Rational least = exact::dot(n, solid.corners[0] + shift) - exact::number(plane.offset);
    for (const exact::Vec& p : solid.corners) least = std::min(least, Rational(exact::dot(n, p + shift) - exact::number(plane.offset)));
    return least.sign() > 0 && exact::square(least) > exact::square(solid.radius) * exact::length_sq(n);
}

template <class T, class B>
void judge_plane(Random& random) {
    int touching = 0, separated = 0;
    for (int i = 0; i < 200; ++i) {
        B b;
        fill(random, b);
        const geo::Plane<T> plane{any_vector<T>(random, 2.0), T(random.range(-3.0, 0.0))};
        const glm::vec<3, T> motion = any_vector<T>(random, 6.0);
        const exact::Vec by = exact::vec(motion);
        const BasicImpact<T> onto = geo::sweep(plane, motion, b);
        const auto check = [&](const BasicImpact<T>& impact, const Rational& sign) {
            const Rational t(static_cast<double>(impact.t));
            if (impact.status == ImpactStatus::Overlapping) {
                ASSERT_FALSE(above(plane, b, exact::Vec{0, 0, 0}));
                return;
            }
            ASSERT_TRUE(above(plane, b, (sign * t) * by)) << "late";
            if (impact.status == ImpactStatus::Separated) {
                ++separated;
                return;
            }
            ++touching;
            const Rational later = t + Rational(std::is_same_v<T, float> ? 4e-7 : 1e-12);
            // Head-on within rounding; along the plane the time may be earlier.
            const double speed = std::abs(glm::dot(dvec3(plane.normal), dvec3(motion))) / glm::length(dvec3(plane.normal));
            ASSERT_FALSE(speed > 0.1 && above(plane, b, (sign * later) * by)) << "early";
        };
        check(onto, Rational(-1));
        if constexpr (requires { geo::sweep(b, motion, plane); }) {
            const BasicImpact<T> fall = geo::sweep(b, motion, plane);
            check(fall, Rational(1));
            ASSERT_EQ(geo::sweep(plane, -motion, b).t, fall.t);
        }
    }
    EXPECT_GT(touching, 20);
    EXPECT_GT(separated, 20);
}
TYPED_TEST(SweepOf, PlanesMeetTheLowestPoint) {
    using T = TypeParam;
    Random random(0x91a4e);
    judge_plane<T, geo::Sphere<T>>(random);
    judge_plane<T, geo::Capsule<T>>(random);
    judge_plane<T, geo::Aabb<T>>(random);
    judge_plane<T, geo::Obb<T>>(random);
    judge_plane<T, geo::Triangle<T>>(random);
    // A cylinder: lying, standing and tilted.
    for (const double tilt : {0.0, 0.5, 0.25 * kPi, 0.5 * kPi}) {
        const SinCos turn = sin_cos(tilt);
        const geo::Cylinder<T> c{{glm::vec<3, T>(-turn.sin, 5.0 - turn.cos, 0.0), glm::vec<3, T>(turn.sin, 5.0 + turn.cos, 0.0)}, T(0.5)};
        const BasicImpact<T> hit = geo::sweep(geo::Plane<T>{{0, 2, 0}, 0}, {0, 10, 0}, c);
        EXPECT_EQ(hit.status, ImpactStatus::Touching);
        EXPECT_NEAR(double(hit.t), (5.0 - turn.cos - 0.5 * turn.sin) / 10.0, 1e-7);
        EXPECT_NEAR(double(hit.normal.y), 1.0, 1e-7);
    }
}

/// Needles and caps, whose normals are lost to rounding, and nearly parallel edges: met, and not from afar.
TEST(Sweep, NeedlesAreMetWhereTheyAre) {
    Random random(0x4eed1e);
    for (int i = 0; i < 300; ++i) {
        const double width = std::pow(10.0, random.range(-19.0, -2.0));
        const dvec3 a = any_vector<double>(random, 1.0), along = test::random_direction(random), aside = test::random_direction(random);
        const geo::Triangle<double> needle{a, a + along, a + (i % 2 == 0 ? 1.0 : 0.4) * along + width * aside};
        const geo::Sphere<double> ball{a + 0.4 * along + 3.0 * aside, random.range(0.01, 0.2)};
        const Impact hit = geo::sweep(ball, -6.0 * aside, needle);
        judge<double>(ball, -6.0 * aside, needle, hit, 0.5, 1e-6);
        ASSERT_EQ(hit.status, ImpactStatus::Touching) << width;
        ASSERT_GT(hit.t, 0.3) << width;
        const geo::Capsule<double> rod{{ball.center, ball.center + along + width * aside}, ball.radius}, other{{a, a + along}, 0.1};
        const Impact rods = geo::sweep(rod, -6.0 * aside, other);
        judge<double>(rod, -6.0 * aside, other, rods, 0.5, 1e-6);
        if (HasFatalFailure()) FAIL() << i << " width " << width;
    }
}

/// Points, segments and flat boxes; motions of zero.
TEST(Sweep, SizelessShapesAndMotionsAreAnswered) {
    const geo::Sphere<double> point{{0, 0, 0}, 0.0}, ball{{0, 0, 0}, 0.5};
    const dvec3 nowhere{0.0}, right{4, 0, 0};
    const geo::Capsule<double> dot{{{2, 0, 0}, {2, 0, 0}}, 0.0};
    const geo::Aabb<double> sheet{{2, -1, -1}, {2, 1, 1}}, spot{{2, 0, 0}, {2, 0, 0}};
    const geo::Triangle<double> line{{2, -1, 0}, {2, 1, 0}, {2, 0, 0}};
    EXPECT_NEAR(geo::sweep(point, right, dot).t, 0.5, 1e-13);
    EXPECT_NEAR(geo::sweep(point, right, sheet).t, 0.5, 1e-13);
    EXPECT_NEAR(geo::sweep(point, right, sheet).normal.x, 1.0, 1e-13);
    EXPECT_NEAR(geo::sweep(point, right, spot).t, 0.5, 1e-13);
    EXPECT_NEAR(geo::sweep(point, right, line).t, 0.5, 1e-13);
    EXPECT_NEAR(geo::sweep(dot, -right, point).t, 0.5, 1e-13);
    EXPECT_NEAR(geo::sweep(dot, -right, dot).t, 0.0, 0.0);
    for (const Impact& still : {geo::sweep(ball, nowhere, sheet), geo::sweep(ball, nowhere, dot), geo::sweep(ball, nowhere, line)}) {
        EXPECT_EQ(still.status, ImpactStatus::Separated);
        EXPECT_EQ(still.t, 1.0);
    }
    const geo::Sphere<double> inside{{2, 0, 0}, 0.1};
    for (const Impact& start : {geo::sweep(inside, nowhere, sheet), geo::sweep(inside, right, dot), geo::sweep(inside, right, line),
                                geo::sweep(inside, right, geo::Plane<double>{{1, 0, 0}, 3.0})}) {
        EXPECT_EQ(start.status, ImpactStatus::Overlapping);
        EXPECT_EQ(start.t, 0.0);
    }
    // An axis that pierces a face, all ends and edges far away.
    const geo::Capsule<double> spear{{{-9, 0, 0}, {9, 0.1, 0.2}}, 0.01};
    EXPECT_EQ(geo::sweep(spear, right, geo::Aabb<double>{dvec3{-1.0}, dvec3{1.0}}).status, ImpactStatus::Overlapping);
    EXPECT_EQ(geo::sweep(spear, right, geo::Triangle<double>{{0, -5, -5}, {0, 5, -5}, {0, 0, 9}}).status, ImpactStatus::Overlapping);
}

template <class A, class B>
void expect_invalid(const A& a, const B& b) {
    EXPECT_EQ(geo::sweep(a, dvec3{1, 0, 0}, b).status, ImpactStatus::Invalid);
    EXPECT_EQ(geo::sweep(a, dvec3{1, 0, 0}, b).t, 0.0);
}
TEST(Sweep, BadInputIsInvalid) {
    const geo::Sphere<double> ball{{9, 0, 0}, 1.0};
    const geo::Capsule<double> rod{{{9, 0, 0}, {9, 1, 0}}, 1.0};
    const geo::Aabb<double> box{dvec3{-1.0}, dvec3{1.0}};
    const geo::Obb<double> turned{.center = dvec3{0.0}, .half_extents = dvec3{1.0}};
    const geo::Triangle<double> face{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const geo::Plane<double> floor{{0, 1, 0}, -5.0};
    for (const double bad : {kInfinity, std::numeric_limits<double>::quiet_NaN(), 1e71}) {
        const dvec3 motion{0, bad, 0};
        for (const Impact& i : {geo::sweep(ball, motion, ball), geo::sweep(ball, motion, rod), geo::sweep(ball, motion, box),
                                geo::sweep(ball, motion, turned), geo::sweep(ball, motion, face), geo::sweep(ball, motion, floor),
                                geo::sweep(rod, motion, ball), geo::sweep(rod, motion, rod), geo::sweep(rod, motion, box),
                                geo::sweep(rod, motion, turned), geo::sweep(rod, motion, face), geo::sweep(rod, motion, floor),
                                geo::sweep(box, motion, box), geo::sweep(floor, motion, box), geo::sweep(floor, motion, turned)}) {
            EXPECT_EQ(i.status, ImpactStatus::Invalid);
        }
        expect_invalid(geo::Sphere<double>{{bad, 0, 0}, 1.0}, box);
        expect_invalid(geo::Sphere<double>{{0, 0, 0}, bad}, box);
        expect_invalid(geo::Capsule<double>{{{bad, 0, 0}, {0, 0, 0}}, 1.0}, box);
        expect_invalid(ball, geo::Aabb<double>{{-1, -1, -1}, {1, 1, bad}});
        expect_invalid(ball, geo::Triangle<double>{{0, 0, 0}, {1, bad, 0}, {0, 1, 0}});
        expect_invalid(ball, geo::Plane<double>{{bad, 1, 0}, 0.0});
        expect_invalid(geo::Plane<double>{{0, 1, 0}, bad}, ball);
    }
    expect_invalid(geo::Sphere<double>{{0, 0, 0}, -1.0}, ball);
    expect_invalid(ball, geo::Aabb<double>{dvec3{1.0}, dvec3{-1.0}});
    expect_invalid(ball, geo::Obb<double>{.center = dvec3{0.0}, .half_extents = {1, -1, 1}});
    expect_invalid(ball, geo::Plane<double>{{0, 0, 0}, 0.0});
    expect_invalid(geo::Plane<double>{{0, 1, 0}, 0.0}, geo::Cylinder<double>{{{0, 0, 0}, {0, 1, 0}}, -1.0});
}

TEST(Sweep, BatchesAreTheSingleCalls) {
    Random random(0xba7c);
    std::vector<geo::Sphere<float>> a(40);
    std::vector<geo::Aabb<float>> b(40);
    std::vector<vec3> motions(40);
    std::vector<BasicImpact<float>> out(40);
    for (std::size_t i = 0; i < 40; ++i) fill(random, a[i]), fill(random, b[i]), motions[i] = any_vector<float>(random, 5.0);
    geo::sweep<geo::Sphere<float>, geo::Aabb<float>, float>(a, motions, b, out);
    for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(out[i].t, geo::sweep(a[i], motions[i], b[i]).t);
    motions.pop_back();
    EXPECT_THROW((geo::sweep<geo::Sphere<float>, geo::Aabb<float>, float>(a, motions, b, out)), MisuseError);
}

}  // namespace
}  // namespace carom
