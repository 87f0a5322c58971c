// Queries against every box looked at by itself: with every method, freshly built and after boxes have moved.
#include "broadphase/crowd.hpp"

#include <carom/broadphase/queries.hpp>
#include <carom/core/check.hpp>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

namespace carom {
namespace {

using Slots = std::vector<std::uint32_t>;

template <class Query>
Slots visited(Query query) {
    Slots slots;
    query([&](std::uint32_t slot) {
        slots.push_back(slot);
        return true;
    });
    std::stable_sort(slots.begin(), slots.end());
    return slots;
}

Slots all_that(const Broadphase& broadphase, std::size_t n, const std::function<bool(const FloatAabb&)>& touch) {
    Slots slots;
    for (std::uint32_t i = 0; i < n; ++i) {
        const FloatAabb box = broadphase.box(i);
        if (box.lower.x <= box.upper.x && touch(box)) slots.push_back(i);
    }
    return slots;
}

/// Points of the box nearest to `p`.
double distance(const FloatAabb& box, const dvec3& p) { return glm::length(p - glm::clamp(p, dvec3(box.lower), dvec3(box.upper))); }

/// The entry of a ray into a box grown by `half`, by looking at every face; infinite for a miss.
double entry(const FloatAabb& box, const dvec3& origin, const dvec3& direction, const dvec3& half) {
    const dvec3 lower = dvec3(box.lower) - half, upper = dvec3(box.upper) + half;
    const auto inside = [&](const dvec3& p, int but) {
        for (int k = 0; k < 3; ++k) {
            if (k != but && (p[k] < lower[k] || p[k] > upper[k])) return false;
        }
        return true;
    };
    if (inside(origin, -1)) return 0.0;
    double best = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
        for (const double face : {lower[k], upper[k]}) {
            const double t = (face - origin[k]) / direction[k];
            if (direction[k] != 0.0 && t >= 0.0 && inside(origin + t * direction, k)) best = std::min(best, t);
        }
    }
    return best;
}

class Queries : public ::testing::TestWithParam<BroadphaseMethod> {};

void compare(const Broadphase& broadphase, std::size_t n, Random& random) {
    const auto point = [&](double size) { return dvec3{random.range(-size, size), random.range(-size, size), random.range(-size, size)}; };
    const dvec3 p = point(10), q = p + glm::abs(point(3)), direction = random.unit() < 0.2 ? dvec3{0, 0, -1} : point(2);
    const double radius = random.range(0, 4), t_max = random.range(0, 9);
    EXPECT_EQ(visited([&](SlotVisitor v) { query_box(broadphase, p, q, v); }), all_that(broadphase, n, [&](const FloatAabb& box) {
                  return glm::all(glm::lessThanEqual(dvec3(box.lower), q)) && glm::all(glm::lessThanEqual(p, dvec3(box.upper)));
              }));
    EXPECT_EQ(visited([&](SlotVisitor v) { query_sphere(broadphase, p, radius, v); }),
              all_that(broadphase, n, [&](const FloatAabb& box) { return distance(box, p) <= radius; }));
    const HalfSpace planes[] = {{{1, 0, 0}, 5.0}, {{-1, 0.3, 0}, 2.0}, {direction, 3.0}};
    EXPECT_EQ(visited([&](SlotVisitor v) { query_volume(broadphase, planes, v); }), all_that(broadphase, n, [&](const FloatAabb& box) {
                  return std::all_of(std::begin(planes), std::end(planes), [&](const HalfSpace& h) {
                      double least = std::numeric_limits<double>::infinity();
                      for (int corner = 0; corner < 8; ++corner) {
                          const dvec3 c{corner & 1 ? box.lower.x : box.upper.x, corner & 2 ? box.lower.y : box.upper.y,
                                        corner & 4 ? box.lower.z : box.upper.z};
                          least = std::min(least, glm::dot(h.normal, c));
                      }
                      return least <= h.offset;
                  });
              }));
    EXPECT_EQ(visited([&](SlotVisitor v) { query_ray(broadphase, p, direction, t_max, v); }),
              all_that(broadphase, n, [&](const FloatAabb& box) { return entry(box, p, direction, dvec3{0.0}) <= t_max; }));
    EXPECT_EQ(visited([&](SlotVisitor v) { query_swept_box(broadphase, p, q, direction, v); }),
              all_that(broadphase, n, [&](const FloatAabb& box) { return entry(box, 0.5 * (p + q), direction, 0.5 * (q - p)) <= 1.0; }));

    const auto odd = [](std::uint32_t slot) { return slot % 2 == 1; };
    std::optional<BoxHit> first;
    for (const std::uint32_t slot : all_that(broadphase, n, [](const FloatAabb&) { return true; })) {
        const double t = entry(broadphase.box(slot), p, direction, dvec3{0.0});
        if (odd(slot) && t <= t_max && (!first || t < first->t)) first = BoxHit{slot, t};
    }
    const std::optional<BoxHit> hit = closest_on_ray(broadphase, p, direction, t_max, odd);
    ASSERT_EQ(hit.has_value(), first.has_value());
    if (hit) {
        EXPECT_EQ(hit->slot, first->slot);
    }

    Slots by_distance = all_that(broadphase, n, [](const FloatAabb&) { return true; });
    std::stable_sort(by_distance.begin(), by_distance.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return distance(broadphase.box(a), p) < distance(broadphase.box(b), p); });
    const Slots near = nearest_boxes(broadphase, p, 12);
    ASSERT_EQ(near.size(), std::min<std::size_t>(12, by_distance.size()));
    for (std::size_t i = 0; i < near.size(); ++i) {  // roots may make equals of unequal squares
        EXPECT_EQ(distance(broadphase.box(near[i]), p), distance(broadphase.box(by_distance[i]), p));
    }
}

TEST_P(Queries, AgreeWithEveryBoxLookedAtByItself) {
    SerialExecutor executor;
    for (const test::Distribution kind : {test::Distribution::Uniform, test::Distribution::Clustered, test::Distribution::Mixed}) {
        test::Crowd crowd(kind, 400, 5, false);
        Broadphase broadphase({.method = GetParam()});
        EXPECT_TRUE(nearest_boxes(broadphase, dvec3{0.0}, 3).empty());
        Random random(6);
        for (int frame = 0; frame < 6; ++frame) {
            ASSERT_NO_FATAL_FAILURE(crowd.check(broadphase, executor));
            SCOPED_TRACE(testing::Message() << "distribution " << int(kind) << ", frame " << frame);
            for (int i = 0; i < 30; ++i) ASSERT_NO_FATAL_FAILURE(compare(broadphase, 400, random));
            crowd.change(random, 0.1, 0.05);
        }
    }
}

// Boxes on a lattice, so that rays run along faces, through edges and corners, and along the borders of cells; all numbers are exact. Some
// boxes span many cells, some rays start very far away, and directions have zeros of both signs.
TEST_P(Queries, RaysAlongBordersFromAfarAndThroughLongBoxes) {
    SerialExecutor executor;
    Random random(17);
    const auto lattice = [&](double size) { return 0.25 * std::floor(random.range(-4.0 * size, 4.0 * size)); };
    for (const bool spread : {false, true}) {  // in a cube; in clumps far apart, where cells are hashed
        std::vector<FloatAabb> boxes;
        for (int i = 0; i < 600; ++i) {
            const double clump = spread ? 4096.0 * (i % 4) : 0.0;
            const dvec3 lower{lattice(4) + clump, lattice(4) - clump, lattice(4)};
            dvec3 edge{0.25 * (i % 5), 0.25 * (i % 3), 0.25 * (i % 7)};
            if (i % 100 == 7) edge[i / 100 % 3] = 12.0;
            boxes.push_back({vec3(lower), vec3(lower + edge)});
        }
        const std::vector<ProxyFilter> filters(boxes.size());
        std::vector<std::uint32_t> slots(boxes.size());
        std::iota(slots.begin(), slots.end(), 0u);
        Broadphase broadphase({.method = GetParam()});
        broadphase.update({boxes, filters, slots, {}}, executor);
        std::size_t hits = 0;
        const auto check = [&](const dvec3& origin, const dvec3& direction, double t_max) {
            SCOPED_TRACE(testing::Message() << origin.x << ' ' << origin.y << ' ' << origin.z << " + t (" << direction.x << ' '
                                            << direction.y << ' ' << direction.z << "), t <= " << t_max);
            Slots want;
            std::optional<BoxHit> first;
            for (std::uint32_t i = 0; i < boxes.size(); ++i) {
                const double t = entry(boxes[i], origin, direction, dvec3{0.0});
                if (t > t_max) continue;
                want.push_back(i);
                if (!first || t < first->t) first = BoxHit{i, t};
            }
            hits += want.size();
            ASSERT_EQ(visited([&](SlotVisitor v) { query_ray(broadphase, origin, direction, t_max, v); }), want);
            const auto any = [](std::uint32_t) { return true; };
            ASSERT_EQ(closest_on_ray(broadphase, origin, direction, t_max, any), first);
        };
        for (int i = 0; i < 400; ++i) {
            const double clump = spread ? 4096.0 * (i % 4) : 0.0;
            const dvec3 at{lattice(6) + clump, lattice(6) - clump, lattice(6)};
            const double zero = i % 2 == 0 ? 0.0 : -0.0, sign = i % 3 == 0 ? -1.0 : 1.0;
            dvec3 along{zero};
            along[i % 3] = sign * (i % 5 == 0 ? 0.5 : 1.0);
            ASSERT_NO_FATAL_FAILURE(check(at, along, random.unit() < 0.3 ? 1e6 : 8.0));
            ASSERT_NO_FATAL_FAILURE(check(at - 0x1p30 * along, along, 0x1p33));
            dvec3 diagonal{sign, 1.0, zero};  // through edges of the lattice
            std::swap(diagonal[2], diagonal[i % 3]);
            ASSERT_NO_FATAL_FAILURE(check(at, diagonal, 20.0));
            ASSERT_NO_FATAL_FAILURE(check(at - 0x1p20 * diagonal, diagonal, 0x1p22));
            ASSERT_NO_FATAL_FAILURE(check(at, dvec3{sign, -1.0, 1.0}, 0.0));
            ASSERT_NO_FATAL_FAILURE(check(at, dvec3{sign, -1.0, 1.0}, 30.0));
        }
        EXPECT_GT(hits, 500u);
        // Directions so long or short that products pass the range of double.
        std::size_t none = 0;
        query_ray(broadphase, dvec3{0.0}, dvec3{1e200, 1e200, -1e200}, 1e200, [&](std::uint32_t) { return ++none, true; });
        query_ray(broadphase, dvec3{1e300}, dvec3{1e-300, 0.0, 0.0}, 1e300, [&](std::uint32_t) { return ++none, true; });
        EXPECT_LE(none, boxes.size());
    }
}

// A walk starts where the ray does, whichever way it goes, and ends soon after the nearest box.
TEST_P(Queries, PathsFromBeyondAllFloatsFindWhatTheyMeet) {
    Broadphase broadphase(BroadphaseSettings{.method = GetParam()});
    const std::vector<FloatAabb> boxes{{vec3{0.0f}, vec3{1.0f}}, {vec3{5.0f}, vec3{6.0f}}};
    const std::vector<ProxyFilter> filters(2);
    const std::vector<std::uint32_t> moved{0, 1};
    SerialExecutor executor;
    broadphase.update({boxes, filters, moved, {}}, executor);
    for (const double far : {1e200, 1e301, 1e305}) {
        const Slots found = visited([&](const auto& visit) { query_ray(broadphase, {far, 0.5, 0.5}, {-far, 0, 0}, 1.0, visit); });
        EXPECT_EQ(found, Slots{0}) << far;
    }
}

TEST(RayWalk, AsksForBoxesNearTheFirstHitOnly) {
    SerialExecutor executor;
    Random random(23);
    std::vector<FloatAabb> boxes;
    for (int i = 0; i < 4000; ++i)
        boxes.push_back(test::box_about({random.range(0, 400), random.range(0, 4), random.range(0, 4)}, dvec3{0.5}));
    const std::vector<ProxyFilter> filters(boxes.size());
    std::vector<std::uint32_t> slots(boxes.size());
    std::iota(slots.begin(), slots.end(), 0u);
    for (const BroadphaseMethod method : {BroadphaseMethod::UniformGrid, BroadphaseMethod::HierarchicalGrid}) {
        Broadphase broadphase({.method = method});
        broadphase.update({boxes, filters, slots, {}}, executor);
        for (const double sign : {1.0, -1.0}) {
            int asked = 0;
            const auto accept = [&](std::uint32_t) { return ++asked, true; };
            const dvec3 origin{sign > 0.0 ? -10.0 : 410.0, 2.0, 2.0};
            EXPECT_TRUE(closest_on_ray(broadphase, origin, {sign, 0.0, 0.0}, 1e3, accept).has_value());
            EXPECT_LT(asked, 10) << to_string(method) << ", " << sign;
        }
    }
}

TEST_P(Queries, StopWhenToldAndRefuseBadInput) {
    SerialExecutor executor;
    test::Crowd crowd(test::Distribution::Uniform, 300, 5, false);
    Broadphase broadphase({.method = GetParam()});
    crowd.check(broadphase, executor);
    int count = 0;
    query_sphere(broadphase, dvec3{0.0}, 100.0, [&](std::uint32_t) { return ++count < 5; });
    EXPECT_EQ(count, 5);
    const auto never = [](std::uint32_t) { return ADD_FAILURE(), true; };
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    EXPECT_THROW(query_box(broadphase, dvec3{1.0}, dvec3{0.0}, never), MisuseError);
    EXPECT_THROW(query_box(broadphase, dvec3{nan}, dvec3{0.0}, never), MisuseError);
    EXPECT_THROW(query_sphere(broadphase, dvec3{0.0}, -1.0, never), MisuseError);
    EXPECT_THROW(query_sphere(broadphase, dvec3{0.0}, infinity, never), MisuseError);
    const HalfSpace bad[] = {{{0, nan, 0}, 1.0}};
    EXPECT_THROW(query_volume(broadphase, bad, never), MisuseError);
    EXPECT_THROW(query_ray(broadphase, dvec3{0.0}, dvec3{0.0}, 1.0, never), MisuseError);
    EXPECT_THROW(query_ray(broadphase, dvec3{0.0}, dvec3{1.0}, infinity, never), MisuseError);
    EXPECT_THROW(query_swept_box(broadphase, dvec3{0.0}, dvec3{-1.0}, dvec3{1.0}, never), MisuseError);
    EXPECT_THROW(static_cast<void>(closest_on_ray(broadphase, dvec3{0.0}, dvec3{1.0}, -1.0, never)), MisuseError);
    EXPECT_THROW(static_cast<void>(nearest_boxes(broadphase, dvec3{infinity}, 1)), MisuseError);
    EXPECT_TRUE(nearest_boxes(broadphase, dvec3{0.0}, 0).empty());
}

INSTANTIATE_TEST_SUITE_P(All, Queries, ::testing::ValuesIn(kBroadphaseMethods),
                         [](const auto& tested) { return std::string(to_string(tested.param)); });

}  // namespace
}  // namespace carom
