// Rays against single primitives: verdicts and intervals against exact rationals, and what is promised for bad input.
#include <carom/collision/ray_primitives.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>
#include <fuzz/ray_primitives_check.hpp>

#include <array>
#include <cmath>
#include <limits>

namespace carom {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <class T>
class RayPrimitives : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(RayPrimitives, Precisions);

class RayPrimitive : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(InFloatThenDouble, RayPrimitive, testing::Range(0, 2 * test::kRayPrimitives));

TEST_P(RayPrimitive, IsRightWithinItsBoundByExactRationals) {
    Random random(static_cast<std::uint64_t>(4000 + GetParam()));
    for (int i = 0; i < 150; ++i) {
        std::vector<std::uint8_t> bytes = test::random_bytes(random, 120);
        bytes[0] = static_cast<std::uint8_t>(GetParam());
        ASSERT_EQ(test::ray_primitives_fault(bytes), "") << "scene " << i;
    }
}

/// One of each solid about the origin, 2 across on y.
template <class T, class F>
void for_each_solid(F check) {
    check(geo::Sphere<T>{.radius = T(1)}, "sphere");
    check(geo::Aabb<T>{{T(-1), T(-1), T(-1)}, {T(1), T(1), T(1)}}, "aabb");
    check(geo::Obb<T>{.half_extents = {T(2), T(1), T(1)}}, "obb");
    check(geo::Capsule<T>{{{T(-1), T(0), T(0)}, {T(1), T(0), T(0)}}, T(1)}, "capsule");
    check(geo::Cylinder<T>{{{T(0), T(-1), T(0)}, {T(0), T(1), T(0)}}, T(1)}, "cylinder");
    check(geo::Cone<T>{{T(0), T(-1), T(0)}, {T(0), T(1), T(0)}, T(1)}, "cone");
}

TYPED_TEST(RayPrimitives, ARayThroughTheMiddleEntersAndLeaves) {
    using T = TypeParam;
    const geo::Ray<T> down{.origin = {T(0), T(5), T(-0.0)}, .direction = {T(-0.0), T(-2), T(0)}};
    for_each_solid<T>([&](const auto& solid, const char* name) {
        const auto inside = geo::ray_interval(solid, down);
        ASSERT_TRUE(inside) << name;
        EXPECT_EQ(inside->t_enter, T(2)) << name;
        EXPECT_EQ(inside->t_exit, T(3)) << name;
        EXPECT_EQ(inside->normal_enter, (geo::Vec3<T>{T(0), T(1), T(0)})) << name;
        EXPECT_EQ(inside->normal_exit, (geo::Vec3<T>{T(0), T(-1), T(0)})) << name;
        EXPECT_EQ(geo::cast_ray(solid, down)->t, T(2)) << name;
    });
}

TYPED_TEST(RayPrimitives, StartingInsideOrOnTheSurfaceHitsAtTheStart) {
    using T = TypeParam;
    for_each_solid<T>([&](const auto& solid, const char* name) {
        for (const T y : {T(0.5), T(1)}) {
            for (const T way : {T(1), T(-1)}) {
                const geo::Ray<T> ray{.origin = {T(0), y, T(0)}, .direction = {T(0), way, T(0)}};
                const auto hit = geo::cast_ray(solid, ray);
                ASSERT_TRUE(hit) << name << ' ' << y << ' ' << way;
                EXPECT_EQ(hit->t, T(0)) << name;
                EXPECT_EQ(hit->normal, -ray.direction) << name;
                EXPECT_LE(geo::ray_interval(solid, ray)->t_enter, T(0)) << name;
                EXPECT_GE(geo::ray_interval(solid, ray)->t_exit, T(0)) << name;
            }
        }
        const geo::Ray<T> away{.origin = {T(0), T(2), T(0)}, .direction = {T(0), T(1), T(0)}};
        EXPECT_FALSE(geo::cast_ray(solid, away)) << name;
    });
}

TYPED_TEST(RayPrimitives, TheRangeIsClosedAtBothEnds) {
    using T = TypeParam;
    for_each_solid<T>([&](const auto& solid, const char* name) {
        geo::Ray<T> ray{.origin = {T(0), T(5), T(0)}, .direction = {T(0), T(-1), T(0)}};
        ray.t_max = T(4);
        EXPECT_TRUE(geo::cast_ray(solid, ray)) << name;
        ray.t_max = std::nextafter(T(4), T(0));
        EXPECT_FALSE(geo::cast_ray(solid, ray)) << name;
        ray.t_max = T(9);
        ray.t_min = T(6);
        EXPECT_TRUE(geo::ray_interval(solid, ray)) << name;
        ray.t_min = std::nextafter(T(6), T(9));
        EXPECT_FALSE(geo::ray_interval(solid, ray)) << name;
    });
}

TYPED_TEST(RayPrimitives, RaysAtTheTipOfAConeAndAlongItsSide) {
    using T = TypeParam;
    Random random(4103);
    for (int i = 0; i < 200; ++i) {
        const auto number = [&] { return static_cast<T>(random.range(-2.0, 2.0)); };
        const T z = number();
        const geo::Cone<T> cone{{number(), number(), z}, {number(), number(), number()}, std::abs(number())};
        geo::Ray<T> ray{.origin = {number(), number(), T(5)}};
        const T beside = std::ldexp(T(1), -i % 60);
        ray.direction = cone.tip + (i % 2 == 0 ? T(0) : beside) * geo::Vec3<T>{number(), number(), T(0)} - ray.origin;
        EXPECT_EQ(test::solid_fault(cone, ray), "") << i;
    }
    // Sides at 45 degrees and rays along them, for which the quadratic has one root only.
    const geo::Cone<T> steep{{T(0), T(1), T(0)}, {T(0), T(-1), T(0)}, T(2)};
    for (const T x : {T(-3), T(-1), T(-0.5), T(0), T(0.5), T(3)}) {
        for (const T way : {T(1), T(-1)}) {
            const geo::Ray<T> ray{{x, T(0), T(0)}, {way, way, T(0)}, T(-9), T(9)};
            EXPECT_EQ(test::solid_fault(steep, ray), "") << x << ' ' << way;
            EXPECT_EQ(geo::ray_interval(steep, ray).has_value(), x >= T(-1) && x <= T(3)) << x;
        }
    }
}

TYPED_TEST(RayPrimitives, RaysNearlyAlongAnAxisAreRightToo) {
    using T = TypeParam;
    Random random(4104);
    for (int i = 0; i < 200; ++i) {
        const auto number = [&] { return static_cast<T>(random.range(-2.0, 2.0)); };
        const T z = number();
        const geo::Segment<T> axis{{number(), number(), z}, {number(), number(), number()}};
        const glm::mat<3, 3, T> about = test::axes_about(axis.b - axis.a);
        const T radius = std::abs(number());
        const T tilt = std::ldexp(T(1), -i % 60);
        geo::Ray<T> ray{.origin = axis.a + about[0] * radius * (T(1) + number() * tilt) - about[2]};
        ray.direction = about[2] + about[i % 2] * tilt * number();
        EXPECT_EQ(test::solid_fault(geo::Cylinder<T>{axis, radius}, ray), "") << i;
        EXPECT_EQ(test::solid_fault(geo::Capsule<T>{axis, radius}, ray), "") << i;
    }
}

TYPED_TEST(RayPrimitives, AnOriginExactlyOnASphereIsAtZero) {
    using T = TypeParam;
    Random random(4105);
    for (const geo::Vec3<T>& on : {geo::Vec3<T>{3, 4, 0}, {0, -5, 0}, {-4, 0, 3}}) {
        for (int i = 0; i < 100; ++i) {
            const geo::Vec3<T> direction(
                dvec3{random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0)});
            const auto inside = geo::ray_interval(geo::Sphere<T>{{T(7), T(7), T(7)}, T(5)},
                                                  {.origin = on + T(7), .direction = direction});
            ASSERT_TRUE(inside);
            EXPECT_EQ(glm::dot(dvec3(on), dvec3(direction)) < 0.0 ? inside->t_enter : inside->t_exit, T(0));
        }
    }
}

TYPED_TEST(RayPrimitives, NeedlesAreAsExactAsOtherTriangles) {
    using T = TypeParam;
    Random random(4106);
    int hits = 0;
    for (int i = 0; i < 300; ++i) {
        const auto point = [&] {
            return geo::Vec3<T>(dvec3{random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0)});
        };
        const geo::Vec3<T> tip = point();
        const geo::Vec3<T> end = point();
        const geo::Triangle<T> needle{tip, end, end + point() * std::ldexp(T(1), -i % 45)};
        const T along = static_cast<T>(random.unit());
        const geo::Ray<T> ray{.origin = point() + T(2),
                              .direction = tip + (T(0.5) * (needle.b + needle.c) - tip) * along};
        const geo::Ray<T> aimed{.origin = ray.origin, .direction = ray.direction - ray.origin};
        const auto hit = geo::cast_ray(needle, aimed);
        EXPECT_EQ(test::flat_fault(needle, hit, aimed), "") << i;
        hits += hit ? 1 : 0;
    }
    EXPECT_GT(hits, 100);
}

TYPED_TEST(RayPrimitives, NormalsAreThoseOfTheSurface) {
    using T = TypeParam;
    const T tolerance = T(16) * std::numeric_limits<T>::epsilon();
    const auto expect = [&](const auto& shape, const geo::Ray<T>& ray, const dvec3& normal) {
        const auto hit = geo::cast_ray(shape, ray);
        ASSERT_TRUE(hit);
        const geo::Vec3<T> off = hit->normal - geo::Vec3<T>(normal);
        EXPECT_LE(std::sqrt(glm::dot(off, off)), tolerance)
            << hit->normal.x << ' ' << hit->normal.y << ' ' << hit->normal.z;
    };
    const geo::Ray<T> slanted{.origin = {T(5), T(0.25), T(0.5)}, .direction = {T(-1), T(0), T(0)}};
    expect(geo::Sphere<T>{.radius = T(1)}, slanted, {std::sqrt(0.6875), 0.25, 0.5});
    expect(geo::Cylinder<T>{{{T(0), T(-1), T(0)}, {T(0), T(1), T(0)}}, T(1)}, slanted, {std::sqrt(0.75), 0.0, 0.5});
    expect(geo::Capsule<T>{{{T(0), T(-1), T(0)}, {T(0), T(1), T(0)}}, T(1)}, slanted, {std::sqrt(0.75), 0.0, 0.5});
    // A cone of half angle 45 degrees, hit at height 0.75 below its tip.
    expect(geo::Cone<T>{{T(0), T(1), T(0)}, {T(0), T(-1), T(0)}, T(2)}, slanted,
           dvec3{std::sqrt(0.5625 - 0.25) / 0.75, 1.0, 0.5 / 0.75} * std::sqrt(0.5));
    expect(geo::Disc<T>{{T(0), T(0), T(0)}, {T(1), T(1), T(0)}, T(1)}, slanted, {std::sqrt(0.5), std::sqrt(0.5), 0.0});
    expect(geo::Plane<T>{{T(-3), T(0), T(4)}, T(1)}, slanted, {0.6, 0.0, -0.8});
    expect(geo::Triangle<T>{{T(0), T(-1), T(-1)}, {T(0), T(-1), T(3)}, {T(0), T(3), T(-1)}}, slanted, {1.0, 0.0, 0.0});
}

TYPED_TEST(RayPrimitives, WeightsGiveThePointOfATriangle) {
    using T = TypeParam;
    const geo::Triangle<T> t{{T(0), T(0), T(0)}, {T(4), T(0), T(0)}, {T(0), T(4), T(8)}};
    const auto hit = geo::cast_ray(t, {.origin = {T(1), T(2), T(9)}, .direction = {T(0), T(0), T(-3)}});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->weights, (geo::Vec3<T>{T(0.25), T(0.25), T(0.5)}));
    EXPECT_EQ(hit->t * T(3), T(5));
}

TYPED_TEST(RayPrimitives, TrianglesRoundAPointLeaveNoGap) {
    using T = TypeParam;
    Random random(4101);
    const auto point = [&](double size) {
        return geo::Vec3<T>(dvec3{random.range(-size, size), random.range(-size, size), random.range(-size, size)});
    };
    for (int scene = 0; scene < 300; ++scene) {
        const double size = std::ldexp(1.0, static_cast<int>(random.range(-40, 40)));
        const geo::Vec3<T> center = point(scene % 2 == 0 ? size : 1000.0 * size);
        std::array<geo::Vec3<T>, 6> rim;
        for (std::size_t i = 0; i < rim.size(); ++i) {
            const SinCos turn = sin_cos(static_cast<double>(i) * kPi / 3.0);
            rim[i] = center + geo::Vec3<T>(size * dvec3{turn.cos, random.range(-0.3, 0.3), turn.sin});
        }
        for (int k = 0; k < 30; ++k) {
            geo::Ray<T> ray{.origin = center + geo::Vec3<T>(dvec3{0.0, 3.0 * size, 0.0}) + point(0.5 * size)};
            const geo::Vec3<T> at = rim[static_cast<std::size_t>(k) % rim.size()];
            ray.direction =
                (k % 3 == 0 ? center : center + (at - center) * static_cast<T>(random.range(0.0, 0.9))) - ray.origin;
            int hits = 0;
            for (std::size_t i = 0; i < rim.size(); ++i) {
                hits += geo::cast_ray(geo::Triangle<T>{center, rim[i], rim[(i + 1) % rim.size()]}, ray) ? 1 : 0;
            }
            ASSERT_GT(hits, 0) << "scene " << scene;
        }
    }
}

TYPED_TEST(RayPrimitives, ConcavePolygonsAndTheirOutline) {
    using T = TypeParam;
    // A U, open upward: x in [0, 3], y in [0, 2], with a notch over (1, 2) from y = 1.
    const std::array<geo::Vec3<T>, 8> u{
        {{0, 0, 1}, {3, 0, 1}, {3, 2, 1}, {2, 2, 1}, {2, 1, 1}, {1, 1, 1}, {1, 2, 1}, {0, 2, 1}}};
    const auto hit = [&](double x, double y) {
        const geo::Ray<T> ray{.origin = {static_cast<T>(x), static_cast<T>(y), T(5)},
                              .direction = {T(0), T(-0.0), T(-1)}};
        return geo::cast_ray_polygon<T>(u, ray).has_value();
    };
    EXPECT_TRUE(hit(0.5, 1.5) && hit(2.5, 1.5) && hit(1.5, 0.5));
    EXPECT_FALSE(hit(1.5, 1.5) || hit(-0.5, 1.0) || hit(3.5, 1.0) || hit(1.5, -0.5) || hit(1.5, 2.5));
    for (const geo::Vec3<T>& corner : u) {
        EXPECT_TRUE(hit(static_cast<double>(corner.x), static_cast<double>(corner.y)));
    }
    EXPECT_TRUE(hit(1.0, 1.5) && hit(1.5, 1.0) && hit(2.0, 1.5) && hit(1.5, 0.0) && hit(0.5, 2.0) && hit(3.0, 1.0));
    EXPECT_FALSE(hit(1.5, 2.0)) << "across the opening";
    EXPECT_FALSE(geo::cast_ray_polygon<T>({u.data(), 2}, {{1, 0, 5}, {0, 0, -1}}));
    EXPECT_FALSE(geo::cast_ray_polygon<T>({}, {{1, 0, 5}, {0, 0, -1}}));
}

/// All queries of one ray against one of each primitive; whether any of them hits.
template <class T>
bool anything_hit(const geo::Ray<T>& ray) {
    bool any = false;
    for_each_solid<T>([&](const auto& solid, const char*) {
        any = any || geo::cast_ray(solid, ray) || geo::ray_interval(solid, ray);
    });
    const geo::Triangle<T> triangle{{T(-9), T(0), T(-9)}, {T(9), T(0), T(-9)}, {T(0), T(0), T(9)}};
    const std::array<geo::Vec3<T>, 3> corners{triangle.a, triangle.b, triangle.c};
    return any || geo::cast_ray(geo::Plane<T>{}, ray) || geo::ray_interval(geo::Plane<T>{}, ray) ||
           geo::cast_ray(geo::Disc<T>{.radius = T(9)}, ray) || geo::cast_ray(triangle, ray) ||
           geo::cast_ray_polygon<T>(corners, ray);
}

TYPED_TEST(RayPrimitives, BadRaysHitNothing) {
    using T = TypeParam;
    const geo::Ray<T> good{.origin = {T(0), T(3), T(0)}, .direction = {T(0), T(-1), T(0)}};
    ASSERT_TRUE(anything_hit(good));
    for (const double bad : {kNan, kInf, -kInf}) {
        for (int k = 0; k < 3; ++k) {
            geo::Ray<T> ray = good;
            ray.origin[k] = static_cast<T>(bad);
            EXPECT_FALSE(anything_hit(ray));
            ray = good;
            ray.direction[k] = static_cast<T>(bad);
            EXPECT_FALSE(anything_hit(ray));
        }
    }
    for (const auto& [t_min, t_max] : {std::pair{kNan, 9.0}, {0.0, kNan}, {2.0, 1.0}}) {
        geo::Ray<T> ray = good;
        ray.t_min = static_cast<T>(t_min);
        ray.t_max = static_cast<T>(t_max);
        EXPECT_FALSE(anything_hit(ray));
    }
    geo::Ray<T> ray = good;
    ray.direction = {T(0), T(-0.0), T(0)};
    EXPECT_FALSE(anything_hit(ray));
}

template <class T, class Shape>
void expect_never_hit(const Shape& shape) {
    for (const geo::Vec3<T>& direction : {geo::Vec3<T>{0, -1, 0}, geo::Vec3<T>{1, -2, 3}}) {
        EXPECT_FALSE(geo::cast_ray(shape, {.origin = direction * T(-3), .direction = direction}));
    }
}

TYPED_TEST(RayPrimitives, BadShapesAreNeverHit) {
    using T = TypeParam;
    for (const T bad : {static_cast<T>(kNan), static_cast<T>(kInf)}) {
        expect_never_hit<T>(geo::Sphere<T>{.radius = bad});
        expect_never_hit<T>(geo::Sphere<T>{.center = {bad, 0, 0}, .radius = T(1)});
        expect_never_hit<T>(geo::Aabb<T>{{-1, -1, -1}, {1, 1, bad}});
        expect_never_hit<T>(geo::Obb<T>{.half_extents = {1, 1, bad}});
        expect_never_hit<T>(geo::Obb<T>{.half_extents = {1, 1, 1}, .axes = glm::mat<3, 3, T>(bad)});
        expect_never_hit<T>(geo::Capsule<T>{{{0, -1, 0}, {0, bad, 0}}, T(1)});
        expect_never_hit<T>(geo::Cylinder<T>{{{0, -1, 0}, {0, 1, 0}}, bad});
        expect_never_hit<T>(geo::Cone<T>{{0, bad, 0}, {0, 1, 0}, T(1)});
        expect_never_hit<T>(geo::Plane<T>{.offset = bad});
        expect_never_hit<T>(geo::Disc<T>{.normal = {0, bad, 0}, .radius = T(1)});
        expect_never_hit<T>(geo::Triangle<T>{{-9, 0, -9}, {9, 0, -9}, {bad, 0, 9}});
    }
    expect_never_hit<T>(geo::Sphere<T>{.radius = T(-1)});
    expect_never_hit<T>(geo::Aabb<T>{{1, 1, 1}, {-1, -1, -1}});
    expect_never_hit<T>(geo::Obb<T>{.half_extents = {1, -1, 1}});
    expect_never_hit<T>(geo::Capsule<T>{{{0, -1, 0}, {0, 1, 0}}, T(-1)});
    expect_never_hit<T>(geo::Cylinder<T>{{{0, 1, 0}, {0, 1, 0}}, T(1)});
    expect_never_hit<T>(geo::Cylinder<T>{{{0, -1, 0}, {0, 1, 0}}, T(0)});
    expect_never_hit<T>(geo::Cone<T>{{0, 1, 0}, {0, 1, 0}, T(1)});
    expect_never_hit<T>(geo::Plane<T>{.normal = {0, 0, 0}});
    expect_never_hit<T>(geo::Disc<T>{.normal = {0, 0, 0}, .radius = T(1)});
    expect_never_hit<T>(geo::Disc<T>{.radius = T(-1)});
}

TYPED_TEST(RayPrimitives, ExtremeNumbersNeverGiveNan) {
    using T = TypeParam;
    constexpr T kMax = std::numeric_limits<T>::max();
    constexpr T kLeast = std::numeric_limits<T>::denorm_min();
    const std::array<T, 10> values{T(0), T(-0.0), kLeast, -kLeast, T(1e-30), T(0.5), T(-1), T(1e30), kMax, -kMax};
    Random random(4102);
    const auto pick = [&] { return values[static_cast<std::size_t>(random.unit() * 10.0)]; };
    const auto pick3 = [&] {
        const T x = pick();
        const T y = pick();
        return geo::Vec3<T>{x, y, pick()};
    };
    int hits = 0;
    const auto check = [&](const auto& shape, const geo::Ray<T>& ray) {
        if (const auto hit = geo::cast_ray(shape, ray)) {
            ++hits;
            EXPECT_TRUE(is_finite(hit->t) && hit->t >= ray.t_min && hit->t <= ray.t_max);
            EXPECT_TRUE(test::is_unit(hit->normal));
        }
    };
    for (int i = 0; i < 20000; ++i) {
        const geo::Ray<T> ray{.origin = pick3(), .direction = pick3()};
        const geo::Segment<T> s{pick3(), pick3()};
        const T r = std::abs(pick());
        check(geo::Sphere<T>{s.a, r}, ray);
        check(geo::Aabb<T>{glm::min(s.a, s.b), glm::max(s.a, s.b)}, ray);
        check(geo::Obb<T>{s.a, glm::abs(s.b)}, ray);
        check(geo::Capsule<T>{s, r}, ray);
        check(geo::Cylinder<T>{s, r}, ray);
        check(geo::Cone<T>{s.a, s.b, r}, ray);
        check(geo::Plane<T>{s.a, pick()}, ray);
        check(geo::Disc<T>{s.a, s.b, r}, ray);
        check(geo::Triangle<T>{s.a, s.b, pick3()}, ray);
    }
    EXPECT_GT(hits, 10000);
}

TEST(RayPrimitives, TheWholeRangeOfDoubleIsServed) {
    for (const double size : {0x1p-1000, 0x1p-400, 1.0, 0x1p400, 0x1p1000}) {
        for (const double length : {0x1p-1020, 0x1p-300, 1.0, 0x1p300, 0x1p1020}) {
            const geo::Ray<double> ray{.origin = {0, 4 * size, 0}, .direction = {0, -length, 0}};
            const auto inside = geo::ray_interval(geo::Sphere<double>{.radius = size}, ray);
            const double enter = 3.0 * size / length;
            if (std::isinf(enter)) {
                EXPECT_FALSE(inside) << size << ' ' << length;
                continue;
            }
            ASSERT_TRUE(inside) << size << ' ' << length;
            EXPECT_EQ(inside->t_enter, enter);
            EXPECT_EQ(inside->normal_enter, (dvec3{0, 1, 0}));
            const auto cone = geo::ray_interval(geo::Cone<double>{{0, size, 0}, {0, -size, 0}, size}, ray);
            EXPECT_TRUE(cone && cone->t_enter == enter);
        }
    }
}

TEST(RayPrimitives, AFarOriginKeepsTheDigitsOfASmallBall) {
    // At 1e6 radii, b² - 4ac would have lost all but four digits of the half chord.
    const geo::Sphere<double> ball{.center = {1e6, 0, 0}, .radius = 1.0};
    const geo::Ray<double> ray{.origin = {0, 0.6, 0}, .direction = {1, 0, 0}};
    const auto inside = geo::ray_interval(ball, ray);
    ASSERT_TRUE(inside);
    EXPECT_EQ(inside->t_enter, 1e6 - 0.8);
    EXPECT_EQ(inside->t_exit, 1e6 + 0.8);
}

}  // namespace
}  // namespace carom
