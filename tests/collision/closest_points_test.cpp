// Closest points of all pairs: exact distances, certificates of optimality, and what symmetry and scaling demand.
#include <carom/collision/closest_points.hpp>

#include <fuzz/overlap_check.hpp>

#include "primitive_cases.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <type_traits>
#include <vector>

namespace carom {
namespace {

using namespace geo;
using test::Cases;

template <class T>
struct Named {
    template <class A, class B>
    static void check(const char* what, std::uint64_t seed, int count) {
        SCOPED_TRACE(what);
        Cases<T> cases(seed);
        for (int i = 0; i < count; ++i) {
            SCOPED_TRACE(i);
            const auto [a, b] = i % 2 == 0 ? cases.template near_pair<A, B>() : cases.template pair<A, B>();
            ASSERT_EQ(test::closest_fault(a, b, test::exact_pair(a, b)), "");
            ASSERT_EQ(test::closest_fault(b, a, test::exact_pair(b, a)), "");
        }
    }
};

template <class T>
class ClosestPointsOf : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(ClosestPointsOf, Scalars);

TYPED_TEST(ClosestPointsOf, ThinThingsAreExactWithinTheBound) {
    using T = TypeParam;
    using N = Named<T>;
    N::template check<Vec3<T>, Vec3<T>>("point point", 0x0601, 50);
    N::template check<Vec3<T>, Segment<T>>("point segment", 0x0602, 80);
    N::template check<Vec3<T>, Triangle<T>>("point triangle", 0x0603, 100);
    N::template check<Segment<T>, Segment<T>>("segment segment", 0x0604, 150);
    N::template check<Segment<T>, Triangle<T>>("segment triangle", 0x0605, 60);
    N::template check<Triangle<T>, Triangle<T>>("triangle triangle", 0x0606, 30);
    N::template check<Capsule<T>, Segment<T>>("capsule segment", 0x0607, 60);
    N::template check<Capsule<T>, Capsule<T>>("capsule capsule", 0x0608, 80);
    N::template check<Capsule<T>, Triangle<T>>("capsule triangle", 0x0609, 30);
    N::template check<Sphere<T>, Capsule<T>>("sphere capsule", 0x060a, 60);
}

TYPED_TEST(ClosestPointsOf, BoxesAreExactWithinTheBound) {
    using T = TypeParam;
    using N = Named<T>;
    N::template check<Vec3<T>, Aabb<T>>("point aabb", 0x0611, 24);
    N::template check<Vec3<T>, Obb<T>>("point obb", 0x0612, 24);
    N::template check<Segment<T>, Aabb<T>>("segment aabb", 0x0613, 16);
    N::template check<Segment<T>, Obb<T>>("segment obb", 0x0614, 16);
    N::template check<Triangle<T>, Aabb<T>>("triangle aabb", 0x0615, 10);
    N::template check<Triangle<T>, Obb<T>>("triangle obb", 0x0616, 10);
    N::template check<Aabb<T>, Aabb<T>>("aabb aabb", 0x0617, 4);
    N::template check<Aabb<T>, Obb<T>>("aabb obb", 0x0618, 4);
    N::template check<Obb<T>, Obb<T>>("obb obb", 0x0619, 4);
    N::template check<Capsule<T>, Obb<T>>("capsule obb", 0x061a, 10);
}

// Calls fn.template operator()<A, B>(name) for a few pairs that take every path.
template <class T, class Fn>
void for_pairs(Fn&& fn) {
    fn.template operator()<Vec3<T>, Triangle<T>>("point triangle");
    fn.template operator()<Segment<T>, Segment<T>>("segment segment");
    fn.template operator()<Segment<T>, Obb<T>>("segment obb");
    fn.template operator()<Capsule<T>, Capsule<T>>("capsule capsule");
    fn.template operator()<Triangle<T>, Triangle<T>>("triangle triangle");
    fn.template operator()<Triangle<T>, Aabb<T>>("triangle aabb");
    fn.template operator()<Obb<T>, Obb<T>>("obb obb");
    fn.template operator()<Sphere<T>, Aabb<T>>("sphere aabb");
}

TYPED_TEST(ClosestPointsOf, ScalesExactlyByPowersOfTwo) {
    using T = TypeParam;
    const int far = sizeof(T) == 4 ? 50 : 400;  // past 2^200, where doubles are scaled inside
    for_pairs<T>([&]<class A, class B>(const char* what) {
        SCOPED_TRACE(what);
        Cases<T> cases(0x0620);
        for (int i = 0; i < 100; ++i) {
            const auto [a, b] = cases.template pair<A, B>();
            const auto one = closest_points(a, b);
            for (const int power : {far, -far}) {
                const T s = std::ldexp(T(1), power);
                const auto many =
                    closest_points(test::moved(a, dvec3{0.0}, static_cast<double>(s)), test::moved(b, dvec3{0.0}, static_cast<double>(s)));
                ASSERT_EQ(many.on_a, one.on_a * s);
                ASSERT_EQ(many.on_b, one.on_b * s);
                ASSERT_EQ(many.distance_sq, one.distance_sq * s * s);
            }
        }
    });
}

TYPED_TEST(ClosestPointsOf, HoldsAtTheEndsOfTheRange) {
    using T = TypeParam;
    for_pairs<T>([&]<class A, class B>(const char* what) {
        SCOPED_TRACE(what);
        Cases<T> cases(0x0621);
        for (const double power : sizeof(T) == 4 ? std::vector<double>{-120, -66, 66, 120} : std::vector<double>{-990, -520, 520, 1000}) {
            const auto [a, b] = cases.template pair<A, B>();
            const double s = std::ldexp(1.0, static_cast<int>(power));
            const auto x = test::moved(a, dvec3{0.0}, s);
            const auto y = test::moved(b, dvec3{0.0}, s);
            EXPECT_EQ(test::closest_fault(x, y, test::exact_pair(x, y)), "") << power;
        }
    });
}

template <class A>
bool same(const A& a, const A& b) {
    return std::memcmp(&a, &b, sizeof(A)) == 0;
}

TYPED_TEST(ClosestPointsOf, DoesNotDependOnTheDistanceFromTheOrigin) {
    using T = TypeParam;
    for_pairs<T>([&]<class A, class B>(const char* what) {
        SCOPED_TRACE(what);
        Cases<T> cases(0x0622);
        for (int i = 0; i < 50; ++i) {
            cases.set_grid(true);  // halves, so that moving by 1,024 is exact
            A a;
            B b;
            cases.make(a), cases.make(b);
            const A far_a = test::moved(a, dvec3{1024.0}, 1.0);
            const B far_b = test::moved(b, dvec3{1024.0}, 1.0);
            if (!same(test::moved(far_a, dvec3{-1024.0}, 1.0), a) || !same(test::moved(far_b, dvec3{-1024.0}, 1.0), b))
                continue;  // off the grid
            EXPECT_EQ(closest_points(far_a, far_b).distance_sq, closest_points(a, b).distance_sq);
        }
    });
}

TYPED_TEST(ClosestPointsOf, IsNeverBeatenBySampledPoints) {
    using T = TypeParam;
    Cases<T> cases(0x0623);
    const auto on = [&](const Triangle<T>& t) {
        double u = cases.random().unit(), v = cases.random().unit();
        if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
        return dvec3(t.a) + u * (dvec3(t.b) - dvec3(t.a)) + v * (dvec3(t.c) - dvec3(t.a));
    };
    for (int i = 0; i < 300; ++i) {
        const auto [a, b] = cases.template pair<Triangle<T>, Triangle<T>>();
        const double best = std::sqrt(static_cast<double>(closest_points(a, b).distance_sq));
        for (int k = 0; k < 100; ++k) {
            const dvec3 d = on(a) - on(b);
            ASSERT_LE(best, std::sqrt(glm::dot(d, d)) + 4 * static_cast<double>(std::numeric_limits<T>::epsilon()));
        }
    }
}

TYPED_TEST(ClosestPointsOf, SharedPointsAreTheDocumentedOnes) {
    using T = TypeParam;
    const Aabb<T> box{{-1, -1, -1}, {1, 1, 1}};
    // The middle of what is inside the box, of what boxes share, and between spheres as their radii.
    EXPECT_EQ(closest_points(Segment<T>{{-3, 0, 0}, {T(0.5), 0, 0}}, box).on_a, (Vec3<T>(T(-0.25), 0, 0)));
    EXPECT_EQ(closest_points(box, Aabb<T>{{0, 0, 0}, {3, 3, 3}}).on_b, Vec3<T>(T(0.5)));
    const auto balls = closest_points(Sphere<T>{{0, 0, 0}, 3}, Sphere<T>{{2, 0, 0}, 1});
    EXPECT_EQ(balls.on_a, (Vec3<T>(T(1.5), 0, 0)));
    EXPECT_EQ(balls.distance_sq, T(0));
    const auto pierced = closest_points(Segment<T>{{0, 0, -1}, {0, 0, 3}}, Triangle<T>{{-1, -1, 0}, {2, -1, 0}, {-1, 2, 0}});
    EXPECT_EQ(pierced.distance_sq, T(0));
    EXPECT_EQ(pierced.on_a, Vec3<T>(T(0)));
}

TYPED_TEST(ClosestPointsOf, BadInputIsNanThroughout) {
    using T = TypeParam;
    const T nan = std::numeric_limits<T>::quiet_NaN(), infinity = std::numeric_limits<T>::infinity();
    const auto refused = [](const auto& c) {
        return std::isnan(c.distance_sq) && std::isnan(c.on_a.x) && std::isnan(c.on_a.y) && std::isnan(c.on_a.z) && std::isnan(c.on_b.x) &&
               std::isnan(c.on_b.y) && std::isnan(c.on_b.z);
    };
    const Triangle<T> good{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (const T bad : {nan, infinity, -infinity}) {
        for (int k = 0; k < 3; ++k) {
            Vec3<T> p{T(0)};
            p[k] = bad;
            EXPECT_TRUE(refused(closest_points(p, good)));
            EXPECT_TRUE(refused(closest_points(good, p)));
            EXPECT_TRUE(refused(closest_points(Segment<T>{p, {1, 1, 1}}, good)));
            EXPECT_TRUE(refused(closest_points(Capsule<T>{{{1, 1, 1}, p}, 1}, good)));
            EXPECT_TRUE(refused(closest_points(Triangle<T>{good.a, good.b, p}, good)));
            EXPECT_TRUE(refused(closest_points(Aabb<T>{{-1, -1, -1}, glm::max(p, Vec3<T>{T(0)}) + p}, good)));
            EXPECT_TRUE(refused(closest_points(Obb<T>{.center = p, .half_extents = {1, 1, 1}}, good)));
            Obb<T> turned{.center = {}, .half_extents = {1, 1, 1}};
            turned.axes[k][(k + 1) % 3] = bad;
            EXPECT_TRUE(refused(closest_points(turned, good)));
        }
        EXPECT_TRUE(refused(closest_points(Sphere<T>{{0, 0, 0}, bad}, good)));
    }
    EXPECT_TRUE(refused(closest_points(Sphere<T>{{0, 0, 0}, T(-1)}, good)));
    EXPECT_TRUE(refused(closest_points(good, Capsule<T>{{{0, 0, 0}, {1, 0, 0}}, T(-1)})));
    EXPECT_TRUE(refused(closest_points(good, Aabb<T>{{1, 0, 0}, {-1, 1, 1}})));
    EXPECT_TRUE(refused(closest_points(Obb<T>{.center = {}, .half_extents = {1, -1, 1}}, good)));
}

}  // namespace
}  // namespace carom
