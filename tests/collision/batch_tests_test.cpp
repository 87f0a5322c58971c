// Batches against the functions for one pair: the same verdicts without exception, distances within the stated bound, the same bits at
// every SIMD width.
#include <carom/collision/batch_tests.hpp>
#include <carom/core/check.hpp>
#include <carom/core/simd_width.hpp>

#include "primitive_cases.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <vector>

namespace carom {
namespace {

using namespace geo;
using test::Cases;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr double kEps = 0x1p-23;

// Every width, and the widest again at the end.
void at_every_width(const std::function<void()>& check) {
    for (const int width : available_simd_widths()) {
        SCOPED_TRACE(width);
        set_simd_width(width);
        check();
    }
    set_simd_width(0);
}

// What no batch may stumble over: some numbers replaced by awful ones, some items tiny, huge or far.
template <class Item>
void spoil(Cases<float>& cases, Item& item) {
    const float awful[] = {kNan, kInfinity, -kInfinity, 0.0f, -0.0f, 1e-42f, 1e-30f, 1e30f, -3e38f};
    if (cases.one_in(20)) {
        auto* numbers = reinterpret_cast<float*>(&item);
        numbers[static_cast<std::size_t>(cases.random().range(0, sizeof(Item) / sizeof(float)))] =
            awful[static_cast<int>(cases.random().range(0, 9))];
    }
    if (cases.one_in(20)) item = test::moved(item, dvec3{0.0}, std::ldexp(1.0, static_cast<int>(cases.random().range(-120, 100))));
}

template <class Item, class Query>
std::vector<Item> items_near(Cases<float>& cases, const Query& query, std::size_t count) {
    std::vector<Item> items(count);
    for (Item& item : items) {
        cases.choose_grid();
        cases.make(item);
        if (cases.one_in(2)) item = test::moved(item, dvec3{cases.random().range(-2, 2), 0.0, cases.random().range(-2, 2)}, 1.0);
        if (cases.one_in(3)) {  // just touching
            const auto c = closest_points(query, item);
            item = test::moved(item, dvec3(c.on_a) - dvec3(c.on_b), 1.0);
        }
        if (cases.one_in(12)) std::memcpy(&item, &items[0], sizeof(Item));
        spoil(cases, item);
    }
    return items;
}

template <class Item, class Query>
void expect_verdicts_of_pairs(std::uint64_t seed) {
    Cases<float> cases(seed);
    int together = 0;
    for (int round = 0; round < 60; ++round) {
        Query query;
        cases.choose_grid();
        cases.make(query);
        const auto items = items_near<Item>(cases, query, static_cast<std::size_t>(round * 7));
        if (round % 10 == 9) spoil(cases, query);
        std::vector<std::uint8_t> hit(items.size(), 7);
        overlaps_batch(items, query, hit);
        for (std::size_t i = 0; i < items.size(); ++i) {
            ASSERT_EQ(hit[i], overlaps(query, items[i]) ? 1 : 0) << round << " " << i;
            together += hit[i];
        }
    }
    EXPECT_GT(together, 2000);
}

TEST(Batch, OfSphereAndBoxesHasTheVerdictsOfPairs) {
    at_every_width([] { expect_verdicts_of_pairs<Aabb<float>, Sphere<float>>(0x0701); });
}

TEST(Batch, OfTurnedBoxesHasTheVerdictsOfPairs) {
    at_every_width([] { expect_verdicts_of_pairs<Obb<float>, Obb<float>>(0x0702); });
}

Ray<float> random_ray(Cases<float>& cases) {
    cases.choose_grid();
    Ray<float> ray{.origin = cases.point(3.0), .direction = cases.point(1.0)};
    if (cases.one_in(4)) ray.direction[static_cast<int>(cases.random().range(0, 3))] = cases.one_in(2) ? 0.0f : -0.0f;
    if (cases.one_in(5)) ray.t_max = static_cast<float>(cases.random().range(0, 4));
    if (cases.one_in(5)) ray.t_min = static_cast<float>(cases.random().range(-4, 1));
    if (cases.one_in(20)) ray.t_min = -kInfinity;
    if (cases.one_in(20)) ray.direction *= cases.one_in(2) ? 1e-25f : 1e25f;
    if (cases.one_in(20)) ray.direction = vec3{0.0f};
    if (cases.one_in(20)) ray.direction.y = cases.one_in(2) ? kNan : kInfinity;
    if (cases.one_in(20)) ray.origin.x = kNan;
    if (cases.one_in(20)) ray.t_min = kNan;
    if (cases.one_in(20)) ray.t_max = -1.0f;
    return ray;
}

// `at_most(item, t)`: how far t may be off for the item.
template <class Item>
void expect_hits_of_pairs(std::uint64_t seed, const std::function<double(const Ray<float>&, const Item&, float)>& at_most) {
    Cases<float> cases(seed);
    int hits = 0;
    double worst = 0.0;
    for (int round = 0; round < 200; ++round) {
        const Ray<float> ray = random_ray(cases);
        // Half of them touched by the ray with a corner, an edge or a face.
        const Vec3<float> on_ray = ray.origin + 1.5f * ray.direction;
        const auto items = items_near<Item>(cases, is_finite(on_ray) ? on_ray : vec3{0.0f}, static_cast<std::size_t>(round));
        std::vector<float> t(items.size(), -7.0f);
        cast_ray_batch(items, ray, t);
        for (std::size_t i = 0; i < items.size(); ++i) {
            const auto want = cast_ray(items[i], ray);
            ASSERT_EQ(t[i] < kInfinity, want.has_value()) << round << " " << i << " " << t[i];
            if (!want) {
                ASSERT_EQ(t[i], kInfinity);
                continue;
            }
            ++hits;
            const double off = std::fabs(static_cast<double>(t[i]) - static_cast<double>(want->t)),
                         allowed = at_most(ray, items[i], want->t);
            ASSERT_LE(off, allowed) << round << " " << i;
            if (allowed > 0.0) worst = std::max(worst, off / allowed);
        }
    }
    EXPECT_GT(hits, 1000);
    testing::Test::RecordProperty("worst", std::to_string(worst));
}

TEST(Batch, OfRayAndBoxesHasTheHitsOfPairs) {
    at_every_width([] {
        expect_hits_of_pairs<Aabb<float>>(
            0x0703, [](const Ray<float>&, const Aabb<float>&, float t) { return 8 * kEps * std::fabs(static_cast<double>(t)) + 0x1p-126; });
    });
}

TEST(Batch, OfRayAndTrianglesHasTheHitsOfPairs) {
    at_every_width([] {
        expect_hits_of_pairs<Triangle<float>>(0x0704, [](const Ray<float>& ray, const Triangle<float>& x, float) {
            double size = 0.0;
            for (const vec3& p : {x.a, x.b, x.c}) size = std::max(size, static_cast<double>(glm::length(dvec3(p) - dvec3(ray.origin))));
            return 512 * kEps * size / glm::length(dvec3(ray.direction));
        });
    });
}

TEST(Batch, OfPointAndTrianglesIsClosestWithinTheBound) {
    at_every_width([] {
        Cases<float> cases(0x0705);
        double worst = 0.0;
        for (int round = 0; round < 40; ++round) {
            cases.choose_grid();
            const Vec3<float> p = cases.point(1.0);
            const auto items = items_near<Triangle<float>>(cases, p, static_cast<std::size_t>(2 * round));
            std::vector<ClosestPoints<float>> closest(items.size());
            closest_points_batch(items, p, closest);
            for (std::size_t i = 0; i < items.size(); ++i) {
                const auto want = closest_points(p, items[i]);
                if (std::isnan(want.distance_sq)) {
                    ASSERT_TRUE(std::isnan(closest[i].distance_sq) && std::isnan(closest[i].on_b.y)) << round << " " << i;
                    continue;
                }
                ASSERT_EQ(closest[i].on_a, p);
                double size = 0.0;
                for (const vec3& corner : {items[i].a, items[i].b, items[i].c}) {
                    const dvec3 d = glm::abs(dvec3(corner) - dvec3(p));
                    size = std::max({size, d.x, d.y, d.z});
                }
                if (!(size < 1e18)) continue;  // squares overflow
                const double allowed = 16 * kEps * size + 0x1p-70;
                const double off =
                    std::fabs(std::sqrt(static_cast<double>(closest[i].distance_sq)) - std::sqrt(static_cast<double>(want.distance_sq)));
                ASSERT_LE(off, allowed) << round << " " << i;
                const double outside = std::sqrt(
                    closest_points(dvec3(closest[i].on_b), Triangle<double>{dvec3(items[i].a), dvec3(items[i].b), dvec3(items[i].c)})
                        .distance_sq);
                ASSERT_LE(outside, allowed + kEps * static_cast<double>(glm::length(dvec3(p)))) << round << " " << i;
                worst = std::max(worst, std::max(off, outside) / allowed);
            }
        }
        testing::Test::RecordProperty("worst", std::to_string(worst));
    });
}

// Triangles that the ray meets at all slopes, and rays that end to the last bit at where it does.
TEST(Batch, OfRayAndTrianglesEndsWhereASingleOneDoes) {
    at_every_width([] {
        Random random(0x0708);
        int hits = 0;
        double worst = 0.0;
        for (int i = 0; i < 3000; ++i) {
            const auto point = [&](double s) { return dvec3{random.range(-s, s), random.range(-s, s), random.range(-s, s)}; };
            const dvec3 origin(vec3(point(3.0))), direction(vec3(point(1.0)));
            const dvec3 at = origin + random.range(0.5, 4.0) * direction;
            // Two edges nearly along the ray, the more so the larger i % 16.
            const dvec3 across = std::ldexp(1.0, -(i % 16)) * point(1.0);
            const dvec3 e1 = random.range(0.5, 1.0) * direction + across, e2 = random.range(-1.0, -0.5) * direction + 0.5 * point(1.0) * std::ldexp(1.0, -(i % 16));
            const std::array<Triangle<float>, 1> t{Triangle<float>{vec3(at - (e1 + e2) / 3.0), vec3(at + e1 - (e1 + e2) / 3.0), vec3(at + e2 - (e1 + e2) / 3.0)}};
            Ray<float> ray{.origin = vec3(origin), .direction = vec3(direction), .t_min = -kInfinity};
            const auto want = cast_ray(t[0], ray);
            if (!want) continue;
            ++hits;
            std::array<float, 1> found{};
            cast_ray_batch(t, ray, found);
            double size = 0.0;
            for (const vec3& p : {t[0].a, t[0].b, t[0].c}) size = std::max(size, static_cast<double>(glm::length(dvec3(p) - origin)));
            const double off = std::fabs(static_cast<double>(found[0]) - static_cast<double>(want->t)) * glm::length(direction);
            ASSERT_LE(off, 512 * kEps * size) << i;
            worst = std::max(worst, off / (512 * kEps * size));
            for (const float end : {want->t, std::nextafter(want->t, kInfinity), std::nextafter(want->t, -kInfinity)}) {
                for (const Ray<float>& cut : {Ray<float>{ray.origin, ray.direction, -kInfinity, end}, Ray<float>{ray.origin, ray.direction, end, kInfinity}}) {
                    cast_ray_batch(t, cut, found);
                    ASSERT_EQ(found[0] < kInfinity, cast_ray(t[0], cut).has_value()) << i;
                }
            }
        }
        EXPECT_GT(hits, 1000);
        testing::Test::RecordProperty("worst", std::to_string(worst));
    });
}

// Far from the world's origin it is the rounding of the point that counts, and only that.
TEST(Batch, ClosestPointsFarFromTheOriginAreRoundedAndNoMore) {
    Random random(0x0707);
    for (const double far : {0.0, 10.0, 1e3, 1e5, 1e6}) {
        double worst = 0.0;
        for (int i = 0; i < 2000; ++i) {
            const auto point = [&] { return vec3(dvec3{far} + dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)}); };
            const std::array<Triangle<float>, 1> t{Triangle<float>{point(), point(), point()}};
            const vec3 p = point();
            std::array<ClosestPoints<float>, 1> closest;
            closest_points_batch(t, p, closest);
            double size = 0.0;
            for (const vec3& corner : {t[0].a, t[0].b, t[0].c}) {
                const dvec3 d = glm::abs(dvec3(corner) - dvec3(p));
                size = std::max({size, d.x, d.y, d.z});
            }
            const Triangle<double> exact{dvec3(t[0].a), dvec3(t[0].b), dvec3(t[0].c)};
            const double outside = std::sqrt(closest_points(dvec3(closest[0].on_b), exact).distance_sq);
            const double half_ulps = glm::length(dvec3(glm::abs(closest[0].on_b))) * 0x1p-24;
            ASSERT_LE(outside, 16 * kEps * size + half_ulps) << far;
            worst = std::max(worst, outside / (16 * kEps * size + half_ulps));
        }
        EXPECT_GT(worst, 0.01) << "the bound says nothing";
    }
}

TEST(Batch, HasTheSameBitsAtEveryWidth) {
    Cases<float> cases(0x0706);
    const Ray<float> ray{.origin = {-3, 0.1f, 0.2f}, .direction = {1, 0.02f, -0.03f}};
    const auto boxes = items_near<Aabb<float>>(cases, vec3{0.0f}, 333);
    const auto triangles = items_near<Triangle<float>>(cases, vec3{0.0f}, 333);
    std::vector<std::vector<float>> seen;
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        std::vector<float> t(2 * 333);
        cast_ray_batch(boxes, ray, std::span(t).first(333));
        cast_ray_batch(triangles, ray, std::span(t).last(333));
        std::vector<ClosestPoints<float>> closest(333);
        closest_points_batch(triangles, vec3{0.5f}, closest);
        for (const auto& c : closest) {
            if (!std::isnan(c.distance_sq)) t.insert(t.end(), {c.on_b.x, c.on_b.y, c.on_b.z, c.distance_sq});
        }
        seen.push_back(t);
    }
    set_simd_width(0);
    for (const auto& t : seen) {
        ASSERT_EQ(t.size(), seen[0].size());
        EXPECT_EQ(std::memcmp(t.data(), seen[0].data(), t.size() * sizeof(float)), 0);
    }
}

TEST(Batch, RefusesOutputOfAnotherLengthAndLeavesItAlone) {
    const std::vector<Aabb<float>> boxes(3);
    const std::vector<Triangle<float>> triangles(3);
    std::vector<float> t(2, -7.0f);
    std::vector<std::uint8_t> hit(4, 7);
    std::vector<ClosestPoints<float>> closest(2);
    EXPECT_THROW(cast_ray_batch(boxes, Ray<float>{}, t), MisuseError);
    EXPECT_THROW(cast_ray_batch(triangles, Ray<float>{}, t), MisuseError);
    EXPECT_THROW(overlaps_batch(boxes, Sphere<float>{}, hit), MisuseError);
    EXPECT_THROW(closest_points_batch(triangles, vec3{0.0f}, closest), MisuseError);
    try {
        cast_ray_batch(boxes, Ray<float>{}, t);
        FAIL();
    } catch (const MisuseError& misuse) {
        EXPECT_NE(misuse.error().where.find("cast_ray_batch("), std::string::npos) << misuse.error().where;
        EXPECT_EQ(misuse.error().where.find("lambda"), std::string::npos) << misuse.error().where;
    }
    EXPECT_EQ(t, (std::vector<float>{-7.0f, -7.0f}));
    EXPECT_EQ(hit, (std::vector<std::uint8_t>{7, 7, 7, 7}));
    cast_ray_batch(std::span<const Aabb<float>>{}, Ray<float>{}, std::span<float>{});  // nothing to do is fine
}

}  // namespace
}  // namespace carom
