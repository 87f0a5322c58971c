// Capsules as they come on boxes and triangles from every side: many pairs, against the distance of axis and solid in double, and on a grid, where lines, edges
// and ways are parallel and faces lie in one plane, against what goes part by part.
#include <carom/collision/closest_points.hpp>
#include <carom/narrowphase/detail/sweep_frame.hpp>
#include <carom/narrowphase/sweep.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

dvec3 any(Random& random, double size) { return size * dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)}; }

void fill(Random& random, geo::Aabb<double>& b) {
    const dvec3 p = any(random, 1.0), q = any(random, 1.0);
    b = {glm::min(p, q), glm::max(p, q)};
}
void fill(Random& random, geo::Obb<double>& b) {
    b = {any(random, 1.0), glm::abs(any(random, 0.7)), glm::mat3_cast(test::random_rotation(random))};
}
void fill(Random& random, geo::Triangle<double>& t) { t = {any(random, 1.0), any(random, 1.0), any(random, 1.0)}; }

/// Thick ones, whose axes pass what they touch from afar, and thin ones; contacts by 1e-9 either way may be either.
template <class B>
void judge(std::uint64_t seed) {
    Random random(seed);
    int touching = 0, separated = 0;
    for (int i = 0; i < 6000; ++i) {
        B b;
        fill(random, b);
        const dvec3 motion = any(random, i % 4 == 0 ? 1.0 : 6.0), at = any(random, 1.5) - 0.5 * motion;
        geo::Capsule<double> a{{at, at + any(random, i % 3 == 0 ? 0.1 : 1.0)}, random.range(0.0, i % 2 == 0 ? 1.2 : 0.2)};
        const auto distance = [&](double t) {
            return std::sqrt(geo::closest_points(geo::Segment<double>{a.axis.a + t * motion, a.axis.b + t * motion}, b).distance_sq);
        };
        double low = 0.0, high = 1.0;  // it is convex in t
        for (int k = 0; k < 60; ++k) {
            const double p = low + (high - low) / 3.0, q = high - (high - low) / 3.0;
            (distance(p) <= distance(q) ? high : low) = distance(p) <= distance(q) ? q : p;
        }
        const double least = std::min({distance(0.0), distance(low), distance(1.0)});
        if (i % 5 == 0) a.radius = least * (i % 10 == 0 ? 1.0 + 1e-6 : 1.0 - 1e-6);  // grazing
        const Impact hit = geo::sweep(a, motion, b);
        if (std::abs(least - a.radius) > 1e-9) {
            ASSERT_EQ(may_touch(hit.status), least <= a.radius) << i << " " << least - a.radius;
        }
        ++(may_touch(hit.status) ? touching : separated);
        if (hit.status != ImpactStatus::Touching) continue;
        for (const double share : {0.5, 0.9, 1.0}) ASSERT_GT(distance(share * hit.t), a.radius - 1e-9) << i;
        ASSERT_LT(distance(hit.t), a.radius + 1e-8) << i;
    }
    EXPECT_GT(touching, 1000);
    EXPECT_GT(separated, 500);
}
TEST(SweepCapsule, BoxesAreMetFromEverySide) { judge<geo::Aabb<double>>(0xca1); }
TEST(SweepCapsule, TurnedBoxesAreMetFromEverySide) { judge<geo::Obb<double>>(0xca2); }
TEST(SweepCapsule, TrianglesAreMetFromEverySide) { judge<geo::Triangle<double>>(0xca3); }

dvec3 on_grid(Random& random, double size) { return 0.5 * glm::round(2.0 * any(random, size)); }
dvec3 along_one_axis(Random& random, const dvec3& v) {
    dvec3 only{0.0};
    const int k = random.unit() < 0.33 ? 0 : random.unit() < 0.5 ? 1 : 2;
    only[k] = v[k];
    return only;
}

void fill_on_grid(Random& random, geo::Aabb<double>& b) {
    const dvec3 p = on_grid(random, 1.5), q = on_grid(random, 1.5);
    b = {glm::min(p, q), glm::max(p, q)};
}
void fill_on_grid(Random& random, geo::Obb<double>& b) {
    b = {on_grid(random, 1.0), glm::abs(on_grid(random, 1.0)), dmat3{dvec3{0, 1, 0}, dvec3{0, 0, 1}, dvec3{1, 0, 0}}};
}
void fill_on_grid(Random& random, geo::Triangle<double>& t) { t = {on_grid(random, 1.5), on_grid(random, 1.5), on_grid(random, 1.5)}; }
void fill_on_grid(Random& random, geo::Capsule<double>& c) {
    c = {{on_grid(random, 1.5), on_grid(random, 1.5)}, random.unit() < 0.5 ? 0.0 : 0.25};
}

/// By how much contact may be early where edges are next to parallel: of boxes no more than elsewhere.
template <class B>
constexpr double kEarly = 3e-6;
template <>
constexpr double kEarly<geo::Aabb<double>> = 1e-12;
template <>
constexpr double kEarly<geo::Obb<double>> = 1e-12;

double distance_to(const geo::Segment<double>& s, const dvec3& p) { return std::sqrt(geo::closest_points(s, p).distance_sq); }
template <class B>
double outside(const B& b, const dvec3& p) {
    return std::sqrt(geo::closest_points(b, p).distance_sq);
}
double outside(const geo::Capsule<double>& b, const dvec3& p) { return std::abs(distance_to(b.axis, p) - b.radius); }

template <class B>
void judge_grid(std::uint64_t seed) {
    Random random(seed);
    int touching = 0, separated = 0, overlapping = 0, aligned = 0;
    for (int i = 0; i < 40'000; ++i) {
        B b;
        fill_on_grid(random, b);
        dvec3 motion = on_grid(random, 4.0), line = on_grid(random, i % 3 == 0 ? 3.0 : 1.0);
        if (random.unit() < 0.4) motion = along_one_axis(random, motion);
        if (random.unit() < 0.4) line = along_one_axis(random, line);
        if (random.unit() < 0.1) line = 0.5 * motion;
        if (i % 16 == 0) line += 1e-9 * any(random, 1.0);  // next to parallel
        const dvec3 at = on_grid(random, 2.0) - 0.5 * motion;
        const geo::Capsule<double> a{{at, at + line}, 0.25 * std::round(random.range(-0.4, 3.4))};
        const Impact hit = geo::sweep(a, motion, b);
        const auto distance = [&](double t) {
            return std::sqrt(geo::closest_points(geo::Segment<double>{a.axis.a + t * motion, a.axis.b + t * motion}, b).distance_sq);
        };
        if (i % 16 == 0) {  // where what goes part by part is early by up to 3e-7 of the sizes
            double low = 0.0, high = 1.0;
            for (int k = 0; k < 100; ++k) {
                const double p = low + (high - low) / 3.0, q = high - (high - low) / 3.0;
                (distance(p) <= distance(q) ? high : low) = distance(p) <= distance(q) ? q : p;
            }
            const double least = std::min({distance(0.0), distance(low), distance(1.0)});
            if (hit.status == ImpactStatus::Separated) {
                ASSERT_GT(least, a.radius - 1e-12) << i;
            }
            if (hit.status == ImpactStatus::Touching) {
                ASSERT_GT(distance(0.0), a.radius - 1e-12) << i;
            }
            if (hit.status == ImpactStatus::Touching) {
                ASSERT_LT(least, a.radius + kEarly<B>) << i;
            }
            if (hit.status == ImpactStatus::Overlapping) {
                ASSERT_LT(distance(0.0), a.radius + kEarly<B>) << i;
            }
        } else {
            const Impact parts = geo::sweep_by_parts(a, motion, b);
            ASSERT_EQ(hit.status, parts.status) << i << " " << hit.t << " " << parts.t;
            ASSERT_NEAR(hit.t, parts.t, 1e-6) << i;
        }
        touching += hit.status == ImpactStatus::Touching ? 1 : 0, separated += hit.status == ImpactStatus::Separated ? 1 : 0;
        overlapping += hit.status == ImpactStatus::Overlapping ? 1 : 0;
        if (hit.status != ImpactStatus::Touching) continue;
        aligned += glm::length(glm::cross(line, motion)) == 0.0 ? 1 : 0;
        const dvec3 by = hit.t * motion;
        const geo::Segment<double> axis{a.axis.a + by, a.axis.b + by};
        for (const double share : {0.5, 0.9, 1.0}) ASSERT_GT(distance(share * hit.t), a.radius - 1e-11) << i;
        ASSERT_LT(outside(b, hit.point), 1e-9) << i;
        ASSERT_NEAR(distance_to(axis, hit.point), a.radius, 1e-6) << i;
        ASSERT_NEAR(glm::length(hit.normal), 1.0, 1e-12) << i;
        ASSERT_NEAR(distance_to(axis, hit.point - a.radius * hit.normal), 0.0, 1e-5) << i;
        ASSERT_GT(glm::dot(hit.normal, motion), -1e-6) << i;
    }
    EXPECT_GT(touching, 5000);
    EXPECT_GT(separated, 5000);
    EXPECT_GT(overlapping, 2000);
    EXPECT_GT(aligned, 200);
}
TEST(SweepCapsule, OnAGridCapsulesAreMetAsPartByPart) { judge_grid<geo::Capsule<double>>(0xca4); }
TEST(SweepCapsule, OnAGridBoxesAreMetAsPartByPart) { judge_grid<geo::Aabb<double>>(0xca5); }
TEST(SweepCapsule, OnAGridTurnedBoxesAreMetAsPartByPart) { judge_grid<geo::Obb<double>>(0xca6); }
TEST(SweepCapsule, OnAGridTrianglesAreMetAsPartByPart) { judge_grid<geo::Triangle<double>>(0xca7); }

}  // namespace
}  // namespace carom
