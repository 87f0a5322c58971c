// Islands against a plain search through the graph of contacts.
#include <carom/dynamics/detail/island_links.hpp>

#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <vector>

namespace carom::dynamics {
namespace {

struct Graph {
    std::vector<Role> roles;
    ContactSet contacts;
};

Graph random_graph(std::uint64_t seed, std::uint32_t bodies, int pairs) {
    Random random(seed);
    Graph g;
    for (std::uint32_t i = 0; i < bodies; ++i) g.roles.push_back(i % 7 == 3 ? Role::Static : i % 11 == 5 ? Role::Kinematic : i % 13 == 6 ? Role::Absent : Role::Dynamic);
    while (static_cast<int>(g.contacts.pairs.size()) < pairs) {
        const auto a = static_cast<std::uint32_t>(random.range(0, bodies)), b = static_cast<std::uint32_t>(random.range(0, bodies));
        if (a == b || g.roles[a] == Role::Absent || g.roles[b] == Role::Absent || (g.roles[a] != Role::Dynamic && g.roles[b] != Role::Dynamic)) continue;
        ContactPair pair;
        pair.body_a.slot = a;
        pair.body_b.slot = b;
        ContactManifold manifold;
        manifold.pair = static_cast<std::uint32_t>(g.contacts.pairs.size());
        manifold.count = 1;
        g.contacts.pairs.push_back(pair);
        g.contacts.manifolds.push_back(manifold);
    }
    return g;
}

std::set<std::uint32_t> reached_from(const Graph& g, std::uint32_t slot) {
    std::set<std::uint32_t> reached{slot};
    for (bool grew = true; grew;) {
        grew = false;
        for (const ContactPair& pair : g.contacts.pairs) {
            const std::uint32_t a = pair.body_a.slot, b = pair.body_b.slot;
            if (g.roles[a] != Role::Dynamic || g.roles[b] != Role::Dynamic || reached.contains(a) == reached.contains(b)) continue;
            reached.insert({a, b});
            grew = true;
        }
    }
    return reached;
}

TEST(IslandLinks, AreThoseOfAPlainSearch) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Graph g = random_graph(seed, 60, 10 * static_cast<int>(seed % 6));
        IslandLinks links;
        links.link(g.contacts, g.roles);
        for (std::uint32_t slot = 0; slot < 60; ++slot) {
            if (g.roles[slot] != Role::Dynamic) continue;
            EXPECT_EQ(links.root(slot), *reached_from(g, slot).begin()) << seed;
        }
    }
}

TEST(IslandLinks, ListsThoseThatAreWantedWithAllTheyHave) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Graph g = random_graph(seed, 60, 35);
        Random random(seed);
        std::vector<unsigned char> wanted(g.contacts.manifolds.size(), 0);
        for (int i = 0; i < 4; ++i) wanted[static_cast<std::size_t>(random.range(0, 35))] = 1;
        std::map<std::uint32_t, std::set<std::uint32_t>> manifolds_of_root;
        std::set<std::uint32_t> wanted_roots;
        for (std::uint32_t m = 0; m < wanted.size(); ++m) {
            const ContactPair& pair = g.contacts.pairs[m];
            const std::uint32_t root = *reached_from(g, g.roles[pair.body_a.slot] == Role::Dynamic ? pair.body_a.slot : pair.body_b.slot).begin();
            manifolds_of_root[root].insert(m);
            if (wanted[m] != 0) wanted_roots.insert(root);
        }
        IslandLinks links;
        links.link(g.contacts, g.roles);
        links.gather(g.contacts, g.roles, wanted);
        ASSERT_EQ(links.islands().size(), wanted_roots.size());
        std::size_t next = 0;
        for (const std::uint32_t root : wanted_roots) {
            const Island& island = links.islands()[next++];
            const auto bodies = links.bodies(island), manifolds = links.manifolds(island);
            const std::set<std::uint32_t> expected = reached_from(g, root);
            EXPECT_EQ(std::vector<std::uint32_t>(bodies.begin(), bodies.end()), std::vector<std::uint32_t>(expected.begin(), expected.end()));
            const std::set<std::uint32_t>& all = manifolds_of_root[root];
            EXPECT_EQ(std::vector<std::uint32_t>(manifolds.begin(), manifolds.end()), std::vector<std::uint32_t>(all.begin(), all.end()));
        }
    }
}

}  // namespace
}  // namespace carom::dynamics
