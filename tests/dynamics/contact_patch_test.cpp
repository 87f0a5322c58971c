// A contact set that changes in places is the one that is made anew.
#include <carom/core/random.hpp>
#include <carom/dynamics/detail/coloring.hpp>
#include <carom/dynamics/detail/contact_patch.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace carom::dynamics {
namespace {

/// The contacts of a pair as they should be: of each manifold the features of its points, each with its impulse.
using Expected = std::vector<std::vector<std::pair<std::uint64_t, float>>>;

ContactPair pair_of(std::uint64_t key) {
    ContactPair pair;
    pair.key = key;
    return pair;
}

std::uint64_t below(Random& random, std::uint64_t n) { return static_cast<std::uint64_t>(random.range(0.0, static_cast<double>(n))); }

/// Up to three manifolds of up to four points, features unlike within the pair.
std::vector<Manifold> some_manifolds(Random& random, std::uint32_t pair) {
    std::vector<Manifold> manifolds(below(random, 4));
    std::uint64_t feature = 1 + below(random, 3);
    for (Manifold& m : manifolds) {
        m.pair = pair;
        m.count = static_cast<std::uint32_t>(1 + below(random, 4));
        for (std::uint32_t k = 0; k < m.count; ++k) {
            m.points[k].feature = feature++;
            m.points[k].separation = static_cast<float>(random.range(-1.0, 1.0));
        }
    }
    return manifolds;
}

/// What `found` is once the impulses of the same features have come over.
Expected carried(const std::vector<Manifold>& found, const Expected& before) {
    Expected out;
    for (const Manifold& m : found) {
        out.emplace_back();
        for (const ContactPoint& point : m.used()) {
            float impulse = 0.0f;
            for (const auto& manifold : before) {
                for (const auto& [feature, had] : manifold) impulse = feature == point.feature ? had : impulse;
            }
            out.back().emplace_back(point.feature, impulse);
        }
    }
    return out;
}

Expected contents(const ContactSet& set, const ContactPair& pair) {
    Expected out;
    for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
        out.emplace_back();
        const std::span<const ContactPoint> points = set.points_of(set.manifolds[m]);
        for (std::size_t k = 0; k < points.size(); ++k) out.back().emplace_back(points[k].feature, set.impulses_of(m)[k].normal);
    }
    return out;
}

TEST(ContactPatch, IsTheSetThatIsMadeAnew) {
    Random random(81);
    SerialExecutor executor;
    for (int world = 0; world < 20; ++world) {
        ContactSet set;
        ContactChanges changes;
        std::size_t most_unused = 0;
        std::map<std::uint64_t, Expected> expected;
        for (int step = 0; step < 30; ++step) {
            std::vector<ContactPair> looked;
            std::vector<Manifold> found;
            std::set<std::uint64_t> ended;
            for (std::uint64_t key = 0; key < 40; ++key) {
                const std::uint64_t what = below(random, 6);
                if (what == 0) ended.insert(key), expected.erase(key);
                if (what != 1 && !(what == 2 && step == 0)) continue;
                const std::vector<Manifold> of_pair = some_manifolds(random, static_cast<std::uint32_t>(looked.size()));
                looked.push_back(pair_of(key));
                found.insert(found.end(), of_pair.begin(), of_pair.end());
                const Expected now = carried(of_pair, expected[key]);
                now.empty() ? static_cast<void>(expected.erase(key)) : static_cast<void>(expected[key] = now);
            }
            std::map<std::uint64_t, std::uint32_t> first_before;
            for (const ContactPair& pair : set.pairs) first_before[pair.key] = pair.first_manifold;
            const auto may_end = [&](const ContactPair& pair) { return ended.contains(pair.key); };
            ContactPatch patch(set, may_end, changes);
            std::size_t next = 0;
            for (std::size_t k = 0; k < looked.size(); ++k) {
                const std::size_t first = next;
                while (next < found.size() && found[next].pair == k) ++next;
                patch.take(looked[k], std::span{found}.subspan(first, next - first));
            }
            patch.finish(executor);

            ASSERT_EQ(set.pairs.size(), expected.size());
            std::size_t i = 0, in_use = 0;
            double deepest = 0.0;
            for (const auto& [key, manifolds] : expected) {
                const ContactPair& pair = set.pairs[i];
                ASSERT_EQ(pair.key, key);
                ASSERT_EQ(contents(set, pair), manifolds);
                for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
                    ASSERT_EQ(set.manifolds[m].pair, i);
                    ASSERT_EQ(set.manifold_number(in_use++), m);
                    for (const ContactPoint& point : set.points_of(set.manifolds[m])) deepest = std::max(deepest, -static_cast<double>(point.separation));
                    for (std::uint32_t k = 0; k < set.manifolds[m].count; ++k) {
                        if (set.impulses_of(m)[k].normal == 0.0f) set.impulses_of(m)[k].normal = static_cast<float>(random.range(0.1, 1.0));
                    }
                }
                expected[key] = contents(set, pair);
                // A pair that was not looked at lies where it lay.
                const bool was_looked = std::ranges::any_of(looked, [&](const ContactPair& one) { return one.key == pair.key; });
                if (!was_looked) {
                    ASSERT_EQ(pair.first_manifold, first_before.at(key));
                }
                ++i;
            }
            ASSERT_EQ(set.manifold_count(), in_use);
            // Each has its own points, and few are nobody's.
            std::vector<int> owners(set.points.size(), 0);
            for (const ContactManifold& m : set.manifolds) {
                ASSERT_LE(m.count, m.room);
                for (std::uint32_t k = 0; k < m.room; ++k) ++owners.at(m.first_point + k);
            }
            ASSERT_EQ(set.impulses.size(), set.points.size());
            ASSERT_LE(std::ranges::count_if(owners, [](int n) { return n > 1; }), 0);
            ASSERT_EQ(static_cast<std::size_t>(std::ranges::count(owners, 0)), set.unused_points);
            EXPECT_LE(set.unused_points, 64 + set.points.size() / 16);
            most_unused = std::max(most_unused, set.unused_points);
            EXPECT_EQ(set.summary.max_penetration, deepest);
            const std::set<std::uint32_t> removed(changes.removed.begin(), changes.removed.end()), added(changes.added.begin(), changes.added.end());
            for (const std::uint32_t m : removed) ASSERT_EQ(set.manifolds[m].pair, kNoPair);
            for (std::uint32_t m = 0; m < set.manifolds.size(); ++m) ASSERT_EQ(set.manifolds[m].pair == kNoPair, set.manifolds[m].count == 0);
            for (const std::uint32_t m : changes.replaced) ASSERT_FALSE(removed.contains(m) || added.contains(m));
        }
        EXPECT_GT(set.manifolds.size(), set.manifold_count()) << "some are unused";
        EXPECT_GT(most_unused, 32u) << "and so are points, until they close up";
    }
}

TEST(Coloring, TakesContactsOneByOne) {
    Random random(82);
    constexpr std::int32_t kMovable = 30;
    std::vector<ContactRows> rows;
    for (int i = 0; i < 60; ++i) rows.push_back({static_cast<std::int32_t>(below(random, kMovable)), static_cast<std::int32_t>(below(random, kMovable + 5))});
    std::erase_if(rows, [](const ContactRows& r) { return r.a == r.b; });
    Coloring coloring;
    coloring.color(rows, kMovable);
    std::vector<std::uint32_t> color_of(rows.size(), kMaxColors);
    for (std::uint32_t c = 0; c + 1 < coloring.starts().size(); ++c) {
        for (std::uint32_t i = coloring.starts()[c]; i < coloring.starts()[c + 1]; ++i) color_of[coloring.order()[i]] = c;
    }
    for (int step = 0; step < 2000; ++step) {
        const std::size_t i = below(random, rows.size());
        ASSERT_LT(color_of[i], kMaxColors);
        coloring.give_back(rows[i], color_of[i]);
        rows[i] = {static_cast<std::int32_t>(below(random, kMovable)), static_cast<std::int32_t>(kMovable - 1 - below(random, 2) + below(random, 4))};
        if (rows[i].a == rows[i].b) rows[i].b = kMovable;
        const std::uint32_t open = coloring.open_to(rows[i]);
        for (std::uint32_t c = 0; c < kMaxColors; ++c) {
            const bool taken = std::ranges::any_of(rows, [&](const ContactRows& other) {
                const auto k = static_cast<std::size_t>(&other - rows.data());
                const auto shares = [&](std::int32_t row) { return row < kMovable && (row == rows[i].a || row == rows[i].b); };
                return k != i && color_of[k] == c && (shares(other.a) || shares(other.b));
            });
            ASSERT_EQ((open >> c & 1u) == 0, taken) << c;
        }
        std::uint32_t c = static_cast<std::uint32_t>(below(random, kMaxColors));
        while ((open >> c & 1u) == 0) c = (c + 1) % kMaxColors;
        coloring.take(rows[i], c);
        color_of[i] = c;
    }
}

}  // namespace
}  // namespace carom::dynamics
