// Rays against primitives where doubles end: flat cones, tiny triangles, polygons without area, distances no float holds.
#include <carom/collision/detail/exact_sign.hpp>
#include <carom/collision/plane_tests.hpp>
#include <carom/collision/ray_primitives.hpp>
#include <carom/core/random.hpp>

#include <support/exact_ray.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

namespace carom {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(RayPrimitivesLimits, AConeNextToFlatIsADisc) {
    const geo::Ray<double> ray{.origin = {-2, 0.3, 0}, .direction = {1, 0, 0}};
    for (const double height : {1e-10, 1e-40, 1e-110, 1e-150, 1e-155, 1e-160, 1e-200, 1e-300, 5e-324}) {
        const geo::Cone<double> cone{{0, 0, 0}, {height, 0, 0}, 1.0};
        const auto inside = geo::ray_interval(cone, ray);
        ASSERT_TRUE(inside) << height;
        EXPECT_NEAR(inside->t_enter, 2.0, 1e-9) << height;
        EXPECT_NEAR(inside->t_exit, 2.0, 1e-9) << height;
        EXPECT_NEAR(inside->normal_enter.x, -1.0, 1e-9) << height;
        EXPECT_NEAR(inside->normal_exit.x, 1.0, 1e-9) << height;
        EXPECT_FALSE(geo::ray_interval(cone, {.origin = {-2, 1.01, 0}, .direction = {1, 0, 0}})) << height;
        // As large and as small as lengths get, at any length of the direction.
        for (const double unit : {1e-60, 1e60}) {
            const geo::Cone<double> scaled{{0, 0, 0}, {height * unit, 0, 0}, unit};
            if (height < 1e-270) continue;
            const auto again = geo::ray_interval(scaled, {.origin = {-2 * unit, 0.3 * unit, 0}, .direction = {1e40, 0, 0}});
            ASSERT_TRUE(again) << height << ' ' << unit;
            EXPECT_NEAR(again->t_enter / (unit * 1e-40), 2.0, 1e-9) << height;
            EXPECT_NEAR(again->normal_enter.x, -1.0, 1e-9) << height;
        }
    }
}

// Products of a direction so nearly parallel to the axis underflow in part; what is left of them would be any number.
TEST(RayPrimitivesLimits, AConeIsMetByWhatIsNextToParallelToItsAxis) {
    const geo::Cone<double> cone{{0, 0, 0}, {0, 0, -0.5}, 1e-5};
    for (double aside = 1e-20; aside > 0.0; aside *= 0.1) {
        const geo::Ray<double> ray{{0, 0, -1}, {0, aside, 1}, -kInfinity, kInfinity};
        const auto inside = geo::ray_interval(cone, ray);
        ASSERT_TRUE(inside) << aside;
        EXPECT_EQ(exact::fault(cone, ray, inside, 8.0), "") << aside;
        EXPECT_NEAR(inside->t_enter, 0.5, 1e-14) << aside;
        EXPECT_NEAR(inside->t_exit, 1.0, 1e-14) << aside;
    }
}

// Squares of the slope underflow from 1e-162 on, the slope itself from 1e-324.
TEST(RayPrimitivesLimits, ANeedleOfAConeIsMetByWhatIsParallelToItsAxisOnlyBeforeItsBase) {
    constexpr double kHeight = 1e20;
    for (const double radius : {1e10, 1e-100, 1e-150, 1e-200, 1e-304, 5e-324}) {
        const geo::Cone<double> cone{{0, 0, 0}, {0, 0, -kHeight}, radius};
        for (const double way : {1.0, -1.0}) {
            const auto at = [&](double x, double y) { return geo::Ray<double>{{x, y, 3e19}, {0, 0, way}, -kInfinity, kInfinity}; };
            for (const geo::Ray<double>& aside : {at(1e20, 5e-324), at(0, 1e12), at(-1e20, 1e20), at(1e30, 0)}) {
                EXPECT_FALSE(geo::ray_interval(cone, aside)) << radius << ' ' << way;
            }
            for (const double share : {0.0, 0.25, 0.5}) {
                const geo::Ray<double> ray = at(share * radius, 0.0);
                const auto inside = geo::ray_interval(cone, ray);
                ASSERT_TRUE(inside) << radius << ' ' << share;
                EXPECT_EQ(exact::fault(cone, ray, inside, 8.0), "") << radius << ' ' << share;
                EXPECT_NEAR(glm::length(inside->normal_enter), 1.0, 1e-15) << radius << ' ' << share;
                EXPECT_NEAR(glm::length(inside->normal_exit), 1.0, 1e-15) << radius << ' ' << share;
                if (radius < 1e-310) continue;  // no share of it is another number
                const double side = way > 0.0 ? inside->t_exit : inside->t_enter, base = way > 0.0 ? inside->t_enter : inside->t_exit;
                EXPECT_NEAR(way * side / kHeight, -0.3 - share, 1e-9) << radius << ' ' << share;
                EXPECT_NEAR(way * base / kHeight, -1.3, 1e-9) << radius << ' ' << share;
            }
        }
    }
}

TEST(RayPrimitivesLimits, ACylinderOrACapsuleOfNoLengthToSpeakOfIsADiscOrABall) {
    for (const double height : {1e-100, 1e-150, 1e-155, 1e-160, 1e-200, 1e-310}) {
        for (const double y : {0.0, 0.3, 0.9}) {
            const geo::Ray<double> along{.origin = {-2, y, 0.1}, .direction = {1, 0, 0}},
                across{.origin = {0, -5, y}, .direction = {0, 1, 0}};
            const geo::Segment<double> axis{{0, 0, 0}, {height, 0, 0}};
            const auto disc = geo::ray_interval(geo::Cylinder<double>{axis, 1.0}, along);
            ASSERT_TRUE(disc) << height << ' ' << y;
            EXPECT_NEAR(disc->t_enter, 2.0, 1e-15);
            EXPECT_NEAR(disc->normal_enter.x, -1.0, 1e-15);
            for (const geo::Ray<double>& ray : {along, across}) {
                const auto capsule = geo::ray_interval(geo::Capsule<double>{axis, 1.0}, ray);
                const auto ball = geo::ray_interval(geo::Sphere<double>{{0, 0, 0}, 1.0}, ray);
                ASSERT_EQ(capsule.has_value(), ball.has_value()) << height;
                EXPECT_NEAR(capsule->t_enter, ball->t_enter, 1e-14) << height;
                EXPECT_NEAR(capsule->t_exit, ball->t_exit, 1e-14) << height;
                EXPECT_NEAR(glm::dot(capsule->normal_enter, ball->normal_enter), 1.0, 1e-14) << height;
            }
        }
    }
}

TEST(RayPrimitivesLimits, AFanOfTrianglesOfAnySizeIsWatertight) {
    constexpr double kPi = 3.14159265358979;
    for (const double size : {1.0, 1e-100, 1e-121, 1e-140, 1e-155, 1e-165, 1e-200, 1e-300, 1e-310}) {
        Random random(5);
        std::array<dvec3, 6> rim;
        for (std::size_t k = 0; k < 6; ++k) {
            const double angle = static_cast<double>(k) * kPi / 3.0;
            rim[k] = {size * std::cos(angle), size * std::sin(angle), 0.0};
        }
        for (int i = 0; i < 300; ++i) {
            geo::Ray<double> ray{{size * random.range(-0.5, 0.5), size * random.range(-0.5, 0.5), 1.0}, {0, 0, -1}};
            if (i % 5 == 0) ray.origin.y = 0.0;  // along an edge
            int hits = 0;
            for (std::size_t k = 0; k < 6; ++k) {
                const auto hit = geo::cast_ray(geo::Triangle<double>{dvec3{0.0}, rim[k], rim[(k + 1) % 6]}, ray);
                hits += hit ? 1 : 0;
                if (!hit) continue;
                ASSERT_NEAR(hit->t, 1.0, 1e-15);
                const dvec3 at = hit->weights.y * rim[k] + hit->weights.z * rim[(k + 1) % 6];
                ASSERT_NEAR(at.x / size, ray.origin.x / size, size < 1e-305 ? 1e-8 : 1e-12);
            }
            ASSERT_GE(hits, 1) << size << ' ' << i;
            ASSERT_LE(hits, 2) << size << ' ' << i;
        }
    }
}

TEST(RayPrimitivesLimits, APolygonWithoutAreaIsNotHit) {
    // Its area by Newell's sum is exactly zero; rounded it is not.
    const std::array<vec3, 6> corners{
        vec3{-0x1.07c6e8p+16f, -0x1.0473bap+17f, -0x1.33803p+9f}, {-0x1.03e374p+17f, -0x1.08e774p+16f, -0x1.33803p+9f},
        {-0x1.07c6e8p+16f, 0x1.ee3116p+15f, -0x1.33803p+9f},      {-0x1.f1b9e6p+10f, -0x1.0473bap+17f, -0x1.33803p+9f},
        {-0x1.07c6e8p+16f, 0x1.ee3116p+15f, -0x1.33803p+9f},      {-0x1.03e374p+17f, -0x1.1cee96p+11f, -0x1.33803p+9f}};
    EXPECT_FALSE(geo::cast_ray_polygon<float>(corners, {.origin = {-0x1.ef501ap+16f, 0x1.dce4fcp+11f, -0x1.08b886p+7f},
                                                        .direction = {-0x1.bad1dcp-3f, 0x1.cbe17cp-4f, -0x1.e2a41cp-1f},
                                                        .t_min = -std::numeric_limits<float>::infinity()}));
    // There and back along a line that doubles do not hold.
    const dvec3 a{0.1, 0.2, 0.3}, d{0.7, -0.1, 0.9};
    const std::array<dvec3, 4> line{a, a + d, a + 0.3 * d, a + 0.7 * d};
    EXPECT_FALSE(geo::cast_ray_polygon<double>(line, {.origin = a + 0.5 * d + dvec3{1, 2, 3}, .direction = {-1, -2, -3}}));
    // A sliver is a polygon still.
    const std::array<dvec3, 4> sliver{dvec3{0, 0, 0}, {1, 0, 0}, {1, 1e-12, 0}, {0, 1e-12, 0}};
    EXPECT_TRUE(geo::cast_ray_polygon<double>(sliver, {.origin = {0.5, 5e-13, 1}, .direction = {0, 0, -1}}));
}

TEST(RayPrimitivesLimits, ADistanceThatAFloatDoesNotHoldHasNoNormal) {
    const auto inside = geo::ray_interval(geo::Sphere<float>{{0, 0, 1e37f}, 2e37f}, {.origin = {0, 0, 0}, .direction = {0, 0, 1e-3f}});
    ASSERT_TRUE(inside);
    EXPECT_EQ(inside->t_enter, -std::numeric_limits<float>::infinity());
    EXPECT_EQ(inside->normal_enter, vec3{0.0f});
    EXPECT_EQ(inside->t_exit, std::numeric_limits<float>::infinity());
    EXPECT_EQ(inside->normal_exit, vec3{0.0f});
}

TEST(RayPrimitivesLimits, AnIntervalAtInfinityHasNoPoints) {
    const geo::Plane<double> floor{{0, 1, 0}, 0.0};
    const geo::Ray<double> down{.origin = {0, 5, 0}, .direction = {0, -1, 0}};
    for (const double end : {kInfinity, -kInfinity}) {
        EXPECT_FALSE(geo::ray_interval(floor, {down.origin, down.direction, end, end}));
        EXPECT_FALSE(geo::ray_interval(floor, {down.origin, -down.direction, end, end}));
        EXPECT_FALSE(geo::ray_interval(geo::Sphere<double>{{0, 0, 0}, 1.0}, {down.origin, down.direction, end, end}));
    }
    EXPECT_TRUE(geo::ray_interval(floor, {down.origin, down.direction, 1e300, kInfinity}));
    EXPECT_TRUE(geo::ray_interval(floor, {down.origin, down.direction, -kInfinity, kInfinity}));
}

/// |got - dot(n, x) + offset| in eps of the exact value.
double error_in_eps(const dvec3& n, const dvec3& x, double offset, double got) {
    const exact::Rational want = exact::dot(exact::vec(n), exact::vec(x)) - exact::number(offset);
    if (want == 0) return got == 0.0 ? 0.0 : kInfinity;
    return static_cast<double>(exact::magnitude((exact::number(got) - want) / want)) / 0x1p-52;
}

TEST(RayPrimitivesLimits, HeightsAreWithinFourEpsWhateverCancels) {
    double worst =
        error_in_eps({0x1.0a7e93e1bb832p+0, 0x1.c8ba147617f68p+0, -0x1.9218926d4cffp+0},
                     {0x1.f885b3b88ac04p+0, 0x1.3d28cbf271539p+0, 0x1.87d205b659546p+0}, 0.0,
                     geo::signed_distance(geo::Plane<double>{{0x1.0a7e93e1bb832p+0, 0x1.c8ba147617f68p+0, -0x1.9218926d4cffp+0}, 0.0},
                                          {0x1.f885b3b88ac04p+0, 0x1.3d28cbf271539p+0, 0x1.87d205b659546p+0}));
    EXPECT_LE(worst, 1.0) << "4.97 ulp where only the leading terms are summed";
    Random random(6);
    for (int i = 0; i < 6000; ++i) {
        dvec3 n{random.range(1, 2), random.range(1, 2), random.range(1, 2)}, x{random.range(1, 2), random.range(1, 2), random.range(1, 2)};
        n.z = -n.z;
        const double rest = n.x * x.x + n.y * x.y + n.z * x.z;
        // What is left of the sum of sizes: from one half, where the plain sum is taken, to nothing at all.
        double offset = rest * (1.0 - std::ldexp(random.range(0.5, 1.0), -static_cast<int>(random.range(0.0, 58.0))));
        if (i % 3 == 0) offset = rest;
        if (i % 3 == 1) offset = -std::copysign(random.range(0.3, 3.0) * (n.x * x.x + n.y * x.y - n.z * x.z), rest);
        worst = std::max(worst, error_in_eps(n, x, offset, geo::signed_distance(geo::Plane<double>{n, offset}, x)));
    }
    EXPECT_LE(worst, 4.0);
    EXPECT_GT(worst, 0.6) << "some plain sums are rounded worse than that";
}

// The oracle itself: a ray that grazes a U crosses the plane between its arms; moved by the bound, on either of them.
TEST(RayPrimitivesLimits, TheOracleOfConcavePolygonsKnowsNotches) {
    const std::array<dvec3, 8> u{dvec3{-2, -1, 0}, {2, -1, 0}, {2, 1, 0}, {1, 1, 0}, {1, -0.9, 0}, {-1, -0.9, 0}, {-1, 1, 0}, {-2, 1, 0}};
    const std::span<const dvec3> corners(u);
    const auto fault_of_a_miss = [&](double x, double slope) {
        const geo::Ray<double> ray{.origin = {0, 0.5, -x * slope}, .direction = {1, 0, slope}, .t_min = -kInfinity};
        return exact::surface_fault(corners, ray, std::optional<double>{}, 4.0);
    };
    const exact::Figure<std::span<const dvec3>> figure(corners);
    const double by = 4.0 * 0x1p-52 * static_cast<double>(figure.size(exact::vec(dvec3{0, 0.5, 0})));
    EXPECT_EQ(fault_of_a_miss(0.0, by / 1.5), "") << "+-1.5 is on the arms, 0 is not";
    EXPECT_EQ(fault_of_a_miss(0.0, 1.0), "");
    EXPECT_EQ(fault_of_a_miss(1.5, 1.0), "a hit is missed");
    EXPECT_EQ(fault_of_a_miss(1.5, 100.0 * by), "a hit is missed");
}

}  // namespace
}  // namespace carom
