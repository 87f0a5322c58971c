// Whether convex shapes overlap: verdicts of one pair and of many against brute force, exact rationals and collide().
#include "near_pairs.hpp"

#include <carom/core/check.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/overlap.hpp>

#include <support/exact_shape.hpp>

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <thread>

namespace carom {
namespace {

using test::Condition;
using test::NearPair;

constexpr ShapeType kConvex[] = {ShapeType::Box,    ShapeType::ConvexHull, ShapeType::Sphere,
                                 ShapeType::Capsule, ShapeType::Cylinder,  ShapeType::Cone};

// Poses of the long property test: 100,000, or as many as CAROM_POSES says (1e7 take a quarter of an hour).
int pose_count() {
    const char* const asked = std::getenv("CAROM_POSES");
    return asked != nullptr ? std::atoi(asked) : 100000;
}

struct Pairs {
    std::vector<NearPair> all;
    std::vector<const Shape*> shapes;
    std::vector<Pose> poses;
    std::vector<NumberedPair> pairs;
    void number() {
        for (const NearPair& p : all) {
            const auto first = static_cast<std::uint32_t>(shapes.size());
            shapes.insert(shapes.end(), {&p.a, &p.b});
            poses.insert(poses.end(), {p.pose_a, p.pose_b});
            pairs.push_back({first, first + 1, 0.0f});
        }
    }
};

Pairs some_pairs(Random& random, int count) {
    Pairs p;
    for (int i = 0; i < count; ++i) {
        p.all.push_back(test::near_pair(random, kConvex[i % 6], kConvex[(i / 6) % 6], test::kConditions[static_cast<std::size_t>(i / 36) % 8]));
    }
    p.number();
    return p;
}

// The bound of the verdicts, generously: 8 E.
double bound_of(const NearPair& p) {
    const dvec3 between = p.pose_b.position - p.pose_a.position;
    return 8.0 * 0x1p-46 * (std::sqrt(glm::dot(between, between)) + 8.0 * p.size);
}

test::Solid solid_of(const Shape& shape, const Pose& pose, const dvec3& origin) {
    if (const Box* box = std::get_if<Box>(&shape)) return test::solid_of(*box, pose, origin);
    return test::solid_of(*std::get<ConvexHullPtr>(shape), pose, origin);
}

// The gap of two boxes along the best of the fifteen axes, each exact: edges may be as parallel as they like.
double exact_gap(const NearPair& p) {
    const std::vector<exact::Vec> a = exact::solid(p.a, p.pose_a).corners, b = exact::solid(p.b, p.pose_b).corners;
    const auto axes_of = [](const std::vector<exact::Vec>& corners) {
        const exact::Vec edges[3] = {corners[1] - corners[0], corners[2] - corners[0], corners[4] - corners[0]};
        return std::array{edges[0], edges[1], edges[2], exact::cross(edges[1], edges[2]), exact::cross(edges[2], edges[0]), exact::cross(edges[0], edges[1])};
    };
    const auto of_a = axes_of(a), of_b = axes_of(b);
    std::vector<exact::Vec> axes{of_a.begin() + 3, of_a.end()};
    axes.insert(axes.end(), of_b.begin() + 3, of_b.end());
    for (std::size_t k = 0; k < 9; ++k) axes.push_back(exact::cross(of_a[k / 3], of_b[k % 3]));
    double best = -std::numeric_limits<double>::infinity();
    for (const exact::Vec& n : axes) {
        const exact::Rational length_sq = exact::length_sq(n);
        if (length_sq.sign() == 0) continue;
        const auto before = [&](const exact::Vec& x, const exact::Vec& y) { return exact::dot(n, x) < exact::dot(n, y); };
        const auto [low_a, high_a] = std::minmax_element(a.begin(), a.end(), before);
        const auto [low_b, high_b] = std::minmax_element(b.begin(), b.end(), before);
        const exact::Rational gap = std::max(exact::dot(n, *low_b - *high_a), exact::dot(n, *low_a - *high_b));
        best = std::max(best, static_cast<double>(gap) / std::sqrt(static_cast<double>(length_sq)));
    }
    return best;
}

// Whether some edges of two boxes are parallel to 4e-8, but for the rounding of turns.
bool nearly_parallel(const NearPair& p) {
    const dmat3 r = glm::transpose(glm::mat3_cast(p.pose_a.orientation)) * glm::mat3_cast(p.pose_b.orientation);
    bool found = false;
    for (int k = 0; k < 9; ++k) found |= std::abs(r[k / 3][k % 3]) > 1.0 - 1e-15;
    return found;
}

// Boxes and small hulls, because brute force tries every two edges.
NearPair small_pair(Random& random, int i) {
    const Condition condition = test::kConditions[static_cast<std::size_t>(i) % test::kConditions.size()];
    NearPair p = test::near_pair(random, ShapeType::Box, ShapeType::Box, condition);
    if (i % 16 != 0 || p.size != 1.0) return p;
    std::vector<vec3> points;
    for (int k = 0; k < 6; ++k) points.push_back(vec3(test::random_direction(random)));
    if (const ConvexHullPtr hull = test::hull_of(points)) p.b = hull;
    return p;
}

// Neither verdict may be wrong, and outside the bound there is one; by one pair at a time, and by many at once.
TEST(Overlap, VerdictsAgainstAllSeparatingAxesInLongDouble) {
    Random random(0x0fe71a9);
    SerialExecutor executor;
    std::vector<Overlap> verdicts;
    int undecided = 0, near = 0, exact = 0;
    const int count = pose_count(), turn = 2000;
    for (int done = 0; done < count; done += turn) {
        Pairs p;
        for (int i = 0; i < turn; ++i) p.all.push_back(small_pair(random, i));
        p.number();
        overlaps({p.shapes, p.poses}, p.pairs, executor, verdicts);
        for (std::size_t i = 0; i < p.all.size(); ++i) {
            const NearPair& pair = p.all[i];
            const dvec3& origin = pair.pose_a.position;
            const auto axis = test::greatest_separation(solid_of(pair.a, pair.pose_a, origin), solid_of(pair.b, pair.pose_b, origin));
            const double gap = static_cast<double>(axis.value), bound = bound_of(pair);
            const Overlap one = overlaps(pair.a, pair.pose_a, pair.b, pair.pose_b);
            const bool is_box = std::holds_alternative<Box>(pair.b);
            near += std::abs(gap) < 1e-9 * pair.size ? 1 : 0;
            const auto fits = [&](Overlap verdict, double truth) {
                // Long double places points to 1e-18 of the size itself.
                const bool right = !(truth > 1e-3 * bound && verdict == Overlap::Overlapping) && !(truth < -1e-3 * bound && verdict == Overlap::Apart);
                return right && (verdict != Overlap::Undecided || std::abs(truth) <= (is_box ? bound : 1e4 * bound));
            };
            // Edges parallel to 1e-9 are no axes to the oracle, but may be those that separate: then exact numbers tell, which take 10 ms.
            const bool is_open = is_box && std::abs(gap) < 1e-7 * pair.size && nearly_parallel(pair);
            const bool is_exact = is_open && (i % 32 == 2 || !fits(one, gap) || !fits(verdicts[i], gap));
            const double truth = is_exact ? exact_gap(pair) : gap;
            exact += is_exact ? 1 : 0;
            for (const Overlap verdict : {one, verdicts[i]}) {
                ASSERT_TRUE(fits(verdict, truth)) << done + int(i) << " " << to_string(verdict) << ", gap " << truth << ", bound " << bound;
                undecided += verdict == Overlap::Undecided ? 1 : 0;
            }
        }
    }
    EXPECT_GT(near, count / 100);
    EXPECT_GT(exact, count / 2000);
    EXPECT_LT(undecided, count / 2);  // of two verdicts each
    EXPECT_GT(undecided, 0);
}

TEST(Overlap, VerdictsAgainstExactRationals) {
    Random random(0xe0ac7);
    for (int i = 0; i < 64; ++i) {
        const Condition condition = i % 2 ? Condition::NearContact : test::kConditions[static_cast<std::size_t>(i / 2) % 8];
        const NearPair p = test::near_pair(random, kConvex[i % 4], kConvex[(i / 4) % 4], condition);
        const exact::Solid a = exact::solid(p.a, p.pose_a), b = exact::solid(p.b, p.pose_b);
        const bool overlap = exact::core_distance_sq(a, b) <= exact::square(a.radius + b.radius);
        const Overlap verdict = overlaps(p.a, p.pose_a, p.b, p.pose_b);
        EXPECT_NE(verdict, overlap ? Overlap::Apart : Overlap::Overlapping) << i;
    }
}

// A tip on a face, a few ulp off: which side it is on only exact numbers tell, and no verdict may say more than they do.
TEST(Overlap, ATipWithinAnUlpOfAFaceIsNeverTakenForTheOtherSide) {
    Random random(0x71b);
    std::vector<vec3> cube, tips;
    for (int k = 0; k < 8; ++k) cube.push_back({k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1});
    for (int k = 0; k < 3; ++k) {
        vec3 tip{0.0f};
        tip[k] = 0.4f;
        tips.insert(tips.end(), {tip, -tip});
    }
    const Shape block = test::hull_of(cube), spike = test::hull_of(tips);
    int over = 0, under = 0;
    for (int i = 0; i < 4000; ++i) {
        Pose pose{{2.0, random.range(-0.3, 0.3), random.range(-0.3, 0.3)}, test::random_rotation(random)};
        double lowest = 2.0;
        for (const vec3& tip : tips) lowest = std::min(lowest, transform_point(pose, dvec3(tip)).x);
        pose.position.x += (1.0 - lowest) + std::floor(random.range(-3.0, 4.0)) * 0x1p-52;
        const exact::Solid b = exact::solid(spike, pose);
        exact::Rational gap = 2;
        for (const exact::Vec& corner : b.corners) gap = std::min(gap, exact::Rational(corner.x - 1));
        (gap.sign() > 0 ? over : under) += 1;
        const Overlap verdict = overlaps(block, {}, spike, pose);
        ASSERT_NE(verdict, gap.sign() > 0 ? Overlap::Overlapping : Overlap::Apart) << i << " gap " << static_cast<double>(gap);
    }
    EXPECT_GT(over, 1000);
    EXPECT_GT(under, 1000);
}

TEST(Overlap, TouchingIsUndecidedOrOverlapping) {
    const Shape cube = Box{{1, 1, 1}}, ball = Sphere{1.0f};
    for (const dvec3& p : {dvec3{2, 0, 0}, dvec3{2, 2, 0}, dvec3{2, 2, 2}, dvec3{2, 0.5, 0.25}}) {
        EXPECT_EQ(overlaps(cube, {}, cube, {p, kIdentityRotation}), Overlap::Undecided);
    }
    EXPECT_EQ(overlaps(cube, {}, ball, {{0, 2, 0}, kIdentityRotation}), Overlap::Undecided);
    EXPECT_EQ(overlaps(ball, {}, ball, {{0, 0, 2}, kIdentityRotation}), Overlap::Undecided);
    EXPECT_EQ(overlaps(cube, {}, cube, {}), Overlap::Overlapping);
    EXPECT_EQ(overlaps(ball, {}, ball, {}), Overlap::Overlapping);
    EXPECT_EQ(overlaps(cube, {}, cube, {{2.0 - 1e-12, 0, 0}, kIdentityRotation}), Overlap::Overlapping);
    EXPECT_EQ(overlaps(cube, {}, cube, {{2.0 + 1e-12, 0, 0}, kIdentityRotation}), Overlap::Apart);
}

// Detected means reported: no contact is lost between the query and the stages that make contacts.
TEST(Overlap, WhateverOverlapsHasADepthAndAManifold) {
    Random random(0xde7ec7);
    int overlapping = 0;
    for (int i = 0; i < 6000; ++i) {
        const Condition condition = i % 3 ? Condition::NearContact : test::kConditions[static_cast<std::size_t>(i / 3) % 6];
        const NearPair p = test::near_pair(random, kConvex[i % 6], kConvex[(i / 6) % 6], condition);
        if (overlaps(p.a, p.pose_a, p.b, p.pose_b) != Overlap::Overlapping) continue;
        ++overlapping;
        const PenetrationResult in = penetration(p.a, p.pose_a, p.b, p.pose_b);
        ASSERT_GT(in.upper, 0.0) << i;
        ASSERT_NEAR(glm::length(in.normal), 1.0, 1e-12) << i;
        ASSERT_EQ(distance(p.a, p.pose_a, p.b, p.pose_b).status, DistanceStatus::Overlap) << i;
        // collide() reports separations to 2e-6 of the larger shape's size, which is at most 5 here.
        const auto manifolds = test::collide_all(p.a, p.pose_a, p.b, p.pose_b, 1e-5f);
        ASSERT_FALSE(manifolds.empty()) << i << " depth " << in.upper;
        if (!std::holds_alternative<Cone>(p.a) && !std::holds_alternative<Cone>(p.b)) {
            EXPECT_NEAR(-static_cast<double>(test::least_separation(manifolds[0])), in.upper, 2e-5) << i;
        }
    }
    EXPECT_GT(overlapping, 2000);
}

TEST(Overlap, BatchesNeverContradictTheCallForOnePair) {
    Random random(0xba7c4);
    const Pairs p = some_pairs(random, 6000);
    SerialExecutor executor;
    std::vector<Overlap> verdicts;
    std::vector<DistanceResult> results;
    overlaps({p.shapes, p.poses}, p.pairs, executor, verdicts);
    distance({p.shapes, p.poses}, p.pairs, executor, {}, results);
    ASSERT_EQ(verdicts.size(), p.pairs.size());
    ASSERT_EQ(results.size(), p.pairs.size());
    int wider = 0;
    for (std::size_t i = 0; i < p.all.size(); ++i) {
        const NearPair& pair = p.all[i];
        const Overlap one = overlaps(pair.a, pair.pose_a, pair.b, pair.pose_b);
        const DistanceResult d = distance(pair.a, pair.pose_a, pair.b, pair.pose_b);
        EXPECT_FALSE(verdicts[i] == Overlap::Apart && one == Overlap::Overlapping) << i;
        EXPECT_FALSE(verdicts[i] == Overlap::Overlapping && one == Overlap::Apart) << i;
        EXPECT_LE(results[i].lower, d.upper) << i;
        EXPECT_GE(results[i].upper, d.lower) << i;
        EXPECT_FALSE(results[i].status == DistanceStatus::Overlap && d.lower > 0.0) << i;
        wider += results[i].upper - results[i].lower > d.upper - d.lower + bound_of(pair) ? 1 : 0;
    }
    EXPECT_LT(wider, 60);  // near contact, where either may end by rounding
}

class FourThreads final : public Executor {
public:
    [[nodiscard]] int thread_count() const noexcept override { return 4; }
    void parallel_for(std::size_t count, std::size_t grain, Body body) override {
        const std::size_t part = std::max(grain, (count + 3) / 4);
        std::vector<std::thread> threads;
        for (std::size_t begin = 0; begin < count; begin += part) threads.emplace_back([=] { body(begin, std::min(count, begin + part)); });
        for (std::thread& t : threads) t.join();
    }
};

bool same_bits(const std::vector<DistanceResult>& a, const std::vector<DistanceResult>& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const bool same = a[i].lower == b[i].lower && a[i].upper == b[i].upper && a[i].on_a == b[i].on_a && a[i].on_b == b[i].on_b &&
                          a[i].normal == b[i].normal && a[i].status == b[i].status && a[i].iterations == b[i].iterations;
        if (!same) return false;
    }
    return true;
}

TEST(Overlap, BatchesHaveTheSameBitsAtEveryWidthOnEveryThreadAndInEveryOrder) {
    Random random(0x51d);
    const Pairs p = some_pairs(random, 3001);
    SerialExecutor serial;
    FourThreads four;
    std::vector<Overlap> golden, verdicts;
    std::vector<DistanceResult> golden_distances, results;
    overlaps({p.shapes, p.poses}, p.pairs, serial, golden);
    distance({p.shapes, p.poses}, p.pairs, serial, {}, golden_distances);
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        for (Executor* executor : {static_cast<Executor*>(&serial), static_cast<Executor*>(&four)}) {
            overlaps({p.shapes, p.poses}, p.pairs, *executor, verdicts);
            distance({p.shapes, p.poses}, p.pairs, *executor, {}, results);
            EXPECT_EQ(verdicts, golden) << width;
            EXPECT_TRUE(same_bits(results, golden_distances)) << width;
        }
    }
    set_simd_width(0);
    std::vector<NumberedPair> backwards(p.pairs.rbegin(), p.pairs.rend());
    overlaps({p.shapes, p.poses}, backwards, serial, verdicts);
    distance({p.shapes, p.poses}, backwards, serial, {}, results);
    EXPECT_TRUE(std::equal(verdicts.rbegin(), verdicts.rend(), golden.begin()));
    EXPECT_TRUE(same_bits({results.rbegin(), results.rend()}, golden_distances));
}

TEST(Overlap, BatchesWithCachesAreTheSingleCall) {
    Random random(0xcac);
    Pairs p = some_pairs(random, 400);
    SerialExecutor executor;
    std::vector<DistanceCache> caches(p.pairs.size()), alone(p.pairs.size());
    std::vector<DistanceResult> results;
    for (int step = 0; step < 3; ++step) {
        distance({p.shapes, p.poses}, p.pairs, executor, caches, results);
        std::vector<DistanceResult> one;
        for (std::size_t i = 0; i < p.all.size(); ++i) {
            one.push_back(distance(p.all[i].a, p.poses[2 * i], p.all[i].b, p.poses[2 * i + 1], {}, &alone[i]));
        }
        EXPECT_TRUE(same_bits(results, one)) << step;
        for (Pose& pose : p.poses) pose.position += 1e-3 * test::random_direction(random);
    }
}

TEST(OverlapMisuse, LeavesTheResultsAlone) {
    const Shape box = Box{}, plane = Plane{}, mesh = TriangleMeshPtr{}, null = ConvexHullPtr{};
    Pose nan;
    nan.orientation.w = std::nan("");
    const std::vector<const Shape*> shapes{&box, &plane, &mesh, &null, nullptr, &box};
    const std::vector<Pose> poses{{}, {}, {}, {}, nan, nan};
    SerialExecutor executor;
    std::vector<Overlap> verdicts{Overlap::Apart};
    std::vector<DistanceResult> results(1);
    results[0].iterations = 77;
    std::vector<DistanceCache> caches(3);
    const auto refused = [&](NumberedPair pair, std::span<const Pose> at) {
        const NumberedPair pairs[] = {{0, 1, 0}, pair};
        EXPECT_THROW(overlaps({shapes, at}, pairs, executor, verdicts), MisuseError);
        EXPECT_THROW(distance({shapes, at}, pairs, executor, {}, results), MisuseError);
    };
    for (const NumberedPair& pair : {NumberedPair{1, 1, 0}, {0, 2, 0}, {3, 0, 0}, {0, 4, 0}, {0, 5, 0}, {0, 6, 0}, {6, 0, 0}}) refused(pair, poses);
    refused({0, 0, 0}, std::span(poses).first(5));
    const NumberedPair fine[] = {{0, 1, 0}};
    EXPECT_THROW(distance({shapes, poses}, fine, executor, caches, results), MisuseError);
    EXPECT_THROW(distance({shapes, poses}, fine, executor, {}, results, {.most_iterations = 0}), MisuseError);
    EXPECT_EQ(verdicts, std::vector<Overlap>{Overlap::Apart});
    EXPECT_EQ(results[0].iterations, 77);
    overlaps({shapes, poses}, fine, executor, verdicts);  // the NaN poses are of shapes that no pair names
    EXPECT_EQ(verdicts, std::vector<Overlap>{Overlap::Overlapping});
    overlaps({shapes, poses}, {}, executor, verdicts);
    EXPECT_TRUE(verdicts.empty());
}

}  // namespace
TEST(OverlapMisuse, SeesEveryNumberOfABoxesPose) {
    // Lanes judge boxes before anyone has asked whether their poses are finite.
    const Shape box = Box{};
    constexpr std::size_t kPairs = 40;
    const std::vector<const Shape*> shapes(2 * kPairs, &box);
    std::vector<NumberedPair> pairs;
    for (std::uint32_t i = 0; i < kPairs; ++i) pairs.push_back({2 * i, 2 * i + 1, 0});
    SerialExecutor executor;
    std::vector<Overlap> verdicts{Overlap::Apart};
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    for (const double bad : {std::nan(""), kInfinity, -kInfinity}) {
        for (int k = 0; k < 7; ++k) {
            for (int who = 1; who < 4; ++who) {  // the first box, the second, or both
                std::vector<Pose> poses(2 * kPairs);
                for (std::size_t side = 0; side < 2; ++side) {
                    if ((who >> side & 1) == 0) continue;
                    Pose& pose = poses[2 * 23 + side];
                    double* const numbers[] = {&pose.position.x,    &pose.position.y,    &pose.position.z,   &pose.orientation.x,
                                               &pose.orientation.y, &pose.orientation.z, &pose.orientation.w};
                    *numbers[k] = bad;
                }
                EXPECT_THROW(overlaps({shapes, poses}, pairs, executor, verdicts), MisuseError) << bad << ' ' << k << ' ' << who;
                EXPECT_EQ(verdicts, std::vector<Overlap>{Overlap::Apart});
            }
        }
    }
}

}  // namespace carom
