// Overlap of all pairs against exact rationals: right outside the stated bound, and `false` always right.
#include <carom/collision/overlap_tests.hpp>

#include <fuzz/overlap_check.hpp>

#include "primitive_cases.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tuple>
#include <type_traits>
#include <typeinfo>

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
        int apart = 0, together = 0;
        for (int i = 0; i < count; ++i) {
            SCOPED_TRACE(i);
            const auto [a, b] = i % 2 == 0 ? cases.template near_pair<A, B>() : cases.template pair<A, B>();
            const test::ExactPair pair = test::exact_pair(a, b);
            ASSERT_EQ(test::verdict_fault(a, b, pair), "");
            ++(pair.overlap() ? together : apart);
        }
        EXPECT_GT(apart, count / 25);
        EXPECT_GT(together, count / 25);
    }
};

template <class T>
class Overlaps : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Overlaps, Scalars);

TYPED_TEST(Overlaps, OfRoundSolidsIsExactOutsideTheBound) {
    using T = TypeParam;
    using N = Named<T>;
    N::template check<Sphere<T>, Sphere<T>>("sphere sphere", 0x0501, 200);
    N::template check<Sphere<T>, Capsule<T>>("sphere capsule", 0x0502, 200);
    N::template check<Capsule<T>, Capsule<T>>("capsule capsule", 0x0503, 300);
    N::template check<Sphere<T>, Triangle<T>>("sphere triangle", 0x0504, 150);
    N::template check<Capsule<T>, Triangle<T>>("capsule triangle", 0x0505, 100);
    N::template check<Sphere<T>, Aabb<T>>("sphere aabb", 0x0506, 50);
    N::template check<Sphere<T>, Obb<T>>("sphere obb", 0x0507, 50);
    N::template check<Capsule<T>, Aabb<T>>("capsule aabb", 0x0508, 30);
    N::template check<Capsule<T>, Obb<T>>("capsule obb", 0x0509, 30);
}

TYPED_TEST(Overlaps, OfFlatSidedSolidsIsExactOutsideTheBound) {
    using T = TypeParam;
    using N = Named<T>;
    N::template check<Triangle<T>, Triangle<T>>("triangle triangle", 0x0511, 120);
    N::template check<Triangle<T>, Aabb<T>>("triangle aabb", 0x0512, 24);
    N::template check<Triangle<T>, Obb<T>>("triangle obb", 0x0513, 24);
    N::template check<Aabb<T>, Aabb<T>>("aabb aabb", 0x0514, 16);
    N::template check<Aabb<T>, Obb<T>>("aabb obb", 0x0515, 16);
    N::template check<Obb<T>, Obb<T>>("obb obb", 0x0516, 20);
}

template <class A, class B>
void expect_both_ways(const A& a, const B& b, bool want) {
    EXPECT_EQ(overlaps(a, b), want) << typeid(A).name() << " " << typeid(B).name();
    EXPECT_EQ(overlaps(b, a), want) << typeid(A).name() << " " << typeid(B).name();
}

TYPED_TEST(Overlaps, TouchingSolidsOverlapAndTheNextNumberDoesNot) {
    using T = TypeParam;
    // One solid against x = 1 from the left, the other moved along x: touching is overlapping, a gap of 200 roundings is not.
    const T gap = T(1) + 200 * std::numeric_limits<T>::epsilon();
    const auto right = [](T x) {
        return std::tuple{Sphere<T>{{x + 1, 0, 0}, 1}, Aabb<T>{{x, -1, -1}, {x + 1, 1, 1}},
                          Obb<T>{.center = {x + 1, 0, 0}, .half_extents = {1, 1, 1}}, Capsule<T>{{{x + 1, -1, 0}, {x + 1, 1, 0}}, 1},
                          Triangle<T>{{x, -1, 0}, {x, 1, 0}, {x + 1, 0, 1}}};
    };
    const auto left = std::tuple{Sphere<T>{{0, 0, 0}, 1}, Aabb<T>{{0, -1, -1}, {1, 1, 1}}, Obb<T>{.center = {}, .half_extents = {1, 1, 1}},
                                 Capsule<T>{{{0, -1, 0}, {0, 1, 0}}, 1}, Triangle<T>{{1, -1, -1}, {1, 1, 1}, {1, 1, -1}}};
    const auto touch = [&](const auto& a) {
        std::apply([&](const auto&... b) { (expect_both_ways(a, b, true), ...); }, right(T(1)));
        std::apply([&](const auto&... b) { (expect_both_ways(a, b, false), ...); }, right(gap));
    };
    std::apply([&](const auto&... a) { (touch(a), ...); }, left);
}

// Edges that cross at a small angle a little apart: no face separates the boxes, and the axis that does is a short cross product, of which
// plain rounding leaves nothing where the angle is about the root of a rounding.
TYPED_TEST(Overlaps, EdgesThatAreNearlyParallelSeparateBoxes) {
    using T = TypeParam;
    const double unit = static_cast<double>(std::numeric_limits<T>::epsilon());
    const auto edge_up = [](double about_y, double height) {  // a box standing on, or hanging by, an edge along x turned about y
        const dquat q = rotation_about({0, 1, 0}, about_y) * rotation_about({1, 0, 0}, kPi / 4);
        const dvec3 half{2.0, 0.5, 0.5};
        return Obb<T>{.center = Vec3<T>(dvec3{0, height, 0}),
                      .half_extents = Vec3<T>(half),
                      .axes = glm::mat<3, 3, T>(dmat3{rotate(q, dvec3{1, 0, 0}), rotate(q, dvec3{0, 1, 0}), rotate(q, dvec3{0, 0, 1})})};
    };
    int missed_by_faces = 0;
    for (int k = 2; k < (sizeof(T) == 4 ? 18 : 40); ++k) {
        const double angle = std::ldexp(1.0, -k);
        for (const double gap : {600 * unit, std::sqrt(unit), 0.3 * angle}) {
            if (gap < 600 * unit) continue;  // the bound: 128 unit times a size of up to 3
            const Obb<T> below = edge_up(angle, 0.0), above = edge_up(0.0, std::sqrt(2.0) + gap);
            EXPECT_FALSE(overlaps(below, above)) << k << " " << gap;
            EXPECT_FALSE(overlaps(above, below)) << k << " " << gap;
            missed_by_faces += gap < angle ? 1 : 0;
        }
    }
    EXPECT_GT(missed_by_faces, 10);
}

TYPED_TEST(Overlaps, ScalesByPowersOfTwo) {
    using T = TypeParam;
    Cases<T> cases(0x0520);
    const int far = sizeof(T) == 4 ? 66 : 600;
    for (int i = 0; i < 300; ++i) {
        const auto [a, b] = cases.template near_pair<Triangle<T>, Obb<T>>();
        const auto [c, d] = cases.template near_pair<Obb<T>, Capsule<T>>();
        for (const int power : {far, -far / 2}) {
            const double s = std::ldexp(1.0, power);
            EXPECT_EQ(overlaps(test::moved(a, dvec3{0.0}, s), test::moved(b, dvec3{0.0}, s)), overlaps(a, b));
            EXPECT_EQ(overlaps(test::moved(c, dvec3{0.0}, s), test::moved(d, dvec3{0.0}, s)), overlaps(c, d));
        }
    }
}

TYPED_TEST(Overlaps, BadInputDoesNotOverlap) {
    using T = TypeParam;
    const T nan = std::numeric_limits<T>::quiet_NaN(), infinity = std::numeric_limits<T>::infinity();
    const auto good = std::tuple{Sphere<T>{{0, 0, 0}, 1}, Aabb<T>{{-1, -1, -1}, {1, 1, 1}}, Obb<T>{.center = {}, .half_extents = {1, 1, 1}},
                                 Capsule<T>{{{0, -1, 0}, {0, 1, 0}}, 1}, Triangle<T>{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}};
    const auto refused = [&](const auto& bad) { std::apply([&](const auto&... x) { (expect_both_ways(bad, x, false), ...); }, good); };
    std::apply([&](const auto&... x) { (expect_both_ways(x, std::get<0>(good), true), ...); }, good);
    refused(Sphere<T>{{0, 0, 0}, T(-0.5)});
    refused(Capsule<T>{{{0, 0, 0}, {0, 0, 0}}, T(-0.5)});
    refused(Aabb<T>{{T(0.5), -1, -1}, {T(-0.5), 1, 1}});
    refused(Obb<T>{.center = {}, .half_extents = {1, 1, T(-0.5)}});
    for (const T bad : {nan, infinity}) {
        refused(Sphere<T>{{0, 0, 0}, bad});
        for (int k = 0; k < 3; ++k) {
            Vec3<T> p{T(0)};
            p[k] = bad;
            refused(Sphere<T>{p, 1});
            refused(Capsule<T>{{p, {0, 0, 0}}, 1});
            refused(Triangle<T>{{0, 0, 0}, p, {0, 1, 0}});
            refused(Obb<T>{.center = p, .half_extents = {1, 1, 1}});
            Obb<T> turned{.center = {}, .half_extents = {1, 1, 1}};
            turned.axes[k][k] = bad;
            refused(turned);
        }
    }
    refused(Aabb<T>{{nan, -1, -1}, {1, 1, 1}});
    refused(Aabb<T>{{-1, -1, -1}, {1, nan, 1}});
    // Unbounded boxes are boxes to each other.
    EXPECT_TRUE(overlaps(Aabb<T>{Vec3<T>{-infinity}, Vec3<T>{infinity}}, std::get<1>(good)));
}

}  // namespace
}  // namespace carom
