// Impulses follow their features from step to step, and only those.
#include <carom/dynamics/detail/carried_contacts.hpp>

#include "odd_executors.hpp"

#include <gtest/gtest.h>

#include <span>
#include <vector>

namespace carom::dynamics {
namespace {

Manifold manifold_of(std::uint32_t pair, std::initializer_list<std::uint64_t> features) {
    Manifold m;
    m.pair = pair;
    for (const std::uint64_t f : features) m.points[m.count++].feature = f;
    return m;
}

CarriedContacts carried(const ContactSet& set) {
    static ScratchPool pool;
    SerialExecutor executor;
    CarriedContacts out(pool);
    out.take(set, executor);
    return out;
}

void append(ContactSet& set, const std::vector<Manifold>& manifolds) {
    for (const Manifold& manifold : manifolds) set.append(manifold, manifold.pair);
}

ContactSet set_of(std::initializer_list<std::uint64_t> keys, const std::vector<Manifold>& manifolds, const ContactSet& before = {}, float scale = 1.0f,
                  std::uint32_t generation = 7) {
    ContactSet set;
    append(set, manifolds);
    const std::vector<std::uint64_t> all(keys);
    SerialExecutor executor;
    link_manifolds(set, [&](std::uint32_t candidate) {
        ContactPair pair;
        pair.key = all[candidate];
        pair.generation_a = 7;
        pair.generation_b = generation;
        return pair;
    }, carried(before), scale, executor);
    return set;
}

TEST(ContactSet, CandidatesWithManifoldsBecomePairs) {
    const ContactSet set = set_of({10, 20, 30}, {manifold_of(0, {1}), manifold_of(2, {1}), manifold_of(2, {2})});
    ASSERT_EQ(set.pairs.size(), 2u);
    EXPECT_EQ(set.pairs[0].key, 10u);
    EXPECT_EQ(set.pairs[0].first_manifold, 0u);
    EXPECT_EQ(set.pairs[0].manifold_count, 1u);
    EXPECT_EQ(set.pairs[1].key, 30u);
    EXPECT_EQ(set.pairs[1].first_manifold, 1u);
    EXPECT_EQ(set.pairs[1].manifold_count, 2u);
    EXPECT_EQ(set.manifolds[0].pair, 0u);
    EXPECT_EQ(set.manifolds[2].pair, 1u);
    EXPECT_TRUE(set_of({10}, {}).pairs.empty());
}

TEST(ContactSet, PairsOfManyPartsAreThoseOfOneOnAnyThreads) {
    // Pairs of one to five manifolds, and candidates without any, across every boundary of the parts.
    std::vector<Manifold> manifolds;
    std::vector<std::size_t> sizes;
    for (std::uint32_t candidate = 0; manifolds.size() < 3000; ++candidate) {
        const std::size_t size = candidate * 7 % 6;
        for (std::size_t m = 0; m < size; ++m) manifolds.push_back(manifold_of(candidate, {m + 1}));
        if (size > 0) sizes.push_back(size);
    }
    const auto make = [](std::uint32_t candidate) {
        ContactPair pair;
        pair.key = candidate;
        return pair;
    };
    for (const int threads : {1, 2, 3, 8}) {
        for (const auto& [name, how] : test::odd_ways()) {
            test::OddExecutor executor(threads, how);
            ContactSet set;
            append(set, manifolds);
            link_manifolds(set, make, carried(set_of({5}, {manifold_of(0, {1})})), 1.0f, executor);
            ASSERT_EQ(set.pairs.size(), sizes.size()) << name;
            std::uint32_t next = 0;
            for (std::size_t i = 0; i < sizes.size(); ++i) {
                ASSERT_EQ(set.pairs[i].first_manifold, next) << name;
                ASSERT_EQ(set.pairs[i].manifold_count, sizes[i]) << name;
                ASSERT_EQ(set.pairs[i].key, manifolds[next].pair) << name;
                for (std::uint32_t m = 0; m < sizes[i]; ++m) ASSERT_EQ(set.manifolds[next + m].pair, i) << name;
                next += static_cast<std::uint32_t>(sizes[i]);
            }
            EXPECT_EQ(set.summary.points, manifolds.size()) << name;
        }
    }
}

TEST(ContactSet, ImpulsesFollowTheFeatureWithinThePair) {
    ContactSet before = set_of({10, 20}, {manifold_of(0, {5, 6}), manifold_of(1, {5})});
    before.impulses_of(0)[1].normal = 3.0f;
    before.impulses_of(0)[1].friction = {1.0f, 2.0f, 3.0f};
    before.impulses_of(1)[0].normal = 9.0f;
    const ContactSet now = set_of({10, 15, 20}, {manifold_of(0, {6, 7}), manifold_of(1, {5}), manifold_of(2, {4, 5})}, before);
    EXPECT_EQ(now.impulses_of(0)[0].normal, 3.0f);
    EXPECT_EQ(now.impulses_of(0)[0].friction, vec3(1.0f, 2.0f, 3.0f));
    EXPECT_EQ(now.impulses_of(0)[1].normal, 0.0f) << "a new feature starts from nothing";
    EXPECT_EQ(now.impulses_of(1)[0].normal, 0.0f) << "a new pair starts from nothing";
    EXPECT_EQ(now.impulses_of(2)[1].normal, 9.0f);
}

TEST(ContactSet, ImpulsesScaleWithTheSubstepAndTwinsKeepTheirOwn) {
    ContactSet before = set_of({10}, {manifold_of(0, {5, 5})});
    before.impulses_of(0)[0].normal = 2.0f;
    before.impulses_of(0)[1].normal = 6.0f;
    const ContactSet now = set_of({10}, {manifold_of(0, {5, 5, 5})}, before, 0.5f);
    EXPECT_EQ(now.impulses_of(0)[0].normal, 1.0f);
    EXPECT_EQ(now.impulses_of(0)[1].normal, 3.0f);
    EXPECT_EQ(now.impulses_of(0)[2].normal, 0.0f);
}

TEST(ContactSet, ImpulsesOfTheSamePointsScaleToo) {
    ContactSet before = set_of({10}, {manifold_of(0, {5, 6})});
    before.impulses_of(0)[1] = {4.0f, {2.0f, 6.0f, 8.0f}};
    const ContactSet now = set_of({10}, {manifold_of(0, {5, 6})}, before, 0.5f);
    EXPECT_EQ(now.impulses_of(0)[1].normal, 2.0f);
    EXPECT_EQ(now.impulses_of(0)[1].friction, vec3(1.0f, 3.0f, 4.0f));
}

TEST(ContactSet, AnotherGenerationIsAnotherPair) {
    ContactSet before = set_of({10}, {manifold_of(0, {5})});
    before.impulses_of(0)[0].normal = 3.0f;
    EXPECT_EQ(set_of({10}, {manifold_of(0, {5})}, before).impulses_of(0)[0].normal, 3.0f);
    EXPECT_EQ(set_of({10}, {manifold_of(0, {5})}, before, 1.0f, 8).impulses_of(0)[0].normal, 0.0f);
}

TEST(ContactSet, PointsOfAPairAreFoundInAnyOfItsManifolds) {
    ContactSet before = set_of({10}, {manifold_of(0, {1, 2}), manifold_of(0, {3, 2})});
    EXPECT_EQ(before.pairs[0].point_count, 4u);
    before.impulses_of(0)[0].normal = 1.0f;
    before.impulses_of(0)[1].normal = 2.0f;
    before.impulses_of(1)[0].normal = 3.0f;
    before.impulses_of(1)[1].normal = 4.0f;
    const ContactSet now = set_of({10}, {manifold_of(0, {3, 1}), manifold_of(0, {2, 2, 2})}, before);
    EXPECT_EQ(now.impulses_of(0)[0].normal, 3.0f);
    EXPECT_EQ(now.impulses_of(0)[1].normal, 1.0f);
    EXPECT_EQ(now.impulses_of(1)[0].normal, 2.0f);
    EXPECT_EQ(now.impulses_of(1)[1].normal, 4.0f);
    EXPECT_EQ(now.impulses_of(1)[2].normal, 0.0f);
}

TEST(CarriedContacts, AreTheSameOnAnyThreadsAndTakeHalfOfTheContacts) {
    std::vector<Manifold> manifolds;
    for (std::uint32_t pair = 0; pair < 1500; ++pair) {
        for (std::uint32_t m = 0; m < 1 + pair % 3; ++m) manifolds.push_back(manifold_of(pair, {7 * pair + m, pair, 9}));
    }
    ContactSet set;
    append(set, manifolds);
    SerialExecutor serial;
    link_manifolds(set, [](std::uint32_t candidate) {
        ContactPair pair;
        pair.key = 2 * candidate;
        return pair;
    }, carried({}), 1.0f, serial);
    for (std::uint32_t m = 0; m < manifolds.size(); ++m) set.impulses_of(m)[1].normal = static_cast<float>(m);
    for (const auto& [name, how] : test::odd_ways()) {
        test::OddExecutor executor(3, how);
        ScratchPool pool;
        CarriedContacts out(pool);
        out.take(set, executor);
        ASSERT_EQ(out.pairs().size(), set.pairs.size()) << name;
        std::size_t m = 0;
        for (std::size_t i = 0; i < set.pairs.size(); ++i) {
            ASSERT_EQ(out.pairs()[i].key, 2 * i) << name;
            const std::span<const CarriedPoint> points = out.points_of(out.pairs()[i]);
            ASSERT_EQ(points.size(), 3 * (1 + i % 3)) << name;
            for (std::size_t p = 0; p < points.size(); p += 3, ++m) {
                ASSERT_EQ(points[p].feature, 7 * i + p / 3) << name;
                ASSERT_EQ(points[p + 1].impulse.normal, static_cast<float>(m)) << name;
            }
        }
    }
    // Of a pile's pairs, which have one manifold with two points: 72 of 156 bytes.
    EXPECT_EQ(sizeof(CarriedPair) + 2 * sizeof(CarriedPoint), 72u);
    EXPECT_EQ(sizeof(ContactPair) + sizeof(ContactManifold) + 2 * (sizeof(ContactPoint) + sizeof(PointImpulse)), 156u);
}

TEST(CarriedContacts, WhatWakesComesInByKey) {
    CarriedContacts all = carried(set_of({10, 30}, {manifold_of(0, {1, 2}), manifold_of(1, {3})}));
    ContactSet woken = set_of({5, 20, 40}, {manifold_of(0, {4}), manifold_of(1, {5, 6, 7}), manifold_of(2, {8})});
    woken.impulses_of(1)[2].normal = 6.0f;
    all.add(woken);
    std::vector<std::uint64_t> keys, features;
    for (const CarriedPair& pair : all.pairs()) {
        keys.push_back(pair.key);
        for (const CarriedPoint& point : all.points_of(pair)) features.push_back(point.feature);
    }
    EXPECT_EQ(keys, (std::vector<std::uint64_t>{5, 10, 20, 30, 40}));
    EXPECT_EQ(features, (std::vector<std::uint64_t>{4, 1, 2, 5, 6, 7, 3, 8}));
    EXPECT_EQ(all.points_of(all.pairs()[2])[2].impulse.normal, 6.0f);
    all.clear();
    EXPECT_TRUE(all.pairs().empty());
}

TEST(ContactSet, SummaryCountsOverlapsOnly) {
    std::vector<Manifold> manifolds{manifold_of(0, {1, 2, 3}), manifold_of(1, {1})};
    manifolds[0].points[0].separation = -0.5f;
    manifolds[0].points[1].separation = 0.25f;
    manifolds[0].points[2].separation = -0.375f;
    manifolds[1].points[0].separation = -0.25f;
    const ContactSummary s = set_of({1, 2}, manifolds).summary;
    EXPECT_EQ(s.points, 4u);
    EXPECT_EQ(s.touching, 3u);
    EXPECT_EQ(s.max_penetration, 0.5);
    EXPECT_EQ(s.mean_penetration, 0.375);
}

}  // namespace
}  // namespace carom::dynamics
